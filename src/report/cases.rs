//! The hard cases, by family.

use super::Budget;
use super::case::{Case, CaseSpec, RATES};
use super::oracle::closed_form::{Bounce, burst_velocities, galperin_collisions, reflected, uniform};
use super::oracle::{Fixed256, Oracle};
use crate::physics::Axis;
use std::sync::LazyLock;

/// Returns the hard cases in the order of the report.
pub fn all(budget: Budget) -> Vec<Case> {
    let specs = [bounces(budget), impacts(budget), bursts(), contacts(), crowds(budget)];
    specs.into_iter().flatten().map(CaseSpec::build).collect()
}

/// The families of [`growth`]: growth with the number of bodies, and with the number of steps.
pub const GROWTH: [&str; 2] = ["bodies", "steps"];

/// Gases of 100 to 1,000,000 boxes at 60 Hz, and a bounce of 1000 to 1,000,000 steps.
pub fn growth() -> Vec<Case> {
    let gases = two_per_decade(100, 1_000_000).map(|bodies| {
        // The first step inserts all bodies and is not typical, so it is not measured.
        let steps = 1 + (10_000_000 / bodies).clamp(20, 600);
        let oracle = Oracle::Unknown("not computed: this case measures costs only".into());
        CaseSpec { family: GROWTH[0], rate: 60.0, factors: &[1], oracle, from: 1, ..gas(bodies, steps) }
    });
    let bounces = two_per_decade(1000, 1_000_000).map(bounce_of_steps);
    gases.chain(bounces).map(CaseSpec::build).collect()
}

/// Returns 1, 3, 10, 30, … times `first`, up to `last`.
fn two_per_decade(first: u64, last: u64) -> impl Iterator<Item = u64> {
    let decades = std::iter::successors(Some(first), |size| size.checked_mul(10));
    decades.flat_map(|decade| [decade, 3 * decade]).take_while(move |size| *size <= last)
}

/// The gravity of most scenes, m/s².
const GRAVITY: f64 = 9.81;

/// An oracle with a formula for the positions of the finite masses.
fn closed_form(positions: impl Fn(&Fixed256) -> Vec<[Fixed256; 2]> + 'static) -> Oracle {
    Oracle::ClosedForm(Box::new(positions))
}

/// A `[[spawn]]` table: upper-left corner and size (m), mass (kg) and velocity (m/s).
fn spawn(at: [f64; 2], size: [f64; 2], mass: f64, velocity: [f64; 2]) -> String {
    format!("[[spawn]]\nat = {at:?}\nsize = {size:?}\nmass = {mass:?}\nvelocity = {velocity:?}\n")
}

/// A `[[spawn]]` table of a static box.
fn static_block(at: [f64; 2], size: [f64; 2]) -> String {
    spawn(at, size, f64::INFINITY, [0.0; 2])
}

/// A million steps, a day, a million metres from the origin, and Zeno bounces until rest.
fn bounces(budget: Budget) -> Vec<CaseSpec> {
    let rate = 60.0;
    let million =
        CaseSpec { rate, steps: 1_000_000, factors: &[1, 4, 16], ..bounce("bounce for a million steps", 0.0, 1.0) };
    let day_factors: &[u64] = match budget {
        Budget::Minutes => &[1, 4],
        Budget::Hours => &[1, 4, 16],
    };
    let day = CaseSpec { rate, steps: 24 * 3600 * 60, factors: day_factors, ..bounce("bounce for 24 hours", 0.0, 1.0) };
    let far = CaseSpec { steps: 30_000, ..bounce("bounce at 10⁶ m from the origin", 1e6, 1.0) };
    let zeno = CaseSpec { family: "zeno", ..bounce("Zeno bounces, e = 0.5", 0.0, 0.5) };
    [million, day, far, zeno].map(with_collisions).into()
}

