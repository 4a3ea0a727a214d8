//! Transformations of a scene that transform its run, to the bit or in the last digits only.

use super::{
    Law, check,
    kinds::random_scene,
    random::Random,
    run::{Impact, Outcome, State, larger},
    scene::{Scene, SceneBody},
};
use crate::world_builder::{BodySpec, Conditions, INFINITE, spec, world};
use rebond::internals::physics::{Engine, Vector};

fn outcome(scene: &Scene) -> Outcome {
    Outcome::of(scene, scene.run())
}

fn to_the_bit(expected: &Outcome, found: &Outcome) -> Result<Law, String> {
    expected.difference_to_the_bit(found).map_or(Ok(Law::Holds), Err)
}

/// Compares a run with that of a transformed scene, transformed back; if they differ, only as far as the result of both is
/// known to be accurate.
fn to_the_last_digits(scene: &Scene, expected: &Outcome, other: &Scene, found: &Outcome) -> Result<Law, String> {
    let reach = larger(scene.extent(), other.extent());
    let Some(difference) = expected.difference(found, scene, reach, scene.steps) else { return Ok(Law::Holds) };
    let steps_of_other = (other.rate / scene.rate) as u64;
    let horizon = scene.horizon().min(other.horizon() / steps_of_other);
    if horizon == scene.steps {
        return Err(difference);
    }
    expected.difference(found, scene, reach, horizon).map_or(Ok(Law::HoldsToTheHorizon), Err)
}

#[test]
fn exchanging_the_axes_exchanges_the_results() {
    check("exchanged axes", random_scene, |scene| {
        // A body in the middle of another one leaves it along one of the two axes.
        if scene.has_overlapping_spawns() {
            return Ok(Law::DoesNotApply);
        }
        let turned = scene.with_axes_exchanged();
        let turn = |state: &mut State| [&mut state.at, &mut state.velocity].map(|pair| pair.swap(0, 1));
        let found = outcome(&turned).map(|_, state| _ = turn(state), |impact| impact.axis = 1 - impact.axis);
        to_the_bit(&outcome(scene).with_sorted_corners(), &found.with_sorted_corners())
    });
}

/// Runs a scene in other units, and multiplies the results back.
fn in_units(scene: &Scene, [length, mass, time]: [f64; 3]) -> Result<Law, String> {
    let (speed, impulse) = (length / time, mass * length / time);
    let state = |_: u64, state: &mut State| {
        state.at = state.at.map(|x| x / length);
        state.velocity = state.velocity.map(|v| v / speed);
    };
    let impact = |impact: &mut Impact| {
        impact.instant /= time;
        (impact.before, impact.after) = (impact.before / speed, impact.after / speed);
        impact.impulse /= impulse;
    };
    to_the_bit(&outcome(scene), &outcome(&scene.scaled(length, mass, time)).map(state, impact))
}

/// 2^k for a k of the scene, between −60 and 60.
fn power_of_two(scene: &Scene) -> f64 {
    let mut random = Random::new(scene.seed + 1);
    let power = (1_u64 << random.pick(&[1, 2, 7, 20, 60])) as f64;
    if random.chance(50) { power } else { 1.0 / power }
}

#[test]
fn lengths_times_a_power_of_two_multiply_the_results() {
    check("lengths", random_scene, |scene| in_units(scene, [power_of_two(scene), 1.0, 1.0]));
}

#[test]
fn masses_times_a_power_of_two_multiply_the_impulses() {
    check("masses", random_scene, |scene| in_units(scene, [1.0, power_of_two(scene), 1.0]));
}

#[test]
fn times_times_a_power_of_two_multiply_the_results() {
    check("times", random_scene, |scene| in_units(scene, [1.0, 1.0, power_of_two(scene)]));
}

#[test]
fn a_rate_times_a_power_of_two_only_adds_samples() {
    check("rates", random_scene, |scene| {
        let factor = Random::new(scene.seed).pick(&[2, 2, 4, 8, 16]);
        to_the_bit(&outcome(scene), &outcome(&scene.at_rate_times(factor)).every(factor as usize))
    });
}

