//! A free body's angular velocity as quasi-velocities along its own axes or the world's: the same motion.

mod common;

use common::{done, read};
use headland_model::Scene;
use headland_sim::Run;

/// Something that rolls, has a force and a torque, and is looked at from all sides; `ground` is what it rolls on.
fn roller(tensor: &str, ground: &str, world: bool) -> String {
    let (key, names) = if world {
        ("angular_velocity = \"world\"\n", ["omega_x", "omega_y", "omega_z"])
    } else {
        ("", ["wx", "wy", "wz"])
    };
    let [x, y, z] = names;
    format!(
        "[world]\ngravity = [0, 0, -9.81]\n[prescribed]\naxle = \"0.7*t + 0.2*sin(t)\"\n\
         [[body]]\nname = \"table\"\ninertia = [1, 1, 1]\n\
         [[joint]]\nname = \"axle\"\nkind = \"revolute\"\nto = \"table\"\n\
         [[body]]\nname = \"b\"\nmass = 1.5\ninertia = {tensor}\n{key}\
         [[force]]\nname = \"push\"\non = \"b\"\nat = [0.1, 0.2, 0.05]\nforce = [0.3, \"1[N]*sin(t)\", 0.1]\ntorque = [0.02, 0.01, 0.03]\n\
         {ground}\
         [initial]\n\"b.x\" = 0.2\n\"b.y\" = 0.1\n\"b.qw\" = 1\n\"b.qx\" = 0\n\"b.qy\" = 0\n\"b.qz\" = 0\n\"b.{x}\" = 0.3\n\"b.{y}\" = 4\n\"b.{z}\" = 0.5\n\
         [outputs]\ncolumns = [\"b.x\", \"b.y\", \"b.z\", \"b.qw\", \"b.qx\", \"b.qz\", \"b.omega_x\", \"b.omega_z\", \"b.wx\", \
         \"b.wy\", \"b.epsilon_x\", \"b.epsilon_z\", \"b.ax\", \"system.lx\", \"system.lz\", \"system.kinetic_energy\"]\n"
    )
}

fn run(text: &str) -> Run {
    let model = read(text).build().unwrap_or_else(|e| panic!("{e}"));
    let run = done(&model, |o| (o.tolerance, o.until) = (1e-12, 2.0));
    assert!(run.report.energy_balance.is_some_and(|b| b < 1e-11), "{:?}", run.report.energy_balance);
    run
}

const GROUNDS: [&str; 3] = [
    "",
    "[[rolling]]\nname = \"c\"\nbody = \"b\"\non = \"table\"\ncenter = [0.01, 0.02, -0.01]\nradius = 0.3\n",
    "[[surface]]\nname = \"bowl\"\non = \"table\"\nat = [0.05, 0, 0.8]\nshape = \"sphere\"\nradius = 1.2\ninside = true\n\
     [[rolling]]\nname = \"c\"\nbody = \"b\"\non = \"bowl\"\nradius = 0.3\n",
];

#[test]
fn both_axes_give_the_same_motion() {
    for tensor in ["[0.03, 0.05, 0.04, 0.001, 0.002, -0.001]", "[0.04, 0.04, 0.04]"] {
        for ground in GROUNDS {
            let [body, world] = [false, true].map(|world| run(&roller(tensor, ground, world)));
            assert_eq!(body.trajectory.rows.len(), world.trajectory.rows.len());
            for (a, b) in body.trajectory.rows.iter().zip(&world.trajectory.rows) {
                for (i, (x, y)) in a.iter().zip(b).enumerate() {
                    let name = &body.trajectory.names[i];
                    assert!((x - y).abs() < 1e-9 * y.abs().max(1.0), "{tensor} {ground} {name}: {x} {y}");
                }
            }
            assert!(
                body.trajectory.rows.iter().any(|r| (r[8] - r[6]).abs() > 0.1),
                "axes that do not turn prove nothing"
            );
        }
    }
}

#[test]
fn a_wrong_word_and_a_body_with_a_joint_are_told() {
    let message =
        |text: &str| Scene::parse("scene.toml", text).and_then(|s| s.build()).map(|_| ()).unwrap_err().to_string();
    let text = roller("[1, 1, 1]", "", true);
    let wrong = message(&text.replace("\"world\"", "\"space\""));
    assert!(wrong.contains("`angular_velocity` is \"body\" (default) or \"world\""), "{wrong}");
    let jointed = message(&text.replace("name = \"table\"", "name = \"table\"\nangular_velocity = \"world\""));
    assert!(jointed.contains("angular_velocity") && jointed.contains("not free"), "{jointed}");
}
