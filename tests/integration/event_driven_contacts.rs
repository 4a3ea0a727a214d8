//! Resting contacts in the event-driven solver.

use crate::world_builder::*;
use rebond::internals::physics::{CollisionCount, Event, Vector};
use rebond::internals::{replay::Run, scene};

const EARTH: Option<[f64; 2]> = Some([0.0, 9.81]);

/// A floor and a stack of unit boxes on it, the lowest first.
fn stack(masses: impl Iterator<Item = f64>) -> Vec<BodySpec> {
    let mut bodies = vec![spec([0.0, 0.0], [4.0, 1.0], INFINITE)];
    bodies.extend(masses.enumerate().map(|(n, mass)| spec([1.0, -1.0 - n as f64], [1.0, 1.0], mass)));
    bodies
}

fn assert_at_rest(steps: u64, conditions: Conditions, bodies: &[BodySpec]) {
    let mut engine = world(conditions, bodies);
    let before = all_bits(&engine);
    assert_eq!(count(&mut engine, steps), 0);
    assert_eq!(all_bits(&engine), before);
}

#[test]
fn stacks_of_any_height_and_mass_ratio_do_not_move_in_a_million_steps() {
    let conditions = |restitution| Conditions { gravity: EARTH, restitution, ..Conditions::default() };
    for restitution in [0.0, 0.5, 1.0] {
        let check = |bodies: &[BodySpec]| assert_at_rest(1_000_000, conditions(restitution), bodies);
        check(&stack([1.0].into_iter()));
        check(&stack((0..50).map(|_| 1.0)));
        check(&stack((0..50).map(|n| if n % 2 == 0 { 1.0 } else { 1e12 })));
        check(&stack((0..1000).map(|n| 1.0 + f64::from(n))));
        check(&stack((0..1000).map(|n| if n % 2 == 0 { 1.0 } else { 1e12 })));
    }
}

/// A floor and 300 boxes on it, the lowest first, whose decimal coordinates cause gaps and overlaps of an ulp.
fn decimal_stack() -> Vec<BodySpec> {
    let mut bodies = vec![spec([0.0, 0.0], [4.0, 1.0], INFINITE)];
    bodies.extend((1..=300).map(|n| spec([1.0, -0.1 * f64::from(n)], [1.0, 0.1], 1.0)));
    bodies
}

#[test]
fn a_stack_with_decimal_coordinates_does_not_move() {
    for restitution in [0.0, 0.3, 1.0] {
        assert_at_rest(100, Conditions { gravity: EARTH, restitution, ..Conditions::default() }, &decimal_stack());
    }
}

#[test]
fn a_stack_with_decimal_coordinates_that_is_created_from_the_top_does_not_move() {
    let mut bodies = decimal_stack();
    bodies[1..].reverse();
    for restitution in [0.0, 0.3, 1.0] {
        assert_at_rest(100, Conditions { gravity: EARTH, restitution, ..Conditions::default() }, &bodies);
    }
}

#[test]
fn a_stack_rests_on_a_moving_platform_and_on_a_wall_when_gravity_is_sideways() {
    let mut bodies = stack((0..5).map(|_| 1.0));
    bodies.iter_mut().for_each(|body| body.velocity = [0.0, -0.75]);
    let mut engine = world(Conditions { gravity: EARTH, restitution: 0.4, ..Conditions::default() }, &bodies);
    assert_eq!(count(&mut engine, 600), 0);
    for (n, body) in engine.world().bodies.iter().enumerate() {
        assert_eq!(body.velocity, Vector::new(0.0, -0.75));
        assert_close(body.rect.origin.y, -(n as f64) - 7.5, 1e-14);
    }
    let sideways =
        [spec([-1.0, 0.0], [1.0, 9.0], INFINITE), spec([0.0, 1.0], [1.0, 1.0], 1.0), spec([1.0, 1.5], [1.0, 1.0], 1e9)];
    assert_at_rest(
        600,
        Conditions { gravity: Some([-3.0, 0.0]), restitution: 0.5, ..Conditions::default() },
        &sideways,
    );
}

