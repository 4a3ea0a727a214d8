//! Properties of the event-driven solver in any world, checked on random worlds.

use crate::world_builder::*;
use proptest::prelude::*;
use rebond::internals::physics::{BodyId, Engine, EngineConfig, Event, Snapshot, SnapshotError, SolverKind, Vector};

const ROOM: f64 = 12.0;

fn specs() -> impl Strategy<Value = Vec<BodySpec>> {
    let one = (0.0..10.0, 0.0..10.0, 0.3..1.8, 0.3..1.8, 0.2..5.0, -4.0..4.0, -4.0..4.0);
    let body =
        one.prop_map(|(x, y, width, height, mass, vx, vy)| spec([x, y], [width, height], mass).with_velocity(vx, vy));
    prop::collection::vec(body, 2..12)
}

/// Rounds coordinates so that they have an exact mirror image, because an inelastic collapse amplifies any
/// difference.
fn rounded(body: BodySpec) -> BodySpec {
    let round = |pair: [f64; 2]| pair.map(|number| (number * 65536.0).round() / 65536.0);
    BodySpec { at: round(body.at), size: round(body.size), ..body }
}

/// Keeps the bodies that overlap none of the kept ones before them.
fn without_overlaps(specs: Vec<BodySpec>) -> Vec<BodySpec> {
    let mut kept: Vec<BodySpec> = Vec::new();
    for candidate in specs {
        let overlaps = |other: &BodySpec| {
            (0..2).all(|axis| {
                candidate.at[axis] < other.at[axis] + other.size[axis]
                    && other.at[axis] < candidate.at[axis] + candidate.size[axis]
            })
        };
        if !kept.iter().any(overlaps) {
            kept.push(candidate);
        }
    }
    kept
}

fn room(bodies: Vec<BodySpec>) -> Vec<BodySpec> {
    let mut room = walls(ROOM, ROOM);
    room.extend(bodies);
    room
}

fn conditions() -> impl Strategy<Value = Conditions> {
    let gravity = prop_oneof![Just(None), Just(Some([0.0, 9.81])), Just(Some([3.0, 9.81])), Just(Some([-2.0, 0.0]))];
    (gravity, prop_oneof![Just(0.0), Just(0.3), Just(0.8), Just(1.0)]).prop_map(|(gravity, restitution)| Conditions {
        gravity,
        restitution,
        ..Conditions::default()
    })
}

fn energy(engine: &Engine) -> f64 {
    engine.world().kinetic_energy() + engine.world().potential_energy()
}

fn restored_copy(conditions: Conditions, engine: &Engine) -> Engine {
    Engine::restore(config(conditions), engine.snapshot()).unwrap()
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 96, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn nothing_overlaps_and_energy_never_rises(conditions in conditions(), bodies in specs()) {
        let mut engine = world(conditions, &room(without_overlaps(bodies)));
        let start = energy(&engine);
        let scale = 1e-12 * (start.abs() + 1000.0);
        let mut before = start;
        for step in 0..240 {
            run(&mut engine, 1);
            let overlap = engine.world().deepest_overlap();
            prop_assert!(overlap <= 2e-14, "overlap {overlap:e} after step {step}");
            let now = energy(&engine);
            prop_assert!(now <= before + scale, "energy rose by {:e} in step {step}", now - before);
            if conditions.restitution == 1.0 {
                prop_assert!((now - start).abs() <= scale);
            }
            before = now;
        }
    }

    #[test]
    fn momentum_is_conserved_without_walls(restitution in 0.0..=1.0, bodies in specs()) {
        let mut engine = world(Conditions { restitution, ..Conditions::default() }, &without_overlaps(bodies));
        let before = engine.world().momentum();
        run(&mut engine, 300);
        let change = engine.world().momentum().sub(before);
        prop_assert!(change.norm() <= 1e-12);
    }

    #[test]
    fn a_restored_world_continues_bit_for_bit(
        conditions in conditions(),
        bodies in specs(),
        late in specs(),
        at in 0_u64..90,
    ) {
        let mut engine = world(conditions, &room(without_overlaps(bodies)));
        let mut other = engine.clone();
        for step in 0..150 {
            if step == at {
                late.iter().take(2).for_each(|body| spawn(&mut engine, body));
                engine.apply(&Event::Delete(5));
                late.iter().take(2).for_each(|body| spawn(&mut other, body));
                other.apply(&Event::Delete(5));
            }
            if step % 7 == at % 7 {
                other = restored_copy(conditions, &other);
            }
            run(&mut engine, 1);
            run(&mut other, 1);
            prop_assert_eq!(all_bits(&engine), all_bits(&other), "after step {}", step);
        }
    }

    /// True except for simultaneous events, which occur systematically only in an inelastic collapse (e < 1).
    #[test]
    fn the_order_of_spawns_changes_no_bit(bodies in specs()) {
        let conditions = Conditions::default();
        let bodies = without_overlaps(bodies);
        let reversed: Vec<BodySpec> = bodies.iter().rev().cloned().collect();
        let mut engine = world(conditions, &room(bodies));
        let mut other = world(conditions, &room(reversed));
        let count = run(&mut engine, 200).len();
        prop_assert_eq!(count, run(&mut other, 200).len());
        let mut found = all_bits(&other);
        found[4..].reverse();
        prop_assert_eq!(all_bits(&engine), found);
    }

    #[test]
    fn a_mirrored_world_has_a_mirrored_run(conditions in conditions(), bodies in specs(), axis in 0_usize..2) {
        let bodies = room(without_overlaps(bodies.into_iter().map(rounded).collect()));
        let mirrored: Vec<BodySpec> = bodies.iter().map(|body| mirror(body, axis)).collect();
        let gravity = conditions.gravity.map(|mut gravity| { gravity[axis] = -gravity[axis]; gravity });
        let mut engine = world(conditions, &bodies);
        let mut image = world(Conditions { gravity, ..conditions }, &mirrored);
        run(&mut engine, 45);
        run(&mut image, 45);
        for (id, body) in (0..).zip(&engine.world().bodies) {
            let [mirrored, original] = [position(&image, id), body.rect.origin].map(|v| [v.x, v.y]);
            let size = [body.rect.width(), body.rect.height()][axis];
            prop_assert!((mirrored[axis] + size + original[axis] - ROOM).abs() <= 1e-9);
            prop_assert!((mirrored[1 - axis] - original[1 - axis]).abs() <= 1e-9);
        }
    }

    #[test]
    fn a_damaged_snapshot_is_rejected_or_harmless(
        bodies in specs(),
        index in any::<prop::sample::Index>(),
        value in prop_oneof![0_u64..20, any::<u64>()],
        is_truncated in any::<bool>(),
    ) {
        let conditions = Conditions { gravity: Some([0.0, 9.81]), restitution: 0.1, ..Conditions::default() };
        let mut engine = world(conditions, &room(without_overlaps(bodies)));
        run(&mut engine, 100);
        let mut snapshot = engine.snapshot();
        let integers = &mut snapshot.solver.integers;
        let index = index.index(integers.len());
        integers[index] = value;
        if is_truncated {
            integers.truncate(index);
        }
        let config = config(Conditions { events_per_step: 10_000, ..conditions });
        if let Ok(mut engine) = Engine::restore(config, snapshot) {
            for _ in 0..3 {
                if engine.step(&mut Vec::new()).is_err() {
                    break;
                }
            }
        }
    }
}

