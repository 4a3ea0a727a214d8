//! Events of one body in one instant, of which the queue holds only the first.

use super::random::Random;
use crate::world_builder::{BodySpec, Conditions, INFINITE, bits, config, run, spawn, spec, walls, world};
use rebond::internals::physics::Engine;

const ORDERS: [[usize; 3]; 6] = [[0, 1, 2], [0, 2, 1], [1, 0, 2], [1, 2, 0], [2, 0, 1], [2, 1, 0]];

/// A box slides along a shelf and leaves it at 1 s, just when another lands on it: it is free then.
fn landing_at_the_end_of_a_shelf(order: [usize; 3]) -> [BodySpec; 3] {
    let bodies = [
        spec([2.0, -2.0], [1.0; 2], 1.0).with_velocity(2.0, 0.0),
        spec([2.0, 3.0], [1.0; 2], 1.0).with_velocity(2.0, 0.0),
        spec([0.0, 4.0], [4.0, 1.0], INFINITE),
    ];
    order.map(|place| bodies[place].clone())
}

#[test]
fn a_box_that_loses_its_support_as_another_lands_on_it_gives_way() {
    let conditions = Conditions { rate: 32.0, restitution: 0.5, gravity: Some([0.0, 8.0]), ..Conditions::default() };
    for order in ORDERS {
        let bodies = landing_at_the_end_of_a_shelf(order);
        let mut engine = world(conditions, &bodies);
        let mut collisions = run(&mut engine, 20);
        // Neither a restored state nor a distant body changes anything.
        let mut others = [true, false].map(|is_restored| {
            let snapshot = engine.snapshot();
            let mut other = Engine::restore(config(conditions), snapshot).unwrap();
            if !is_restored {
                spawn(&mut other, &spec([1e4; 2], [1.0; 2], INFINITE));
            }
            other
        });
        collisions.extend(run(&mut engine, 44));
        assert_eq!(collisions.len(), 1, "order {order:?}");
        assert_eq!(collisions[0].impulse, 6.0, "order {order:?}");
        for other in &mut others {
            let found = run(other, 44);
            assert_eq!(format!("{found:?}"), format!("{collisions:?}"), "order {order:?}");
            let states = |engine: &Engine| engine.world().bodies.iter().take(3).map(bits).collect::<Vec<_>>();
            assert_eq!(states(other), states(&engine), "order {order:?}");
        }
    }
}

/// A box is thrown at a side wall so that its highest point is just at the ceiling, at 0.5 s.
#[test]
fn a_box_that_turns_at_a_face_goes_on_at_every_rate() {
    for start in 0..48 {
        let restitution = [1.0, 0.9, 0.5][start % 3];
        let state_at_one_second = |rate: f64| {
            let gravity = Some([0.0, 8.0]);
            let conditions = Conditions { rate, restitution, gravity, events_per_step: 1000 };
            let mut bodies = walls(4.0, 3.0);
            let x = 0.05 + 0.03 * start as f64;
            bodies.push(spec([x, 1.0], [1.0; 2], 1.0).with_velocity(-3.0, -4.0));
            let mut engine = world(conditions, &bodies);
            let collisions = run(&mut engine, rate as u64);
            assert!(collisions.iter().all(|collision| collision.bodies != [0, 4]), "nothing hits the ceiling");
            bits(&engine.world().bodies[4])
        };
        let slow = [1.0, 2.0, 4.0, 64.0].map(state_at_one_second);
        assert_eq!(slow, [slow[0]; 4], "start {start}");
        let fast = [60.0, 120.0, 240.0].map(state_at_one_second);
        assert_eq!(fast, [fast[0]; 3], "start {start}");
        state_at_one_second(61.0);
    }
}

/// Boxes far apart are hit by a moving wall of infinite mass at times that differ by less than the resolution of positions:
/// each has the states that it has without the others.
#[test]
fn boxes_that_a_moving_wall_hits_in_one_instant_do_not_depend_on_each_other() {
    for seed in 0..300 {
        let mut random = Random::new(seed);
        let restitution = random.pick(&[1.0, 0.5, 0.0]);
        let conditions = Conditions { rate: 1e6, restitution, ..Conditions::default() };
        let [wall_speed, speed] = [1, 0].map(|least| random.whole(least, 8) as f64);
        let wall = spec([-1.0, -1.0], [60.0, 1.0], INFINITE).with_velocity(0.0, wall_speed);
        let gap = random.between(1e-5, 1e-4);
        let boxes = [2.0, 20.0, 40.0].map(|x| {
            let top = (0..random.below(4)).fold(gap, |top, _| top.next_up());
            spec([x, top], [1.0; 2], random.pick(&[1.0, 3.0])).with_velocity(0.0, -speed)
        });
        let states_with = |boxes: &[BodySpec]| {
            let bodies: Vec<BodySpec> = [&wall].into_iter().chain(boxes).cloned().collect();
            let mut engine = world(conditions, &bodies);
            run(&mut engine, 150);
            engine.world().bodies.iter().skip(1).map(bits).collect::<Vec<_>>()
        };
        let alone: Vec<_> = boxes.iter().flat_map(|body| states_with(std::slice::from_ref(body))).collect();
        assert_eq!(states_with(&boxes), alone, "seed {seed}");
    }
}