#[test]
fn a_stack_falls_from_the_instant_at_which_its_lowest_box_is_deleted() {
    let mut engine = world(
        Conditions { gravity: Some([0.0, 10.0]), restitution: 0.0, ..Conditions::default() },
        &stack((0..50).map(|n| 1.0 + f64::from(n % 7))),
    );
    run(&mut engine, 60);
    engine.apply(&Event::Delete(1));
    run(&mut engine, 6);
    for id in 2..=50 {
        let fallen = body(&engine, id);
        assert_close(fallen.velocity.y, 1.0, 1e-15);
        assert_close(fallen.rect.origin.y, -f64::from(id) + 0.05, 1e-13);
    }
    run(&mut engine, 60);
    for id in 2..=50 {
        assert_eq!(body(&engine, id).velocity, Vector::ZERO);
        assert_close(body(&engine, id).rect.origin.y, 1.0 - f64::from(id), 1e-13);
    }
    assert!(engine.world().deepest_overlap() <= 1e-13);
}

#[test]
fn a_box_that_slides_past_an_edge_falls_from_there() {
    let table = spec([0.0, 0.0], [2.0, 1.0], INFINITE);
    let slider = spec([1.0, -1.0], [0.5, 1.0], 1.0).with_velocity(1.0, 0.0);
    let conditions = Conditions { gravity: Some([0.0, 10.0]), restitution: 0.5, ..Conditions::default() };
    let mut engine = world(conditions, &[table, slider]);
    run(&mut engine, 60);
    assert_eq!(body(&engine, 1).rect.origin.y, -1.0, "it passes the edge at exactly 1 s");
    run(&mut engine, 30);
    assert_close(body(&engine, 1).rect.origin.y, -1.0 + 5.0 * 0.25, 1e-14);
    assert_close(body(&engine, 1).rect.origin.x, 2.5, 1e-14);
}

#[test]
fn forces_press_boxes_against_a_wall_without_overlap() {
    let bodies = [
        spec([-1.0, 0.0], [1.0, 4.0], INFINITE),
        spec([0.0, 1.0], [1.0, 1.0], 1.0),
        spec([1.0, 1.2], [1.0, 1.0], 5.0).with_force(-3.0, 0.0),
        spec([2.0, 0.9], [1.0, 1.0], 2.0).with_force(1.0, 0.0),
    ];
    let conditions = Conditions { restitution: 0.0, rate: 64.0, ..Conditions::default() };
    let mut engine = world(conditions, &bodies);
    run(&mut engine, 128);
    assert_eq!(body(&engine, 1).rect.origin.x, 0.0);
    assert_eq!(body(&engine, 2).rect.origin.x, 1.0);
    assert_close(body(&engine, 3).rect.origin.x, 3.0, 1e-14);
}

#[test]
fn a_row_with_a_force_on_its_last_box_moves_as_one() {
    let bodies = [
        spec([0.0, 0.0], [1.0, 1.0], 1.0).with_force(12.0, 0.0),
        spec([1.0, 0.0], [1.0, 1.0], 2.0),
        spec([2.0, 0.0], [1.0, 1.0], 3.0),
    ];
    for restitution in [0.0, 0.7, 1.0] {
        let mut engine = world(Conditions { restitution, rate: 64.0, ..Conditions::default() }, &bodies);
        assert_eq!(count(&mut engine, 64), 0);
        for id in 0..3 {
            assert_close(body(&engine, id).rect.origin.x, f64::from(id) + 1.0, 1e-15);
            assert_eq!(body(&engine, id).velocity.x, 2.0);
        }
    }
}

