//! Collisions computed by hand from the printed formulas: each face, each row of the rules
//! for shares and masses, each repair.

use super::*;
use crate::physics::{Restitution, RestitutionPair};

const INFINITE: f64 = f64::INFINITY;

fn body(id: u32, at: [f64; 2], size: [f64; 2], mass: f64, velocity: [f64; 2]) -> Body {
    Body {
        id,
        name: format!("#{id}"),
        rect: Rect::new(Vector::new(at[0], at[1]), size[0], size[1]),
        mass,
        inverse_mass: 1.0 / mass,
        velocity: Vector::new(velocity[0], velocity[1]),
        force: Vector::ZERO,
        constant_force: Vector::ZERO,
        material: Default::default(),
    }
}

fn world(bodies: Vec<Body>) -> World {
    World { bodies, gravity: None, restitution: Restitution::new(1.0, &[]) }
}

/// Resolves c = body 0 against b = body 1 once and returns the observed collision, if any.
fn collide_once(world: &mut World) -> Option<Collision> {
    let mut collisions: Vec<Collision> = Vec::new();
    collide(world, 0, 1.0, [0, 1], &mut collisions);
    collisions.pop()
}

/// A unit box c at the origin of mass 1 moving with `velocity`, and a unit box b at `at` at rest.
fn unit_pair(velocity: [f64; 2], at: [f64; 2]) -> World {
    world(vec![body(0, [0.0, 0.0], [1.0, 1.0], 1.0, velocity), body(1, at, [1.0, 1.0], 1.0, [0.0, 0.0])])
}

fn x_y(v: Vector) -> (f64, f64) {
    (v.x, v.y)
}

#[test]
fn each_face_pushes_c_out_of_it() {
    // (velocity of c, position of b, unit normal, position of c afterwards): only c moves, so Nc = 1.
    let faces = [
        ([2.0, 0.0], [0.75, 0.125], (-1.0, 0.0), (-0.25, 0.0)),
        ([-2.0, 0.0], [-0.75, 0.125], (1.0, 0.0), (0.25, 0.0)),
        ([0.0, 2.0], [0.125, 0.75], (0.0, -1.0), (0.0, -0.25)),
        ([0.0, -2.0], [0.125, -0.75], (0.0, 1.0), (0.0, 0.25)),
    ];
    for (velocity, at, normal, after) in faces {
        let mut world = unit_pair(velocity, at);
        let collision = collide_once(&mut world).expect("they overlap");
        assert_eq!(x_y(collision.normal), normal);
        assert_eq!(x_y(world.bodies[0].rect.origin), after);
        assert_eq!(x_y(world.bodies[1].rect.origin), (at[0], at[1]));
        assert_eq!(x_y(world.bodies[0].velocity), (0.0, 0.0), "equal masses swap velocities at e = 1");
        assert_eq!(x_y(world.bodies[1].velocity), (velocity[0], velocity[1]));
        assert_eq!(collision.impulse, 2.0);
    }
}

#[test]
fn a_tie_between_faces_is_resolved_in_the_order_left_right_top_bottom() {
    // A box centred on an equal one: all four vectors to a face are 1 m long.
    let (_, normal) = minimum_translation(&Rect::new(Vector::new(-1.0, -1.0), 2.0, 2.0));
    assert_eq!(x_y(normal), (-1.0, 0.0), "left before right, top, bottom");
    let (_, normal) = minimum_translation(&Rect::new(Vector::new(-3.0, -1.0), 4.0, 2.0));
    assert_eq!(x_y(normal), (1.0, 0.0), "right before top and bottom");
    let (_, normal) = minimum_translation(&Rect::new(Vector::new(-3.0, -1.0), 6.0, 2.0));
    assert_eq!(x_y(normal), (0.0, -1.0), "top before bottom");
}

#[test]
fn penetration_is_shared_in_proportion_to_speed() {
    let mut world = unit_pair([3.0, 0.0], [0.5, 0.0]);
    world.bodies[1].velocity = Vector::new(-1.0, 0.0);
    let collision = collide_once(&mut world).unwrap();
    assert_eq!(collision.shares, [0.75, 0.25]);
    assert_eq!(world.bodies[0].rect.origin.x, -0.5 * 0.75);
    assert_eq!(world.bodies[1].rect.origin.x, 0.5 + 0.5 * 0.25);
    assert_eq!([world.bodies[0].velocity.x, world.bodies[1].velocity.x], [-1.0, 3.0]);
}

