//! Impacts in the event-driven solver, compared with closed forms.

use crate::laws::random::Random;
use crate::world_builder::*;
use rebond::internals::physics::{Axis, BodyId, Engine, Event, StepError, Vector};

/// The position of a point between elastic walls at 0 and `width` that has moved `distance` from 0.
fn reflected(distance: f64, width: f64) -> f64 {
    let phase = distance % (2.0 * width);
    if phase <= width { phase } else { 2.0 * width - phase }
}

#[test]
fn a_box_between_elastic_walls_loses_no_energy() {
    let mut bodies = walls(9.0, 9.0);
    bodies.push(spec([1.0, 2.0], [1.0, 1.0], 1.0).with_velocity(5.0, -3.0));
    let mut engine = world(Conditions::default(), &bodies);
    let steps = 60_000;
    count(&mut engine, steps);
    let bouncing = body(&engine, 4);
    let seconds = steps as f64 / 60.0;
    assert_close(bouncing.rect.origin.x, reflected(1.0 + 5.0 * seconds, 8.0), 1e-10);
    assert_close(bouncing.rect.origin.y, reflected(16.0 + 2.0 - 3.0 * seconds % 16.0, 8.0), 1e-10);
    assert_eq!(engine.world().kinetic_energy(), 17.0, "the kinetic energy has changed");
}

/// Energy drift ≤ 1e-12 and position error ≤ 1e-9 m after 10⁶ steps. `cargo test --release -- --ignored`
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
    let floor = spec([0.0, 5.0], [10.0, 1.0], INFINITE);
    let mut engine = world(conditions, &[floor, spec([4.0, -1.0], [1.0, 1.0], 1.0)]);
    let energy = |engine: &rebond::internals::physics::Engine| {
        engine.world().kinetic_energy() + engine.world().potential_energy()
    };
    let before = energy(&engine);
    run(&mut engine, steps);
    // The ball falls 5 m in 1 s, so the period is 2 s.
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

/// The number of collisions for a mass ratio of 100^digits: π with this number of decimals, without the
/// point (Galperin, "Playing pool with π", 2003).
fn galperin(digits: u32) -> u64 {
    let mass = (0..digits).fold(1.0, |mass, _| mass * 100.0);
    let bodies = [
        spec([0.0, 0.0], [1.0, 9.0], INFINITE),
        spec([4.0, 8.0], [1.0, 1.0], 1.0),
        spec([8.0, 7.0], [2.0, 2.0], mass).with_velocity(-1.0, 0.0),
    ];
    let conditions = Conditions { rate: 0.01, events_per_step: u64::MAX, ..Conditions::default() };
    count(&mut world(conditions, &bodies), 1000)
}

#[test]
fn a_bullet_does_not_pass_through_a_thin_plate() {
    for rate in [1.0, 60.0, 1000.0] {
        let plate = spec([5.0, 0.0], [0.001, 2.0], INFINITE);
        let bullet = spec([0.0, 0.99], [0.01, 0.01], 0.01).with_velocity(7000.0, 0.0);
        let mut engine = world(Conditions { rate, ..Conditions::default() }, &[plate, bullet]);
        let collisions = run(&mut engine, 1);
        assert_eq!(collisions.len(), usize::from(rate < 1000.0 * 7.0 / 4.99));
        let x = reflected(7000.0 / rate, 4.99 * 1e9);
        let expected = if x > 4.99 { 2.0 * 4.99 - x } else { x };
        assert_close(body(&engine, 1).rect.origin.x, expected, 1e-10);
    }
}

#[test]
fn a_bullet_and_a_free_plate_exchange_momentum_by_the_impact_law() {
    let plate = spec([5.0, 0.0], [0.001, 2.0], 3.0);
    let bullet = spec([0.0, 0.99], [0.01, 0.01], 1.0).with_velocity(8000.0, 0.0);
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
        (0..5).map(|ball| spec([4.0 + f64::from(ball) * (1.0 + gap), 0.0], [1.0, 1.0], 2.0)).collect();
    bodies[0].at[0] -= 1.0;
    bodies[0].velocity[0] = 1.7;
    let mut engine = world(Conditions::default(), &bodies);
    assert_eq!(count(&mut engine, 120), 4);
    engine.world().bodies.iter().map(|body| body.velocity.x).collect()
}

