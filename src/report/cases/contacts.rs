//! Contacts: stacks, seams, overlaps, and what happens when a support goes.

use super::draft::{Draft, GRAVITY, block, closed_form, named, spawn};
use crate::report::truth::closed_form::straight;
use crate::report::{Case, Truth, truth::Number};

/// Stacks, tile seams, a foot that is removed, overlapping spawns.
pub fn cases(_full: bool) -> Vec<Case> {
    let light = [10, 100, 1000].map(|count| stack(count, &format!("stack of {count}"), &|_| 1.0));
    let heavy =
        stack(13, "stack of 13, each ten times as heavy", &|number| (0..number).fold(1.0, |mass, _| mass * 10.0));
    let others = [heavy, tiles(), support(), overlaps()];
    light.into_iter().chain(others).map(Draft::case).collect()
}

/// Unit boxes on each other, e = 0, which have to stay; number 0 is the lowest.
fn stack(count: u32, name: &str, mass: &dyn Fn(u32) -> f64) -> Draft {
    let height = f64::from(count) + 1.0;
    let mut bodies = block([0.0, height], [9.0, 1.0]);
    for number in 0..count {
        bodies += &spawn([4.0, height - 1.0 - f64::from(number)], [1.0; 2], mass(number), [0.0; 2]);
    }
    let world = [9.0, height];
    let factors: &[u64] = if count > 100 { &[1, 2] } else { super::draft::RATES };
    Draft {
        world,
        gravity: GRAVITY,
        restitution: 0.0,
        factors,
        truth: Truth::Rest,
        ..Draft::new("stack", name, bodies)
    }
}

/// A box slides over a floor of forty tiles, where there is nothing to stop it.
fn tiles() -> Draft {
    let mut bodies = String::new();
    (0..40).for_each(|number| bodies += &block([0.5 * f64::from(number), 5.0], [0.5, 0.5]));
    bodies += &spawn([1.0, 4.0], [1.0; 2], 1.0, [3.0, 0.0]);
    let truth = closed_form(|time| vec![[straight(1.0, 3.0, time), Number::from(4.0)]]);
    let steps = 150;
    Draft { gravity: GRAVITY, restitution: 0.0, steps, truth, ..Draft::new("tiles", "over tile seams", bodies) }
}

/// Ten boxes stand on a block that goes after a second, and fall two metres together.
fn support() -> Draft {
    let mut bodies = block([0.0, 14.0], [9.0, 1.0]) + &named("foot", &block([3.0, 12.0], [3.0, 2.0]));
    (0..10).for_each(|number| bodies += &spawn([4.0, 11.0 - f64::from(number)], [1.0; 2], 1.0, [0.0; 2]));
    bodies += "[[delete]]\nstep = 30\nname = \"foot\"\n";
    let after = |time: &Number| {
        let fall = time - &Number::from(1.0);
        let way = &(&Number::from(GRAVITY / 2.0) * &fall) * &fall;
        let fallen = match () {
            () if fall < Number::zero() => Number::zero(),
            () if way > Number::from(2.0) => Number::from(2.0),
            () => way,
        };
        (0..10).map(|number| [Number::from(4.0), &Number::from(11.0 - f64::from(number)) + &fallen]).collect()
    };
    let (world, truth) = ([9.0, 15.0], closed_form(after));
    Draft {
        world,
        gravity: GRAVITY,
        restitution: 0.0,
        truth,
        ..Draft::new("support", "foot of a stack deleted", bodies)
    }
}

/// Three boxes spawned inside each other, which are to part without any gain.
fn overlaps() -> Draft {
    let bodies = spawn([4.0, 4.0], [2.0; 2], 1.0, [1.0, 0.0])
        + &spawn([5.0, 4.5], [2.0; 2], 2.0, [-1.0, 0.5])
        + &spawn([5.5, 3.5], [1.0; 2], 4.0, [0.0, -0.5]);
    let truth = Truth::Unknown("how they part is a choice".into());
    Draft { steps: 60, from: 1, truth, ..Draft::new("overlap", "spawned inside each other", bodies) }
}
