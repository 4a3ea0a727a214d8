//! What holds for the exact solver in any world, tried on random ones.

use crate::laboratory::*;
use proptest::prelude::*;
use rebond::physics::{BodyId, Engine, Event, Snapshot, SnapshotError, Vector, invariants};

const ROOM: f64 = 12.0;

fn sketches() -> impl Strategy<Value = Vec<Sketch>> {
    let one = (0.0..10.0, 0.0..10.0, 0.3..1.8, 0.3..1.8, 0.2..5.0, -4.0..4.0, -4.0..4.0);
    let body = one.prop_map(|(x, y, width, height, mass, vx, vy)| sketch([x, y], [width, height], mass).moving(vx, vy));
    prop::collection::vec(body, 2..12)
}

/// Rounds coordinates so that they have an exact mirror image: an inelastic collapse amplifies
/// whatever is not the same.
fn on_grid(body: Sketch) -> Sketch {
    let rounded = |pair: [f64; 2]| pair.map(|number| (number * 65536.0).round() / 65536.0);
    Sketch { at: rounded(body.at), size: rounded(body.size), ..body }
}

/// Keeps those that overlap none before them.
fn apart(sketches: Vec<Sketch>) -> Vec<Sketch> {
    let mut kept: Vec<Sketch> = Vec::new();
    for new in sketches {
        let overlaps = |old: &Sketch| {
            (0..2).all(|axis| {
                new.at[axis] < old.at[axis] + old.size[axis] && old.at[axis] < new.at[axis] + new.size[axis]
            })
        };
        if !kept.iter().any(overlaps) {
            kept.push(new);
        }
    }
    kept
}

fn room(bodies: Vec<Sketch>) -> Vec<Sketch> {
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
    invariants::kinetic_energy(engine.world()) + invariants::potential_energy(engine.world())
}

