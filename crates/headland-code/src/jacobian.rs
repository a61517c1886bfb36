//! [`Jacobian`]: exact, sparse, column-compressed, as one compiled function.

use headland_expr::{Graph, NodeId};

use crate::function::Function;

/// Sparse Jacobian `J = ∂y/∂x` of some outputs with respect to some inputs; the values are a [`Function`].
///
/// ```text
/// J[row_index[k]][j] = values[k],   k = col_ptr[j] .. col_ptr[j + 1],   values = function(x)
/// ```
/// Rows grow within a column; structural zeros are left out. The derivatives are expressions (forward, a pass a
/// column), so they are exact, and what columns have in common is computed once.
///
/// ```
/// use headland_code::{Evaluator, Function, Jacobian, TapeFunction};
/// use headland_expr::{Graph, Scalar};
///
/// let graph = Graph::new();
/// let (x, y) = (graph.input("x"), graph.input("y"));
/// let outputs = [graph.id(x * y), graph.id(y.powi(2))];
/// let jacobian = Jacobian::<TapeFunction>::new(&graph, &outputs, &[graph.id(x), graph.id(y)]);
/// assert_eq!((jacobian.col_ptr(), jacobian.row_index()), (&[0, 1, 3][..], &[0, 0, 1][..]));
///
/// let mut evaluator = jacobian.function().evaluator();
/// let values = evaluator.eval(&[3.0, 5.0]);
/// assert_eq!(values, [5.0, 3.0, 10.0]);
/// assert_eq!(jacobian.dense(values), [5.0, 0.0, 3.0, 10.0]); // column by column
/// ```
#[derive(Clone, Debug)]
pub struct Jacobian<F> {
    function: F,
    rows: usize,
    col_ptr: Vec<usize>,
    row_index: Vec<usize>,
    known: bool,
}

impl<F: Function> Jacobian<F> {
    /// Derives and compiles `∂outputs/∂inputs`; the derivatives become nodes of `graph`.
    ///
    /// # Panics
    /// If one of `inputs` is not an input of the graph.
    pub fn new(graph: &Graph, outputs: &[NodeId], inputs: &[NodeId]) -> Self {
        let is_input = |&id: &NodeId| graph.node(id).op == headland_expr::Op::Input;
        assert!(inputs.iter().all(is_input), "a Jacobian is with respect to inputs");
        let entries = graph.jacobian(outputs, inputs);
        let mut col_ptr = vec![0; inputs.len() + 1];
        for (_, column, _) in &entries {
            col_ptr[column + 1] += 1;
        }
        for j in 0..inputs.len() {
            col_ptr[j + 1] += col_ptr[j];
        }
        let row_index = entries.iter().map(|(row, _, _)| *row).collect();
        let values: Vec<NodeId> = entries.iter().map(|(_, _, e)| graph.id(*e)).collect();
        let known = graph.beyond_fields(&values).is_none();
        Self { function: F::compile(graph, &values), rows: outputs.len(), col_ptr, row_index, known }
    }

    /// The values, in the order of [`row_index`](Self::row_index); its inputs are all inputs of the graph.
    pub fn function(&self) -> &F {
        &self.function
    }

    /// The same Jacobian with some inputs of the function fixed, as by [`Function::bind`]; the pattern stays.
    pub fn bind(&self, known: &[(usize, f64)]) -> Self {
        Self {
            function: self.function.bind(known),
            rows: self.rows,
            col_ptr: self.col_ptr.clone(),
            row_index: self.row_index.clone(),
            known: self.known,
        }
    }

    /// False where a value is NaN because a field has no derivative of that order
    /// ([`Graph::beyond_fields`]); differences of the function must then stand for it.
    pub fn is_known(&self) -> bool {
        self.known
    }

    /// Number of rows: outputs.
    pub fn rows(&self) -> usize {
        self.rows
    }

    /// Number of columns: inputs it was derived for.
    pub fn columns(&self) -> usize {
        self.col_ptr.len() - 1
    }

    /// Where each column starts among the values, and the end of the last; shape `[columns + 1]`.
    pub fn col_ptr(&self) -> &[usize] {
        &self.col_ptr
    }

    /// The row of each value.
    pub fn row_index(&self) -> &[usize] {
        &self.row_index
    }

    /// The dense matrix, column by column: entry `(i, j)` at `i + rows · j`.
    ///
    /// # Panics
    /// If `values` is not as long as [`row_index`](Self::row_index).
    pub fn dense(&self, values: &[f64]) -> Vec<f64> {
        let mut dense = vec![0.0; self.rows * self.columns()];
        self.dense_into(values, &mut dense);
        dense
    }

    /// [`dense`](Self::dense) into the caller's buffer.
    ///
    /// # Panics
    /// If a length is wrong.
    pub fn dense_into(&self, values: &[f64], dense: &mut [f64]) {
        assert_eq!(values.len(), self.row_index.len(), "number of values");
        assert_eq!(dense.len(), self.rows * self.columns(), "rows times columns");
        dense.fill(0.0);
        for j in 0..self.columns() {
            for k in self.col_ptr[j]..self.col_ptr[j + 1] {
                dense[self.row_index[k] + self.rows * j] = values[k];
            }
        }
    }
}