/// A bounce of `steps` steps, to measure the growth of errors.
fn bounce_of_steps(steps: u64) -> CaseSpec {
    let bounce = bounce(&format!("bounce of {steps} steps"), 0.0, 1.0);
    with_collisions(CaseSpec { family: GROWTH[1], rate: 60.0, steps, factors: &[1], ..bounce })
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

/// Galperin's billiard, fast shots, cradles, corners, squeezes, a wide range of sizes.
fn impacts(budget: Budget) -> Vec<CaseSpec> {
    let digits = match budget {
        Budget::Minutes => 0..=4,
        Budget::Hours => 0..=6,
    };
    let mut specs: Vec<CaseSpec> = digits.map(billiard).collect();
    specs.extend([shot_at_static_plate(), shot_at_free_plate(), cradle("touching", 0.0), cradle("gaps of 1 mm", 1e-3)]);
    specs.extend([corner_of_a_room(), past_corners(), corner_on_corner(), piston(), crush(), sizes()]);
    specs
}

/// Galperin's billiard: masses of 1 kg and 100^digits kg, and a wall.
fn billiard(digits: u32) -> CaseSpec {
    let mass = (0..digits).fold(1.0, |mass, _| mass * 100.0);
    let bodies = static_block([0.0, 0.0], [1.0, 9.0])
        + &spawn([4.0, 8.0], [1.0; 2], 1.0, [0.0; 2])
        + &spawn([8.0, 7.0], [2.0; 2], mass, [-1.0, 0.0]);
    let collisions = Some(galperin_collisions(digits));
    let name = format!("Galperin, masses 1 : {mass}");
    let factors = if digits > 4 { &[2, 32][..] } else { RATES };
    // The last collision happens after 24 s.
    CaseSpec { steps: 900, factors, collisions, ..CaseSpec::new("galperin", &name, bodies) }
}

/// Speed of the fast shots, m/s.
const SHOT: f64 = 7000.0;

/// A fast small box hits a static plate of 1 mm.
fn shot_at_static_plate() -> CaseSpec {
    let bodies = static_block([5.0, 0.0], [0.001, 9.0]) + &spawn([1.0, 4.0], [0.01; 2], 0.01, [SHOT, 0.0]);
    let face = &Fixed256::from(5.0) - &Fixed256::stated(0.01);
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
        let face = &Fixed256::from(5.0) - &Fixed256::stated(0.01);
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
        let faces = (0..4).map(|number| Fixed256::stated(position(number))).collect::<Vec<_>>();
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

/// The scene of [`piston`] at e = 0, until no gap is left.
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

/// Touching rows and columns that hit a wall.
fn bursts() -> Vec<CaseSpec> {
    // The impacts follow from the same arithmetic as the velocities, which takes too long to be done here.
    let rows = [
        (16, 0.0, None),
        (8, 0.9, Some(80)),
        (16, 0.99, Some(396)),
        (110, 0.999, Some(67_045)),
        (110, 1.0, Some(6105)),
    ];
    let columns = [(8, 0.9, Some(80)), (16, 0.99, Some(396))];
    let of =
        |axis| move |(count, restitution, impacts)| CaseSpec { collisions: impacts, ..burst(axis, count, restitution) };
    rows.map(of(Axis::X)).into_iter().chain(columns.map(of(Axis::Y))).collect()
}

/// Touching unit boxes of 1 kg hit a wall at 1 m/s. All impacts happen in one instant, the lowest approaching pair
/// first.
fn burst(axis: Axis, count: u32, restitution: f64) -> CaseSpec {
    let length = f64::from(count) + 4.0;
    let along = |along: f64, across: f64| match axis {
        Axis::X => [along, across],
        Axis::Y => [across, along],
    };
    let mut bodies = static_block([0.0; 2], along(1.0, 3.0));
    (0..count)
        .for_each(|number| bodies += &spawn(along(2.0 + f64::from(number), 1.0), [1.0; 2], 1.0, along(-1.0, 0.0)));
    let after = LazyLock::new(move || burst_velocities(count as usize, restitution).0);
    let positions = move |time: &Fixed256| {
        let since = time - &Fixed256::from(1.0);
        let moved = |(number, velocity): (usize, &Fixed256)| {
            let start = Fixed256::from(number as f64 + 2.0);
            let at = if since < Fixed256::zero() {
                &start - time
            } else {
                &(&start - &Fixed256::from(1.0)) + &(velocity * &since)
            };
            match axis {
                Axis::X => [at, Fixed256::from(1.0)],
                Axis::Y => [Fixed256::from(1.0), at],
            }
        };
        after.iter().enumerate().map(moved).collect()
    };
    let noun = if axis == Axis::X { "row" } else { "column" };
    let [width, height] = along(length, 3.0);
    CaseSpec {
        world: [width, height],
        restitution,
        steps: 60,
        oracle: closed_form(positions),
        ..CaseSpec::new("burst", &format!("{noun} of {count} at a wall, e = {restitution}"), bodies)
    }
}

/// The boxes that slide over tiles, as multiples of the width of a tile.
const RATIOS: [f64; 9] = [0.5, 0.8, 1.0, 1.25, 1.6, 2.0, 2.5, 3.0, 7.0];

/// A box pressed onto a corner from rest slides along the axis on which it is pressed less; so do two boxes that press
/// their corners together.
fn corner_presses() -> [CaseSpec; 2] {
    let pushed = |at, force: [f64; 2]| spawn(at, [1.0; 2], 1.0, [0.0; 2]) + &format!("force = {force:?}\n");
    let half_square = |acceleration: f64, time: &Fixed256| &(&Fixed256::from(acceleration / 2.0) * time) * time;
    let spec = |name: &str, bodies: String, oracle: Oracle| CaseSpec {
        restitution: 0.0,
        steps: 7,
        oracle,
        collisions: Some(0),
        ..CaseSpec::new("corner", name, bodies)
    };
    let alone = closed_form(move |time| vec![[Fixed256::from(3.0), &Fixed256::from(3.0) + &half_square(5.0, time)]]);
    let pair = closed_form(move |time| {
        let right = half_square(4.5, time);
        vec![
            [&Fixed256::from(2.0) + &right, &Fixed256::from(1.0) + &half_square(10.0, time)],
            [&Fixed256::from(3.0) + &right, &Fixed256::from(2.0) + &half_square(-15.0, time)],
        ]
    });
    [
        spec("box pressed onto a corner", static_block([4.0, 4.0], [1.0; 2]) + &pushed([3.0, 3.0], [2.0, 5.0]), alone),
        spec("corners pressed together", pushed([2.0, 1.0], [6.0, 10.0]) + &pushed([3.0, 2.0], [3.0, -15.0]), pair),
    ]
}

/// Stacks, tile seams, corners pressed together, a deleted support, overlapping spawns.
fn contacts() -> Vec<CaseSpec> {
    let light = [10, 100, 1000].map(|count| stack(count, &format!("stack of {count}"), &|_| 1.0));
    let heavy = stack(13, "stack of 13, mass ratio 10 per box", &|number| (0..number).fold(1.0, |mass, _| mass * 10.0));
    let seams = [0.0, 1.0].into_iter().flat_map(|restitution| RATIOS.map(|ratio| tiles(ratio, restitution)));
    let others = [support(), overlaps()].into_iter().chain(corner_presses());
    light.into_iter().chain([heavy]).chain(seams).chain(others).collect()
}

/// A stack of unit boxes, e = 0, which must not move; number 0 is the lowest.
fn stack(count: u32, name: &str, mass: &dyn Fn(u32) -> f64) -> CaseSpec {
    let height = f64::from(count) + 1.0;
    let mut bodies = static_block([0.0, height], [9.0, 1.0]);
    for number in 0..count {
        bodies += &spawn([4.0, height - 1.0 - f64::from(number)], [1.0; 2], mass(number), [0.0; 2]);
    }
    let world = [9.0, height];
    let factors: &[u64] = if count > 100 { &[1, 2] } else { RATES };
    CaseSpec {
        world,
        gravity: GRAVITY,
        restitution: 0.0,
        factors,
        oracle: Oracle::Rest,
        ..CaseSpec::new("stack", name, bodies)
    }
}

/// A box slides over a floor of forty flush tiles of 0.8 m; nothing may stop it.
fn tiles(ratio: f64, restitution: f64) -> CaseSpec {
    const WIDTH: f64 = 0.8;
    let mut bodies = String::new();
    (0..40).for_each(|number| bodies += &static_block([WIDTH * f64::from(number), 8.0], [WIDTH, 0.5]));
    let side = WIDTH * ratio;
    let top = 8.0 - side;
    bodies += &spawn([0.5, top], [side; 2], 1.0, [3.0, 0.0]);
    let oracle = closed_form(move |time| vec![[uniform(0.5, 3.0, time), Fixed256::from(top)]]);
    let noun = if ratio == 1.0 { "tile" } else { "tiles" };
    CaseSpec {
        world: [32.0, 9.0],
        gravity: GRAVITY,
        restitution,
        steps: 240,
        oracle,
        collisions: Some(0),
        ..CaseSpec::new("tiles", &format!("box of {ratio} {noun} over seams, e = {restitution}"), bodies)
    }
}

/// Ten stacked boxes lose their support after a second and fall two metres together.
fn support() -> CaseSpec {
    let mut bodies =
        static_block([0.0, 14.0], [9.0, 1.0]) + &static_block([3.0, 12.0], [3.0, 2.0]) + "name = \"support\"\n";
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

/// Gases of 100 to 100,000 boxes; piles of 1000 and 10,000, while they fall and later.
fn crowds(budget: Budget) -> Vec<CaseSpec> {
    let mut specs = vec![gas(100, 300), gas(1000, 30), gas(10_000, 60), gas(100_000, 30)];
    let piles: &[u64] = match budget {
        Budget::Minutes => &[1000],
        Budget::Hours => &[1000, 10_000],
    };
    specs.extend(piles.iter().flat_map(|&bodies| [pile(bodies), settled(bodies)]));
    specs
}

/// Unit boxes between walls that fill a fifth of the area, with up to 5 m/s along each axis.
fn gas(bodies: u64, steps: u64) -> CaseSpec {
    let side = (bodies as f64 * 5.0).sqrt();
    let scatter = format!(
        "[[scatter]]\ncount = {bodies}\nseed = 1\nregion = [0.0, 0.0, {side:?}, {side:?}]\n\
         size = [[1.0, 1.0], [1.0, 1.0]]\nmass = [1.0, 1.0]\nvelocity = [[-5.0, -5.0], [5.0, 5.0]]\n"
    );
    let oracle = match bodies {
        0..=1000 => Oracle::Simulation,
        _ => Oracle::Unknown("too many bodies for 77 decimals".into()),
    };
    let world = [side; 2];
    let factors: &[u64] = if bodies > 10_000 { &[1, 2] } else { RATES };
    CaseSpec {
        world,
        walls: true,
        steps,
        factors,
        oracle,
        ..CaseSpec::new("gas", &format!("gas of {bodies}"), scatter)
    }
}

/// Boxes of sides 0.6 to 1.4 m fall into a bin, e = 0.3.
fn pile(bodies: u64) -> CaseSpec {
    let width = (bodies as f64 * 3.6).sqrt();
    let height = width * 0.8;
    let scatter = format!(
        "[[scatter]]\ncount = {bodies}\nseed = 1\nregion = [0.0, 0.0, {width:?}, {height:?}]\n\
         size = [[0.6, 0.6], [1.4, 1.4]]\nmass = [1.0, 1.0]\nvelocity = [[-3.0, 0.0], [3.0, 0.0]]\n"
    );
    let oracle = Oracle::Unknown("resting contacts are not simulated with 77 decimals".into());
    CaseSpec {
        world: [width, height],
        walls: true,
        gravity: GRAVITY,
        restitution: 0.3,
        factors: &[1, 2],
        oracle,
        ..CaseSpec::new("pile", &format!("pile of {bodies}"), scatter)
    }
}

/// The scene of [`pile`] 30 s later. Without friction, boxes keep sliding over and off each other.
fn settled(bodies: u64) -> CaseSpec {
    let name = format!("pile of {bodies} after 30 s");
    CaseSpec { family: "settled pile", name, steps: 1950, from: 1800, ..pile(bodies) }
}