/// The double nearest to `digit`·10^`exponent`.
fn decimal((exponent, digit): (i32, f64)) -> f64 {
    format!("{digit}e{exponent}").parse().unwrap()
}

/// Floats of any sign and magnitude.
fn any_magnitude() -> impl Strategy<Value = f64> {
    prop_oneof![
        3 => -5.0..5.0,
        1 => (-300..300_i32, -9.0..9.0).prop_map(decimal),
        1 => (8..20_i32, -9.0..9.0).prop_map(decimal),
    ]
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 256, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn no_numbers_cause_a_hang_or_panic(
        numbers in prop::collection::vec(prop::array::uniform9(any_magnitude()), 2..8),
        gravity in [any_magnitude(), any_magnitude()],
        restitution in 0.0..=1.0,
        rate in any_magnitude(),
    ) {
        let positive = |number: f64| number.abs() + f64::MIN_POSITIVE;
        let bodies: Vec<BodySpec> = numbers.iter().enumerate().map(|(n, [x, y, width, height, mass, vx, vy, fx, fy])| {
            let mass = if n % 3 == 2 { INFINITE } else { positive(*mass) };
            spec([*x, *y], [positive(*width), positive(*height)], mass).with_velocity(*vx, *vy).with_force(*fx, *fy)
        }).collect();
        let rate = positive(rate);
        prop_assume!((1.0 / rate).is_finite());
        let gravity = Some(gravity);
        let mut engine = world(Conditions { rate, restitution, gravity, events_per_step: 1000 }, &bodies);
        for _ in 0..5 {
            if engine.step(&mut Vec::new()).is_err() {
                break;
            }
        }
    }
}

fn mirror(body: &BodySpec, axis: usize) -> BodySpec {
    let mut image = body.clone();
    image.at[axis] = ROOM - body.at[axis] - body.size[axis];
    image.velocity[axis] = -body.velocity[axis];
    image
}

fn position(engine: &Engine, id: BodyId) -> Vector {
    body(engine, id).rect.origin
}

#[test]
fn a_snapshot_that_does_not_fit_the_solver_is_rejected() {
    let engine = world(Conditions::default(), &walls(4.0, 4.0));
    let error_of = |change: &dyn Fn(&mut Snapshot)| -> SnapshotError {
        let mut snapshot = engine.snapshot();
        change(&mut snapshot);
        Engine::restore(config(Conditions::default()), snapshot).expect_err("a damaged snapshot")
    };
    for error in [
        error_of(&|snapshot| snapshot.solver.integers[0] = 77),
        error_of(&|snapshot| snapshot.solver.integers[1] = 3),
        error_of(&|snapshot| snapshot.solver.integers.truncate(2)),
        error_of(&|snapshot| snapshot.solver.numbers[0] = f64::NAN),
        error_of(&|snapshot| snapshot.solver.numbers.push(0.0)),
        error_of(&|snapshot| snapshot.bodies.truncate(2)),
        error_of(&|snapshot| {
            // The last of the four pending spawns, before the number of pending wakes.
            let last = snapshot.solver.integers.len() - 2;
            snapshot.solver.integers[last] -= 1;
        }),
        error_of(&|snapshot| {
            // A contact of the first wall, whose mass is made finite, with the second one.
            snapshot.bodies[0].mass = 1.0;
            let contacts = 2 + 2 * snapshot.bodies.len();
            snapshot.solver.integers.splice(contacts..=contacts, [1, 0, 1, 1]);
        }),
    ] {
        assert!(error.to_string().starts_with("the snapshot of step 0 does not fit the solver: "), "{error}");
    }
    let handout = EngineConfig::new(SolverKind::Handout, 60.0);
    let error = Engine::restore(handout.clone(), engine.snapshot()).expect_err("a snapshot of the other solver");
    assert_eq!(error.reason, "it was taken with the event-driven solver");
    assert!(Engine::restore(config(Conditions::default()), Engine::new(handout).snapshot()).is_err());
}
