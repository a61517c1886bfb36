//! [`group`]: equal operations side by side, so that the interpreter decides once for many of them.
//!
//! Independent steps may run in any order; their values do not change. Within a window, the kind with the most steps
//! ready runs until none is left, the longest ready first, so that neighbours seldom wait for each other. The window
//! bounds how much longer values live, and so the number of slots.
//!
//! Measured on random arithmetic of 10 000 operations, in ns per operation: 6.9 in the order of the graph, 2.0 grouped,
//! 1.1 grouped and interpreted run by run. A chain in which each operation waits for the one before loses (3.3 to 4.8).

use std::collections::VecDeque;

use crate::lower::{Code, NONE, Step};

/// Steps that may change places.
const WINDOW: usize = 512;
/// More than there are pairs of code and operator.
const CLASSES: usize = 64;

/// What the jump depends on: the code, and the operator where the code leaves it open.
fn class(step: &Step) -> usize {
    match step.code {
        Code::Other => Code::Copy as usize + 1 + step.op as usize,
        code => code as usize,
    }
}

/// Reorders the steps of each window.
pub(crate) fn group(steps: &mut [Step], values: u32) {
    let mut maker = vec![NONE; values as usize]; // step of the window that makes a value
    for window in steps.chunks_mut(WINDOW) {
        group_window(window, &mut maker);
    }
}

fn group_window(window: &mut [Step], maker: &mut [u32]) {
    let n = window.len();
    for (i, step) in window.iter().enumerate() {
        step.dst().for_each(|v| maker[v as usize] = i as u32);
    }
    // Users of a step, as a linked list through `next`, three links a step.
    let mut first = vec![NONE; n];
    let mut next = vec![NONE; 3 * n];
    let mut missing = vec![0u8; n];
    for i in (0..n).rev() {
        for (k, value) in window[i].src.into_iter().enumerate() {
            if value != NONE && maker[value as usize] != NONE {
                let operand = maker[value as usize] as usize;
                missing[i] += 1;
                next[3 * i + k] = first[operand];
                first[operand] = (3 * i + k) as u32;
            }
        }
    }
    // Ready steps of each kind, first in, first out.
    let mut ready: [VecDeque<u32>; CLASSES] = std::array::from_fn(|_| VecDeque::new());
    for i in 0..n {
        if missing[i] == 0 {
            ready[class(&window[i])].push_back(i as u32);
        }
    }
    let mut order = Vec::with_capacity(n);
    while order.len() < n {
        let widest = (0..CLASSES).max_by_key(|&c| ready[c].len()).unwrap_or(0);
        while let Some(i) = ready[widest].pop_front() {
            order.push(window[i as usize]);
            let mut link = first[i as usize];
            while link != NONE {
                let user = link as usize / 3;
                missing[user] -= 1;
                if missing[user] == 0 {
                    ready[class(&window[user])].push_back(user as u32);
                }
                link = next[link as usize];
            }
        }
    }
    for step in window.iter() {
        step.dst().for_each(|v| maker[v as usize] = NONE);
    }
    window.copy_from_slice(&order);
}