#[test]
fn at_rest_only_the_lighter_body_is_displaced() {
    // (mass of c, mass of b, shares)
    let rows = [(1.0, 2.0, [1.0, 0.0]), (2.0, 1.0, [0.0, 1.0]), (1.0, 1.0, [0.0, 1.0])];
    for (mass_c, mass_b, shares) in rows {
        let c = body(0, [0.0, 0.0], [1.0, 1.0], mass_c, [0.0, 0.0]);
        let b = body(1, [0.75, 0.0], [1.0, 1.0], mass_b, [0.0, 0.0]);
        let mut world = world(vec![c, b]);
        let collision = collide_once(&mut world).unwrap();
        assert_eq!(collision.shares, shares);
        assert_eq!(world.bodies[0].rect.origin.x, -0.25 * shares[0]);
        assert_eq!(world.bodies[1].rect.origin.x, 0.75 + 0.25 * shares[1]);
        assert_eq!(collision.impulse, 0.0);
    }
}

#[test]
fn the_impulse_follows_masses_and_restitution() {
    // c of 2 kg at 3 m/s hits b of 1 kg at rest: j = −(1+e)·3/(1/2 + 1).
    for (e, after) in [(1.0, [1.0, 4.0]), (0.5, [1.5, 3.0]), (0.0, [2.0, 2.0])] {
        let c = body(0, [0.0, 0.0], [1.0, 1.0], 2.0, [3.0, 0.0]);
        let b = body(1, [0.75, 0.0], [1.0, 1.0], 1.0, [0.0, 0.0]);
        let mut world = world(vec![c, b]);
        world.restitution = Restitution::new(e, &[]);
        let collision = collide_once(&mut world).unwrap();
        assert_eq!(collision.impulse, (1.0 + e) * 3.0 / 1.5);
        assert_eq!([world.bodies[0].velocity.x, world.bodies[1].velocity.x], after);
    }
}

#[test]
fn steel_and_wood_rebound_as_the_handout_says() {
    let pair = |name: &str, restitution| RestitutionPair { materials: [name.into(), name.into()], restitution };
    let table = Restitution::new(1.0, &[pair("steel", 19.0 / 20.0), pair("wood", 1.0 / 2.0)]);
    for (name, e, rebound) in [("steel", 0.95, -19.0), ("wood", 0.5, -10.0)] {
        let mut c = body(0, [0.0, 0.0], [1.0, 1.0], 4.0, [20.0, 0.0]);
        let mut b = body(1, [0.75, 0.0], [1.0, 1.0], INFINITE, [0.0, 0.0]);
        c.material = table.material(name);
        b.material = table.material(name);
        let mut world = world(vec![c, b]);
        world.restitution = table.clone();
        let collision = collide_once(&mut world).unwrap();
        assert_eq!(collision.impulse, (1.0 + e) * 20.0 / 0.25);
        assert_eq!(world.bodies[0].velocity.x, rebound);
    }
}

#[test]
fn a_wall_at_rest_does_not_move() {
    let c = body(0, [0.0, 0.0], [1.0, 1.0], 2.0, [3.0, 1.0]);
    let wall = body(1, [0.75, -5.0], [1.0, 10.0], INFINITE, [0.0, 0.0]);
    let mut world = world(vec![c, wall.clone()]);
    let collision = collide_once(&mut world).unwrap();
    assert_eq!(collision.shares, [1.0, 0.0]);
    assert_eq!(x_y(world.bodies[0].rect.origin), (-0.25, 0.0));
    assert_eq!(x_y(world.bodies[0].velocity), (-3.0, 1.0));
    assert_eq!(world.bodies[1], wall);
}

#[test]
fn r1_boxes_that_just_touch_have_a_normal() {
    let mut world = unit_pair([1.0, 0.0], [1.0, 0.0]);
    let collision = collide_once(&mut world).expect("touching boxes collide");
    assert_eq!((x_y(collision.penetration), x_y(collision.normal)), ((0.0, 0.0), (-1.0, 0.0)));
    assert_eq!([world.bodies[0].velocity.x, world.bodies[1].velocity.x], [0.0, 1.0]);
    assert!(world.bodies.iter().all(|body| body.rect.origin.is_finite()));
}

