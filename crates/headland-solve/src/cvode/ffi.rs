//! The border to the C library: everything unsafe of this crate is here.
//!
//! A [`Session`] owns what the library allocates. The library's callbacks reach the problem through
//! the [`Bridge`], whose pointer is set for the time of one call only; a panic in a callback is
//! caught, carried past the C frames and thrown again behind them.
#![allow(unsafe_code)]

use std::any::Any;
use std::ffi::{c_int, c_void};
use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};
use std::ptr;

use sundials_sys as sys;

use crate::problem::EvalFailure;
use crate::{Function, OdeProblem, Options};

/// A call of the library that failed.
#[derive(Clone, Copy, Debug)]
pub(super) struct Failed {
    pub doing: &'static str,
    pub code: c_int,
}

/// The last evaluation that failed.
#[derive(Clone, Copy, Debug)]
pub(super) struct BadEvaluation {
    pub function: Function,
    pub t: f64,
    /// First component that is not finite, if that was it.
    pub component: Option<usize>,
}

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

/// What the callbacks see.
struct Bridge {
    n: usize,
    problem: Option<*mut (dyn OdeProblem + 'static)>,
    jacobian: Vec<f64>,
    panic: Option<Box<dyn Any + Send>>,
    bad: Option<BadEvaluation>,
    t_last: f64,
    rhs: u64,
    projections: u64,
}

/// CVODE for one problem size.
pub(super) struct Session {
    context: sys::SUNContext,
    memory: *mut c_void,
    y: sys::N_Vector,
    work: sys::N_Vector,
    atol: sys::N_Vector,
    matrix: sys::SUNMatrix,
    linear: sys::SUNLinearSolver,
    nonlinear: sys::SUNNonlinearSolver,
    bridge: Box<Bridge>,
    initialized: bool,
    projects: bool,
    bdf: bool,
    rtol: f64,
    max_order: Option<u8>,
    stability_limit_detection: bool,
}

// SAFETY: the session owns all that its pointers lead to, shares none of it with another session,
// and the library keeps no state per thread. The problem's pointer is empty between calls.
unsafe impl Send for Session {}

impl Session {
    pub(super) fn new(bdf: bool, n: usize, options: &Options) -> Result<Self, Failed> {
        // The library wants one component at least; ours then is a constant zero.
        let m = n.max(1) as sys::sunindextype;
        let mut session = Self {
            context: ptr::null_mut(),
            memory: ptr::null_mut(),
            y: ptr::null_mut(),
            work: ptr::null_mut(),
            atol: ptr::null_mut(),
            matrix: ptr::null_mut(),
            linear: ptr::null_mut(),
            nonlinear: ptr::null_mut(),
            bridge: Box::new(Bridge {
                n,
                problem: None,
                jacobian: Vec::new(),
                panic: None,
                bad: None,
                t_last: 0.0,
                rhs: 0,
                projections: 0,
            }),
            initialized: false,
            projects: false,
            bdf,
            rtol: options.rtol,
            max_order: options.max_order,
            stability_limit_detection: options.stability_limit_detection,
        };
        let s = &mut session;
        // SAFETY: plain constructors; every pointer is checked before it is used, and freed by Drop.
        unsafe {
            check("making a context", sys::SUNContext_Create(sys::comm_no_mpi(), &mut s.context))?;
            s.y = made("a vector", sys::N_VNew_Serial(m, s.context))?;
            s.work = made("a vector", sys::N_VNew_Serial(m, s.context))?;
            s.atol = made("a vector", sys::N_VNew_Serial(m, s.context))?;
            let atol = std::slice::from_raw_parts_mut(sys::N_VGetArrayPointer(s.atol), m as usize);
            atol.fill(1.0);
            atol[..n].copy_from_slice(&options.atol);
            sys::N_VConst(0.0, s.y);
            let formulas = if bdf { sys::CV_BDF } else { sys::CV_ADAMS };
            s.memory = made("the solver", sys::CVodeCreate(formulas as c_int, s.context))?;
            silence(s.context, s.memory);
            if bdf {
                s.matrix = made("a matrix", sys::SUNDenseMatrix(m, m, s.context))?;
                s.linear = made("a linear solver", sys::SUNLinSol_Dense(s.y, s.matrix, s.context))?;
            } else {
                s.nonlinear = made("a fixed-point solver", sys::SUNNonlinSol_FixedPoint(s.y, 0, s.context))?;
            }
        }
        Ok(session)
    }

