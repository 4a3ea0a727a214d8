//! Impacts: thousands of them, at 7 km/s, along rows of boxes, on corners, in narrow gaps.

use super::case_spec::{CaseSpec, closed_form, spawn, static_block};
use crate::report::oracle::closed_form::{galperin_collisions, reflected, uniform};
use crate::report::{Case, Oracle, oracle::Fixed256};

/// Galperin's billiard, fast shots, cradles, corners, squeezes, a wide range of sizes.
pub fn cases(full: bool) -> Vec<Case> {
    let digits = if full { 0..=6 } else { 0..=4 };
    let mut specs: Vec<CaseSpec> = digits.map(billiard).collect();
    specs.extend([shot_at_static_plate(), shot_at_free_plate(), cradle("touching", 0.0), cradle("gaps of 1 mm", 1e-3)]);
    specs.extend([corner_of_a_room(), past_corners(), corner_on_corner(), piston(), crush(), sizes()]);
    specs.into_iter().map(CaseSpec::build).collect()
}

/// Galperin's billiard: masses of 1 kg and 100^digits kg, and a wall.
fn billiard(digits: u32) -> CaseSpec {
    let mass = (0..digits).fold(1.0, |mass, _| mass * 100.0);
    let bodies = static_block([0.0, 0.0], [1.0, 9.0])
        + &spawn([4.0, 8.0], [1.0; 2], 1.0, [0.0; 2])
        + &spawn([8.0, 7.0], [2.0; 2], mass, [-1.0, 0.0]);
    let collisions = Some(galperin_collisions(digits));
    let name = format!("Galperin, masses 1 : {mass}");
    let factors = if digits > 4 { &[2, 32][..] } else { super::case_spec::RATES };
    // The last collision happens after 24 s.
    CaseSpec { steps: 900, factors, collisions, ..CaseSpec::new("galperin", &name, bodies) }
}

/// Speed of the fast shots, m/s.
const SHOT: f64 = 7000.0;

/// A fast small box hits a static plate of 1 mm.
fn shot_at_static_plate() -> CaseSpec {
    let bodies = static_block([5.0, 0.0], [0.001, 9.0]) + &spawn([1.0, 4.0], [0.01; 2], 0.01, [SHOT, 0.0]);
    let face = &Fixed256::from(5.0) - &Fixed256::from(0.01);
    let reflected_path = move |time: &Fixed256| {
        let [forward, backward] = [uniform(1.0, SHOT, time), uniform(1.0, -SHOT, time)];
        let turn = &(&face + &face) - &Fixed256::from(2.0);
        vec![[if forward > face { &turn + &backward } else { forward }, Fixed256::from(4.0)]]
    };
    let oracle = closed_form(reflected_path);
    CaseSpec {
        steps: 30,
        oracle,
        collisions: Some(1),
        ..CaseSpec::new("shot", "7 km/s at a static 1 mm plate", bodies)
    }
}

/// A fast box of 1 kg hits a free plate of 1 mm and 3 kg and returns at half its speed.
fn shot_at_free_plate() -> CaseSpec {
    let bodies = spawn([5.0, 0.0], [0.001, 9.0], 3.0, [0.0; 2]) + &spawn([1.0, 4.0], [0.01; 2], 1.0, [SHOT, 0.0]);
    let after = |time: &Fixed256| {
        let face = &Fixed256::from(5.0) - &Fixed256::from(0.01);
        let hit = &(&face - &Fixed256::from(1.0)) / &Fixed256::from(SHOT);
        if *time < hit {
            return vec![[Fixed256::from(5.0), Fixed256::zero()], [uniform(1.0, SHOT, time), Fixed256::from(4.0)]];
        }
        let travelled = &Fixed256::from(SHOT / 2.0) * &(time - &hit);
        vec![[&Fixed256::from(5.0) + &travelled, Fixed256::zero()], [&face - &travelled, Fixed256::from(4.0)]]
    };
    let oracle = closed_form(after);
    CaseSpec { steps: 30, oracle, collisions: Some(1), ..CaseSpec::new("shot", "7 km/s at a free 1 mm plate", bodies) }
}

/// Newton's cradle without gravity: the first of five boxes arrives at 2 m/s, the last one leaves.
fn cradle(name: &str, gap: f64) -> CaseSpec {
    let position = move |number: u32| 4.0 + f64::from(number) * (1.0 + gap);
    let mut bodies = spawn([1.0, 4.0], [1.0; 2], 1.0, [2.0, 0.0]);
    (0..4).for_each(|number| bodies += &spawn([position(number), 4.0], [1.0; 2], 1.0, [0.0; 2]));
    let after = move |time: &Fixed256| {
        // Equal masses exchange their velocities, so one box after the other moves.
        let faces = (0..4).map(|number| Fixed256::from(position(number))).collect::<Vec<_>>();
        let (mut start, mut at) = (Fixed256::zero(), vec![Fixed256::from(1.0)]);
        at.extend(faces);
        let last = at.len() - 1;
        for number in 0..=last {
            let moved = &at[number] + &(&Fixed256::from(2.0) * &(time - &start));
            let face = if number == last { None } else { Some(&at[number + 1] - &Fixed256::from(1.0)) };
            match face {
                Some(face) if moved > face => {
                    start = &start + &(&(&face - &at[number]) / &Fixed256::from(2.0));
                    at[number] = face;
                }
                Some(_) | None => {
                    at[number] = moved;
                    break;
                }
            }
        }
        at.into_iter().map(|x| [x, Fixed256::from(4.0)]).collect()
    };
    let oracle = closed_form(after);
    CaseSpec { steps: 120, oracle, collisions: Some(4), ..CaseSpec::new("cradle", &format!("cradle, {name}"), bodies) }
}

