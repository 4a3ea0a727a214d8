//! How costs grow: with the number of bodies, and with the number of steps.

use super::draft::Draft;
use super::{bounces, crowds};
use crate::report::Case;

/// Gases of 100 to 100,000 boxes (1,000,000 if `full`) at 60 Hz, and a bounce of 1000 to 1,000,000
/// steps.
pub fn cases(full: bool) -> Vec<Case> {
    let largest = if full { 6 } else { 5 };
    let counts = (4..=2 * largest).map(|half: u32| {
        let decade = 10_u64.pow(half / 2);
        if half % 2 == 0 { decade } else { 3 * decade }
    });
    let gases = counts.map(|bodies| {
        let steps = (3_000_000 / bodies).clamp(10, 600);
        Draft { family: "bodies", rate: 60.0, factors: &[1], ..crowds::gas(bodies, steps) }
    });
    let bounces = (6..=12).map(|half: u32| bounces::long(if half % 2 == 0 { 1 } else { 3 } * 10_u64.pow(half / 2)));
    gases.chain(bounces).map(Draft::case).collect()
}
