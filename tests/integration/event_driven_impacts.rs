//! The exact solver's impacts, each against a closed form.

use crate::laboratory::*;
use rebond::physics::{StepError, Vector, invariants};

/// Unfolds the motion of a point between two elastic walls.
fn reflected(distance: f64, room: f64) -> f64 {
    let within = distance % (2.0 * room);
    if within <= room { within } else { 2.0 * room - within }
}

#[test]
fn a_box_bounces_between_walls_for_ever() {
    let mut bodies = walls(9.0, 9.0);
    bodies.push(sketch([1.0, 2.0], [1.0, 1.0], 1.0).moving(5.0, -3.0));
    let mut engine = world(Conditions::default(), &bodies);
    let steps = 60_000;
    count(&mut engine, steps);
    let bounced = body(&engine, 4);
    let seconds = steps as f64 / 60.0;
    assert_close(bounced.rect.origin.x, reflected(1.0 + 5.0 * seconds, 8.0), 1e-10);
    assert_close(bounced.rect.origin.y, reflected(16.0 + 2.0 - 3.0 * seconds % 16.0, 8.0), 1e-10);
    assert_eq!(invariants::kinetic_energy(engine.world()), 17.0, "not a bit of energy is lost");
}

/// Issue 3: drift ≤ 1e-12 and position ≤ 1e-9 m after 10⁶ steps. `cargo test --release -- --ignored`
#[test]
#[ignore = "a million steps"]
fn an_elastic_ball_bounces_under_gravity_for_a_million_steps() {
    bouncing_ball(1_000_000, 1e-9);
}

#[test]
fn an_elastic_ball_bounces_under_gravity() {
    bouncing_ball(20_000, 1e-10);
}

fn bouncing_ball(steps: u64, tolerance: f64) {
    let conditions = Conditions { gravity: Some([0.0, 10.0]), ..Conditions::default() };
    let floor = sketch([0.0, 5.0], [10.0, 1.0], INFINITE);
    let mut engine = world(conditions, &[floor, sketch([4.0, -1.0], [1.0, 1.0], 1.0)]);
    let energy = |engine: &rebond::physics::Engine| {
        invariants::kinetic_energy(engine.world()) + invariants::potential_energy(engine.world())
    };
    let before = energy(&engine);
    run(&mut engine, steps);
    // Falls 5 m in 1 s, so it is back every 2 s.
    let phase = (steps % 120) as f64 / 60.0 - 1.0;
    let height = 5.0 - 5.0 * (1.0 - phase.abs()) * (1.0 - phase.abs());
    assert_close(4.0 - body(&engine, 1).rect.origin.y, height, tolerance);
    assert!((energy(&engine) - before).abs() <= 1e-12 * 50.0);
}

#[test]
fn galperins_billiard_counts_the_digits_of_pi() {
    for (digits, expected) in [(0, 3), (1, 31), (2, 314), (3, 3141), (4, 31415)] {
        assert_eq!(galperin(digits), expected);
    }
}

/// `cargo test --release -- --ignored`
#[test]
#[ignore = "three million collisions"]
fn galperins_billiard_counts_seven_digits_of_pi() {
    assert_eq!((galperin(5), galperin(6)), (314_159, 3_141_592));
}

/// Mass ratio 100^digits: that many digits of π after the first (Galperin, "Playing pool with π", 2003).
fn galperin(digits: u32) -> u64 {
    let mass = (0..digits).fold(1.0, |mass, _| mass * 100.0);
    let bodies = [
        sketch([0.0, 0.0], [1.0, 9.0], INFINITE),
        sketch([4.0, 8.0], [1.0, 1.0], 1.0),
        sketch([8.0, 7.0], [2.0, 2.0], mass).moving(-1.0, 0.0),
    ];
    let conditions = Conditions { rate: 0.01, events_per_step: u64::MAX, ..Conditions::default() };
    count(&mut world(conditions, &bodies), 1000)
}

#[test]
fn a_shot_does_not_pass_a_thin_plate() {
    for rate in [1.0, 60.0, 1000.0] {
        let plate = sketch([5.0, 0.0], [0.001, 2.0], INFINITE);
        let bullet = sketch([0.0, 0.99], [0.01, 0.01], 0.01).moving(7000.0, 0.0);
        let mut engine = world(Conditions { rate, ..Conditions::default() }, &[plate, bullet]);
        let collisions = run(&mut engine, 1);
        assert_eq!(collisions.len(), usize::from(rate < 1000.0 * 7.0 / 4.99));
        let x = reflected(7000.0 / rate, 4.99 * 1e9);
        let expected = if x > 4.99 { 2.0 * 4.99 - x } else { x };
        assert_close(body(&engine, 1).rect.origin.x, expected, 1e-10);
    }
}

