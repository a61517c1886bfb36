//! What the wrappers of SUNDIALS' solvers share: context, vectors, dense matrices, and the way from a
//! callback to the problem.
//!
//! The library's callbacks reach the problem through the [`Bridge`], whose pointer is set for the time
//! of one call only; a panic in a callback is caught, carried past the C frames and thrown again
//! behind them. Each of the types frees what it owns; the context must go last.
#![allow(unsafe_code)]

use std::any::Any;
use std::ffi::{c_char, c_int, c_void};
use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};
use std::ptr;

use sundials_sys as sys;

use crate::problem::EvalFailure;
use crate::{Function, Pattern};

/// A call of the library that failed.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Failed {
    pub doing: &'static str,
    pub code: c_int,
}

/// The last evaluation that failed.
#[derive(Clone, Copy, Debug)]
pub(crate) struct BadEvaluation {
    pub function: Function,
    pub t: f64,
    /// First component that is not finite, if that was it.
    pub component: Option<usize>,
}

/// Code of the library's solvers for what could not be allocated.
pub(crate) const OUT_OF_MEMORY: c_int = -20;

pub(crate) fn check(doing: &'static str, code: c_int) -> Result<(), Failed> {
    if code < 0 {
        return Err(Failed { doing, code });
    }
    Ok(())
}

pub(crate) fn made<T>(what: &'static str, pointer: *mut T) -> Result<*mut T, Failed> {
    if pointer.is_null() {
        return Err(Failed { doing: what, code: OUT_OF_MEMORY });
    }
    Ok(pointer)
}

pub(crate) fn first_not_finite(values: &[f64]) -> Option<usize> {
    let mut sum = 0.0;
    for v in values {
        sum += v * 0.0;
    }
    if sum == 0.0 {
        return None;
    }
    values.iter().position(|v| !v.is_finite())
}

/// What the library allocates for.
pub(crate) struct Context(sys::SUNContext);

impl Context {
    pub(crate) fn new() -> Result<Self, Failed> {
        let mut context = Self(ptr::null_mut());
        // SAFETY: a plain constructor.
        check("making a context", unsafe { sys::SUNContext_Create(sys::comm_no_mpi(), &mut context.0) })?;
        context.silence();
        Ok(context)
    }

    pub(crate) fn raw(&self) -> sys::SUNContext {
        self.0
    }

    /// Keeps version 7 of the library from printing; version 6 has a function a solver for it.
    ///
    /// A name that the bindings lack resolves to the stand-in outside, as the glob import in the body
    /// goes before what is in scope around it.
    fn silence(&self) {
        #[allow(unused_imports)]
        use sundials_sys::*;
        // SAFETY: it was just made.
        unsafe { SUNContext_ClearErrHandlers(self.0) };
    }
}

#[allow(dead_code, non_snake_case)]
unsafe fn SUNContext_ClearErrHandlers<C>(_: C) -> c_int {
    0
}

impl Drop for Context {
    fn drop(&mut self) {
        if !self.0.is_null() {
            // SAFETY: made by `new`, freed once, after all that was made in it.
            unsafe { sys::SUNContext_Free(&mut self.0) };
        }
    }
}

/// Handler of version 6 for messages: drops them.
pub(crate) type Handler = unsafe extern "C" fn(c_int, *const c_char, *const c_char, *mut c_char, *mut c_void);

pub(crate) unsafe extern "C" fn on_message(
    _code: c_int,
    _module: *const c_char,
    _function: *const c_char,
    _message: *mut c_char,
    _data: *mut c_void,
) {
}

/// A serial vector. The library wants one component at least: with `n = 0` there is one that is not seen.
pub(crate) struct Vector {
    raw: sys::N_Vector,
    n: usize,
}

impl Vector {
    /// `n` times `value`.
    pub(crate) fn new(n: usize, value: f64, context: &Context) -> Result<Self, Failed> {
        let m = n.max(1) as sys::sunindextype;
        // SAFETY: a plain constructor, checked before its result is used.
        unsafe {
            let raw = made("making a vector", sys::N_VNew_Serial(m, context.0))?;
            sys::N_VConst(value, raw);
            Ok(Self { raw, n })
        }
    }

    pub(crate) fn raw(&self) -> sys::N_Vector {
        self.raw
    }

    pub(crate) fn as_slice(&self) -> &[f64] {
        // SAFETY: a serial vector of at least `n` components.
        unsafe { slice(self.raw, self.n) }
    }

    pub(crate) fn as_mut_slice(&mut self) -> &mut [f64] {
        // SAFETY: as above, and borrowed as long.
        unsafe { slice_mut(self.raw, self.n) }
    }
}

