//! Bounds of a spline surface over rectangles, from its coefficients.
//!
//! A B-spline lies between the least and the largest of the coefficients that meet there; so do its derivatives, whose
//! coefficients are differences. A pyramid of blocks makes a large rectangle as cheap as a small one.

use super::Table;
use crate::height::Bounds;

/// What is known of a block of coefficients.
#[derive(Clone, Copy, Debug)]
struct Block {
    height: [f64; 2],
    /// Of `f_xx`, `f_yy`, 1/m.
    bend: [[f64; 2]; 2],
    /// Of `|f_xy|`, 1/m.
    twist: f64,
}

impl Block {
    const NOTHING: Self = Self { height: [f64::INFINITY, f64::NEG_INFINITY], bend: [[0.0; 2]; 2], twist: 0.0 };

    fn join(&mut self, other: &Block) {
        let wider = |a: [f64; 2], b: [f64; 2]| [a[0].min(b[0]), a[1].max(b[1])];
        self.height = wider(self.height, other.height);
        self.bend = [wider(self.bend[0], other.bend[0]), wider(self.bend[1], other.bend[1])];
        self.twist = self.twist.max(other.twist);
    }
}

/// Blocks of 2, 4, 8 .. coefficients along each side.
#[derive(Debug)]
pub(super) struct Pyramid {
    stored: [usize; 2],
    levels: Vec<Level>,
    /// Largest differences of neighbouring coefficients, m: along x, along y, of both.
    steps: [f64; 3],
}

#[derive(Debug)]
struct Level {
    columns: usize,
    blocks: Vec<Block>,
}

impl Pyramid {
    pub fn new(table: &Table, spacing: [f64; 2]) -> Self {
        let stored = [table.columns, table.rows];
        let mut steps = [0.0f64; 3];
        let mut single = vec![Block::NOTHING; table.values.len()];
        let [dx, dy] = spacing;
        for row in 0..table.rows {
            for column in 0..table.columns {
                let c = |i: usize, j: usize| table.get(column + i - 1, row + j - 1);
                let block = &mut single[row * table.columns + column];
                block.height = [c(1, 1); 2];
                let (across, up) = (column + 1 < table.columns, row + 1 < table.rows);
                if across {
                    steps[0] = steps[0].max((c(2, 1) - c(1, 1)).abs());
                }
                if up {
                    steps[1] = steps[1].max((c(1, 2) - c(1, 1)).abs());
                }
                if across && up {
                    let both = (c(2, 2) - c(1, 2) - c(2, 1) + c(1, 1)).abs();
                    steps[2] = steps[2].max(both);
                    block.twist = both / (dx * dy);
                }
                if across && column > 0 {
                    block.bend[0] = [(c(2, 1) - 2.0 * c(1, 1) + c(0, 1)) / (dx * dx); 2];
                }
                if up && row > 0 {
                    block.bend[1] = [(c(1, 2) - 2.0 * c(1, 1) + c(1, 0)) / (dy * dy); 2];
                }
            }
        }
        let mut levels = vec![coarser(&Level { columns: table.columns, blocks: single })];
        while let Some(last) = levels.last().filter(|level| level.blocks.len() > 1) {
            levels.push(coarser(last));
        }
        Self { stored, levels, steps }
    }

    /// Over a rectangle of places in spacings from the first point.
    pub fn bounds(&self, x: [f64; 2], y: [f64; 2]) -> Bounds {
        let ([i0, i1], beyond_x) = touched(x, self.stored[0]);
        let ([j0, j1], beyond_y) = touched(y, self.stored[1]);
        // the finest level with no more than four blocks along a side
        let longest = (i1 - i0).max(j1 - j0);
        let level = (0..self.levels.len() - 1).find(|k| longest >> (k + 1) < 3).unwrap_or(self.levels.len() - 1);
        let (shift, blocks) = (level + 1, &self.levels[level]);
        let mut all = Block::NOTHING;
        for j in j0 >> shift..=j1 >> shift {
            for i in i0 >> shift..=i1 >> shift {
                all.join(&blocks.blocks[j * blocks.columns + i]);
            }
        }
        let [sx, sy, sxy] = self.steps;
        let change = beyond_x * sx + beyond_y * sy + beyond_x * beyond_y * sxy;
        let height = [all.height[0] - change, all.height[1] + change];
        // across an edge the bend ends; along it, it goes on linearly
        let beyond = [beyond_y, beyond_x];
        let grown = [0, 1].map(|k| {
            let [low, high] = all.bend[k];
            let more = 2.0 * beyond[k] * self.overall_bend(k);
            [low - more, high + more]
        });
        let low = grown[0][0].min(grown[1][0]) - all.twist;
        let high = grown[0][1].max(grown[1][1]) + all.twist;
        Bounds { height, bend: [low, high] }
    }

    fn overall_bend(&self, axis: usize) -> f64 {
        let top = self.levels.last().and_then(|level| level.blocks.first());
        top.map_or(0.0, |block| block.bend[axis][1].max(-block.bend[axis][0]))
    }
}

/// Stored coefficients that meet a range of places, and how many there would be beyond them.
fn touched(range: [f64; 2], stored: usize) -> ([usize; 2], f64) {
    let last = (stored - 1) as f64;
    let (from, to) = (range[0].floor(), range[1].floor() + 5.0);
    let beyond = (-from).max(to - last).max(0.0);
    // two at least, so that the difference that goes on outside is among them
    ([from.clamp(0.0, last - 1.0) as usize, to.clamp(1.0, last) as usize], beyond)
}

fn coarser(level: &Level) -> Level {
    let rows = level.blocks.len() / level.columns;
    let (columns, half) = (level.columns.div_ceil(2), rows.div_ceil(2));
    let mut blocks = vec![Block::NOTHING; columns * half];
    for row in 0..rows {
        for column in 0..level.columns {
            blocks[(row / 2) * columns + column / 2].join(&level.blocks[row * level.columns + column]);
        }
    }
    Level { columns, blocks }
}
