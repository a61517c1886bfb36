//! Tables of two variables: units, files, dimensions, and what wrong ones are told.

use headland_model::Scene;

const EVEN: &str = "x = [0, 10, 20, 30, 40, 50], y = [-1, 0, 1, 2, 3, 4, 5]";

/// Seven rows of six heights, by their places.
fn heights(z: impl Fn(f64, f64) -> f64) -> String {
    let row =
        |j: i32| (0..6).map(|i| z(10.0 * f64::from(i), f64::from(j - 1)).to_string()).collect::<Vec<_>>().join(", ");
    let rows: Vec<String> = (0..7).map(|j| format!("[{}]", row(j))).collect();
    format!("z = [{}]", rows.join(", "))
}

/// A scene with a table and an output made of it.
fn scene(table: &str, output: &str) -> String {
    format!(
        "[tables]\nground = {table}\n[coordinates]\nx = \"m\"\ny = \"m\"\n[initial]\nx = 0.12\ny = 1.7\n\
         \"x'\" = 0\n\"y'\" = 0\n[[inertia]]\nname = \"m\"\nvalue = \"1 kg\"\ngeometric = \"x\"\n\
         [[inertia]]\nname = \"n\"\nvalue = \"1 kg\"\ngeometric = \"y\"\n[outputs]\ncolumns = [\"{output}\"]\n"
    )
}

/// The output at `x = 0.12 m`, `y = 1.7 m`.
fn value(name: &str, table: &str, output: &str) -> f64 {
    let text = scene(table, output);
    let model = Scene::parse(name, &text).and_then(|s| s.build()).unwrap_or_else(|e| panic!("{e}"));
    let mut x = vec![0.0; model.graph.input_count()];
    x[model.input_index(model.coordinates[0].q)] = 0.12;
    x[model.input_index(model.coordinates[1].q)] = 1.7;
    model.graph.eval(&[model.outputs[0].node], &x)[0]
}

fn error(table: &str, output: &str) -> String {
    let text = scene(table, output);
    Scene::parse("scene.toml", &text).and_then(|s| s.build()).expect_err("a wrong table").to_string()
}

/// A bilinear height and one of degree 5, which the spline has exactly.
#[test]
fn numbers_are_in_the_units_of_the_table() {
    let table =
        format!("{{ {EVEN}, {}, x_unit = \"cm\", y_unit = \"m\", z_unit = \"mm\" }}", heights(|x, y| 3.0 * x + x * y));
    // 0.12 m are 12 cm
    let h = value("scene.toml", &table, "ground(x, y)");
    assert!((h - 1e-3 * (36.0 + 12.0 * 1.7)).abs() < 1e-14, "{h}");
    let table = format!("{{ {EVEN}, {} }}", heights(|x, y| 1e-4 * x * x * x * y.powi(5)));
    let h = value("scene.toml", &table, "ground(100*x, y)");
    assert!((h - 1e-4 * 12.0f64.powi(3) * 1.7f64.powi(5)).abs() < 1e-11, "{h}");
}

#[test]
fn a_file_stands_beside_the_scene() {
    let folder = std::env::temp_dir().join(format!("headland-tables-{}", std::process::id()));
    std::fs::create_dir_all(&folder).expect("a folder");
    let mut text = String::from("x, y, z\n# a comment\n");
    for i in 0..6 {
        for j in 0..7 {
            let (x, y) = (10.0 * f64::from(i), f64::from(j - 1));
            text += &format!("{x}, {y}, {}\n", 3.0 * x + x * y);
        }
    }
    std::fs::write(folder.join("hills.csv"), &text).expect("a file");
    let name = folder.join("scene.toml").display().to_string();
    let file = "{ file = \"hills.csv\", x_unit = \"cm\", y_unit = \"m\", z_unit = \"mm\" }";
    let inline =
        format!("{{ {EVEN}, {}, x_unit = \"cm\", y_unit = \"m\", z_unit = \"mm\" }}", heights(|x, y| 3.0 * x + x * y));
    let (a, b) = (value(&name, file, "ground(x, y)"), value("scene.toml", &inline, "ground(x, y)"));
    assert!((a - b).abs() < 1e-16, "{a} {b}");

    std::fs::write(folder.join("hills.csv"), text.replace("20, 3, 120", "20, 3, high")).expect("a file");
    let found =
        Scene::parse(&name, &scene(file, "ground(x, y)")).and_then(|s| s.build()).expect_err("a word").to_string();
    assert!(found.contains("scene.toml:2:20") && found.contains("hills.csv: ") && found.contains("line "), "{found}");
    std::fs::remove_dir_all(&folder).expect("removed");
}

