//! Supported boxes slide over flush seams as over one plank.

use super::random::{COEFFICIENTS, Random};
use crate::world_builder::{BodySpec, Conditions, INFINITE, body, run, spawn, spec, world};
use rebond::internals::physics::Axis;

/// The largest number of units in the width of a tile or a box.
const WIDEST: i64 = 8;

/// A box of `width` units slides over tiles of `tile` units. Everything else is random.
fn slide(tile: i64, width: i64, seed: u64) {
    let mut random = Random::new(seed);
    let unit = random.pick(&[1.0, 0.25, 0.1, 0.3, 0.8]);
    let count = 2 * WIDEST / tile + 3;
    let metres = |units: i64| units as f64 * unit;
    let has_finite_tiles = random.chance(20);
    let mut tiles: Vec<BodySpec> = (0..count)
        .map(|n| spec([metres(n * tile), 0.0], [metres(tile), 1.0], if has_finite_tiles { 1e3 } else { INFINITE }))
        .collect();
    if random.chance(50) {
        tiles.reverse();
    }
    let speed = random.pick(&[1, 2, 4, 6]);
    let direction = random.pick(&[1, -1]);
    let falls = random.chance(30);
    let seam = random.whole(0, 1) * tile + if direction > 0 { 0 } else { (count - 1) * tile - width - tile };
    let start = seam + if random.chance(50) { 0 } else { random.whole(0, tile) };
    let is_pushed = random.chance(30);
    // After half a second at 8 m/s², a box that falls lands with a corner exactly above a seam in many of the scenes.
    let mut sliding = spec([metres(start), if falls { -2.0 } else { -1.0 }], [metres(width), 1.0], 1.0)
        .with_velocity(metres(direction * speed), 0.0);
    let mut gravity = Some([0.0, 8.0]);
    if is_pushed && !has_finite_tiles {
        (sliding.force, gravity) = ([0.0, 8.0], None);
    }
    let (mut bodies, is_first) = (tiles, random.chance(50));
    if has_finite_tiles {
        bodies.push(spec([-1.0, 1.0], [metres(count * tile) + 2.0, 1.0], INFINITE));
    }
    let id = if is_first { 0 } else { bodies.len() };
    bodies.insert(id, sliding.clone());
    let is_turned = random.chance(50);
    if is_turned {
        bodies.iter_mut().for_each(|body| {
            [&mut body.at, &mut body.size, &mut body.velocity, &mut body.force]
                .into_iter()
                .for_each(|pair| pair.swap(0, 1));
        });
        gravity = gravity.map(|[x, y]| [y, x]);
    }
    let restitution = random.pick(&COEFFICIENTS);
    let about =
        format!("tile {tile}, box {width}, seed {seed}, e = {restitution}, {sliding:?}, body {id} of {bodies:#?}");
    let mut engine = world(Conditions { restitution, gravity, rate: 16.0, ..Conditions::default() }, &bodies);
    // It slides off the last tile in some of the scenes.
    let steps = if falls { 24 } else { 64 };
    let (along, across) = if is_turned { (Axis::Y, Axis::X) } else { (Axis::X, Axis::Y) };
    let components = |v: rebond::internals::physics::Vector| if is_turned { [v.y, v.x] } else { [v.x, v.y] };
    for step in 1..=steps {
        let collisions = run(&mut engine, 1);
        assert!(collisions.iter().all(|collision| collision.axis == across), "step {step}, {along:?}, {about}");
        let found = body(&engine, id as u32);
        let ([x, y], [vx, _]) = (components(found.rect.origin), components(found.velocity));
        assert_eq!(vx.to_bits(), sliding.velocity[0].to_bits(), "step {step}: its speed, {about}");
        let expected = sliding.at[0] + vx * f64::from(step) / 16.0;
        assert!((x - expected).abs() <= 1e-13 * (1.0 + expected.abs()), "step {step}: {x} and {expected}, {about}");
        let is_supported = x < metres(count * tile) && x + metres(width) > 0.0;
        if is_supported && !falls {
            assert!(
                collisions.is_empty() && y == -1.0,
                "step {step}: y = {y}, {} collisions, {about}",
                collisions.len()
            );
        }
    }
}

fn all_ratios(rounds: u64) {
    for (tile, width) in (1..=WIDEST).flat_map(|tile| (1..=WIDEST).map(move |width| (tile, width))) {
        for round in 0..rounds {
            slide(tile, width, round * 64 + (tile * 8 + width) as u64);
        }
    }
    println!("seams: {} slides over tiles of all ratios up to {WIDEST}", rounds * 64);
}