#[test]
fn a_rate_times_15_changes_the_last_digits_only() {
    check("rate times 15", random_scene, |scene| {
        let (expected, faster) = (outcome(scene), scene.at_rate_times(15));
        to_the_last_digits(scene, &expected, &faster, &outcome(&faster).every(15))
    });
}

#[test]
fn distant_bodies_change_nothing() {
    check("distant bodies", random_scene, |scene| {
        let mut random = Random::new(scene.seed);
        let far = random.pick(&[16384.0, -16384.0, 1048576.0]);
        let mass = random.pick(&[0.25, 1.0, 1e6]);
        let at = |x: f64, y: f64, mass: f64| spec([far + x, far + y], [1.0; 2], mass);
        // A copy has all its events at the same instants, to rounding.
        let can_be_copied = scene.pairs.is_empty() && !scene.has_overlapping_spawns();
        let others = match random.below(if can_be_copied { 8 } else { 4 }) {
            0 => vec![at(0.0, 0.0, INFINITE)],
            1 => vec![at(0.0, 0.0, INFINITE), at(0.5, -1.0, mass), at(0.0, -2.0, mass), at(0.5, -3.5, mass)],
            2 => vec![at(0.0, 0.0, INFINITE), at(2.0, 0.0, mass).with_velocity(-1.5, 0.25), at(3.0, 0.0, mass)],
            3 => vec![
                at(0.0, 0.0, mass).with_force(3.0, 1.0),
                at(1.0, 0.0, 1.0).with_force(-7.0, 0.5),
                at(1.0, 1.0, 1.0).with_force(0.0, -20.0),
            ],
            _ => {
                let copy = scene.moved([1.1 * far, 0.3], [0.0; 2]);
                // Moved by a distance that is rounded, bodies that just fit into a slot can be crushed.
                if copy.run().error.is_some() {
                    return Ok(Law::DoesNotApply);
                }
                let first = copy.bodies.into_iter().filter(|body| body.step == 0);
                first.map(|body| body.spec).collect()
            }
        };
        to_the_bit(&outcome(scene), &outcome_within(&scene.with_others(&others, random.chance(50)), scene))
    });
}

/// Boxes into which blocks of infinite mass are spawned.
fn random_blocks_among_boxes(seed: u64) -> Scene {
    let mut random = Random::new(seed);
    let mut place = |label: usize, step: u64, largest: i64| {
        let [x, y, width, height] =
            [(0, 15), (0, 15), (1, largest), (1, largest)].map(|(least, most)| 0.25 * random.whole(least, most) as f64);
        let mass = if step == 0 { 1.0 } else { INFINITE };
        SceneBody { label, spec: spec([x, y], [width, height], mass), material: "", step }
    };
    let boxes = (0..6).map(|label| place(label, 0, 4)).collect::<Vec<_>>();
    let blocks = (6..9).map(|label| place(label, 1 + label as u64 % 2, 8));
    let mut scene = random_scene(0);
    scene.bodies = boxes.into_iter().chain(blocks).collect();
    scene.bodies.sort_by_key(|body| body.step);
    Scene { kind: "blocks among boxes", seed, rate: 8.0, steps: 6, gravity: [0.0; 2], deletes: Vec::new(), ..scene }
}

#[test]
fn a_distant_block_that_is_spawned_in_the_same_step_changes_nothing() {
    check("a distant block", random_blocks_among_boxes, |scene| {
        let mut with_distant = scene.clone();
        let far = Random::new(scene.seed).pick(&[16384.0, -16384.0]);
        for step in [1, 2] {
            let place = with_distant.bodies.iter().take_while(|body| body.step <= step).count();
            let (label, spec) = (with_distant.bodies.len(), spec([far, 4.0 * step as f64], [1.0; 2], INFINITE));
            with_distant.bodies.insert(place, SceneBody { label, spec, material: "", step });
        }
        to_the_bit(&outcome(scene), &outcome_within(&with_distant, scene))
    });
}

