//! Eigenvalues of a state matrix, block by block.

use nalgebra::linalg::balancing::balance_parlett_reinsch;
use nalgebra::{DMatrix, Schur};

use super::LineariseError;
use super::steady::pattern;

/// An eigenvalue and the states that have part in it.
#[derive(Clone, PartialEq, Debug)]
pub struct Mode {
    /// Real part, 1/s.
    pub re: f64,
    /// Imaginary part, rad/s.
    pub im: f64,
    /// States, by position in the matrix, that depend on each other with this eigenvalue.
    pub states: Vec<usize>,
}

impl Mode {
    /// Frequency of the damped motion `|Im λ|/2π`, Hz.
    pub fn frequency(&self) -> f64 {
        self.im.abs() / std::f64::consts::TAU
    }

    /// Damping ratio `−Re λ/|λ|`; none where λ is zero.
    pub fn damping(&self) -> Option<f64> {
        let size = self.re.hypot(self.im);
        (size > 0.0).then(|| -self.re / size)
    }

    /// Time in which it halves (positive) or doubles (negative), s; none where it does neither.
    pub fn half_life(&self) -> Option<f64> {
        (self.re != 0.0).then(|| -std::f64::consts::LN_2 / self.re)
    }
}

/// Eigenvalues, those with the largest real part first.
///
/// States that depend on each other, whether at once or by way of others, make a block; the eigenvalues of a block do not
/// feel the rounding of the others. Blocks are balanced, then brought to Schur form.
///
/// # Errors
/// [`LineariseError::NoEigenvalues`] if the iteration does not converge.
pub fn modes(a: &DMatrix<f64>) -> Result<Vec<Mode>, LineariseError> {
    let mut found = Vec::new();
    for states in blocks(&pattern(a)) {
        if let [i] = states.as_slice() {
            let there = pattern(a)[(*i, *i)];
            found.push(Mode { re: if there { a[(*i, *i)] } else { 0.0 }, im: 0.0, states });
            continue;
        }
        let mut block = DMatrix::from_fn(states.len(), states.len(), |i, j| a[(states[i], states[j])]);
        balance_parlett_reinsch(&mut block);
        let schur = Schur::try_new(block, f64::EPSILON, 10_000).ok_or(LineariseError::NoEigenvalues)?;
        let values = schur.complex_eigenvalues();
        found.extend(values.iter().map(|z| Mode { re: z.re, im: z.im, states: states.clone() }));
    }
    found.sort_by(|a, b| b.re.total_cmp(&a.re).then(b.im.total_cmp(&a.im)));
    Ok(found)
}

/// Sets of states that reach each other.
fn blocks(there: &DMatrix<bool>) -> Vec<Vec<usize>> {
    let n = there.nrows();
    let mut reach = there.clone();
    for k in 0..n {
        for i in (0..n).filter(|&i| there[(i, k)] || reach[(i, k)]).collect::<Vec<_>>() {
            for j in 0..n {
                reach[(i, j)] |= reach[(k, j)];
            }
        }
    }
    let mut blocks: Vec<Vec<usize>> = Vec::new();
    let mut taken = vec![false; n];
    for i in 0..n {
        if !taken[i] {
            let block: Vec<usize> = (i..n).filter(|&j| j == i || (reach[(i, j)] && reach[(j, i)])).collect();
            block.iter().for_each(|&j| taken[j] = true);
            blocks.push(block);
        }
    }
    blocks
}
