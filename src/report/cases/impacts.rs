//! Impacts: by the thousand, at 7 km/s, from body to body, on corners, in narrow places.

use super::draft::{Draft, block, closed_form, spawn};
use crate::report::truth::closed_form::{galperin, straight, turning};
use crate::report::{Case, Truth, truth::Number};

/// Galperin's billiard, shots, cradles, corners, squeezes, sizes.
pub fn cases(full: bool) -> Vec<Case> {
    let digits = if full { 0..=6 } else { 0..=4 };
    let mut drafts: Vec<Draft> = digits.map(billiard).collect();
    drafts.extend([shot_at_block(), shot_at_plate(), cradle("touching", 0.0), cradle("1 mm apart", 1e-3)]);
    drafts.extend([corner_of_a_room(), past_corners(), corner_on_corner(), piston(), crush(), sizes()]);
    drafts.into_iter().map(Draft::case).collect()
}

/// Galperin's billiard: masses 1 and 100^digits, and a wall.
fn billiard(digits: u32) -> Draft {
    let mass = (0..digits).fold(1.0, |mass, _| mass * 100.0);
    let bodies = block([0.0, 0.0], [1.0, 9.0])
        + &spawn([4.0, 8.0], [1.0; 2], 1.0, [0.0; 2])
        + &spawn([8.0, 7.0], [2.0; 2], mass, [-1.0, 0.0]);
    let collisions = Some(galperin(digits));
    let name = format!("Galperin, masses 1 : {mass}");
    let factors = if digits > 4 { &[2, 32][..] } else { super::draft::RATES };
    // The last collision of all is after 24 s.
    Draft { steps: 900, factors, collisions, ..Draft::new("galperin", &name, bodies) }
}

/// 7 km/s, m/s.
const SHOT: f64 = 7000.0;

/// At a millimetre of what nothing moves.
fn shot_at_block() -> Draft {
    let bodies = block([5.0, 0.0], [0.001, 9.0]) + &spawn([1.0, 4.0], [0.01; 2], 0.01, [SHOT, 0.0]);
    let face = &Number::from(5.0) - &Number::from(0.01);
    let turned = move |time: &Number| {
        let [there, back] = [straight(1.0, SHOT, time), straight(1.0, -SHOT, time)];
        let turn = &(&face + &face) - &Number::from(2.0);
        vec![[if there > face { &turn + &back } else { there }, Number::from(4.0)]]
    };
    let truth = closed_form(turned);
    Draft { steps: 30, truth, collisions: Some(1), ..Draft::new("shot", "7 km/s at 1 mm that stands", bodies) }
}

/// At a millimetre of 3 kg that hangs free: the shot of 1 kg comes back at half its speed.
fn shot_at_plate() -> Draft {
    let bodies = spawn([5.0, 0.0], [0.001, 9.0], 3.0, [0.0; 2]) + &spawn([1.0, 4.0], [0.01; 2], 1.0, [SHOT, 0.0]);
    let after = |time: &Number| {
        let face = &Number::from(5.0) - &Number::from(0.01);
        let hit = &(&face - &Number::from(1.0)) / &Number::from(SHOT);
        if *time < hit {
            return vec![[Number::from(5.0), Number::zero()], [straight(1.0, SHOT, time), Number::from(4.0)]];
        }
        let way = &Number::from(SHOT / 2.0) * &(time - &hit);
        vec![[&Number::from(5.0) + &way, Number::zero()], [&face - &way, Number::from(4.0)]]
    };
    let truth = closed_form(after);
    Draft { steps: 30, truth, collisions: Some(1), ..Draft::new("shot", "7 km/s at 1 mm that hangs free", bodies) }
}