#[test]
fn no_older_box_overlaps_a_spawned_block() {
    check("spawned blocks", random_blocks_among_boxes, |scene| {
        let mut overlap = 0.0;
        scene.run_with(|engine| {
            let bodies = &engine.world().bodies;
            let is_new = |id: u32| scene.bodies[id as usize].step == engine.current_step();
            let blocks = bodies.iter().filter(|body| body.mass == INFINITE && !is_new(body.id));
            for block in blocks {
                for other in bodies.iter().filter(|other| other.mass != INFINITE) {
                    if let Some(shared) = block.rect.intersection(&other.rect) {
                        let [width, height] = [shared.width(), shared.height()];
                        overlap = larger(overlap, if width < height { width } else { height });
                    }
                }
            }
        });
        if overlap < 1e-12 { Ok(Law::Holds) } else { Err(format!("an overlap of {overlap} m")) }
    });
}

#[test]
fn a_force_elsewhere_changes_nothing_when_all_bodies_with_forces_are_deleted() {
    check("a force elsewhere", random_scene, |scene| {
        let is_deleted = |label: usize| scene.deletes.iter().any(|delete| delete.1 == label);
        let forced = scene.bodies.iter().filter(|body| body.spec.force != [0.0; 2] && !is_deleted(body.label));
        let mut random = Random::new(scene.seed);
        let deletes = forced.map(|body| (random.whole(body.step as i64 + 1, scene.steps as i64) as u64, body.label));
        let mut without_forces = scene.clone();
        without_forces.deletes.extend(deletes);
        if without_forces.deletes.len() == scene.deletes.len() {
            return Ok(Law::DoesNotApply);
        }
        let elsewhere = [spec([65536.0; 2], [1.0; 2], 1.0).with_force(1.0, 1.0)];
        let with_another = without_forces.with_others(&elsewhere, random.chance(50));
        to_the_bit(&outcome(&without_forces), &outcome_within(&with_another, &without_forces))
    });
}

/// A row that flies to a wall, 4.5 hours after the start: the time between two of its impacts is a few roundings of their
/// times, as doubles.
fn row_with_tiny_gaps(seed: u64) -> Scene {
    const HOURS: f64 = 16384.0;
    let mut random = Random::new(seed);
    let speed = random.pick(&[1.0, 32.0, 1024.0]);
    let mut face = -speed * random.pick(&[0.0, 1e-6, 0.125]);
    let mut bodies = vec![spec([0.0, -1.0], [1.0, 3.0], INFINITE)];
    for _ in 0..random.whole(1, 5) {
        let size = random.pick(&[1.0, 0.5, 0.75]);
        let velocity = speed * random.pick(&[1.0, 1.0, 1.0, 2.0]);
        face -= size;
        bodies.push(
            spec([face, random.pick(&[0.0, 0.5])], [size, 1.0], random.pick(&[1.0, 3.0])).with_velocity(velocity, 0.0),
        );
        face -= speed * HOURS * random.pick(&[0.0, 1.0, 2.0, 4.0, 1e6]) * (f64::EPSILON * random.between(0.0, 2.0));
    }
    random.shuffle(&mut bodies);
    let body = |(label, spec)| SceneBody { label, spec, material: "", step: 1 };
    Scene {
        kind: "row with tiny gaps",
        seed,
        rate: 1.0 / HOURS,
        steps: 2,
        gravity: [0.0; 2],
        restitution: random.pick(&[1.0, 0.5, 0.9]),
        pairs: Vec::new(),
        bodies: (0..).zip(bodies).map(body).collect(),
        deletes: Vec::new(),
        is_dyadic: false,
    }
}

#[test]
fn slow_impacts_elsewhere_at_nearly_the_same_time_change_nothing() {
    let scene_of = |seed: u64| if seed.is_multiple_of(2) { row_with_tiny_gaps(seed) } else { random_scene(seed / 2) };
    check("slow impacts elsewhere", scene_of, |scene| {
        let expected = outcome(scene);
        let mut random = Random::new(scene.seed + 1);
        let mut others = Vec::new();
        for index in 0..if expected.impacts.is_empty() { 0 } else { random.whole(1, 3) } {
            let instant = expected.impacts[random.below(expected.impacts.len() as u64) as usize].instant;
            let speed = 1.0 / random.pick(&[1_u64 << 8, 1 << 14, 1 << 20, 1 << 28, 1 << 40]) as f64;
            let roundings = random.pick(&[0.0, 1.0, 2.0, 3.0, 8.0, -1.0, -2.0]);
            let y = 65536.0 + 4.0 * index as f64;
            others.push(spec([-1.0, y], [1.0; 2], 1.0).with_velocity(speed, 0.0));
            others.push(spec([speed * instant * (1.0 + roundings * f64::EPSILON), y], [1.0; 2], 1.0));
        }
        to_the_bit(&expected, &outcome_within(&scene.with_others(&others, random.chance(50)), scene))
    });
}