#[test]
fn a_cradle_passes_an_impact_on_whether_its_balls_touch_or_not() {
    for gap in [0.0, 1e-3, 0.1] {
        assert_eq!(cradle(gap), [0.0, 0.0, 0.0, 0.0, 1.7]);
    }
}

#[test]
fn two_moving_balls_of_a_cradle_set_two_in_motion() {
    let at = |x: f64| spec([x, 0.0], [1.0, 1.0], 1.0);
    let bodies = [at(1.0).with_velocity(1.0, 0.0), at(2.0).with_velocity(1.0, 0.0), at(4.0), at(5.0), at(6.0)];
    let mut engine = world(Conditions::default(), &bodies);
    count(&mut engine, 90);
    let velocities: Vec<f64> = engine.world().bodies.iter().map(|body| body.velocity.x).collect();
    assert_eq!(velocities, [0.0, 0.0, 0.0, 1.0, 1.0]);
}

/// A collision of exact corners is a collision along both axes, so it is invariant under reflection.
#[test]
fn a_collision_of_exact_corners_reverses_both_velocity_components() {
    for (sx, sy) in [(1.0, 1.0), (1.0, -1.0), (-1.0, 1.0), (-1.0, -1.0)] {
        let fixed = spec([-0.5, -0.5], [1.0, 1.0], INFINITE);
        let incoming = spec([-3.0 * sx - 0.5, -3.0 * sy - 0.5], [1.0, 1.0], 1.0).with_velocity(2.0 * sx, 2.0 * sy);
        let mut engine = world(Conditions::default(), &[fixed, incoming]);
        assert_eq!(run(&mut engine, 120).len(), 2);
        assert_eq!(body(&engine, 1).velocity, Vector::new(-2.0 * sx, -2.0 * sy));
    }
}

#[test]
fn boxes_whose_edges_slide_along_one_line_do_not_collide() {
    let fixed = spec([0.0, 1.0], [4.0, 1.0], INFINITE);
    let passing = spec([-3.0, 0.0], [1.0, 1.0], 1.0).with_velocity(1.5, 0.0);
    let mut engine = world(Conditions::default(), &[fixed, passing]);
    assert_eq!(run(&mut engine, 600), []);
}

#[test]
fn a_box_slides_over_the_seams_of_a_tiled_floor() {
    let conditions = Conditions { gravity: Some([0.0, 9.81]), restitution: 0.5, ..Conditions::default() };
    let mut bodies: Vec<_> = (0..40).map(|tile| spec([f64::from(tile) * 0.3, 5.0], [0.3, 0.3], INFINITE)).collect();
    bodies.push(spec([0.1, 4.1], [0.5, 0.9], 1.0).with_velocity(1.3, 0.0));
    let mut engine = world(conditions, &bodies);
    for step in 1..=480_u32 {
        assert_eq!(run(&mut engine, 1), [], "a collision at a seam in step {step}");
        let slider = body(&engine, 40);
        assert_eq!((slider.rect.origin.y, slider.velocity), (4.1, Vector::new(1.3, 0.0)));
        assert_close(slider.rect.origin.x, 0.1 + 1.3 * f64::from(step) / 60.0, 1e-14);
    }
}

#[test]
fn boxes_of_mixed_sizes_far_from_the_origin_do_not_overlap() {
    let far = 1e6;
    let bodies = [
        spec([far - 1000.0, 5.0], [2000.0, 1000.0], INFINITE),
        spec([far, 0.0], [1.0, 1.0], 1.0).with_velocity(0.0, 3.0),
        spec([far + 0.5, 4.0], [1e-3, 1e-3], 1e-6),
        spec([far - 400.0, -950.0], [800.0, 900.0], 1e9),
    ];
    let conditions = Conditions { gravity: Some([0.0, 9.81]), restitution: 0.5, ..Conditions::default() };
    let mut engine = world(conditions, &bodies);
    for _ in 0..1200 {
        run(&mut engine, 1);
        assert!(engine.world().deepest_overlap() <= 1e-12);
    }
    assert!(engine.world().bodies.iter().all(|body| body.velocity == Vector::ZERO), "a body still moves");
}

