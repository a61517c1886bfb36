//! The border to IDA: calls of the C library and its callbacks.
//!
//! A [`Session`] owns what the library allocates; `sundials.rs` has what it shares with other solvers.
#![allow(unsafe_code)]

use std::ffi::{c_int, c_void};
use std::ptr;

use sundials_sys as sys;

use crate::problem::EvalFailure;
use crate::sundials::{
    BadEvaluation, Context, DenseSolver, Failed, Handler, Vector, check, first_not_finite, made, on_message, scatter,
    slice, slice_mut,
};
use crate::{DaeProblem, Function, Options};

type Bridge = crate::sundials::Bridge<dyn DaeProblem>;

/// Counts of the library since the last start.
#[derive(Clone, Copy, Default)]
pub(super) struct Counts {
    pub error_test_failures: u64,
    pub solve_failures: u64,
    pub setups: u64,
    pub iterations: u64,
    pub iteration_failures: u64,
    pub jacobians: u64,
}

/// IDA for one problem size.
pub(super) struct Session {
    memory: *mut c_void,
    y: Vector,
    dy: Vector,
    work: Vector,
    atol: Vector,
    /// Which components are differential, or, during the steps, which count in the error test.
    id: Vector,
    dense: DenseSolver,
    bridge: Box<Bridge>,
    initialized: bool,
    rtol: f64,
    max_order: Option<u8>,
    iteration_tolerance: f64,
    context: Context,
}

// SAFETY: the session owns all that its pointers lead to, shares none of it with another session,
// and the library keeps no state per thread. The problem's pointer is empty between calls.
unsafe impl Send for Session {}

impl Session {
    pub(super) fn new(n: usize, options: &Options) -> Result<Self, Failed> {
        let context = Context::new()?;
        let y = Vector::new(n, 0.0, &context)?;
        let dense = DenseSolver::new(&y, &context)?;
        let mut session = Self {
            memory: ptr::null_mut(),
            y,
            dy: Vector::new(n, 0.0, &context)?,
            work: Vector::new(n, 0.0, &context)?,
            atol: Vector::new(n, 1.0, &context)?,
            id: Vector::new(n, 1.0, &context)?,
            dense,
            bridge: Bridge::new(n),
            initialized: false,
            rtol: options.rtol,
            max_order: options.max_order,
            iteration_tolerance: options.iteration_tolerance,
            context,
        };
        session.atol.as_mut_slice().copy_from_slice(&options.atol);
        // SAFETY: a plain constructor; the pointer is checked before it is used, and freed by Drop.
        session.memory = made("making the solver", unsafe { sys::IDACreate(session.context.raw()) })?;
        silence(session.memory);
        Ok(session)
    }

    /// Starts or restarts at `(t, y, dy)`. `tested`: which components count in the error test.
    pub(super) fn start(
        &mut self,
        problem: &dyn DaeProblem,
        t: f64,
        [y, dy]: [&[f64]; 2],
        tested: impl Fn(usize) -> bool,
        h_first: Option<f64>,
        h_max: f64,
    ) -> Result<(), Failed> {
        self.restart(problem, t, [y, dy])?;
        let all = (0..y.len()).all(&tested);
        self.set_id(tested)?;
        // SAFETY: calls of an initialized solver.
        unsafe {
            check("setting suppress_algebraic", sys::IDASetSuppressAlg(self.memory, c_int::from(!all)))?;
            check("setting h_first", sys::IDASetInitStep(self.memory, h_first.unwrap_or(0.0)))?;
        }
        self.set_h_max(h_max)
    }

