//! Random programs: straight-line code over any scalar, the same for the same seed.

use std::sync::Arc;

use headland_expr::ops::{Form, OPS, Op, apply};
use headland_expr::{Field, Scalar, Spline, Wave};

/// SplitMix64.
pub struct Random(pub u64);

impl Random {
    pub fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }
    pub fn below(&mut self, n: usize) -> usize {
        (self.next() % n as u64) as usize
    }
    pub fn between(&mut self, lo: f64, hi: f64) -> f64 {
        lo + (hi - lo) * (self.next() >> 11) as f64 / (1u64 << 53) as f64
    }
}

enum Step {
    Constant(f64),
    Power(usize, i32),
    Table(usize, u8),
    Field([usize; 3], usize),
    Apply(Op, [usize; 3]),
}

/// Operations on earlier results; the inputs come first.
pub struct Program {
    steps: Vec<Step>,
    inputs: usize,
    table: Spline,
    field: Arc<dyn Field>,
}

impl Program {
    /// `length` random steps over `inputs` inputs; half of them sums and products, the rest any row of the table.
    pub fn new(random: &mut Random, inputs: usize, length: usize) -> Self {
        let x: Vec<f64> = (0..6).map(|i| f64::from(i) - 2.5 + 0.3 * random.between(0.0, 1.0)).collect();
        let y: Vec<f64> = x.iter().map(|_| random.between(-1.0, 1.0)).collect();
        let table = Spline::new("table", &x, &y).unwrap();
        let (rate, phase) = ([0.7, -1.1, 0.4], [0.1, 1.3, -0.6]);
        let field = Arc::new(Wave { name: "wave".into(), rate, phase });
        let infix: Vec<Op> = OPS.iter().filter(|r| matches!(r.form, Form::Infix(_))).map(|r| r.op).collect();
        let steps = (0..length)
            .map(|k| {
                let known = inputs + k;
                let pick = |random: &mut Random| {
                    // Mostly recent results, so that the program is deep.
                    if random.below(2) == 0 { random.below(known) } else { known - 1 - random.below(known.min(4)) }
                };
                let args = [pick(random), pick(random), pick(random)];
                match random.below(17) {
                    0 => Step::Constant([0.0, 1.0, -1.0, 2.0, 0.5, -3.0, 1e-3][random.below(7)]),
                    1 | 2 => Step::Power(args[0], random.below(9) as i32 - 3),
                    3 => Step::Table(args[0], random.below(4) as u8),
                    4..=9 => Step::Apply(infix[random.below(infix.len())], args),
                    10 => Step::Field(args, random.below(10)), // to the second order: tests derive once more
                    _ => Step::Apply(OPS[random.below(OPS.len())].op, args),
                }
            })
            .collect();
        Self { steps, inputs, table, field }
    }

    /// Its field.
    #[allow(dead_code)] // not every test file asks
    pub fn field(&self) -> &Arc<dyn Field> {
        &self.field
    }

    /// Its table.
    #[allow(dead_code)] // not every test file asks
    pub fn table(&self) -> &Spline {
        &self.table
    }

    /// All results, inputs included.
    pub fn run<S: Scalar>(&self, inputs: &[S]) -> Vec<S> {
        assert_eq!(inputs.len(), self.inputs);
        let mut value = inputs.to_vec();
        for step in &self.steps {
            value.push(match *step {
                Step::Constant(x) => S::constant(x),
                Step::Power(a, n) => value[a].powi(n),
                Step::Table(a, order) => value[a].spline(&self.table, order),
                Step::Field(point, part) => S::field(point.map(|a| value[a]), &self.field, part),
                Step::Apply(op, [a, b, c]) => apply(op, value[a], value[b], value[c]),
            });
        }
        value
    }
}

/// Equal up to rounding that may have been magnified by `1/tolerance`.
pub fn close(a: f64, b: f64, tolerance: f64) -> bool {
    a == b || (a - b).abs() <= tolerance * (1.0 + a.abs().max(b.abs()))
}