impl Drop for Vector {
    fn drop(&mut self) {
        // SAFETY: made by `new`, freed once.
        unsafe { sys::N_VDestroy(self.raw) };
    }
}

/// # Safety
/// `v` must be a serial vector of at least `n` components that outlives `'a` and is not written to.
pub(crate) unsafe fn slice<'a>(v: sys::N_Vector, n: usize) -> &'a [f64] {
    // SAFETY: by contract.
    unsafe { std::slice::from_raw_parts(sys::N_VGetArrayPointer(v), n) }
}

/// # Safety
/// As [`slice`], and nobody else may look at it.
pub(crate) unsafe fn slice_mut<'a>(v: sys::N_Vector, n: usize) -> &'a mut [f64] {
    // SAFETY: by contract.
    unsafe { std::slice::from_raw_parts_mut(sys::N_VGetArrayPointer(v), n) }
}

/// A dense matrix and the solver by LU factors that goes with it.
pub(crate) struct DenseSolver {
    pub matrix: sys::SUNMatrix,
    pub linear: sys::SUNLinearSolver,
}

impl DenseSolver {
    /// For vectors like `y`.
    pub(crate) fn new(y: &Vector, context: &Context) -> Result<Self, Failed> {
        let m = y.n.max(1) as sys::sunindextype;
        let mut solver = Self { matrix: ptr::null_mut(), linear: ptr::null_mut() };
        // SAFETY: plain constructors; every pointer is checked before it is used.
        unsafe {
            solver.matrix = made("making a matrix", sys::SUNDenseMatrix(m, m, context.0))?;
            let linear = sys::SUNLinSol_Dense(y.raw, solver.matrix, context.0);
            solver.linear = made("making a linear solver", linear)?;
        }
        Ok(solver)
    }
}

impl Drop for DenseSolver {
    fn drop(&mut self) {
        // SAFETY: each pointer is either null or was made by `new`, and is freed once.
        unsafe {
            if !self.linear.is_null() {
                sys::SUNLinSolFree(self.linear);
            }
            if !self.matrix.is_null() {
                sys::SUNMatDestroy(self.matrix);
            }
        }
    }
}

/// Writes values in the order of a pattern into a dense matrix that is zero; returns the row of the
/// first that is not finite.
///
/// # Safety
/// `matrix` must be dense, and as large as the pattern.
pub(crate) unsafe fn scatter(pattern: &Pattern, values: &[f64], matrix: sys::SUNMatrix) -> Option<usize> {
    let (ends, rows) = (pattern.col_ptr(), pattern.row_idx());
    for j in 0..pattern.cols() {
        // SAFETY: by contract.
        let column = unsafe {
            let first = sys::SUNDenseMatrix_Column(matrix, j as sys::sunindextype);
            std::slice::from_raw_parts_mut(first, pattern.rows())
        };
        for e in ends[j]..ends[j + 1] {
            column[rows[e]] = values[e];
        }
    }
    first_not_finite(values).map(|e| rows[e])
}

/// What the callbacks see. `P` is the trait object of the problem.
pub(crate) struct Bridge<P: ?Sized> {
    pub n: usize,
    /// Set for the time of one call.
    pub problem: Option<*mut P>,
    /// Values of the Jacobian, in the order of its pattern.
    pub jacobian: Vec<f64>,
    panic: Option<Box<dyn Any + Send>>,
    pub bad: Option<BadEvaluation>,
    /// Time of the last evaluation of the equations.
    pub t_last: f64,
    /// Evaluations of the equations.
    pub evaluations: u64,
    #[cfg_attr(not(feature = "cvode"), allow(dead_code))]
    pub projections: u64,
}

impl<P: ?Sized> Bridge<P> {
    pub(crate) fn new(n: usize) -> Box<Self> {
        Box::new(Self {
            n,
            problem: None,
            jacobian: Vec::new(),
            panic: None,
            bad: None,
            t_last: 0.0,
            evaluations: 0,
            projections: 0,
        })
    }

    /// Ends the time of a call: the problem goes, and a panic from inside goes on.
    pub(crate) fn leave(&mut self) {
        self.problem = None;
        if let Some(panic) = self.panic.take() {
            resume_unwind(panic);
        }
    }

    /// Calls a function of the problem; returns what the library takes for success (0), for a
    /// recoverable (1) and for a fatal failure (-1). `f` returns the first bad component.
    ///
    /// # Safety
    /// The pointer to the problem must be valid, if there is one.
    pub(crate) unsafe fn call(
        &mut self,
        function: Function,
        t: f64,
        f: impl FnOnce(&mut P, &mut [f64]) -> Result<Option<usize>, EvalFailure>,
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
