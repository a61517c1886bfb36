//! Exact Jacobians.