    /// Starts or restarts at `(t, y)`.
    pub(super) fn start(
        &mut self,
        problem: &dyn OdeProblem,
        t: f64,
        y: &[f64],
        h_first: Option<f64>,
        h_max: f64,
    ) -> Result<(), Failed> {
        self.y_mut().copy_from_slice(y);
        self.bridge.bad = None;
        if self.initialized {
            // SAFETY: both were made by `new`.
            check("restarting", unsafe { sys::CVodeReInit(self.memory, t, self.y) })?;
        } else {
            self.initialize(t)?;
            self.initialized = true;
        }
        // SAFETY: calls of an initialized solver.
        unsafe {
            let h = h_first.unwrap_or(0.0);
            check("setting h_first", sys::CVodeSetInitStep(self.memory, h))?;
        }
        self.set_h_max(h_max)?;
        if self.bdf {
            let nnz = problem.pattern().map_or(0, crate::Pattern::nnz);
            self.bridge.jacobian.resize(nnz, 0.0);
            let exact = problem.pattern().is_some();
            // SAFETY: as above; a null function makes the library take differences.
            check("setting the Jacobian", unsafe {
                sys::CVodeSetJacFn(self.memory, if exact { Some(on_jacobian) } else { None })
            })?;
            self.set_projection(problem.has_projection())?;
        }
        Ok(())
    }

    fn initialize(&mut self, t: f64) -> Result<(), Failed> {
        let memory = self.memory;
        let bridge: *mut Bridge = &mut *self.bridge;
        // SAFETY: the solver and its parts were made by `new`; the bridge lives in its box as long.
        unsafe {
            check("initializing", sys::CVodeInit(memory, Some(on_rhs), t, self.y))?;
            check("setting user data", sys::CVodeSetUserData(memory, bridge.cast()))?;
            check("setting tolerances", sys::CVodeSVtolerances(memory, self.rtol, self.atol))?;
            if self.bdf {
                check("attaching the linear solver", sys::CVodeSetLinearSolver(memory, self.linear, self.matrix))?;
                let detect = c_int::from(self.stability_limit_detection);
                check("setting stability_limit_detection", sys::CVodeSetStabLimDet(memory, detect))?;
            } else {
                check("attaching the fixed-point solver", sys::CVodeSetNonlinearSolver(memory, self.nonlinear))?;
            }
            if let Some(order) = self.max_order {
                let order = c_int::from(order);
                check("setting max_order", sys::CVodeSetMaxOrd(memory, order))?;
            }
            check(
                "setting limits",
                sys::CVodeSetMaxHnilWarns(memory, -1)
                    | sys::CVodeSetMaxConvFails(memory, 30)
                    | sys::CVodeSetMaxErrTestFails(memory, 20),
            )
        }
    }

    fn set_projection(&mut self, on: bool) -> Result<(), Failed> {
        // SAFETY: calls of an initialized solver.
        unsafe {
            if on && !self.projects {
                let set =
                    sys::CVodeSetProjFn(self.memory, Some(on_projection)) | sys::CVodeSetProjErrEst(self.memory, 0);
                check("setting the projection", set)?;
                self.projects = true;
            }
            if self.projects {
                let frequency = c_long_from(on);
                check("setting the projection", sys::CVodeSetProjFrequency(self.memory, frequency))?;
            }
        }
        Ok(())
    }

    pub(super) fn set_h_max(&mut self, h: f64) -> Result<(), Failed> {
        if !self.initialized {
            return Ok(());
        }
        // Zero stands for no limit.
        let h = if h.is_finite() { h } else { 0.0 };
        // SAFETY: call of an initialized solver.
        check("setting h_max", unsafe { sys::CVodeSetMaxStep(self.memory, h) })
    }