/// Boxes of all sizes that would hit the ceiling at one instant if their times were not rounded: none is lost between
/// those that coincide and those that do not.
#[test]
fn similar_boxes_of_all_sizes_hit_a_wall_at_times_that_differ_by_rounding() {
    for variant in 0..300 {
        let fraction = 0.37 + 0.001 * f64::from(variant);
        let mut bodies = walls(60_000.0, 40_000.0);
        for (number, size) in [1e-3, 1e-2, 0.1, 1.0, 10.0, 100.0, 1000.0].into_iter().enumerate() {
            let at = [4000.0 * number as f64, 20.0 * size * fraction];
            bodies.push(spec(at, [0.7 * size, 0.9 * size], 1.0).with_velocity(0.0, -2.0 * size * (1.3 - fraction)));
        }
        let mut engine = world(Conditions { rate: 1.0, ..Conditions::default() }, &bodies);
        let hits = run(&mut engine, 15);
        assert_eq!(hits.len(), 7, "variant {variant}: {hits:#?}");
        assert!(engine.world().deepest_overlap() <= 1e-12, "variant {variant}");
    }
}

#[test]
fn positions_after_a_day_are_as_exact_as_after_a_second() {
    let mut bodies = walls(8.0, 8.0);
    bodies.push(spec([1.0, 2.0], [0.5, 0.5], 1.0).with_velocity(0.75, 0.0));
    let mut engine = world(Conditions { rate: 0.1, ..Conditions::default() }, &bodies);
    run(&mut engine, 8640);
    assert_close(body(&engine, 4).rect.origin.x, reflected(1.0 + 0.75 * 86400.0, 7.5), 1e-15);
}