    /// Moves `y` and `dy` to where the equations hold, with the differential components of `y` left
    /// as they are.
    pub(super) fn correct_start(
        &mut self,
        problem: &mut dyn DaeProblem,
        t: f64,
        [y, dy]: [&mut [f64]; 2],
        t_towards: f64,
    ) -> Result<(), Failed> {
        self.restart(problem, t, [y, dy])?;
        self.set_id(|i| problem.differential()[i])?;
        self.enter(problem);
        // SAFETY: calls of an initialized solver; `enter` has set the problem, which outlives the call.
        let code = unsafe {
            sys::IDASetInitStep(self.memory, 0.0);
            sys::IDASetSuppressAlg(self.memory, 0);
            sys::IDACalcIC(self.memory, sys::IDA_YA_YDP_INIT as c_int, t_towards)
        };
        self.bridge.leave();
        check("correcting the start", code)?;
        // SAFETY: call of an initialized solver with vectors of its length.
        let got = unsafe { sys::IDAGetConsistentIC(self.memory, self.y.raw(), self.dy.raw()) };
        check("reading the corrected start", got)?;
        y.copy_from_slice(self.y.as_slice());
        dy.copy_from_slice(self.dy.as_slice());
        Ok(())
    }

    fn restart(&mut self, problem: &dyn DaeProblem, t: f64, [y, dy]: [&[f64]; 2]) -> Result<(), Failed> {
        self.y.as_mut_slice().copy_from_slice(y);
        self.dy.as_mut_slice().copy_from_slice(dy);
        self.bridge.bad = None;
        if self.initialized {
            // SAFETY: all were made by `new`.
            let set = unsafe { sys::IDAReInit(self.memory, t, self.y.raw(), self.dy.raw()) };
            check("restarting", set)?;
        } else {
            self.initialize(t)?;
            self.initialized = true;
        }
        self.bridge.jacobian.resize(problem.pattern().map_or(0, crate::Pattern::nnz), 0.0);
        let exact = problem.pattern().is_some();
        // SAFETY: call of an initialized solver; a null function makes the library take differences.
        check("setting the Jacobian", unsafe {
            sys::IDASetJacFn(self.memory, if exact { Some(on_jacobian) } else { None })
        })
    }

    fn initialize(&mut self, t: f64) -> Result<(), Failed> {
        let memory = self.memory;
        let bridge: *mut Bridge = &mut *self.bridge;
        // SAFETY: the solver and its parts were made by `new`; the bridge lives in its box as long.
        unsafe {
            check("initializing", sys::IDAInit(memory, Some(on_residual), t, self.y.raw(), self.dy.raw()))?;
            check("setting user data", sys::IDASetUserData(memory, bridge.cast()))?;
            check("setting tolerances", sys::IDASVtolerances(memory, self.rtol, self.atol.raw()))?;
            let set = sys::IDASetLinearSolver(memory, self.dense.linear, self.dense.matrix);
            check("attaching the linear solver", set)?;
            if let Some(order) = self.max_order {
                check("setting max_order", sys::IDASetMaxOrd(memory, c_int::from(order)))?;
            }
            let set = sys::IDASetNonlinConvCoef(memory, self.iteration_tolerance);
            check("setting iteration_tolerance", set)?;
            let set = sys::IDASetMaxConvFails(memory, 30) | sys::IDASetMaxErrTestFails(memory, 20);
            check("setting limits", set)
        }
    }

    fn set_id(&mut self, id: impl Fn(usize) -> bool) -> Result<(), Failed> {
        for (i, v) in self.id.as_mut_slice().iter_mut().enumerate() {
            *v = f64::from(u8::from(id(i)));
        }
        // SAFETY: call of an initialized solver, which copies the vector.
        check("setting the kinds of the components", unsafe { sys::IDASetId(self.memory, self.id.raw()) })
    }

    pub(super) fn set_h_max(&mut self, h: f64) -> Result<(), Failed> {
        if !self.initialized {
            return Ok(());
        }
        // Zero stands for no limit.
        let h = if h.is_finite() { h } else { 0.0 };
        // SAFETY: call of an initialized solver.
        check("setting h_max", unsafe { sys::IDASetMaxStep(self.memory, h) })
    }