#[test]
fn dimensions_are_those_of_the_units() {
    let table = format!("{{ {EVEN}, {}, x_unit = \"cm\", y_unit = \"m\", z_unit = \"N\" }}", heights(|x, y| x + y));
    let message = error(&table, "ground(x, y) + x");
    assert!(message.contains("cannot add `ground(x, y)` and `x`"), "{message}");
    let message = error(&table, "ground(x, t)");
    assert!(message.contains("the second argument of the table `ground` is a length [m], but"), "{message}");
    // Without units they are what their place needs.
    value("scene.toml", &format!("{{ {EVEN}, {} }}", heights(|x, y| x + y)), "x + ground(x, y)");
    let message = error(&format!("{{ {EVEN}, {} }}", heights(|x, y| x + y)), "ground(x, y) + ground(t, y)");
    assert!(message.contains("the first argument of the table `ground`"), "{message}");
}

#[test]
fn wrong_tables_are_told_with_their_place() {
    let rows = heights(|x, y| x + y);
    let check = |table: &str, output: &str, wanted: &[&str]| {
        let message = error(table, output);
        assert!(wanted.iter().all(|part| message.contains(part)), "{wanted:?} in {message}");
    };
    let good = format!("{{ {EVEN}, {rows} }}");
    check(&good, "ground(x)", &["takes 2 arguments, found 1"]);
    check(&good, "ground*x", &["used as a function: `ground(x, y)`"]);
    check(&good, "groud(x, y)", &["did you mean `ground`"]);
    let uneven = good.replace("10, 20, 30", "10, 20, 31");
    check(&uneven, "ground(x, y)", &["scene.toml:2:28", "even steps, but point 4 is 31, and 30 was expected"]);
    check(
        &good.replace("[0, 10,", "[10, 0,"),
        "ground(x, y)",
        &["scene.toml:2:21", "must grow by even steps, but point 2 is 0"],
    );
    check(&good.replace("y = [-1, 0,", "y = [0,"), "ground(x, y)", &["z has 7 row(s), but y has 6 point(s)"]);
    check(&good.replace("[-1, 9,", "[9,"), "ground(x, y)", &["row 1 of z has 5 number(s), but x has 6 point(s)"]);
    check(&good.replace("[-1, 9,", "[\"a\", 9,"), "ground(x, y)", &["the points of a table are numbers"]);
    check(&format!("{{ {EVEN}, z = 3 }}"), "ground(x, y)", &["rows of numbers"]);
    check("{ x = [0, 1], z = [[1]] }", "ground(x, y)", &["a row of z for each y"]);
    check("{ x = [0, 1, 2], y = [0, 1], z = [[1, 2, 3], [1, 2, 3]] }", "ground(x, y)", &["at least 6 of each"]);
    check("{ x = [0], y = [0, 1], z = [[1], [2]] }", "ground(x, y)", &["x has 1 point(s)"]);
    check(&good.replace("z =", "zz = 1, z ="), "ground(x, y)", &["not `zz`"]);
    check("{ file = \"no such file.csv\" }", "ground(x, y)", &["cannot read `no such file.csv`", "scene.toml:2:20"]);
    check("{ file = 3 }", "ground(x, y)", &["the file of a table is a number"]);
    check(&good.replace("z =", "file = \"a.csv\", z ="), "ground(x, y)", &["has points in its file already"]);
    check(&good.replace("z =", "z_unit = \"furlong\", z ="), "ground(x, y)", &["furlong"]);
    check(&good.replace("z =", "z_unit = 3, z ="), "ground(x, y)", &["`z_unit` is a number; a unit was expected"]);
}