fn snapshot_of(conditions: Conditions, engine: &Engine) -> Engine {
    Engine::restore(settings(conditions), engine.snapshot()).unwrap()
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 96, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn nothing_overlaps_and_energy_never_rises(conditions in conditions(), bodies in sketches()) {
        let mut engine = world(conditions, &room(apart(bodies)));
        let start = energy(&engine);
        let scale = 1e-12 * (start.abs() + 1000.0);
        let mut before = start;
        for step in 0..240 {
            run(&mut engine, 1);
            let overlap = invariants::worst_overlap(engine.world());
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
    fn momentum_is_kept_where_nothing_stands(restitution in 0.0..=1.0, bodies in sketches()) {
        let mut engine = world(Conditions { restitution, ..Conditions::default() }, &apart(bodies));
        let before = invariants::momentum(engine.world());
        run(&mut engine, 300);
        let change = invariants::momentum(engine.world()).sub(before);
        prop_assert!(change.norm() <= 1e-12);
    }

    #[test]
    fn restored_worlds_go_on_to_the_bit(
        conditions in conditions(),
        bodies in sketches(),
        late in sketches(),
        at in 0_u64..90,
    ) {
        let mut engine = world(conditions, &room(apart(bodies)));
        let mut other = engine.clone();
        for step in 0..150 {
            if step == at {
                late.iter().take(2).for_each(|body| spawn(&mut engine, body));
                engine.apply(&Event::Delete(5));
                late.iter().take(2).for_each(|body| spawn(&mut other, body));
                other.apply(&Event::Delete(5));
            }
            if step % 7 == at % 7 {
                other = snapshot_of(conditions, &other);
            }
            run(&mut engine, 1);
            run(&mut other, 1);
            prop_assert_eq!(all_bits(&engine), all_bits(&other), "after step {}", step);
        }
    }

    /// But in ties; and only in a Zeno sequence (e < 1) are ties more than chance.
    #[test]
    fn the_order_of_spawning_does_not_matter(bodies in sketches()) {
        let conditions = Conditions::default();
        let bodies = apart(bodies);
        let reversed: Vec<Sketch> = bodies.iter().rev().cloned().collect();
        let mut engine = world(conditions, &room(bodies));
        let mut other = world(conditions, &room(reversed));
        let count = run(&mut engine, 200).len();
        prop_assert_eq!(count, run(&mut other, 200).len());
        let mut found = all_bits(&other);
        found[4..].reverse();
        prop_assert_eq!(all_bits(&engine), found);
    }

    #[test]
    fn mirrors_show_mirrored_runs(conditions in conditions(), bodies in sketches(), axis in 0_usize..2) {
        let bodies = room(apart(bodies.into_iter().map(on_grid).collect()));
        let mirrored: Vec<Sketch> = bodies.iter().map(|body| mirror(body, axis)).collect();
        let gravity = conditions.gravity.map(|mut gravity| { gravity[axis] = -gravity[axis]; gravity });
        let mut engine = world(conditions, &bodies);
        let mut image = world(Conditions { gravity, ..conditions }, &mirrored);
        run(&mut engine, 45);
        run(&mut image, 45);
        for (id, body) in (0..).zip(&engine.world().bodies) {
            let [there, here] = [position(&image, id), body.rect.origin].map(|v| [v.x, v.y]);
            let size = [body.rect.width(), body.rect.height()][axis];
            prop_assert!((there[axis] + size + here[axis] - ROOM).abs() <= 1e-6);
            prop_assert!((there[1 - axis] - here[1 - axis]).abs() <= 1e-6);
        }
    }

    #[test]
    fn damaged_memories_are_refused_or_harmless(
        bodies in sketches(),
        place in any::<prop::sample::Index>(),
        value in prop_oneof![0_u64..20, any::<u64>()],
        cut in any::<bool>(),
    ) {
        let conditions = Conditions { gravity: Some([0.0, 9.81]), restitution: 0.1, ..Conditions::default() };
        let mut engine = world(conditions, &room(apart(bodies)));
        run(&mut engine, 100);
        let mut snapshot = engine.snapshot();
        let integers = &mut snapshot.memory.integers;
        let place = place.index(integers.len());
        integers[place] = value;
        if cut {
            integers.truncate(place);
        }
        if let Ok(mut engine) = Engine::restore(settings(Conditions { events_per_step: 10_000, ..conditions }), snapshot) {
            for _ in 0..3 {
                if engine.step(&mut Vec::new()).is_err() {
                    break;
                }
            }
        }
    }
}

/// Any magnitude a float can have, either sign.
fn wild() -> impl Strategy<Value = f64> {
    prop_oneof![
        3 => -5.0..5.0,
        1 => (-300..300_i32, -9.0..9.0).prop_map(|(exponent, digit): (i32, f64)| format!("{digit}e{exponent}").parse().unwrap()),
        1 => (8..20_i32, -9.0..9.0).prop_map(|(exponent, digit): (i32, f64)| format!("{digit}e{exponent}").parse().unwrap()),
    ]
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 256, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn no_numbers_make_it_hang_or_panic(
        numbers in prop::collection::vec([wild(), wild(), wild(), wild(), wild(), wild(), wild(), wild(), wild()], 2..8),
        gravity in [wild(), wild()],
        restitution in 0.0..=1.0,
        rate in wild(),
    ) {
        let positive = |number: f64| number.abs() + f64::MIN_POSITIVE;
        let bodies: Vec<Sketch> = numbers.iter().enumerate().map(|(n, [x, y, width, height, mass, vx, vy, fx, fy])| {
            let mass = if n % 3 == 2 { INFINITE } else { positive(*mass) };
            sketch([*x, *y], [positive(*width), positive(*height)], mass).moving(*vx, *vy).pushed(*fx, *fy)
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

fn mirror(body: &Sketch, axis: usize) -> Sketch {
    let mut image = body.clone();
    image.at[axis] = ROOM - body.at[axis] - body.size[axis];
    image.velocity[axis] = -body.velocity[axis];
    image
}

fn position(engine: &Engine, id: BodyId) -> Vector {
    body(engine, id).rect.origin
}

#[test]
fn a_memory_that_is_not_the_solvers_is_refused() {
    let engine = world(Conditions::default(), &walls(4.0, 4.0));
    let refused = |change: &dyn Fn(&mut Snapshot)| -> SnapshotError {
        let mut snapshot = engine.snapshot();
        change(&mut snapshot);
        Engine::restore(settings(Conditions::default()), snapshot).expect_err("it is damaged")
    };
    for error in [
        refused(&|snapshot| snapshot.memory.integers[0] = 77),
        refused(&|snapshot| snapshot.memory.integers[1] = 3),
        refused(&|snapshot| snapshot.memory.integers.truncate(2)),
        refused(&|snapshot| snapshot.memory.numbers[0] = f64::NAN),
        refused(&|snapshot| snapshot.memory.numbers.push(0.0)),
        refused(&|snapshot| snapshot.bodies.truncate(2)),
    ] {
        assert!(error.to_string().starts_with("the snapshot of step 0 does not fit the solver: "), "{error}");
    }
}