    /// One step towards `t_stop`; returns the time reached, and leaves the state in [`y`](Self::y)
    /// and [`dy`](Self::dy).
    pub(super) fn step(&mut self, problem: &mut dyn DaeProblem, t_stop: f64, t_towards: f64) -> Result<f64, Failed> {
        let mut t = 0.0;
        // SAFETY: call of an initialized solver.
        check("setting the stop", unsafe { sys::IDASetStopTime(self.memory, t_stop) })?;
        self.enter(problem);
        let one_step = sys::IDA_ONE_STEP as c_int;
        // SAFETY: as above; `enter` has set the problem, which outlives the call.
        let code = unsafe { sys::IDASolve(self.memory, t_towards, &mut t, self.y.raw(), self.dy.raw(), one_step) };
        self.bridge.leave();
        check("stepping", code)?;
        if self.bridge.bad.is_some_and(|bad| bad.t <= t) {
            self.bridge.bad = None;
        }
        Ok(t)
    }

    /// Shows the problem to the callbacks, until the bridge is left.
    fn enter(&mut self, problem: &mut dyn DaeProblem) {
        let pointer: *mut (dyn DaeProblem + '_) = problem;
        // SAFETY: only the lifetime changes; the pointer is removed before the caller's borrow ends.
        let pointer =
            unsafe { std::mem::transmute::<*mut (dyn DaeProblem + '_), *mut (dyn DaeProblem + 'static)>(pointer) };
        self.bridge.problem = Some(pointer);
    }

    /// The interpolant of the last step at `t`, or its derivative.
    pub(super) fn interpolate(&mut self, t: f64, derivative: u8, y: &mut [f64]) -> Result<(), Failed> {
        let k = c_int::from(derivative);
        // SAFETY: call of an initialized solver with a vector of its length.
        check("interpolating", unsafe { sys::IDAGetDky(self.memory, t, k, self.work.raw()) })?;
        y.copy_from_slice(self.work.as_slice());
        Ok(())
    }

    pub(super) fn y(&self) -> &[f64] {
        self.y.as_slice()
    }

    pub(super) fn dy(&self) -> &[f64] {
        self.dy.as_slice()
    }

    pub(super) fn last_order(&self) -> u8 {
        let mut order = 0;
        // SAFETY: reads one number of the solver.
        unsafe { sys::IDAGetLastOrder(self.memory, &mut order) };
        u8::try_from(order).unwrap_or(0)
    }

    /// Size of the step to come.
    pub(super) fn next_step_size(&self) -> f64 {
        let mut h = 0.0;
        // SAFETY: reads one number of the solver.
        unsafe { sys::IDAGetCurrentStep(self.memory, &mut h) };
        h
    }

    /// Factor by which the tolerances are too small.
    pub(super) fn tolerance_factor(&self) -> f64 {
        let mut factor = 0.0;
        // SAFETY: reads one number of the solver.
        unsafe { sys::IDAGetTolScaleFactor(self.memory, &mut factor) };
        factor
    }

    /// Component with the largest error estimate relative to its tolerance, of those that count.
    pub(super) fn worst_component(&mut self) -> usize {
        // SAFETY: call of an initialized solver with a vector of its length.
        unsafe { sys::IDAGetEstLocalErrors(self.memory, self.work.raw()) };
        let (error, y) = (self.work.as_slice(), self.y());
        let (atol, counts) = (self.atol.as_slice(), self.id.as_slice());
        let relative = |i: usize| (counts[i] * error[i] / (atol[i] + self.rtol * y[i].abs())).abs();
        (0..y.len()).max_by(|&i, &j| relative(i).total_cmp(&relative(j))).unwrap_or(0)
    }

    pub(super) fn counts(&self) -> Counts {
        let mut raw = [0; 6];
        let [a, b, c, d, e, f] = &mut raw;
        // SAFETY: each call writes one number.
        unsafe {
            sys::IDAGetNumErrTestFails(self.memory, a);
            sys::IDAGetNumStepSolveFails(self.memory, b);
            sys::IDAGetNumLinSolvSetups(self.memory, c);
            sys::IDAGetNumNonlinSolvIters(self.memory, d);
            sys::IDAGetNumNonlinSolvConvFails(self.memory, e);
            sys::IDAGetNumJacEvals(self.memory, f);
        }
        let [a, b, c, d, e, f] = raw.map(|count| u64::try_from(count).unwrap_or(0));
        Counts {
            error_test_failures: a,
            solve_failures: b,
            setups: c,
            iterations: d,
            iteration_failures: e,
            jacobians: f,
        }
    }

    /// Evaluations of the residual since this session was made.
    pub(super) fn evaluations(&self) -> u64 {
        self.bridge.evaluations
    }

    /// The last evaluation that failed, if the steps have not gone past it.
    pub(super) fn bad_evaluation(&self) -> Option<BadEvaluation> {
        self.bridge.bad
    }

    /// Time of the last evaluation of the residual.
    pub(super) fn t_last_evaluation(&self) -> f64 {
        self.bridge.t_last
    }
}

impl Drop for Session {
    fn drop(&mut self) {
        if !self.memory.is_null() {
            // SAFETY: made by `new`, and freed once, before the vectors, the matrix and the context.
            unsafe { sys::IDAFree(&mut self.memory) };
        }
    }
}

/// Keeps version 6 of the library from printing; the context does so for version 7.
///
/// A name that the bindings lack resolves to the stand-in outside, as the glob import in the body
/// goes before what is in scope around it.
fn silence(memory: *mut c_void) {
    #[allow(unused_imports)]
    use sundials_sys::*;
    // SAFETY: it was just made; the handler touches none of its arguments.
    unsafe { IDASetErrHandlerFn(memory, Some(on_message as Handler), ptr::null_mut::<c_void>()) };
}

#[allow(dead_code, non_snake_case)]
unsafe fn IDASetErrHandlerFn<M, H, D>(_: M, _: H, _: D) -> c_int {
    0
}

unsafe extern "C" fn on_residual(
    t: f64,
    y: sys::N_Vector,
    dy: sys::N_Vector,
    r: sys::N_Vector,
    data: *mut c_void,
) -> c_int {
    // SAFETY: the library hands back the bridge and vectors of the session's length, of which `r`
    // does not overlap the others.
    unsafe {
        let bridge = &mut *data.cast::<Bridge>();
        let n = bridge.n;
        let (y, dy, r) = (slice(y, n), slice(dy, n.max(1)), slice_mut(r, n.max(1)));
        bridge.t_last = t;
        bridge.evaluations += 1;
        if n == 0 {
            r[0] = dy[0];
        }
        let (dy, r) = (&dy[..n], &mut r[..n]);
        bridge.call(Function::Residual, t, |problem, _| {
            problem.residual(t, y, dy, r)?;
            Ok(first_not_finite(r))
        })
    }
}

unsafe extern "C" fn on_jacobian(
    t: f64,
    c: f64,
    y: sys::N_Vector,
    dy: sys::N_Vector,
    _r: sys::N_Vector,
    jacobian: sys::SUNMatrix,
    data: *mut c_void,
    _tmp1: sys::N_Vector,
    _tmp2: sys::N_Vector,
    _tmp3: sys::N_Vector,
) -> c_int {
    // SAFETY: the library hands back the bridge, vectors of the session's length and its dense
    // matrix, already set to zero.
    unsafe {
        let bridge = &mut *data.cast::<Bridge>();
        let n = bridge.n;
        if n == 0 {
            *sys::SUNDenseMatrix_Column(jacobian, 0) = c;
        }
        let (y, dy) = (slice(y, n), slice(dy, n));
        bridge.call(Function::Jacobian, t, |problem, values| {
            problem.jacobian(t, y, dy, c, values)?;
            let pattern = problem.pattern().ok_or(EvalFailure::Fatal)?;
            Ok(scatter(pattern, values, jacobian))
        })
    }
}
