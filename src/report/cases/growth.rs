//! How costs grow: with the number of bodies, and with the number of steps.

use super::draft::Draft;
use super::{bounces, crowds};
use crate::report::{Case, Truth};

/// The families of these cases: growth with bodies, growth with steps.
pub const FAMILIES: [&str; 2] = ["bodies", "steps"];

/// Gases of 100 to 1,000,000 boxes at 60 Hz, and a bounce of 1000 to 1,000,000 steps.
pub fn cases() -> Vec<Case> {
    let gases = sizes(100, 1_000_000).map(|bodies| {
        // The first step, which takes up all bodies, is not what a step costs.
        let steps = 1 + (10_000_000 / bodies).clamp(20, 600);
        let truth = Truth::Unknown("for costs alone".into());
        Draft { family: FAMILIES[0], rate: 60.0, factors: &[1], truth, from: 1, ..crowds::gas(bodies, steps) }
    });
    let bounces = sizes(1000, 1_000_000).map(bounces::long);
    gases.chain(bounces).map(Draft::case).collect()
}

/// 1, 3, 10, 30, … times the first.
fn sizes(first: u64, last: u64) -> impl Iterator<Item = u64> {
    let decades = std::iter::successors(Some(first), |size| size.checked_mul(10));
    decades.flat_map(|decade| [decade, 3 * decade]).take_while(move |size| *size <= last)
}
