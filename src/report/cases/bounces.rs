//! One box that bounces: long, far away, and until it rests.

use super::draft::{Draft, GRAVITY, block, closed_form, spawn};
use crate::report::{Case, truth::Number, truth::closed_form::Bounce};

/// A million steps, a day, a million metres away, and the end of endless bouncing.
pub fn cases(full: bool) -> Vec<Case> {
    let rate = 60.0;
    let million = Draft { rate, steps: 1_000_000, factors: &[1, 4, 16], ..bounce("a million steps", 0.0, 1.0) };
    let day_factors: &[u64] = if full { &[1, 4, 16] } else { &[1, 4] };
    let day = Draft { rate, steps: 24 * 3600 * 60, factors: day_factors, ..bounce("24 hours", 0.0, 1.0) };
    let far = Draft { steps: 30_000, ..bounce("a million metres away", 1e6, 1.0) };
    let zeno = Draft { family: "zeno", ..bounce("bounces that end, e = 0.5", 0.0, 0.5) };
    [million, day, far, zeno].map(counted).map(Draft::case).into()
}

/// So many steps of it, to see how errors grow.
pub fn long(steps: u64) -> Draft {
    let name = format!("bounce of {steps} steps");
    counted(Draft { family: super::GROWTH[1], name, rate: 60.0, steps, factors: &[1], ..bounce("", 0.0, 1.0) })
}

/// A unit box that falls 4 m onto a floor, with its upper-left corner so far from the origin.
fn bounce(name: &str, corner: f64, restitution: f64) -> Draft {
    let fall = Bounce { height: 4.0, gravity: GRAVITY, restitution };
    let places = move |time: &Number| {
        let corner = Number::from(corner);
        vec![[corner.clone(), &corner + &fall.at(time).0]]
    };
    let floor = block([corner - 4.0, corner + 5.0], [9.0, 1.0]);
    let bodies = floor + &spawn([corner; 2], [1.0; 2], 1.0, [0.0; 2]);
    Draft { gravity: GRAVITY, restitution, truth: closed_form(places), ..Draft::new("bounce", name, bodies) }
}

/// With the number of impacts up to the end, if it is finite.
fn counted(draft: Draft) -> Draft {
    let fall = Bounce { height: 4.0, gravity: GRAVITY, restitution: draft.restitution };
    let end = &Number::from(draft.steps as f64) / &Number::from(draft.rate);
    Draft { collisions: fall.at(&end).1, ..draft }
}
