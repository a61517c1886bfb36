//! [`TapeFunction`]: a graph as an array of instructions over reused slots, and its interpreter.

use std::ops::Range;
use std::sync::Arc;

use headland_expr::ops::apply;
use headland_expr::{FIELD_PARTS, Field, Graph, NodeId, Op, Scalar, Spline};

use crate::function::{Evaluator, Function};
use crate::group::group;
use crate::lanes::{Lanes, Lanes4, Lanes8};
use crate::lower::{Code, Lowered, NONE, Step, lower};
use crate::program::Program;

/// `y = f(x)` as a tape: the portable back end, without latency and without unsafe code.
///
/// The slots of an evaluator are inputs, constants, outputs and temporaries in one array, so that every operand is an
/// index and an output needs no copy. Equal instructions stand side by side and are interpreted in runs. A constant is
/// a slot that is filled once, so no instruction needs a form with a number in it. A field is evaluated once a point, its
/// value and derivatives side by side in slots of their own. Memory: 16 bytes a node of the
/// graph, 6 bytes an instruction (12 beyond 65 536 slots); compiling is linear in the operations.
///
/// No multiplication is contracted with an addition: a fused multiply-add rounds once where the graph rounds
/// twice.
#[derive(Clone, Debug)]
pub struct TapeFunction {
    program: Arc<Program>,
    tape: Arc<Tape>,
}

impl TapeFunction {
    fn new(program: Program) -> Self {
        let mut lowered = lower(&program);
        group(&mut lowered.steps, lowered.values);
        Self { tape: Arc::new(Tape::new(lowered)), program: Arc::new(program) }
    }

    /// Number of instructions: powers are spelled out, sine with cosine is one, a field with its derivatives is one.
    pub fn instructions(&self) -> usize {
        let rows_each = |run: &Run| if matches!(run.code, Code::Select | Code::Field) { 2 } else { 1 };
        self.tape.runs.iter().map(|run| (run.end - run.start) as usize / rows_each(run)).sum()
    }

    /// Number of slots, 8 bytes each for one point.
    pub fn slots(&self) -> usize {
        self.tape.slots
    }
}

impl Function for TapeFunction {
    type Evaluator = TapeEvaluator;

    fn compile(graph: &Graph, outputs: &[NodeId]) -> Self {
        Self::new(Program::from_graph(graph, outputs))
    }
    fn inputs(&self) -> usize {
        self.program.inputs
    }
    fn outputs(&self) -> usize {
        self.program.outputs.len()
    }
    fn operations(&self) -> usize {
        self.program.operations()
    }
    fn keep_outputs(&self, keep: &[usize]) -> Self {
        Self::new(self.program.keep_outputs(keep))
    }
    fn bind(&self, known: &[(usize, f64)]) -> Self {
        Self::new(self.program.bind(known))
    }
    fn evaluator(&self) -> TapeEvaluator {
        TapeEvaluator {
            inputs: self.inputs(),
            slots: self.tape.new_slots(),
            slots4: Vec::new(),
            slots8: Vec::new(),
            many: vec![Vec::new(); self.outputs()],
            tape: self.tape.clone(),
        }
    }
}

/// Slots of one thread for a [`TapeFunction`]; those for lanes are made when first needed.
#[derive(Clone, Debug)]
pub struct TapeEvaluator {
    tape: Arc<Tape>,
    inputs: usize,
    slots: Vec<f64>,
    slots4: Vec<Lanes4>,
    slots8: Vec<Lanes8>,
    many: Vec<Vec<f64>>,
}

impl Evaluator for TapeEvaluator {
    fn eval(&mut self, x: &[f64]) -> &[f64] {
        assert_eq!(x.len(), self.inputs, "eval: length of x and number of inputs");
        for (slot, &input) in self.slots.iter_mut().zip(&self.tape.loads) {
            *slot = x[input as usize];
        }
        self.tape.run(&mut self.slots);
        &self.slots[self.tape.outputs.clone()]
    }

    fn eval_many(&mut self, x: &[&[f64]]) -> &[Vec<f64>] {
        assert_eq!(x.len(), self.inputs, "eval_many: length of x and number of inputs");
        let points = x.first().map_or(1, |row| row.len());
        assert!(x.iter().all(|row| row.len() == points), "eval_many: every input needs {points} points");
        for row in &mut self.many {
            row.resize(points, 0.0);
        }
        if points >= Lanes4::WIDTH && self.slots4.is_empty() {
            self.slots4 = self.tape.new_slots();
            self.slots8 = self.tape.new_slots();
        }
        let mut done = self.tape.run_groups(0, x, &mut self.slots8, &mut self.many);
        done = self.tape.run_groups(done, x, &mut self.slots4, &mut self.many);
        self.tape.run_groups(done, x, &mut self.slots, &mut self.many);
        &self.many
    }
}

/// So many instructions of one kind.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
struct Run {
    code: Code,
    op: Op,
    /// Its instructions are these rows.
    start: u32,
    end: u32,
}