#[test]
fn a_free_plate_takes_its_part_of_the_shot() {
    let plate = sketch([5.0, 0.0], [0.001, 2.0], 3.0);
    let bullet = sketch([0.0, 0.99], [0.01, 0.01], 1.0).moving(8000.0, 0.0);
    let mut engine = world(Conditions { restitution: 0.5, ..Conditions::default() }, &[plate, bullet]);
    let collision = run(&mut engine, 1).remove(0);
    assert_eq!((body(&engine, 0).velocity.x, body(&engine, 1).velocity.x), (3000.0, -1000.0));
    assert_close(collision.time, 4.99 / 8000.0, 1e-18);
    assert_eq!((collision.bodies, collision.normal, collision.impulse), ([0, 1], Vector::new(1.0, 0.0), 9000.0));
    assert_eq!(collision.before, [Vector::ZERO, Vector::new(8000.0, 0.0)]);
    assert_eq!(collision.after, [Vector::new(3000.0, 0.0), Vector::new(-1000.0, 0.0)]);
}

fn cradle(gap: f64) -> Vec<f64> {
    let mut bodies: Vec<_> =
        (0..5).map(|ball| sketch([4.0 + f64::from(ball) * (1.0 + gap), 0.0], [1.0, 1.0], 2.0)).collect();
    bodies[0].at[0] -= 1.0;
    bodies[0].velocity[0] = 1.7;
    let mut engine = world(Conditions::default(), &bodies);
    assert_eq!(count(&mut engine, 120), 4);
    engine.world().bodies.iter().map(|body| body.velocity.x).collect()
}

#[test]
fn a_cradle_hands_its_blow_on_touching_or_apart() {
    for gap in [0.0, 1e-3, 0.1] {
        assert_eq!(cradle(gap), [0.0, 0.0, 0.0, 0.0, 1.7]);
    }
}

#[test]
fn two_balls_of_a_cradle_lift_two() {
    let at = |x: f64| sketch([x, 0.0], [1.0, 1.0], 1.0);
    let bodies = [at(1.0).moving(1.0, 0.0), at(2.0).moving(1.0, 0.0), at(4.0), at(5.0), at(6.0)];
    let mut engine = world(Conditions::default(), &bodies);
    count(&mut engine, 90);
    let velocities: Vec<f64> = engine.world().bodies.iter().map(|body| body.velocity.x).collect();
    assert_eq!(velocities, [0.0, 0.0, 0.0, 1.0, 1.0]);
}

/// An exact corner hit is a hit on both faces: the same seen in any mirror.
#[test]
fn corners_that_meet_exactly_turn_both_velocities() {
    for (sx, sy) in [(1.0, 1.0), (1.0, -1.0), (-1.0, 1.0), (-1.0, -1.0)] {
        let standing = sketch([-0.5, -0.5], [1.0, 1.0], INFINITE);
        let coming = sketch([-3.0 * sx - 0.5, -3.0 * sy - 0.5], [1.0, 1.0], 1.0).moving(2.0 * sx, 2.0 * sy);
        let mut engine = world(Conditions::default(), &[standing, coming]);
        assert_eq!(run(&mut engine, 120).len(), 2);
        assert_eq!(body(&engine, 1).velocity, Vector::new(-2.0 * sx, -2.0 * sy));
    }
}

#[test]
fn boxes_that_slide_along_each_others_line_do_not_meet() {
    let standing = sketch([0.0, 1.0], [4.0, 1.0], INFINITE);
    let passing = sketch([-3.0, 0.0], [1.0, 1.0], 1.0).moving(1.5, 0.0);
    let mut engine = world(Conditions::default(), &[standing, passing]);
    assert_eq!(run(&mut engine, 600), []);
}

#[test]
fn a_box_slides_over_the_seams_of_a_tiled_floor() {
    let conditions = Conditions { gravity: Some([0.0, 9.81]), restitution: 0.5, ..Conditions::default() };
    let mut bodies: Vec<_> = (0..40).map(|tile| sketch([f64::from(tile) * 0.3, 5.0], [0.3, 0.3], INFINITE)).collect();
    bodies.push(sketch([0.1, 4.1], [0.5, 0.9], 1.0).moving(1.3, 0.0));
    let mut engine = world(conditions, &bodies);
    for step in 1..=480_u32 {
        assert_eq!(run(&mut engine, 1), [], "a seam was felt at step {step}");
        let slider = body(&engine, 40);
        assert_eq!((slider.rect.origin.y, slider.velocity), (4.1, Vector::new(1.3, 0.0)));
        assert_close(slider.rect.origin.x, 0.1 + 1.3 * f64::from(step) / 60.0, 1e-14);
    }
}

#[test]
fn far_from_the_origin_and_in_mixed_sizes_nothing_overlaps() {
    let far = 1e6;
    let bodies = [
        sketch([far - 1000.0, 5.0], [2000.0, 1000.0], INFINITE),
        sketch([far, 0.0], [1.0, 1.0], 1.0).moving(0.0, 3.0),
        sketch([far + 0.5, 4.0], [1e-3, 1e-3], 1e-6),
        sketch([far - 400.0, -950.0], [800.0, 900.0], 1e9),
    ];
    let conditions = Conditions { gravity: Some([0.0, 9.81]), restitution: 0.5, ..Conditions::default() };
    let mut engine = world(conditions, &bodies);
    for _ in 0..1200 {
        run(&mut engine, 1);
        assert!(invariants::worst_overlap(engine.world()) <= 1e-12);
    }
    assert!(engine.world().bodies.iter().all(|body| body.velocity == Vector::ZERO), "all came to rest");
}