/// A box moves into the corner of a room and hits both walls at the same instant.
fn corner_of_a_room() -> CaseSpec {
    let bodies = spawn([11.0, 4.0], [1.0; 2], 1.0, [3.0, 3.0]);
    let after = |time: &Fixed256| vec![[reflected(11.0, 3.0, 15.0, time), reflected(4.0, 3.0, 8.0, time)]];
    let oracle = closed_form(after);
    CaseSpec {
        walls: true,
        steps: 75,
        oracle,
        collisions: Some(2),
        ..CaseSpec::new("corner", "into the corner of a room", bodies)
    }
}

/// Two boxes move towards the corners of a block: one misses by a nanometre, one hits by a nanometre.
fn past_corners() -> CaseSpec {
    let nanometre = 1e-9;
    let bodies = static_block([4.0, 5.0], [4.0, 1.0])
        + &spawn([3.0 - nanometre, 1.0], [1.0; 2], 1.0, [0.0, 2.0])
        + &spawn([8.0 - nanometre, 1.0], [1.0; 2], 1.0, [0.0, 2.0]);
    let after = move |time: &Fixed256| {
        let [missing, hitting] = [3.0 - nanometre, 8.0 - nanometre].map(Fixed256::from);
        vec![[missing, uniform(1.0, 2.0, time)], [hitting, reflected(1.0, 2.0, 4.0, time)]]
    };
    let oracle = closed_form(after);
    CaseSpec {
        steps: 90,
        oracle,
        collisions: Some(1),
        ..CaseSpec::new("corner", "past a corner by a nanometre", bodies)
    }
}

/// A box hits a corner exactly with its corner; it is reflected on both axes.
fn corner_on_corner() -> CaseSpec {
    let bodies = static_block([5.0, 5.0], [4.0, 4.0]) + &spawn([1.0, 1.0], [1.0; 2], 1.0, [2.0, 2.0]);
    let after = |time: &Fixed256| vec![[reflected(1.0, 2.0, 4.0, time), reflected(1.0, 2.0, 4.0, time)]];
    let oracle = closed_form(after);
    CaseSpec { steps: 90, oracle, collisions: Some(2), ..CaseSpec::new("corner", "corner on corner", bodies) }
}

/// A moving infinite mass squeezes a box against a wall until a gap of one centimetre is left; the box
/// bounces faster and faster.
fn piston() -> CaseSpec {
    let bodies = static_block([0.0, 0.0], [1.0, 9.0])
        + &spawn([4.0, 4.0], [1.0; 2], 1.0, [1.0, 0.0])
        + &spawn([10.0, 0.0], [1.0, 9.0], f64::INFINITY, [-1.0, 0.0]);
    CaseSpec {
        rate: 100.0,
        steps: 799,
        factors: &[1, 4, 16],
        ..CaseSpec::new("squeeze", "between a piston and a wall", bodies)
    }
}

/// The same at e = 0, until no gap is left.
fn crush() -> CaseSpec {
    let bodies = static_block([0.0, 0.0], [1.0, 9.0])
        + &spawn([4.0, 4.0], [1.0; 2], 1.0, [0.0; 2])
        + &spawn([10.0, 0.0], [1.0, 9.0], f64::INFINITY, [-1.0, 0.0]);
    CaseSpec { restitution: 0.0, oracle: Oracle::Error, ..CaseSpec::new("squeeze", "piston closes completely", bodies) }
}

/// Boxes of 1 mm to 1 km in one room, with masses proportional to their areas.
fn sizes() -> CaseSpec {
    let mut bodies = String::new();
    let mut size = 1000.0;
    let mut corner = 100.0;
    while size >= 1e-3 {
        let velocity = [(if size > 10.0 { 20.0 } else { -80.0 }), 0.0];
        bodies += &spawn([corner, 1000.0 - size / 2.0], [size; 2], size * size, velocity);
        corner += 1.5 * size;
        size /= 10.0;
    }
    let world = [2500.0, 2000.0];
    CaseSpec { world, walls: true, steps: 3600, ..CaseSpec::new("sizes", "sizes from 1 mm to 1 km", bodies) }
}