/// Slots `[dst, a, b]` of an instruction; what they mean is said at [`Code`].
type Row<I> = [I; 3];

#[derive(Debug)]
enum Rows {
    Short(Vec<Row<u16>>),
    Long(Vec<Row<u32>>),
}

/// Slots are, in this order: the inputs that are needed, constants, outputs, parts of fields, temporaries.
#[derive(Debug)]
struct Tape {
    runs: Vec<Run>,
    rows: Rows,
    slots: usize,
    /// The input of slot 0, 1, …
    loads: Vec<u32>,
    /// Slots that hold a number from the start.
    constants: Vec<(u32, f64)>,
    outputs: Range<usize>,
    immediates: Immediates,
}

/// What an instruction may refer to beside slots.
#[derive(Debug)]
struct Immediates {
    /// Tables, each with the order of the derivative.
    tables: Vec<(Arc<Spline>, u8)>,
    /// Fields, each with the order up to which it is evaluated.
    fields: Vec<(Arc<dyn Field>, usize)>,
}

impl Tape {
    /// Last step first, so that the first mention of a value is its last use: liveness and slots in one pass.
    fn new(lowered: Lowered) -> Self {
        let mut allocator = Allocator::new(&lowered);
        allocator.copies(&lowered);
        for step in lowered.steps.iter().rev() {
            allocator.instruction(step);
        }
        let Allocator { mut runs, mut rows, constants, outputs, end: slots, .. } = allocator;
        runs.reverse();
        rows.reverse();
        let count = rows.len() as u32;
        for run in &mut runs {
            (run.start, run.end) = (count - run.end, count - run.start);
        }
        let immediates = Immediates { tables: lowered.tables, fields: lowered.fields };
        let most = immediates.tables.len().max(immediates.fields.len());
        let rows = if most.max(slots as usize) <= 1 << 16 {
            Rows::Short(rows.iter().map(|row| row.map(|slot| slot as u16)).collect())
        } else {
            Rows::Long(rows)
        };
        let loads = lowered.loads.iter().map(|&(_, input)| input).collect();
        Self { runs, rows, slots: slots as usize, loads, constants, outputs, immediates }
    }

    fn new_slots<S: Scalar>(&self) -> Vec<S> {
        let mut slots = vec![S::constant(0.0); self.slots];
        for &(slot, x) in &self.constants {
            slots[slot as usize] = S::constant(x);
        }
        slots
    }

    /// Evaluates as many whole groups of lanes as there are from point `start` on; gives the first point left over.
    fn run_groups<L: Lanes>(&self, start: usize, x: &[&[f64]], slots: &mut [L], y: &mut [Vec<f64>]) -> usize {
        let points = x.first().map_or(1, |row| row.len());
        let mut p = start;
        while p + L::WIDTH <= points {
            for (slot, &input) in slots.iter_mut().zip(&self.loads) {
                *slot = L::load(&x[input as usize][p..]);
            }
            self.run(slots);
            for (row, value) in y.iter_mut().zip(&slots[self.outputs.clone()]) {
                value.store(&mut row[p..]);
            }
            p += L::WIDTH;
        }
        p
    }

    fn run<S: Scalar>(&self, slots: &mut [S]) {
        match &self.rows {
            Rows::Short(rows) => run(&self.runs, rows, &self.immediates, slots),
            Rows::Long(rows) => run(&self.runs, rows, &self.immediates, slots),
        }
    }
}

/// An index into the slots.
trait Slot: Copy {
    fn index(self) -> usize;
}
impl Slot for u16 {
    #[inline(always)]
    fn index(self) -> usize {
        usize::from(self)
    }
}
impl Slot for u32 {
    #[inline(always)]
    fn index(self) -> usize {
        self as usize
    }
}

/// The interpreter: one for numbers and lanes, one decision a run.
fn run<S: Scalar, I: Slot>(runs: &[Run], rows: &[Row<I>], immediates: &Immediates, s: &mut [S]) {
    let Immediates { tables, fields } = immediates;
    for run in runs {
        let rows = &rows[run.start as usize..run.end as usize];
        match run.code {
            Code::Add => each(rows, |[y, a, b]| s[y] = s[a] + s[b]),
            Code::Sub => each(rows, |[y, a, b]| s[y] = s[a] - s[b]),
            Code::Mul => each(rows, |[y, a, b]| s[y] = s[a] * s[b]),
            Code::Div => each(rows, |[y, a, b]| s[y] = s[a] / s[b]),
            Code::Neg => each(rows, |[y, a, _]| s[y] = -s[a]),
            Code::Copy => each(rows, |[y, a, _]| s[y] = s[a]),
            Code::SinCos => each(rows, |[y, a, b]| (s[y], s[b]) = s[a].sin_cos()),
            Code::Spline => each(rows, |[y, a, b]| s[y] = s[a].spline(&tables[b].0, tables[b].1)),
            Code::Field => {
                for pair in rows.chunks_exact(2) {
                    let ([y, a, b], [_, c, field]) = (pair[0].map(I::index), pair[1].map(I::index));
                    let (field, order) = &fields[field];
                    let point = [s[a], s[b], s[c]];
                    S::field_parts(point, field, *order, &mut s[y..y + FIELD_PARTS[*order]]);
                }
            }
            Code::Select => {
                for pair in rows.chunks_exact(2) {
                    let ([y, a, b], [_, cond, _]) = (pair[0].map(I::index), pair[1].map(I::index));
                    s[y] = S::select(s[cond], s[a], s[b]);
                }
            }
            Code::Other => each(rows, |[y, a, b]| {
                s[y] = apply(run.op, s[a], s[b], S::constant(0.0));
            }),
        }
    }
}

