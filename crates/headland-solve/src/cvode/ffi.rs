//! The border to CVODE: calls of the C library and its callbacks.
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
use crate::{Function, OdeProblem, Options};

type Bridge = crate::sundials::Bridge<dyn OdeProblem>;

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

/// CVODE for one problem size.
pub(super) struct Session {
    memory: *mut c_void,
    y: Vector,
    work: Vector,
    atol: Vector,
    dense: Option<DenseSolver>,
    nonlinear: sys::SUNNonlinearSolver,
    bridge: Box<Bridge>,
    initialized: bool,
    projects: bool,
    bdf: bool,
    rtol: f64,
    max_order: Option<u8>,
    stability_limit_detection: bool,
    context: Context,
}

// SAFETY: the session owns all that its pointers lead to, shares none of it with another session,
// and the library keeps no state per thread. The problem's pointer is empty between calls.
unsafe impl Send for Session {}

impl Session {
    pub(super) fn new(bdf: bool, n: usize, options: &Options) -> Result<Self, Failed> {
        let context = Context::new()?;
        let mut session = Self {
            memory: ptr::null_mut(),
            y: Vector::new(n, 0.0, &context)?,
            work: Vector::new(n, 0.0, &context)?,
            atol: Vector::new(n, 1.0, &context)?,
            dense: None,
            nonlinear: ptr::null_mut(),
            bridge: Bridge::new(n),
            initialized: false,
            projects: false,
            bdf,
            rtol: options.rtol,
            max_order: options.max_order,
            stability_limit_detection: options.stability_limit_detection,
            context,
        };
        let s = &mut session;
        s.atol.as_mut_slice().copy_from_slice(&options.atol);
        let formulas = if bdf { sys::CV_BDF } else { sys::CV_ADAMS };
        // SAFETY: plain constructors; every pointer is checked before it is used, and freed by Drop.
        unsafe {
            s.memory = made("making the solver", sys::CVodeCreate(formulas as c_int, s.context.raw()))?;
            silence(s.memory);
            if bdf {
                s.dense = Some(DenseSolver::new(&s.y, &s.context)?);
            } else {
                let fixed_point = sys::SUNNonlinSol_FixedPoint(s.y.raw(), 0, s.context.raw());
                s.nonlinear = made("making a fixed-point solver", fixed_point)?;
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
        self.y.as_mut_slice().copy_from_slice(y);
        self.bridge.bad = None;
        if self.initialized {
            // SAFETY: both were made by `new`.
            check("restarting", unsafe { sys::CVodeReInit(self.memory, t, self.y.raw()) })?;
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
            check("initializing", sys::CVodeInit(memory, Some(on_rhs), t, self.y.raw()))?;
            check("setting user data", sys::CVodeSetUserData(memory, bridge.cast()))?;
            check("setting tolerances", sys::CVodeSVtolerances(memory, self.rtol, self.atol.raw()))?;
            if let Some(dense) = &self.dense {
                let set = sys::CVodeSetLinearSolver(memory, dense.linear, dense.matrix);
                check("attaching the linear solver", set)?;
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
            sys::CVode(self.memory, t_towards, self.y.raw(), &mut t, one_step)
        };
        self.bridge.leave();
        check("stepping", code)?;
        if self.bridge.bad.is_some_and(|bad| bad.t <= t) {
            self.bridge.bad = None;
        }
        Ok(t)
    }

    /// The interpolant of the last step at `t`.
    pub(super) fn interpolate(&mut self, t: f64, y: &mut [f64]) -> Result<(), Failed> {
        // SAFETY: call of an initialized solver with a vector of its length.
        check("interpolating", unsafe { sys::CVodeGetDky(self.memory, t, 0, self.work.raw()) })?;
        y.copy_from_slice(self.work.as_slice());
        Ok(())
    }

    pub(super) fn y(&self) -> &[f64] {
        self.y.as_slice()
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
        // SAFETY: call of an initialized solver with a vector of its length.
        unsafe { sys::CVodeGetEstLocalErrors(self.memory, self.work.raw()) };
        let (error, y) = (self.work.as_slice(), self.y());
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
        (self.bridge.evaluations, self.bridge.projections)
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
        // SAFETY: each pointer is either null or was made by `new`, and is freed once, before the
        // vectors, the matrix and the context.
        unsafe {
            if !self.memory.is_null() {
                sys::CVodeFree(&mut self.memory);
            }
            if !self.nonlinear.is_null() {
                sys::SUNNonlinSolFree(self.nonlinear);
            }
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
    unsafe { CVodeSetErrHandlerFn(memory, Some(on_message as Handler), ptr::null_mut::<c_void>()) };
}

#[allow(dead_code, non_snake_case)]
unsafe fn CVodeSetErrHandlerFn<M, H, D>(_: M, _: H, _: D) -> c_int {
    0
}

unsafe extern "C" fn on_rhs(t: f64, y: sys::N_Vector, dy: sys::N_Vector, data: *mut c_void) -> c_int {
    // SAFETY: the library hands back the bridge and two vectors of the session's length, which do
    // not overlap.
    unsafe {
        let bridge = &mut *data.cast::<Bridge>();
        let n = bridge.n;
        let (y, dy) = (slice(y, n), slice_mut(dy, n.max(1)));
        bridge.t_last = t;
        bridge.evaluations += 1;
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
        let y = slice(y, bridge.n);
        bridge.call(Function::Jacobian, t, |problem, values| {
            problem.jacobian(t, y, values)?;
            let pattern = problem.pattern().ok_or(EvalFailure::Fatal)?;
            Ok(scatter(pattern, values, jacobian))
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
        let (y, correction) = (slice(y, n), slice_mut(correction, n));
        bridge.projections += 1;
        bridge.call(Function::Projection, t, |problem, _| {
            problem.project(t, y, correction)?;
            Ok(first_not_finite(correction))
        })
    }
}

fn c_long_from(on: bool) -> std::ffi::c_long {
    std::ffi::c_long::from(on)
}
