//! A bouncing box: for a long time, far from the origin, and until it rests.

use super::case_spec::{CaseSpec, GRAVITY, closed_form, spawn, static_block};
use crate::report::{Case, oracle::Fixed256, oracle::closed_form::Bounce};

/// A million steps, a day, a million metres from the origin, and Zeno bounces until rest.
pub fn cases(full: bool) -> Vec<Case> {
    let rate = 60.0;
    let million =
        CaseSpec { rate, steps: 1_000_000, factors: &[1, 4, 16], ..bounce("bounce for a million steps", 0.0, 1.0) };
    let day_factors: &[u64] = if full { &[1, 4, 16] } else { &[1, 4] };
    let day = CaseSpec { rate, steps: 24 * 3600 * 60, factors: day_factors, ..bounce("bounce for 24 hours", 0.0, 1.0) };
    let far = CaseSpec { steps: 30_000, ..bounce("bounce at 10⁶ m from the origin", 1e6, 1.0) };
    let zeno = CaseSpec { family: "zeno", ..bounce("Zeno bounces, e = 0.5", 0.0, 0.5) };
    [million, day, far, zeno].map(with_collisions).map(CaseSpec::build).into()
}

/// A bounce of `steps` steps, to measure the growth of errors.
pub fn bounce_of_steps(steps: u64) -> CaseSpec {
    let name = format!("bounce of {steps} steps");
    with_collisions(CaseSpec {
        family: super::GROWTH[1],
        name,
        rate: 60.0,
        steps,
        factors: &[1],
        ..bounce("", 0.0, 1.0)
    })
}

/// A unit box that falls 4 m onto a floor, with its upper-left corner at (`corner`, `corner`), m.
fn bounce(name: &str, corner: f64, restitution: f64) -> CaseSpec {
    let fall = Bounce { height: 4.0, gravity: GRAVITY, restitution };
    let positions = move |time: &Fixed256| {
        let corner = Fixed256::from(corner);
        vec![[corner.clone(), &corner + &fall.state_at(time).0]]
    };
    let floor = static_block([corner - 4.0, corner + 5.0], [9.0, 1.0]);
    let bodies = floor + &spawn([corner; 2], [1.0; 2], 1.0, [0.0; 2]);
    CaseSpec { gravity: GRAVITY, restitution, oracle: closed_form(positions), ..CaseSpec::new("bounce", name, bodies) }
}

/// Adds the number of impacts up to the end of the run, if it is finite.
fn with_collisions(case_spec: CaseSpec) -> CaseSpec {
    let fall = Bounce { height: 4.0, gravity: GRAVITY, restitution: case_spec.restitution };
    let end = &Fixed256::from(case_spec.steps as f64) / &Fixed256::from(case_spec.rate);
    CaseSpec { collisions: fall.state_at(&end).1, ..case_spec }
}