#[test]
fn r2_a_separating_pair_is_repositioned_without_an_impulse() {
    let mut world = unit_pair([-1.0, 0.0], [0.75, 0.0]);
    let collision = collide_once(&mut world).unwrap();
    assert_eq!(collision.impulse, 0.0);
    assert_eq!(collision.before, collision.after);
    assert_eq!(world.bodies[0].rect.origin.x, -0.25);
    assert_eq!(world.bodies[0].velocity.x, -1.0);
}

#[test]
fn r3_infinite_masses_never_collide_even_in_motion() {
    let c = body(0, [0.0, 0.0], [1.0, 1.0], INFINITE, [1.0, 0.0]);
    let b = body(1, [0.5, 0.0], [1.0, 1.0], INFINITE, [-1.0, 0.0]);
    let mut world = world(vec![c.clone(), b.clone()]);
    assert_eq!(collide_once(&mut world), None);
    assert_eq!(world.bodies, [c, b]);
}

#[test]
fn r4_an_infinite_mass_in_motion_is_not_displaced() {
    for infinite in [0, 1] {
        let mut world = unit_pair([0.0, 0.0], [0.75, 0.0]);
        let mass = &mut world.bodies[infinite];
        (mass.mass, mass.inverse_mass) = (INFINITE, 0.0);
        mass.velocity = Vector::new(if infinite == 0 { 2.0 } else { -2.0 }, 0.0);
        let before = world.bodies[infinite].rect;
        let collision = collide_once(&mut world).unwrap();
        assert_eq!(collision.shares, if infinite == 0 { [0.0, 1.0] } else { [1.0, 0.0] });
        assert_eq!(world.bodies[infinite].rect, before);
        assert_eq!(world.bodies[1 - infinite].velocity.x, if infinite == 0 { 4.0 } else { -4.0 });
    }
}

#[test]
fn a_step_adds_force_and_weight_and_moves_with_the_new_velocity() {
    let mut falling = body(0, [0.0, 0.0], [1.0, 1.0], 2.0, [1.0, 0.0]);
    falling.constant_force = Vector::new(4.0, -2.0);
    let mut pinned = body(1, [50.0, 0.0], [1.0, 1.0], INFINITE, [1.0, 0.0]);
    pinned.constant_force = Vector::new(4.0, 4.0);
    let mut world = world(vec![falling, pinned]);
    world.gravity = Some(Vector::new(0.0, 8.0));
    step(&mut world, 0, 0.25, &mut Vec::new()).unwrap();
    // a = (4, −2 + 16)/2 = (2, 7)
    assert_eq!(x_y(world.bodies[0].velocity), (1.5, 1.75));
    assert_eq!(x_y(world.bodies[0].rect.origin), (0.375, 0.4375));
    assert_eq!(x_y(world.bodies[0].force), (0.0, 0.0));
    assert_eq!(x_y(world.bodies[1].velocity), (1.0, 0.0), "neither acts on an infinite mass");
    assert_eq!(x_y(world.bodies[1].rect.origin), (50.25, 0.0));
}

#[test]
fn a_step_tests_each_pair_twice_and_moves_each_body_before_testing_the_next() {
    // c collides and moves before b is tested: the second test finds the pair touching, but separating.
    let mut world = unit_pair([2.0, 0.0], [0.75, 0.0]);
    let mut collisions: Vec<Collision> = Vec::new();
    step(&mut world, 7, 0.5, &mut collisions).unwrap();
    let pairs: Vec<_> =
        collisions.iter().map(|collision| (collision.step, collision.bodies, collision.impulse)).collect();
    assert_eq!(pairs, [(7, [0, 1], 2.0), (7, [1, 0], 0.0)]);
    assert_eq!(world.bodies[1].rect.origin.x, 0.75 + 2.0 * 0.5);
}

#[test]
fn an_overflow_is_an_error_that_names_the_body() {
    let mut world = world(vec![body(0, [0.0, 0.0], [1.0, 1.0], 1.0, [1e308, 0.0])]);
    let error = step(&mut world, 3, 10.0, &mut Vec::new()).unwrap_err();
    assert_eq!(error, StepError::NotFinite { step: 3, body: "#0".into() });
}