#[test]
fn a_gas_in_front_of_a_piston_does_not_depend_on_the_rate() {
    let at_rate = |rate: f64| {
        let mut bodies = walls(8.0, 4.0);
        bodies.push(spec([0.0, 0.0], [0.5, 4.0], INFINITE).with_velocity(0.25, 0.0));
        bodies.extend((0..6).map(|n| {
            let n = f64::from(n);
            spec([2.0 + 0.9 * n, 0.3 + 0.5 * n], [0.5, 0.5], 1.0 + n).with_velocity(1.0 - 0.3 * n, 0.7)
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
fn a_body_crushed_between_infinite_masses_is_an_error_that_names_all_three() {
    for restitution in [0.0, 0.5] {
        let bodies = [
            spec([0.0, 0.0], [1.0, 4.0], INFINITE).with_velocity(1.0, 0.0),
            spec([6.0, 0.0], [1.0, 4.0], INFINITE),
            spec([3.0, 1.0], [1.0, 1.0], 1.0),
        ];
        let mut engine = world(Conditions { restitution, ..Conditions::default() }, &bodies);
        let error = (0..600).find_map(|_| engine.step(&mut Vec::new()).err()).expect("an error");
        let between = ["0".to_owned(), "1".to_owned()];
        assert_eq!(error, StepError::Crushed { step: 239, body: "2".to_owned(), between });
    }
}

/// The lower wall acts through two boxes that rest on it.
#[test]
fn a_body_pressed_through_others_that_rest_on_a_rising_wall_is_crushed() {
    let bodies = [
        spec([-0.5, -0.75], [0.25, 0.125], 1.0),
        spec([-0.5, 0.0], [0.5, 0.25], INFINITE).with_velocity(0.0, -0.25),
        spec([-0.375, -0.5], [0.125, 0.125], 10.0),
        spec([-0.375, -0.375], [0.125, 0.125], 1.0),
        spec([-0.5, -1.0], [0.5, 0.25], INFINITE).with_velocity(0.0, 0.5),
    ];
    let mut engine = world(Conditions { restitution: 0.5, rate: 32.0, ..Conditions::default() }, &bodies);
    let error = (0..32).find_map(|_| engine.step(&mut Vec::new()).err()).expect("the room is closed after 0.5 s");
    assert!(matches!(&error, StepError::Crushed { step: 15, between, .. } if *between == ["4", "1"]), "{error:?}");
}

#[test]
fn a_body_with_e_1_is_crushed_too() {
    let bodies = [
        spec([0.0, 0.0], [1.0, 4.0], INFINITE).with_velocity(1.0, 0.0),
        spec([6.0, 0.0], [1.0, 4.0], INFINITE),
        spec([3.0, 1.0], [1.0, 1.0], 1.0),
    ];
    let mut engine = world(Conditions { events_per_step: 10_000, ..Conditions::default() }, &bodies);
    let error = (0..600).find_map(|_| engine.step(&mut Vec::new()).err()).expect("an error");
    let between = ["0".to_owned(), "1".to_owned()];
    assert_eq!(error, StepError::Crushed { step: 239, body: "2".to_owned(), between });
}

#[test]
fn a_collision_at_the_instant_of_a_sample_precedes_the_sample() {
    for (speed, gap, rate) in
        [(5.0, 1.5, 60.0), (3.0, 0.5, 60.0), (0.75, 2.25, 10.0), (7.0, 1.75, 100.0), (5.0, 0.5, 10.0)]
    {
        let bodies = [
            spec([16.0, 0.0], [1.0, 1.0], INFINITE),
            spec([15.0 - gap, 0.0], [1.0, 1.0], 1.0).with_velocity(speed, 0.0),
        ];
        let mut engine = world(Conditions { rate, ..Conditions::default() }, &bodies);
        run(&mut engine, (gap / speed * rate).round() as u64);
        assert_eq!(body(&engine, 1).velocity, Vector::new(-speed, 0.0), "{gap} m at {speed} m/s");
    }
}

/// A box that falls onto the edge of a platform is hit away from it just before it lands: far from the origin, the doubles
/// of the coordinates cannot distinguish whether it still overlaps the platform then.
#[test]
fn a_box_hit_away_from_an_edge_lands_if_it_still_overlaps_the_platform() {
    let mut random = Random::new(1);
    for _ in 0..400 {
        let far = random.pick(&[0.0, 1.0, 1024.0, 16384.0, 65536.0, 262144.0]);
        // The numbers of a coordinate this far are 2⁻³⁴ m apart, so equal lengths would not be clear.
        let [overlap, slide] = [(); 2].map(|()| random.whole(1, 40) as f64);
        if (overlap - slide).abs() < 2.0 {
            continue;
        }
        let [overlap, slide] = [overlap, slide].map(|times| times / (1_u64 << 33) as f64);
        let (speed, is_upright, sign) = (random.pick(&[0.5, 1.0, 2.0]), random.chance(50), random.pick(&[1.0, -1.0]));
        // A square by the distance of its centre from that of the platform, along its edge and away from it.
        let square = |along: f64, away: f64, size: f64, mass: f64, [v_along, v_away]: [f64; 2]| {
            let ordered = |along: f64, away: f64| if is_upright { [away, along] } else { [along, away] };
            let at = ordered(far + (sign * along - 0.5 * size), away - 0.5 * size);
            let [x, y] = ordered(sign * v_along, v_away);
            spec(at, [size; 2], mass).with_velocity(x, y)
        };
        let bodies = [
            square(0.0, 0.0, 1.0, INFINITE, [0.0, 0.0]),
            square(1.0 - overlap, -1.5, 1.0, 1.0, [0.0, speed]),
            square(0.25 - overlap + slide - 0.5, -1.125, 0.5, 1.0, [speed, 0.0]),
        ];
        let mut engine = world(Conditions { rate: 0.5, ..Conditions::default() }, &bodies);
        let mut collisions = Vec::new();
        engine.step(&mut collisions).unwrap();
        let pairs: Vec<[BodyId; 2]> = collisions.iter().map(|collision| collision.bodies).collect();
        let expected = if slide < overlap { vec![[1, 2], [0, 1]] } else { vec![[1, 2]] };
        assert_eq!(pairs, expected, "{overlap} m and {slide} m at {far} m");
    }
}

#[test]
fn each_impact_counts_once_against_the_limit_of_events() {
    let bodies = |others: usize| {
        let far = (0..others).map(|index| spec([100.0 + 2.0 * index as f64, 100.0], [1.0, 1.0], INFINITE));
        let two = [spec([0.0, 0.0], [1.0, 1.0], 1.0).with_velocity(1.0, 0.0), spec([1.5, 0.0], [1.0, 1.0], 1.0)];
        two.into_iter().chain(far).collect::<Vec<BodySpec>>()
    };
    for (restitution, others) in [(1.0, 0), (0.5, 0), (0.0, 0), (1.0, 20), (0.0, 20)] {
        let conditions =
            |events_per_step| Conditions { rate: 1.0, restitution, events_per_step, ..Conditions::default() };
        assert_eq!(count(&mut world(conditions(1), &bodies(others)), 1), 1, "e = {restitution}, {others} others");
        let mut in_a_row = bodies(others);
        in_a_row.push(spec([2.75, 0.0], [1.0, 1.0], 1.0).with_velocity(-0.125, 0.0));
        let error = world(conditions(1), &in_a_row).step(&mut Vec::new()).expect_err("two impacts");
        assert!(matches!(error, StepError::TooManyEvents { limit: 1, .. }), "{error}");
        assert_eq!(world(conditions(3), &in_a_row).step(&mut Vec::new()), Ok(()));
    }
}

#[test]
fn gravity_and_a_force_that_add_up_to_an_infinite_acceleration_are_an_error() {
    let body = spec([0.0, 0.0], [1.0, 1.0], 1.0).with_force(1e308, 0.0);
    let mut engine = world(Conditions { gravity: Some([1e308, 0.0]), ..Conditions::default() }, &[body]);
    assert_eq!(engine.step(&mut Vec::new()), Err(StepError::NotFinite { step: 0, body: "0".to_owned() }));
}

#[test]
fn an_error_of_too_many_events_names_the_bodies() {
    let bodies = [
        spec([0.0, 0.0], [1.0, 1.0], INFINITE),
        spec([1.0, 0.0], [1.0, 1.0], 1.0).with_velocity(1.0, 0.0),
        spec([2.000001, 0.0], [1.0, 1.0], INFINITE),
    ];
    let mut engine = world(Conditions { events_per_step: 1000, ..Conditions::default() }, &bodies);
    let error = engine.step(&mut Vec::new()).expect_err("a step with 16,667 collisions");
    assert!(matches!(&error, StepError::TooManyEvents { limit: 1000, .. }), "{error}");
    assert!(error.to_string().contains("\"1\""));
}

#[test]
fn a_body_at_e_1_without_room_has_endless_impacts() {
    let bodies = [
        spec([0.0, 0.0], [1.0, 1.0], INFINITE),
        spec([1.0, 0.0], [1.0, 1.0], 1.0).with_velocity(1.0, 0.0),
        spec([2.0, 0.0], [1.0, 1.0], INFINITE),
    ];
    let mut engine = world(Conditions::default(), &bodies);
    let error = engine.step(&mut Vec::new()).expect_err("impacts without end");
    assert!(matches!(&error, StepError::Endless { step: 0, .. }), "{error}");
    assert_eq!(engine.step(&mut Vec::new()), Err(error), "a failed engine returns its error again");
}

#[test]
fn a_body_thinner_than_the_precision_of_its_position_is_refused() {
    let mut engine = world(Conditions::default(), &[spec([1e12, 0.0], [0.0002, 1.0], 1.0)]);
    let error = engine.step(&mut Vec::new()).expect_err("a body of one or two ulps");
    assert_eq!(error, StepError::TooThin { step: 0, body: "0".to_owned() });
    let mut engine = world(Conditions::default(), &[spec([1e12, 0.0], [0.001, 1.0], 1.0)]);
    assert_eq!(engine.step(&mut Vec::new()), Ok(()));
}

#[test]
fn a_body_too_thin_is_refused_after_its_engine_was_restored() {
    let conditions = Conditions::default();
    let engine = world(conditions, &[spec([1e12, 0.0], [0.0002, 1.0], 1.0)]);
    let mut restored = Engine::restore(config(conditions), engine.snapshot()).unwrap();
    assert!(matches!(restored.step(&mut Vec::new()), Err(StepError::TooThin { step: 0, .. })));
    restored = Engine::restore(config(conditions), engine.snapshot()).unwrap();
    restored.apply(&Event::Delete(0));
    assert_eq!(restored.step(&mut Vec::new()), Ok(()), "it was deleted before the step");
}

#[test]
fn boxes_whose_faces_overlap_by_an_ulp_along_one_axis_collide_along_the_other() {
    let bodies = [
        spec([0.6_f64.next_down(), -0.6], [0.2, 0.4], 1.0),
        spec([0.2, -1.2], [0.4, 0.4], 1.0).with_velocity(0.0, -0.5),
        spec([0.0, 0.0], [0.8, 0.4], 1000.0).with_velocity(0.0, -0.5),
        spec([0.0, -1.6], [0.8, 0.4], INFINITE),
    ];
    let conditions = Conditions { restitution: 0.9, gravity: Some([9.81, 0.0]), rate: 16.0, ..Conditions::default() };
    let mut engine = world(conditions, &bodies);
    engine.assert_invariants();
    let collisions = run(&mut engine, 14);
    assert!(collisions.iter().any(|collision| collision.bodies == [0, 1] && collision.axis == Axis::Y));
}