#[test]
fn boxes_that_were_pushed_stay_in_contact_when_the_force_ends() {
    let row = [
        spec([0.0, 0.0], [1.0, 1.0], 1.0).with_force(4.0, 0.0),
        spec([1.0, 0.0], [1.0, 1.0], 1.0),
        spec([2.0, 0.0], [1.0, 1.0], 1.0),
        spec([3.0, 0.0], [1.0, 1.0], 1.0),
        spec([-8.0, 0.0], [1.0, 1.0], 1.0).with_velocity(5.0, 0.0),
    ];
    let forced_elsewhere = spec([1000.0, 5000.0], [1.0, 1.0], 1.0).with_force(1.0, 0.0);
    for bodies in [row.to_vec(), [&row[..], &[forced_elsewhere]].concat()] {
        let mut engine = world(Conditions::default(), &bodies);
        run(&mut engine, 30);
        engine.apply(&Event::Delete(0));
        let impulses: Vec<f64> = run(&mut engine, 170).iter().map(|collision| collision.impulse).collect();
        assert_eq!(impulses, [6.75], "1 kg at 5 m/s hits 3 kg at 0.5 m/s");
    }
}

/// A ball dropped from the height h is at rest after √(2h/g)·(1 + e)/(1 − e).
#[test]
fn a_bouncing_ball_comes_to_rest_at_the_limit_of_its_series_of_impacts() {
    for e in [0.3_f64, 0.5, 0.8, 0.95] {
        let floor = spec([0.0, 0.0], [4.0, 1.0], INFINITE);
        let ball = spec([1.0, -2.25], [1.0, 1.0], 1.0);
        let conditions =
            Conditions { gravity: Some([0.0, 10.0]), restitution: e, rate: 1000.0, ..Conditions::default() };
        let mut engine = world(conditions, &[floor, ball]);
        let total = 0.5 * (1.0 + e) / (1.0 - e);
        let steps = (total * 1000.0) as u64;
        let collisions = run(&mut engine, steps + 2);
        let last = collisions.last().unwrap();
        let end = last.step as f64 / 1000.0 + last.time;
        assert!(end <= total + 1e-12 && end >= total - 1e-5, "e = {e}: at rest after {end} s, expected {total} s");
        // The first impact is at 5 m/s; bounces of less than 2⁻⁶⁴ of the sizes, which add up to 2 m, are plastic.
        let slowest = (2.0 * 10.0 * 2.0 / (1_u128 << 64) as f64).sqrt();
        let impacts = std::iter::successors(Some(5.0), |speed| Some(speed * e)).take_while(|&speed| speed > slowest);
        let (count, expected) = (collisions.len(), impacts.count());
        assert!(count.abs_diff(expected) <= 1, "e = {e}: {count} impacts, expected {expected}");
        assert_eq!(body(&engine, 1).velocity, Vector::ZERO);
        assert_eq!(body(&engine, 1).rect.origin.y, -1.0);
    }
}

/// Along each axis the gap closes after √(2·gap/a) and each bounce takes e times as long as the one before.
#[test]
fn a_box_that_is_drawn_diagonally_into_a_corner_comes_to_rest_there() {
    for (e, gap) in [(0.5, 0.125), (0.3, 2.0), (0.9, 0.5)] {
        let block = spec([0.0, 1.0], [1.0, 1.0], INFINITE);
        let body = spec([1.0 + gap, -gap], [1.0, 1.0], 1.0).with_force(-6.0, 6.0);
        let conditions = Conditions { gravity: None, restitution: e, rate: 1000.0, ..Conditions::default() };
        let mut engine = world(conditions, &[block, body]);
        let fall = (gap / 3.0_f64).sqrt();
        let rest = fall * (1.0 + 2.0 * e / (1.0 - e));
        let collisions = run(&mut engine, (rest * 1000.0) as u64 + 2);
        let last = collisions.last().unwrap();
        assert!((last.instant - rest).abs() < 1e-8, "e = {e}: at rest after {} s, expected {rest} s", last.instant);
        let body = self::body(&engine, 1);
        let Vector { x, y } = body.rect.origin;
        assert!((x - 1.0).abs() < 1e-18 && y.abs() < 1e-18, "e = {e}: at {x}, {y}");
        assert_eq!(body.velocity, Vector::ZERO);
    }
}

