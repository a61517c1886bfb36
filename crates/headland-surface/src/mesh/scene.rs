//! [`Scene`]: which of many surfaces a ball can touch.

use super::parry::Tree;

/// Up to so many surfaces each is looked at; more are put into a tree.
pub const HANDFUL: usize = 8;

/// Boxes of surfaces in one frame.
pub struct Scene {
    /// Those that have no end are always candidates.
    endless: Vec<usize>,
    bounded: Vec<(usize, [[f64; 2]; 3])>,
    tree: Option<Tree>,
}

impl Scene {
    /// From each surface's box, m, `[from, to]` along x, y and z; `None` for one that has no end.
    pub fn new(boxes: &[Option<[[f64; 2]; 3]>]) -> Self {
        let endless = (0..boxes.len()).filter(|&i| boxes[i].is_none()).collect();
        let bounded: Vec<_> = boxes.iter().enumerate().filter_map(|(i, b)| b.map(|b| (i, b))).collect();
        let tree = (bounded.len() > HANDFUL).then(|| Tree::new(&bounded.iter().map(|(_, b)| *b).collect::<Vec<_>>()));
        Self { endless, bounded, tree }
    }

    /// Numbers of the surfaces whose box comes within `reach`, m, of a point, growing. Beside these, nothing is touched by a
    /// ball of that radius there.
    pub fn candidates(&self, centre: [f64; 3], reach: f64) -> Vec<usize> {
        let region = centre.map(|x| [x - reach, x + reach]);
        let mut all = self.endless.clone();
        match &self.tree {
            Some(tree) => all.extend(tree.meet(region).into_iter().map(|i| self.bounded[i].0)),
            None => {
                let meets = |b: &[[f64; 2]; 3]| (0..3).all(|i| b[i][0] <= region[i][1] && region[i][0] <= b[i][1]);
                all.extend(self.bounded.iter().filter(|(_, b)| meets(b)).map(|(i, _)| *i));
            }
        }
        all.sort_unstable();
        all
    }
}