/// A pair of boxes that collide 9·10⁻¹⁶ s after a sample at a rate of 8 Hz.
fn pair_that_collides_after_a_sample() -> [BodySpec; 2] {
    [
        spec([3.2499999999999996, -1.75], [0.25; 2], 1.0).with_velocity(-0.75, 0.25),
        spec([2.0, -1.2499999999999998], [0.5; 2], 1.0),
    ]
}

/// A pair of boxes that collide, so slowly that their gap is 0 at the instant 1 s already, some roundings of doubles
/// after it.
fn slow_pair(speed: f64, roundings: f64) -> [BodySpec; 2] {
    [
        spec([-1.0, 65536.0], [1.0; 2], 1.0).with_velocity(speed, 0.0),
        spec([speed * (1.0 + roundings * f64::EPSILON), 65536.0], [1.0; 2], 1.0),
    ]
}

const SLOW_SPEEDS: [f64; 3] = [1.0 / (1_u64 << 14) as f64, 1.0 / (1_u64 << 20) as f64, 1.0 / (1_u64 << 40) as f64];

fn conditions_with_sample_at_1_s() -> Conditions {
    Conditions { rate: 8.0, restitution: 0.0, gravity: Some([0.0, 10.0]), ..Conditions::default() }
}

#[test]
fn a_slow_impact_at_a_sample_does_not_bring_others_before_it() {
    for speed in SLOW_SPEEDS {
        let bodies = [slow_pair(speed, 4.0), pair_that_collides_after_a_sample()].concat();
        let mut engine = world(conditions_with_sample_at_1_s(), &bodies);
        let mut collisions = Vec::new();
        (0..8).for_each(|_| engine.step(&mut collisions).unwrap());
        assert_eq!(collisions.iter().map(|collision| collision.bodies).collect::<Vec<_>>(), [[0, 1]], "{speed} m/s");
        assert_eq!(engine.world().bodies[2].velocity, Vector::new(-0.75, 10.25));
        engine.step(&mut collisions).unwrap();
        assert_eq!(collisions[1].bodies, [2, 3]);
    }
}

#[test]
fn an_impact_at_a_sample_is_shown_there_whatever_collides_elsewhere() {
    for (speed, roundings) in SLOW_SPEEDS.into_iter().flat_map(|speed| (-3..14).map(move |count| (speed, count))) {
        let slow = slow_pair(speed, f64::from(roundings));
        let velocity = |bodies: &[BodySpec], index: usize| {
            let mut engine = world(conditions_with_sample_at_1_s(), bodies);
            let mut collisions = Vec::new();
            (0..8).for_each(|_| engine.step(&mut collisions).unwrap());
            engine.world().bodies[index].velocity
        };
        let [alone, others] = [velocity(&slow, 0), velocity(&pair_that_collides_after_a_sample(), 0)];
        let all = [slow, pair_that_collides_after_a_sample()].concat();
        assert_eq!([velocity(&all, 0), velocity(&all, 2)], [alone, others], "{speed} m/s, {roundings} roundings");
    }
}

/// With so many bodies, neighbours are found with lists for windows of steps, and not among all bodies.
#[test]
fn many_distant_bodies_change_nothing() {
    check("many distant bodies", random_scene, |scene| {
        let plates: Vec<BodySpec> =
            (0..20).map(|index| spec([16384.0 + 2.0 * f64::from(index), 0.0], [1.0; 2], INFINITE)).collect();
        to_the_bit(&outcome(scene), &outcome_within(&scene.with_others(&plates, false), scene))
    });
}