#[test]
fn a_row_with_e_0_moves_as_one_after_an_impact() {
    let mut bodies: Vec<_> = (0..1000).map(|n| spec([f64::from(n), 0.0], [1.0, 1.0], 1.0)).collect();
    bodies.push(spec([-2.0, 0.0], [1.0, 1.0], 24.0).with_velocity(1.0, 0.0));
    let mut engine = world(Conditions { restitution: 0.0, ..Conditions::default() }, &bodies);
    count(&mut engine, 61);
    for body in &engine.world().bodies {
        assert_close(body.velocity.x, 24.0 / 1024.0, 1e-15);
    }
    assert!(engine.world().deepest_overlap() <= 1e-12);
}

#[test]
fn overlapping_spawns_are_separated_and_gain_no_energy() {
    let mut bodies = walls(10.0, 10.0);
    bodies.extend((0..60).map(|n| {
        let n = f64::from(n);
        spec([4.0 + 0.02 * n, 5.0 - 0.013 * n], [0.5 + 0.01 * n, 0.6], 1.0).with_velocity(0.1 * n - 3.0, 1.0)
    }));
    bodies.push(bodies[20].clone());
    let mut engine = world(Conditions::default(), &bodies);
    let before = engine.world().kinetic_energy();
    for _ in 0..60 {
        run(&mut engine, 1);
        assert!(engine.world().deepest_overlap() <= 1e-13);
        assert!((engine.world().kinetic_energy() - before).abs() <= 1e-12 * before);
    }
}

#[test]
fn an_infinite_mass_spawned_in_a_pile_displaces_the_boxes() {
    let mut bodies = walls(6.0, 6.0);
    bodies.extend((0..16).map(|n| spec([f64::from(n % 4) * 1.2, 2.0 + f64::from(n / 4)], [1.0, 1.0], 1.0)));
    let mut engine = world(Conditions { gravity: EARTH, restitution: 0.2, ..Conditions::default() }, &bodies);
    run(&mut engine, 60);
    spawn(&mut engine, &spec([1.5, 3.5], [1.5, 1.5], INFINITE));
    for _ in 0..120 {
        run(&mut engine, 1);
        assert!(engine.world().deepest_overlap() <= 1e-13);
    }
}

/// A supported body responds to an impact like its support, and transmits nothing to the bodies below.
#[test]
fn an_impact_from_above_does_not_move_a_stack() {
    let mut bodies = stack([1.0, 1e-6, 1e6].into_iter());
    bodies.push(spec([1.2, -9.0], [1.0, 1.0], 1e3).with_velocity(0.0, 20.0));
    let mut engine = world(Conditions { gravity: EARTH, restitution: 0.5, ..Conditions::default() }, &bodies);
    let before: Vec<_> = (1..=3).map(|id| bits(body(&engine, id))).collect();
    let collisions = run(&mut engine, 600);
    assert!(collisions.len() > 5);
    assert_eq!((1..=3).map(|id| bits(body(&engine, id))).collect::<Vec<_>>(), before);
    assert_eq!(body(&engine, 4).velocity, Vector::ZERO);
}

#[test]
fn a_light_box_between_a_wall_and_a_heavy_box_comes_to_rest_with_it() {
    for mirrored in [1.0, -1.0] {
        let at = |x: f64, width: f64| if mirrored > 0.0 { x } else { -x - width };
        let bodies = [
            spec([at(-1.0, 1.0), 0.0], [1.0, 4.0], INFINITE),
            spec([at(0.0, 1.5), 1.0], [1.5, 1.0], 0.2).with_velocity(-1.2 * mirrored, 0.0),
            spec([at(4.2, 0.3), 1.0], [0.3, 0.3], 4.4).with_velocity(-3.9 * mirrored, 0.0),
        ];
        let mut engine = world(Conditions { restitution: 0.3, ..Conditions::default() }, &bodies);
        let collisions = count(&mut engine, 120);
        assert!(collisions < 1000, "{collisions} collisions");
        for id in [1, 2] {
            assert_eq!(body(&engine, id).velocity, Vector::ZERO, "body {id} moves after the inelastic collapse");
        }
    }
}