    /// One step towards `t_stop`; returns the time reached, and leaves the state in [`y`](Self::y).
    pub(super) fn step(&mut self, problem: &mut dyn OdeProblem, t_stop: f64, t_towards: f64) -> Result<f64, Failed> {
        let mut t = 0.0;
        // SAFETY: the problem outlives this call, after which its pointer is removed; nothing else
        // uses the problem in the meantime.
        let code = unsafe {
            check("setting the stop", sys::CVodeSetStopTime(self.memory, t_stop))?;
            self.bridge.problem =
                Some(std::mem::transmute::<*mut dyn OdeProblem, *mut (dyn OdeProblem + 'static)>(problem));
            let one_step = sys::CV_ONE_STEP as c_int;
            sys::CVode(self.memory, t_towards, self.y, &mut t, one_step)
        };
        self.bridge.problem = None;
        if let Some(panic) = self.bridge.panic.take() {
            resume_unwind(panic);
        }
        check("stepping", code)?;
        if self.bridge.bad.is_some_and(|bad| bad.t <= t) {
            self.bridge.bad = None;
        }
        Ok(t)
    }

    /// The interpolant of the last step at `t`.
    pub(super) fn interpolate(&mut self, t: f64, y: &mut [f64]) -> Result<(), Failed> {
        // SAFETY: `work` was made by `new` with at least `y.len()` components.
        unsafe {
            check("interpolating", sys::CVodeGetDky(self.memory, t, 0, self.work))?;
            y.copy_from_slice(std::slice::from_raw_parts(sys::N_VGetArrayPointer(self.work), y.len()));
        }
        Ok(())
    }

    pub(super) fn y(&self) -> &[f64] {
        // SAFETY: a serial vector of at least `n` components, made by `new`.
        unsafe { std::slice::from_raw_parts(sys::N_VGetArrayPointer(self.y), self.bridge.n) }
    }

    fn y_mut(&mut self) -> &mut [f64] {
        // SAFETY: as in `y`.
        unsafe { std::slice::from_raw_parts_mut(sys::N_VGetArrayPointer(self.y), self.bridge.n) }
    }

    pub(super) fn last_order(&self) -> u8 {
        let mut order = 0;
        // SAFETY: reads one number of the solver.
        unsafe { sys::CVodeGetLastOrder(self.memory, &mut order) };
        u8::try_from(order).unwrap_or(0)
    }

    /// Size of the step to come.
    pub(super) fn next_step_size(&self) -> f64 {
        let mut h = 0.0;
        // SAFETY: reads one number of the solver.
        unsafe { sys::CVodeGetCurrentStep(self.memory, &mut h) };
        h
    }

    /// Factor by which the tolerances are too small.
    pub(super) fn tolerance_factor(&self) -> f64 {
        let mut factor = 0.0;
        // SAFETY: reads one number of the solver.
        unsafe { sys::CVodeGetTolScaleFactor(self.memory, &mut factor) };
        factor
    }

    /// Component with the largest error estimate relative to its tolerance.
    pub(super) fn worst_component(&mut self, atol: &[f64]) -> usize {
        // SAFETY: both vectors have at least `n` components.
        let error = unsafe {
            sys::CVodeGetEstLocalErrors(self.memory, self.work);
            std::slice::from_raw_parts(sys::N_VGetArrayPointer(self.work), self.bridge.n)
        };
        let y = self.y();
        let relative = |i: usize| (error[i] / (atol[i] + self.rtol * y[i].abs())).abs();
        (0..y.len()).max_by(|&i, &j| relative(i).total_cmp(&relative(j))).unwrap_or(0)
    }

    pub(super) fn counts(&self) -> Counts {
        let mut raw = [0; 6];
        let [a, b, c, d, e, f] = &mut raw;
        // SAFETY: each call writes one number.
        unsafe {
            sys::CVodeGetNumErrTestFails(self.memory, a);
            sys::CVodeGetNumStepSolveFails(self.memory, b);
            sys::CVodeGetNumLinSolvSetups(self.memory, c);
            sys::CVodeGetNumNonlinSolvIters(self.memory, d);
            sys::CVodeGetNumNonlinSolvConvFails(self.memory, e);
            if self.bdf {
                sys::CVodeGetNumJacEvals(self.memory, f);
            }
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

    /// Evaluations of the right-hand side and of the projection since this session was made.
    pub(super) fn evaluations(&self) -> (u64, u64) {
        (self.bridge.rhs, self.bridge.projections)
    }

    /// The last evaluation that failed, if the steps have not gone past it.
    pub(super) fn bad_evaluation(&self) -> Option<BadEvaluation> {
        self.bridge.bad
    }

    /// Time of the last evaluation of the right-hand side.
    pub(super) fn t_last_evaluation(&self) -> f64 {
        self.bridge.t_last
    }
}

impl Drop for Session {
    fn drop(&mut self) {
        // SAFETY: each pointer is either null or was made by `new`, and is freed once.
        unsafe {
            if !self.memory.is_null() {
                sys::CVodeFree(&mut self.memory);
            }
            if !self.linear.is_null() {
                sys::SUNLinSolFree(self.linear);
            }
            if !self.nonlinear.is_null() {
                sys::SUNNonlinSolFree(self.nonlinear);
            }
            if !self.matrix.is_null() {
                sys::SUNMatDestroy(self.matrix);
            }
            for vector in [self.y, self.work, self.atol] {
                if !vector.is_null() {
                    sys::N_VDestroy(vector);
                }
            }
            if !self.context.is_null() {
                sys::SUNContext_Free(&mut self.context);
            }
        }
    }
}

/// Keeps the library from printing: versions 6 and 7 have different functions for it.
///
/// The names that the bindings lack resolve to the stand-ins outside, as the glob import in the body
/// goes before what is in scope around it.
fn silence(context: sys::SUNContext, memory: *mut c_void) {
    #[allow(unused_imports)]
    use sundials_sys::*;
    type Handler = unsafe extern "C" fn(
        c_int,
        *const std::ffi::c_char,
        *const std::ffi::c_char,
        *mut std::ffi::c_char,
        *mut c_void,
    );
    // SAFETY: both were just made; the handler touches none of its arguments.
    unsafe {
        SUNContext_ClearErrHandlers(context);
        CVodeSetErrHandlerFn(memory, Some(on_message as Handler), ptr::null_mut::<c_void>());
    }
}

#[allow(dead_code, non_snake_case)]
unsafe fn SUNContext_ClearErrHandlers<C>(_: C) -> c_int {
    0
}

#[allow(dead_code, non_snake_case)]
unsafe fn CVodeSetErrHandlerFn<M, H, D>(_: M, _: H, _: D) -> c_int {
    0
}

unsafe extern "C" fn on_message(
    _code: c_int,
    _module: *const std::ffi::c_char,
    _function: *const std::ffi::c_char,
    _message: *mut std::ffi::c_char,
    _data: *mut c_void,
) {
}

unsafe extern "C" fn on_rhs(t: f64, y: sys::N_Vector, dy: sys::N_Vector, data: *mut c_void) -> c_int {
    // SAFETY: the library hands back the bridge and two vectors of the session's length, which do
    // not overlap.
    unsafe {
        let bridge = &mut *data.cast::<Bridge>();
        let n = bridge.n;
        let y = std::slice::from_raw_parts(sys::N_VGetArrayPointer(y), n);
        let dy = std::slice::from_raw_parts_mut(sys::N_VGetArrayPointer(dy), n.max(1));
        bridge.t_last = t;
        bridge.rhs += 1;
        if n == 0 {
            dy[0] = 0.0;
        }
        let dy = &mut dy[..n];
        bridge.call(Function::Rhs, t, |problem, _| {
            problem.rhs(t, y, dy)?;
            Ok(first_not_finite(dy))
        })
    }
}

unsafe extern "C" fn on_jacobian(
    t: f64,
    y: sys::N_Vector,
    _fy: sys::N_Vector,
    jacobian: sys::SUNMatrix,
    data: *mut c_void,
    _tmp1: sys::N_Vector,
    _tmp2: sys::N_Vector,
    _tmp3: sys::N_Vector,
) -> c_int {
    // SAFETY: the library hands back the bridge, a vector of the session's length and its dense
    // matrix, already set to zero.
    unsafe {
        let bridge = &mut *data.cast::<Bridge>();
        let n = bridge.n;
        let y = std::slice::from_raw_parts(sys::N_VGetArrayPointer(y), n);
        bridge.call(Function::Jacobian, t, |problem, values| {
            problem.jacobian(t, y, values)?;
            let pattern = problem.pattern().ok_or(EvalFailure::Fatal)?;
            let (ends, rows) = (pattern.col_ptr(), pattern.row_idx());
            for j in 0..n {
                let first = sys::SUNDenseMatrix_Column(jacobian, j as sys::sunindextype);
                let column = std::slice::from_raw_parts_mut(first, n);
                for e in ends[j]..ends[j + 1] {
                    column[rows[e]] = values[e];
                }
            }
            let bad = first_not_finite(values);
            Ok(bad.map(|e| rows[e]))
        })
    }
}

unsafe extern "C" fn on_projection(
    t: f64,
    y: sys::N_Vector,
    correction: sys::N_Vector,
    _tolerance: f64,
    _error: sys::N_Vector,
    data: *mut c_void,
) -> c_int {
    // SAFETY: as in `on_rhs`.
    unsafe {
        let bridge = &mut *data.cast::<Bridge>();
        let n = bridge.n;
        let y = std::slice::from_raw_parts(sys::N_VGetArrayPointer(y), n);
        let correction = std::slice::from_raw_parts_mut(sys::N_VGetArrayPointer(correction), n);
        bridge.projections += 1;
        bridge.call(Function::Projection, t, |problem, _| {
            problem.project(t, y, correction)?;
            Ok(first_not_finite(correction))
        })
    }
}

impl Bridge {
    /// Calls a function of the problem; returns what the library takes for success (0), for a
    /// recoverable (1) and for a fatal failure (-1). `f` returns the first bad component.
    ///
    /// # Safety
    /// The pointer to the problem must be valid, if there is one.
    unsafe fn call(
        &mut self,
        function: Function,
        t: f64,
        f: impl FnOnce(&mut dyn OdeProblem, &mut [f64]) -> Result<Option<usize>, EvalFailure>,
    ) -> c_int {
        let Some(problem) = self.problem else {
            return -1;
        };
        // SAFETY: by contract.
        let problem = unsafe { &mut *problem };
        let values = &mut self.jacobian;
        let outcome = catch_unwind(AssertUnwindSafe(|| f(problem, values)));
        let (component, code) = match outcome {
            Ok(Ok(None)) => return 0,
            Ok(Ok(bad)) => (bad, 1),
            Ok(Err(EvalFailure::Recoverable)) => (None, 1),
            Ok(Err(EvalFailure::Fatal)) => (None, -1),
            Err(panic) => {
                self.panic = Some(panic);
                return -1;
            }
        };
        self.bad = Some(BadEvaluation { function, t, component });
        code
    }
}

fn first_not_finite(values: &[f64]) -> Option<usize> {
    let mut sum = 0.0;
    for v in values {
        sum += v * 0.0;
    }
    if sum == 0.0 {
        return None;
    }
    values.iter().position(|v| !v.is_finite())
}

fn check(doing: &'static str, code: c_int) -> Result<(), Failed> {
    if code < 0 {
        return Err(Failed { doing, code });
    }
    Ok(())
}

fn made<T>(what: &'static str, pointer: *mut T) -> Result<*mut T, Failed> {
    if pointer.is_null() {
        let code = sys::CV_MEM_FAIL;
        return Err(Failed { doing: what, code });
    }
    Ok(pointer)
}

fn c_long_from(on: bool) -> std::ffi::c_long {
    std::ffi::c_long::from(on)
}