#[test]
fn no_box_is_stopped_or_turned_at_a_flush_seam() {
    // The seeds of the random scenes, divided among the ratios.
    all_ratios(super::seeds().count() as u64 / 64 + 1);
}

/// Boxes of decimal widths stand beside each other in decimal columns, and fall from different heights.
#[test]
fn boxes_that_fit_in_decimals_do_not_catch_on_each_other() {
    for seed in 0..200 {
        let mut random = Random::new(seed);
        let parts = random.pick(&[10.0, 100.0, 1000.0, 1e6]);
        // Along x and along y, from the left and from the right.
        let (across, sign) = (random.below(2) as usize, random.pick(&[1.0, -1.0]));
        let vector = |along: f64, over: f64| if across == 0 { [over, along] } else { [along, over] };
        let mut bodies = vec![spec(vector(3.0, -1e4), vector(1.0, 2e4), INFINITE)];
        let mut first = random.whole(-50, 50);
        for _ in 0..12 {
            let width = random.whole(1, 20);
            let low = if sign > 0.0 { first } else { -(first + width) };
            let [x, width_in_metres] = [low, width].map(|units| units as f64 / parts);
            let height = random.whole(1, 9) as f64 / 10.0;
            bodies.push(spec(vector(-(random.whole(1, 20) as f64), x), vector(height, width_in_metres), 1.0));
            first += width;
        }
        let [x, y] = vector(8.0, 0.0);
        let conditions = Conditions { restitution: 0.0, gravity: Some([x, y]), ..Conditions::default() };
        let mut engine = world(conditions, &bodies);
        let collisions = run(&mut engine, 180);
        let pairs: Vec<_> = collisions.iter().map(|collision| collision.bodies).collect();
        assert!(pairs.iter().all(|pair| pair[0] == 0), "seed {seed}: only the floor is hit: {pairs:?}");
        assert_eq!(pairs.len(), 12, "seed {seed}: each box hits the floor once");
    }
}

/// A box of some micrometres lies within a micrometre of a face of a body that is up to 10⁹ m thick, or overlaps it.
fn near_a_huge_body(seed: u64) {
    let mut random = Random::new(seed);
    let metres = |nanometres: i64| nanometres as f64 / 1e9;
    let (thickness, size, gap) =
        (random.pick(&[1e6, 1e7, 1e9]), random.whole(2_000, 20_000), random.whole(-1_000, 1_000));
    // The face is the low one, at a decimal, or the high one, at 0, where a stated overlap is below the rounding of a double.
    let is_low = gap < 0 || random.chance(60);
    let face = if is_low { random.whole(-9_000, 9_000) } else { 0 };
    let at = if is_low { [metres(face), metres(face - gap - size)] } else { [-thickness, metres(gap)] };
    let is_turned = random.chance(50);
    let vector = |along: f64, across: f64| if is_turned { [across, along] } else { [along, across] };
    // A box that does not overlap the body approaches it.
    let speed = if gap < 0 { 0.0 } else { 1e-3 };
    let velocity = vector(if is_low { speed } else { -speed }, 0.0);
    let huge = spec(vector(at[0], -5e5), vector(thickness, 1e6), INFINITE);
    let small = spec(vector(at[1], 0.0), vector(metres(size), 1e-6), 1.0).with_velocity(velocity[0], velocity[1]);
    let order = random.pick(&["small, huge", "huge, small", "huge, a step, small"]);
    let about = format!("seed {seed}: {order}, gap {gap} nm, {small:?}, {huge:?}");
    let mut engine =
        world(Conditions::default(), if order == "small, huge" { &[] } else { std::slice::from_ref(&huge) });
    if order == "huge, a step, small" {
        run(&mut engine, 1);
    }
    let start = engine.current_step() as f64 / 60.0;
    let id = engine.next_id();
    spawn(&mut engine, &small);
    if order == "small, huge" {
        spawn(&mut engine, &huge);
    }
    let collisions = run(&mut engine, 1);
    if gap < 0 {
        let origin = body(&engine, id).rect.origin;
        let found = if is_turned { origin.y } else { origin.x };
        assert!((found - metres(face - size)).abs() <= 1e-20, "it is moved onto the face, to {found:e}, {about}");
        return;
    }
    assert_eq!(collisions.len(), 1, "{about}");
    let (found, expected) = (collisions[0].instant - start, metres(gap) / speed);
    assert!((found - expected).abs() <= 1e-15 + 1e-12 * expected, "hit after {found:e} s, not {expected:e} s, {about}");
}

#[test]
fn a_small_box_keeps_its_stated_gap_from_a_huge_body() {
    (0..500).for_each(near_a_huge_body);
}