/// Among the millions of impacts are approaches that doubles do not see, which push boxes onto their neighbours by
/// rounding.
#[test]
#[ignore = "three million collisions"]
fn a_heap_of_ten_thousand_boxes_has_no_overlaps() {
    let width = 36_000_f64.sqrt();
    let height = width * 0.8;
    let scene = format!(
        "[world]\nsize = [{width}, {height}]\nwalls = true\ngravity = [0.0, 9.81]\n[run]\nrate = 60\nsteps = 300\n\
         events_per_step = 100000000\n[restitution]\ndefault = 0.3\n[[scatter]]\ncount = 10000\nseed = 1\n\
         region = [0.0, 0.0, {width}, {height}]\nsize = [[0.6, 0.6], [1.4, 1.4]]\nmass = [1.0, 1.0]\n\
         velocity = [[-3.0, 0.0], [3.0, 0.0]]\n"
    );
    let scene = scene::parse("heap.toml", &scene).unwrap();
    let mut run = Run::new(&scene);
    run.apply_inputs(Vec::new(), |error| Err(error.into())).unwrap();
    (0..scene.run.steps).for_each(|_| run.step(&mut CollisionCount::default()).unwrap());
    assert!(run.engine().world().deepest_overlap() <= 1e-12);
}

/// A box slides off a shelf and is squeezed between a pusher and a wall when it has just left it. The gap to the wall is 0
/// below the resolution of the wall, which is coarser the thicker the wall is.
#[test]
fn a_box_that_a_squeeze_moves_off_its_shelf_falls_whatever_the_thickness_of_the_wall() {
    let bodies = |pusher: f64, shelf: f64, thickness: f64| {
        [
            spec([-shelf, 5.0], [shelf, 1.0], INFINITE),
            spec([1.0, 0.0], [thickness, 16.0], INFINITE),
            spec([-0.125, 4.0], [1.0, 1.0], 1.0),
            spec([-2.0, 3.5], [1.5, 0.75], pusher).with_velocity(1.0, 0.0).with_force(0.0, -8.0 * pusher),
        ]
    };
    for (restitution, pusher) in [(0.3, 10.0), (0.3, 1e6), (0.5, 10.0), (0.5, 1000.0), (0.7, 1000.0), (0.9, 1e6)] {
        for is_reversed in [false, true] {
            let height_after = |shelf: f64, thickness: f64| {
                let mut bodies = bodies(pusher, shelf, thickness);
                if is_reversed {
                    bodies.reverse();
                }
                let conditions =
                    Conditions { rate: 16.0, restitution, gravity: Some([0.0, 8.0]), ..Conditions::default() };
                let mut engine = world(conditions, &bodies);
                count(&mut engine, 64);
                body(&engine, if is_reversed { 1 } else { 2 }).rect.origin.y
            };
            let expected = height_after(1.0, 1.0);
            assert!(expected > 40.0, "e = {restitution}, pusher of {pusher} kg: the box is at {expected} m");
            for (shelf, thickness) in [(0.25, 1.0), (1.0, 16.0), (0.25, 16.0), (0.25, 1024.0)] {
                let found = height_after(shelf, thickness);
                assert!((found - expected).abs() < 1e-9, "{thickness} m thick wall: {found} m, not {expected} m");
            }
            if (restitution, pusher) == (0.5, 1000.0) {
                // It falls from 0.50025050201 s on, in exact arithmetic.
                assert!((expected - 52.992_986_195_472_34).abs() < 1e-9, "{expected}");
            }
        }
    }
}
