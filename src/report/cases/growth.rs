//! Growth of costs with the number of bodies and with the number of steps.

use super::case_spec::CaseSpec;
use super::{bounces, many_bodies};
use crate::report::{Case, Oracle};

/// The families of these cases: growth with bodies, growth with steps.
pub const FAMILIES: [&str; 2] = ["bodies", "steps"];

/// Gases of 100 to 1,000,000 boxes at 60 Hz, and a bounce of 1000 to 1,000,000 steps.
pub fn cases() -> Vec<Case> {
    let gases = sizes(100, 1_000_000).map(|bodies| {
        // The first step inserts all bodies and is not typical, so it is not measured.
        let steps = 1 + (10_000_000 / bodies).clamp(20, 600);
        let oracle = Oracle::Unknown("not computed: this case measures costs only".into());
        CaseSpec { family: FAMILIES[0], rate: 60.0, factors: &[1], oracle, from: 1, ..many_bodies::gas(bodies, steps) }
    });
    let bounces = sizes(1000, 1_000_000).map(bounces::bounce_of_steps);
    gases.chain(bounces).map(CaseSpec::build).collect()
}

/// Returns 1, 3, 10, 30, … times `first`, up to `last`.
fn sizes(first: u64, last: u64) -> impl Iterator<Item = u64> {
    let decades = std::iter::successors(Some(first), |size| size.checked_mul(10));
    decades.flat_map(|decade| [decade, 3 * decade]).take_while(move |size| *size <= last)
}