#[inline(always)]
fn each<I: Slot>(rows: &[Row<I>], mut instruction: impl FnMut([usize; 3])) {
    for row in rows {
        instruction(row.map(I::index));
    }
}

/// Gives values their slots, from the last step to the first.
struct Allocator {
    slot: Vec<u32>,
    /// Slots free again, the most recently used on top.
    free: Vec<u32>,
    constants: Vec<(u32, f64)>,
    outputs: Range<usize>,
    /// First slot that may be given to one value after another.
    shared: u32,
    /// First slot never used.
    end: u32,
    /// The code, last instruction first.
    runs: Vec<Run>,
    rows: Vec<Row<u32>>,
}

impl Allocator {
    /// Inputs, constants, outputs and parts of fields placed; they keep their slots.
    fn new(lowered: &Lowered) -> Self {
        let mut slot = vec![NONE; lowered.values as usize];
        let mut end = 0;
        let mut place = |value: u32| {
            slot[value as usize] = end;
            end += 1;
        };
        lowered.loads.iter().for_each(|&(value, _)| place(value));
        lowered.constants.iter().for_each(|&(value, _)| place(value));
        let outputs = end as usize..end as usize + lowered.outputs.len();
        let constants = lowered.constants.iter().map(|&(value, x)| (slot[value as usize], x)).collect();
        let mut end = outputs.end as u32;
        for step in lowered.steps.iter().filter(|step| step.code == Code::Field) {
            for value in step.dst() {
                slot[value as usize] = end;
                end += 1;
            }
        }
        Self { slot, free: Vec::new(), constants, outputs, shared: end, end, runs: Vec::new(), rows: Vec::new() }
    }

    /// Places each output where it is read; what already has a place (an input, an output seen before) is copied there,
    /// and a constant stands there from the start.
    fn copies(&mut self, lowered: &Lowered) {
        let fixed = self.outputs.start as u32;
        let first_constant = lowered.loads.len() as u32;
        for (dst, &value) in (fixed..).zip(&lowered.outputs) {
            match self.slot[value as usize] {
                NONE => self.slot[value as usize] = dst,
                a if (first_constant..fixed).contains(&a) => {
                    self.constants.push((dst, self.constants[(a - first_constant) as usize].1));
                }
                a => self.push(Code::Copy, Op::Input, &[[dst, a, a]]),
            }
        }
    }

    fn instruction(&mut self, step: &Step) {
        let first = self.used(step.dst);
        let last = self.used(step.dst + u32::from(step.count) - 1);
        // The results' slots are free before the step, so an operand may have one: operands are read first.
        let results: &[u32] = if step.count == 1 { &[first] } else { &[first, last] };
        self.free.extend(results.iter().filter(|&&slot| slot >= self.shared));
        let [a, b, c] = step.src.map(|value| if value == NONE { NONE } else { self.used(value) });
        let y = first;
        match step.code {
            Code::Select => self.push(step.code, step.op, &[[y, a, y], [y, b, c]]),
            Code::SinCos => self.push(step.code, step.op, &[[y, a, last]]),
            Code::Field => self.push(step.code, step.op, &[[y, c, step.table], [y, a, b]]),
            Code::Spline => self.push(step.code, step.op, &[[y, a, step.table]]),
            _ => self.push(step.code, step.op, &[[y, a, if b == NONE { a } else { b }]]),
        }
    }

    /// Before the last one written, to which it joins if it is of the same kind; the last of its rows will stand first.
    fn push(&mut self, code: Code, op: Op, rows: &[Row<u32>]) {
        let start = self.rows.len() as u32;
        self.rows.extend(rows);
        let end = self.rows.len() as u32;
        match self.runs.last_mut() {
            Some(run) if (run.code, run.op) == (code, op) => run.end = end,
            _ => self.runs.push(Run { code, op, start, end }),
        }
    }

    /// The slot of a value; its last use, met first, gives it one.
    fn used(&mut self, value: u32) -> u32 {
        let end = &mut self.end;
        let slot = &mut self.slot[value as usize];
        if *slot == NONE {
            *slot = self.free.pop().unwrap_or_else(|| {
                *end += 1;
                *end - 1
            });
        }
        *slot
    }
}
