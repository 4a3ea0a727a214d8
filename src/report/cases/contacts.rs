//! Contacts: stacks, tile seams, overlapping spawns, and a support that is deleted.

use super::case_spec::{CaseSpec, GRAVITY, closed_form, named, spawn, static_block};
use crate::report::oracle::closed_form::uniform;
use crate::report::{Case, Oracle, oracle::Fixed256};

/// Stacks, tile seams, a deleted support, overlapping spawns.
pub fn cases(_full: bool) -> Vec<Case> {
    let light = [10, 100, 1000].map(|count| stack(count, &format!("stack of {count}"), &|_| 1.0));
    let heavy = stack(13, "stack of 13, mass ratio 10 per box", &|number| (0..number).fold(1.0, |mass, _| mass * 10.0));
    let others = [heavy, tiles(), support(), overlaps()];
    light.into_iter().chain(others).map(CaseSpec::build).collect()
}

/// A stack of unit boxes, e = 0, which must not move; number 0 is the lowest.
fn stack(count: u32, name: &str, mass: &dyn Fn(u32) -> f64) -> CaseSpec {
    let height = f64::from(count) + 1.0;
    let mut bodies = static_block([0.0, height], [9.0, 1.0]);
    for number in 0..count {
        bodies += &spawn([4.0, height - 1.0 - f64::from(number)], [1.0; 2], mass(number), [0.0; 2]);
    }
    let world = [9.0, height];
    let factors: &[u64] = if count > 100 { &[1, 2] } else { super::case_spec::RATES };
    CaseSpec {
        world,
        gravity: GRAVITY,
        restitution: 0.0,
        factors,
        oracle: Oracle::Rest,
        ..CaseSpec::new("stack", name, bodies)
    }
}

/// A box slides over a floor of forty flush tiles; nothing may stop it.
fn tiles() -> CaseSpec {
    let mut bodies = String::new();
    (0..40).for_each(|number| bodies += &static_block([0.5 * f64::from(number), 5.0], [0.5, 0.5]));
    bodies += &spawn([1.0, 4.0], [1.0; 2], 1.0, [3.0, 0.0]);
    let oracle = closed_form(|time| vec![[uniform(1.0, 3.0, time), Fixed256::from(4.0)]]);
    let steps = 150;
    CaseSpec {
        gravity: GRAVITY,
        restitution: 0.0,
        steps,
        oracle,
        ..CaseSpec::new("tiles", "sliding over tile seams", bodies)
    }
}

/// Ten stacked boxes lose their support after a second and fall two metres together.
fn support() -> CaseSpec {
    let mut bodies = static_block([0.0, 14.0], [9.0, 1.0]) + &named("support", &static_block([3.0, 12.0], [3.0, 2.0]));
    (0..10).for_each(|number| bodies += &spawn([4.0, 11.0 - f64::from(number)], [1.0; 2], 1.0, [0.0; 2]));
    bodies += "[[delete]]\nstep = 30\nname = \"support\"\n";
    let after = |time: &Fixed256| {
        let fall = time - &Fixed256::from(1.0);
        let distance = &(&Fixed256::from(GRAVITY / 2.0) * &fall) * &fall;
        let fallen = match () {
            () if fall < Fixed256::zero() => Fixed256::zero(),
            () if distance > Fixed256::from(2.0) => Fixed256::from(2.0),
            () => distance,
        };
        (0..10).map(|number| [Fixed256::from(4.0), &Fixed256::from(11.0 - f64::from(number)) + &fallen]).collect()
    };
    let (world, oracle) = ([9.0, 15.0], closed_form(after));
    CaseSpec {
        world,
        gravity: GRAVITY,
        restitution: 0.0,
        oracle,
        ..CaseSpec::new("support", "support of a stack deleted", bodies)
    }
}

/// Three overlapping boxes, which must separate without gaining energy.
fn overlaps() -> CaseSpec {
    let bodies = spawn([4.0, 4.0], [2.0; 2], 1.0, [1.0, 0.0])
        + &spawn([5.0, 4.5], [2.0; 2], 2.0, [-1.0, 0.5])
        + &spawn([5.5, 3.5], [1.0; 2], 4.0, [0.0, -0.5]);
    let oracle = Oracle::Unknown("the separation is a modelling choice".into());
    CaseSpec { steps: 60, from: 1, oracle, ..CaseSpec::new("overlap", "overlapping spawns", bodies) }
}
