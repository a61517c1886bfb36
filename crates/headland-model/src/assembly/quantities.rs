//! What expressions can ask of a body or frame: `trailer[2].x`, `wheel.wy`, `fork.yaw`.

use headland_expr::{Expr, Scalar};
use headland_spatial::{Symmetric, Vector};

use super::motion::Motion;
use crate::build::Builder;
use crate::dimension::Dimension;
use crate::lower::{Typed, per_time};

/// Parts of a frame's motion by name, with what they are.
pub(crate) const QUANTITIES: [(&str, &str); 37] = [
    ("x", "position of the origin in the world"),
    ("y", ""),
    ("z", ""),
    ("vx", "velocity of the origin, axes of the world"),
    ("vy", ""),
    ("vz", ""),
    ("ax", "acceleration of the origin, axes of the world"),
    ("ay", ""),
    ("az", ""),
    ("wx", "angular velocity, axes of the frame"),
    ("wy", ""),
    ("wz", ""),
    ("omega_x", "angular velocity, axes of the world"),
    ("omega_y", ""),
    ("omega_z", ""),
    ("epsilon_x", "angular acceleration, axes of the frame"),
    ("epsilon_y", ""),
    ("epsilon_z", ""),
    ("exx", "the frame's x axis in the world"),
    ("exy", ""),
    ("exz", ""),
    ("eyx", "the frame's y axis in the world"),
    ("eyy", ""),
    ("eyz", ""),
    ("ezx", "the frame's z axis in the world"),
    ("ezy", ""),
    ("ezz", ""),
    ("roll", "R = Rz(yaw) Ry(pitch) Rx(roll)"),
    ("pitch", ""),
    ("yaw", ""),
    ("qw", "unit quaternion of the orientation, qw >= 0"),
    ("qx", ""),
    ("qy", ""),
    ("qz", ""),
    ("ux", "velocity of the origin, axes of the frame"),
    ("uy", ""),
    ("uz", ""),
];

impl Builder<'_, '_> {
    /// Hands the motions of the frames to the lowering of expressions.
    pub(crate) fn publish_frames(&mut self) {
        self.low.frames = self.assembly.frames.iter().map(|f| f.motion).collect();
        self.low.totals = self.assembly.total.quantities().into_iter().collect();
    }
}

/// Sums over all bodies.
pub(crate) struct Total<'g> {
    mass: Expr<'g>,
    moment: Vector<Expr<'g>>,
    momentum: Vector<Expr<'g>>,
    angular: Vector<Expr<'g>>,
}

impl Default for Total<'_> {
    fn default() -> Self {
        let zero = Vector::constant([0.0; 3]);
        Self { mass: Expr::constant(0.0), moment: zero, momentum: zero, angular: zero }
    }
}

impl<'g> Total<'g> {
    /// One more body, by the motion of its mass centre.
    pub(super) fn add(&mut self, mass: Expr<'g>, centre: &Motion<'g>, tensor: Symmetric<Expr<'g>>) {
        let momentum = centre.velocity_in_world() * mass;
        self.mass = self.mass + mass;
        self.moment = self.moment + centre.position * mass;
        self.momentum = self.momentum + momentum;
        let spin = match centre.level_spin {
            Some((w, _)) if is_round(&tensor) => w * tensor.0[0],
            _ => centre.rotation.apply(tensor * centre.spin),
        };
        self.angular = self.angular + centre.position.cross(momentum) + spin;
    }

    /// `system.mass`, `system.x` (mass centre), `system.px` (momentum), `system.lx` (angular momentum about the world's
    /// origin).
    pub(super) fn quantities(&self) -> Vec<(String, Typed<'g>)> {
        let typed = |expr, dimension| Typed { expr, ..Typed::number(0.0, dimension) };
        let mut all = vec![("system.mass".to_string(), typed(self.mass, Dimension::of(1, 0, 0)))];
        for (i, axis) in ["x", "y", "z"].into_iter().enumerate() {
            all.push((format!("system.{axis}"), typed(self.moment[i] / self.mass, Dimension::of(0, 1, 0))));
            all.push((format!("system.p{axis}"), typed(self.momentum[i], Dimension::of(1, 1, -1))));
            all.push((format!("system.l{axis}"), typed(self.angular[i], Dimension::of(1, 2, -1))));
        }
        all
    }
}