/// The outcome of a scene for the bodies of a part of it, which touch no others.
fn outcome_within(scene: &Scene, part: &Scene) -> Outcome {
    let mut found = outcome(scene);
    let is_part = |label: usize| label < part.next_label();
    found.states.iter_mut().for_each(|states| states.retain(|state| is_part(state.id)));
    found.impacts.retain(|impact| is_part(impact.bodies[0]));
    found
}

#[test]
fn an_engine_restored_at_every_step_continues_bit_for_bit() {
    check("restored", random_scene, |scene| {
        let restore = |engine: &mut Engine| {
            *engine = Engine::restore(scene.config(), engine.snapshot()).unwrap_or_else(|error| panic!("{error}"));
            engine.assert_invariants();
        };
        to_the_bit(&outcome(scene), &Outcome::of(scene, scene.run_with(restore)))
    });
}

#[test]
fn worlds_within_a_step_do_not_depend_on_those_before_them() {
    check("within steps", random_scene, |scene| {
        let mut difference = None;
        // In debug builds within every fourth step.
        let stride = if cfg!(debug_assertions) { 4 } else { 1 };
        scene.run_with(|engine| {
            if !(engine.current_step() + scene.seed).is_multiple_of(stride) {
                return;
            }
            let (mut within, mut collisions) = (engine.within_step(), Vec::new());
            for part in 1..=3 {
                let offset = f64::from(part) / (3.0 * scene.rate);
                let mut all = Vec::new();
                let [step_by_step, at_once] =
                    [within.world_after(offset, &mut collisions), engine.world_after(offset, &mut all)];
                if format!("{step_by_step:?} {collisions:?}") != format!("{at_once:?} {all:?}") {
                    difference = difference.take().or(Some(format!("step {} + {offset} s", engine.current_step())));
                }
                if step_by_step.is_err() {
                    break;
                }
            }
        });
        difference.map_or(Ok(Law::Holds), Err)
    });
}

#[test]
fn a_mirrored_scene_has_a_mirrored_run() {
    check("mirror", random_scene, |scene| {
        // A body in the middle of another one leaves it to one of the two sides.
        if !scene.is_dyadic || scene.has_overlapping_spawns() {
            return Ok(Law::DoesNotApply);
        }
        let expected = outcome(scene);
        for axis in 0..2 {
            let mirrored = scene.mirrored(axis);
            let size_of = |id: usize| scene.bodies.iter().find(|body| body.label == id).expect("a body").spec.size;
            let state = |_: u64, state: &mut State| {
                state.at[axis] = -state.at[axis] - size_of(state.id)[axis];
                state.velocity[axis] = -state.velocity[axis];
            };
            let found = outcome(&mirrored).map(state, |_| {});
            to_the_last_digits(scene, &expected, &mirrored, &found).map_err(|text| format!("axis {axis}, {text}"))?;
        }
        Ok(Law::Holds)
    });
}

#[test]
fn an_exact_translation_moves_the_run() {
    check("translation", random_scene, |scene| {
        if !scene.is_dyadic {
            return Ok(Law::DoesNotApply);
        }
        let mut random = Random::new(scene.seed);
        let by = [0, 1].map(|_| random.pick(&[0.0, 0.25, -3.0, 17.0, 1024.0, -4096.5, 1048576.0, 0.015625]));
        let moved = scene.moved(by, [0.0; 2]);
        let back = |_: u64, state: &mut State| (0..2).for_each(|k| state.at[k] -= by[k]);
        to_the_last_digits(scene, &outcome(scene), &moved, &outcome(&moved).map(back, |_| {}))
    });
}

#[test]
fn another_inertial_frame_moves_the_run() {
    check("inertial frame", random_scene, |scene| {
        if !scene.is_dyadic {
            return Ok(Law::DoesNotApply);
        }
        let mut random = Random::new(scene.seed);
        let by = [0, 1].map(|_| random.pick(&[0.0, 0.5, -1.0, 3.0, -8.0, 0.125]));
        let moving = scene.moved([0.0; 2], by);
        let back = |step: u64, state: &mut State| {
            for (k, speed) in by.into_iter().enumerate() {
                state.at[k] -= speed * (step as f64 / scene.rate);
                state.velocity[k] -= speed;
            }
        };
        to_the_last_digits(scene, &outcome(scene), &moving, &outcome(&moving).map(back, |_| {}))
    });
}