#[test]
fn a_day_is_as_exact_as_a_second() {
    let mut bodies = walls(8.0, 8.0);
    bodies.push(sketch([1.0, 2.0], [0.5, 0.5], 1.0).moving(0.75, 0.0));
    let mut engine = world(Conditions { rate: 0.1, ..Conditions::default() }, &bodies);
    run(&mut engine, 8640);
    assert_close(body(&engine, 4).rect.origin.x, reflected(1.0 + 0.75 * 86400.0, 7.5), 1e-10);
}

#[test]
fn a_piston_heats_and_the_rate_does_not_matter() {
    let at_rate = |rate: f64| {
        let mut bodies = walls(8.0, 4.0);
        bodies.push(sketch([0.0, 0.0], [0.5, 4.0], INFINITE).moving(0.25, 0.0));
        bodies.extend((0..6).map(|n| {
            let n = f64::from(n);
            sketch([2.0 + 0.9 * n, 0.3 + 0.5 * n], [0.5, 0.5], 1.0 + n).moving(1.0 - 0.3 * n, 0.7)
        }));
        let mut engine = world(Conditions { rate, ..Conditions::default() }, &bodies);
        let collisions = count(&mut engine, (8.0 * rate) as u64);
        (collisions, engine)
    };
    let (collisions, slow) = at_rate(1.0);
    for rate in [7.0, 60.0, 1000.0] {
        let (others, fast) = at_rate(rate);
        assert_eq!(collisions, others);
        for (a, b) in slow.world().bodies.iter().zip(&fast.world().bodies) {
            assert_close(a.rect.origin.x, b.rect.origin.x, 1e-11);
            assert_close(a.rect.origin.y, b.rect.origin.y, 1e-11);
        }
    }
}

#[test]
fn a_squeeze_between_infinite_masses_is_an_error_that_names_them() {
    for restitution in [0.0, 0.5] {
        let bodies = [
            sketch([0.0, 0.0], [1.0, 4.0], INFINITE).moving(1.0, 0.0),
            sketch([6.0, 0.0], [1.0, 4.0], INFINITE),
            sketch([3.0, 1.0], [1.0, 1.0], 1.0),
        ];
        let mut engine = world(Conditions { restitution, ..Conditions::default() }, &bodies);
        let error = (0..600).find_map(|_| engine.step(&mut Vec::new()).err()).expect("a crush");
        let between = ["0".to_owned(), "1".to_owned()];
        assert_eq!(error, StepError::Crushed { step: 239, body: "2".to_owned(), between });
    }
}

#[test]
fn what_bounces_without_loss_is_crushed_too() {
    let bodies = [
        sketch([0.0, 0.0], [1.0, 4.0], INFINITE).moving(1.0, 0.0),
        sketch([6.0, 0.0], [1.0, 4.0], INFINITE),
        sketch([3.0, 1.0], [1.0, 1.0], 1.0),
    ];
    let mut engine = world(Conditions { events_per_step: 10_000, ..Conditions::default() }, &bodies);
    let error = (0..600).find_map(|_| engine.step(&mut Vec::new()).err()).expect("a crush");
    let between = ["0".to_owned(), "1".to_owned()];
    assert_eq!(error, StepError::Crushed { step: 239, body: "2".to_owned(), between });
}

#[test]
fn a_collision_at_the_instant_of_a_sample_shows_in_it() {
    for (speed, gap, rate) in [(5.0, 1.5, 60.0), (1.0, 0.1, 10.0), (3.0, 0.9, 10.0), (0.7, 2.1, 60.0), (1.1, 3.3, 60.0)]
    {
        let bodies =
            [sketch([16.0, 0.0], [1.0, 1.0], INFINITE), sketch([15.0 - gap, 0.0], [1.0, 1.0], 1.0).moving(speed, 0.0)];
        let mut engine = world(Conditions { rate, ..Conditions::default() }, &bodies);
        run(&mut engine, (gap / speed * rate).round() as u64);
        assert_eq!(body(&engine, 1).velocity, Vector::new(-speed, 0.0), "{gap} m at {speed} m/s");
    }
}

#[test]
fn too_many_events_name_the_bodies() {
    let bodies = [
        sketch([0.0, 0.0], [1.0, 1.0], INFINITE),
        sketch([1.0, 0.0], [1.0, 1.0], 1.0).moving(1.0, 0.0),
        sketch([2.0, 0.0], [1.0, 1.0], INFINITE),
    ];
    let mut engine = world(Conditions { events_per_step: 1000, ..Conditions::default() }, &bodies);
    let error = engine.step(&mut Vec::new()).expect_err("an endless bounce without room");
    assert!(matches!(&error, StepError::TooManyEvents { limit: 1000, .. }), "{error}");
    assert!(error.to_string().contains("\"1\""));
}