/// Whether a tensor is the same about all axes, whatever the numbers.
pub(super) fn is_round(tensor: &Symmetric<Expr<'_>>) -> bool {
    let Symmetric([xx, yy, zz, rest @ ..]) = tensor;
    yy == xx && zz == xx && rest.iter().all(|e| e.is(0.0))
}

/// A part of a frame's motion.
pub(crate) fn quantity<'g>(m: &Motion<'g>, part: &str) -> Option<Typed<'g>> {
    let axis = |name: &str| ["x", "y", "z"].iter().position(|a| *a == name);
    let typed = |expr, dimension: Dimension, angle| Some(Typed { expr, angle, ..Typed::number(0.0, dimension) });
    let length = |primes| per_time(&Dimension::of(0, 1, 0), primes);
    let rate = |primes| per_time(&Dimension::NONE, primes);
    let of = |v: Vector<Expr<'g>>, name: &str| axis(name).map(|i| v[i]);
    if let Some(e) = of(m.position, part) {
        return typed(e, length(0), false);
    }
    if let Some(e) = part.strip_prefix("omega_").and_then(|a| of(m.spin_in_world(), a)) {
        return typed(e, rate(1), true);
    }
    if let Some(e) = part.strip_prefix("epsilon_").and_then(|a| of(m.spin_rate, a)) {
        return typed(e, rate(2), true);
    }
    let (roll, pitch, yaw) = m.rotation.roll_pitch_yaw();
    match part {
        "roll" => return typed(roll, Dimension::NONE, true),
        "pitch" => return typed(pitch, Dimension::NONE, true),
        "yaw" => return typed(yaw, Dimension::NONE, true),
        _ => {}
    }
    let mut letters = part.chars();
    let (first, rest) = (letters.next()?, letters.as_str());
    match first {
        'v' => of(m.velocity_in_world(), rest).and_then(|e| typed(e, length(1), false)),
        'a' => of(m.acceleration_in_world(), rest).and_then(|e| typed(e, length(2), false)),
        'u' => of(m.velocity, rest).and_then(|e| typed(e, length(1), false)),
        'w' => of(m.spin, rest).and_then(|e| typed(e, rate(1), true)),
        'e' if rest.len() == 2 => {
            let (column, row) = (axis(&rest[..1])?, axis(&rest[1..])?);
            typed(m.rotation.0[row][column], Dimension::NONE, false)
        }
        'q' => {
            let k = ["w", "x", "y", "z"].iter().position(|a| *a == rest)?;
            typed(quaternion(m)[k], Dimension::NONE, false)
        }
        _ => None,
    }
}

/// The unit quaternion with `qw ≥ 0`: by the largest of its components (Shepperd 1978), as a chain of selections.
fn quaternion<'g>(m: &Motion<'g>) -> [Expr<'g>; 4] {
    let r = &m.rotation.0;
    let c = Expr::constant;
    let trace = r[0][0] + r[1][1] + r[2][2];
    let squares = [trace, r[0][0], r[1][1], r[2][2]]; // largest entry, largest component
    let differences = [r[2][1] - r[1][2], r[0][2] - r[2][0], r[1][0] - r[0][1]];
    let branch = |k: usize| -> [Expr<'g>; 4] {
        // 4 q_k²; not below what it is where it is the largest, so that the other branches stay defined
        let square = (c(1.0) + c(2.0) * squares[k] - trace).max(c(0.1));
        let root = square.sqrt(); // 2 q_k
        let own = c(0.5) * root;
        let part = |x: Expr<'g>| x / (c(2.0) * root);
        match k {
            0 => [own, part(differences[0]), part(differences[1]), part(differences[2])],
            _ => {
                let i = k - 1;
                let mut q = [part(differences[i]); 4];
                for n in 0..3 {
                    q[n + 1] = if n == i { own } else { part(r[n][i] + r[i][n]) };
                }
                let sign = Expr::select(q[0], c(1.0), c(-1.0));
                q.map(|x| x * sign)
            }
        }
    };
    let square = |k: usize| c(2.0) * squares[k] - trace;
    let mut best = (square(0), branch(0));
    for k in 1..4 {
        let here = branch(k);
        let better = square(k) - best.0;
        best = (best.0.max(square(k)), [0, 1, 2, 3].map(|n| Expr::select(better, here[n], best.1[n])));
    }
    best.1
}