/// Newton's cradle laid flat: one box of five comes in at 2 m/s, the last one goes.
fn cradle(name: &str, gap: f64) -> Draft {
    let place = move |number: u32| 4.0 + f64::from(number) * (1.0 + gap);
    let mut bodies = spawn([1.0, 4.0], [1.0; 2], 1.0, [2.0, 0.0]);
    (0..4).for_each(|number| bodies += &spawn([place(number), 4.0], [1.0; 2], 1.0, [0.0; 2]));
    let after = move |time: &Number| {
        // Equal masses hand on their velocities: what moves is one place after the other.
        let faces = (0..4).map(|number| Number::from(place(number))).collect::<Vec<_>>();
        let (mut start, mut at) = (Number::zero(), vec![Number::from(1.0)]);
        at.extend(faces);
        let last = at.len() - 1;
        for number in 0..=last {
            let gone = &at[number] + &(&Number::from(2.0) * &(time - &start));
            let face = if number == last { None } else { Some(&at[number + 1] - &Number::from(1.0)) };
            match face {
                Some(face) if gone > face => {
                    start = &start + &(&(&face - &at[number]) / &Number::from(2.0));
                    at[number] = face;
                }
                Some(_) | None => {
                    at[number] = gone;
                    break;
                }
            }
        }
        at.into_iter().map(|x| [x, Number::from(4.0)]).collect()
    };
    let truth = closed_form(after);
    Draft { steps: 120, truth, collisions: Some(4), ..Draft::new("cradle", &format!("cradle, {name}"), bodies) }
}

/// Into the corner of a room: both walls are hit at the same instant.
fn corner_of_a_room() -> Draft {
    let bodies = spawn([11.0, 4.0], [1.0; 2], 1.0, [3.0, 3.0]);
    let after = |time: &Number| vec![[turning(11.0, 3.0, 15.0, time), turning(4.0, 3.0, 8.0, time)]];
    let truth = closed_form(after);
    Draft {
        walls: true,
        steps: 75,
        truth,
        collisions: Some(2),
        ..Draft::new("corner", "into the corner of a room", bodies)
    }
}

/// Two boxes fall towards a block's corner: one misses it by a nanometre, one hits it by as much.
fn past_corners() -> Draft {
    let nanometre = 1e-9;
    let bodies = block([4.0, 5.0], [4.0, 1.0])
        + &spawn([3.0 - nanometre, 1.0], [1.0; 2], 1.0, [0.0, 2.0])
        + &spawn([8.0 - nanometre, 1.0], [1.0; 2], 1.0, [0.0, 2.0]);
    let after = move |time: &Number| {
        let [missing, hitting] = [3.0 - nanometre, 8.0 - nanometre].map(Number::from);
        vec![[missing, straight(1.0, 2.0, time)], [hitting, turning(1.0, 2.0, 4.0, time)]]
    };
    let truth = closed_form(after);
    Draft { steps: 90, truth, collisions: Some(1), ..Draft::new("corner", "past a corner by a nanometre", bodies) }
}

/// Corner on corner exactly, which goes back as it came: the rule that has no side to prefer.
fn corner_on_corner() -> Draft {
    let bodies = block([5.0, 5.0], [4.0, 4.0]) + &spawn([1.0, 1.0], [1.0; 2], 1.0, [2.0, 2.0]);
    let after = |time: &Number| vec![[turning(1.0, 2.0, 4.0, time), turning(1.0, 2.0, 4.0, time)]];
    let truth = closed_form(after);
    Draft { steps: 90, truth, collisions: Some(2), ..Draft::new("corner", "corner on corner", bodies) }
}

/// An infinite mass closes in on a box before a wall until a centimetre is left: it bounces
/// faster and faster.
fn piston() -> Draft {
    let bodies = block([0.0, 0.0], [1.0, 9.0])
        + &spawn([4.0, 4.0], [1.0; 2], 1.0, [1.0, 0.0])
        + &spawn([10.0, 0.0], [1.0, 9.0], f64::INFINITY, [-1.0, 0.0]);
    Draft {
        rate: 100.0,
        steps: 799,
        factors: &[1, 4, 16],
        ..Draft::new("squeeze", "between a piston and a wall", bodies)
    }
}

/// The same without bouncing, and on until there is no room left.
fn crush() -> Draft {
    let bodies = block([0.0, 0.0], [1.0, 9.0])
        + &spawn([4.0, 4.0], [1.0; 2], 1.0, [0.0; 2])
        + &spawn([10.0, 0.0], [1.0, 9.0], f64::INFINITY, [-1.0, 0.0]);
    Draft { restitution: 0.0, truth: Truth::Crush, ..Draft::new("squeeze", "until there is no room", bodies) }
}

/// Boxes from a millimetre to a kilometre in one room, masses as their areas.
fn sizes() -> Draft {
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
    Draft { world, walls: true, steps: 3600, ..Draft::new("sizes", "sizes from 1 mm to 1 km", bodies) }
}
