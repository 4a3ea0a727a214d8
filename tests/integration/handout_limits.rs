//! Limits of the handout's algorithm. A change of any number here is a change of the algorithm as printed.

use crate::snapshot::assert_text;
use rebond::internals::physics::{
    CollisionCount, Engine, EngineConfig, Event, Rect, Restitution, SolverKind, Spawn, Vector,
};
use std::fmt::Write;

fn engine(gravity: Option<Vector>, restitution: f64) -> Engine {
    Engine::new(
        EngineConfig::new(SolverKind::Handout, 60.0)
            .with_gravity(gravity)
            .with_restitution(Restitution::new(restitution, &[])),
    )
}

fn spawn(engine: &mut Engine, name: &str, at: [f64; 2], size: [f64; 2], mass: f64, velocity: [f64; 2]) {
    let rect = Rect::new(Vector::new(at[0], at[1]), size[0], size[1]);
    let spawn = Spawn::new(name, rect, mass);
    engine.apply(&Event::Spawn(spawn.with_velocity(Vector::new(velocity[0], velocity[1]))));
}

fn advance(engine: &mut Engine, steps: u64) {
    for _ in 0..steps {
        engine.step(&mut CollisionCount::default()).expect("finite numbers");
    }
}

/// 16 boxes above a floor between two walls at e = 1: the energy should be constant and no boxes should overlap.
#[test]
fn energy_is_not_conserved_at_e_1() {
    let mut engine = engine(Some(Vector::new(0.0, 9.81)), 1.0);
    spawn(&mut engine, "floor", [-1.0, 9.0], [18.0, 1.0], f64::INFINITY, [0.0, 0.0]);
    spawn(&mut engine, "left", [-1.0, -91.0], [1.0, 100.0], f64::INFINITY, [0.0, 0.0]);
    spawn(&mut engine, "right", [16.0, -91.0], [1.0, 100.0], f64::INFINITY, [0.0, 0.0]);
    for number in 0..16_u32 {
        let (column, row) = (f64::from(number % 4), f64::from(number / 4));
        let velocity = [1.5 - column + 0.25 * row, 0.5 * row - 0.75];
        spawn(&mut engine, &format!("box {number}"), [2.0 + 3.0 * column, 1.0 + 1.75 * row], [1.0, 1.0], 1.0, velocity);
    }
    let mut table = String::from("step   energy change   worst overlap\n");
    let energy = |engine: &Engine| engine.world().kinetic_energy() + engine.world().potential_energy();
    let first = energy(&engine);
    for _ in 0..6 {
        let change = (energy(&engine) - first) / first.abs();
        let overlap = engine.world().deepest_overlap();
        writeln!(table, "{:4}   {:12.3} %   {overlap:11.3} m", engine.current_step(), 100.0 * change).unwrap();
        advance(&mut engine, 120);
    }
    assert_text("handout-energy-at-e-1", &table);
}

/// A stack of ten boxes at e = 0: nothing should move.
#[test]
fn a_stack_sinks_into_the_floor() {
    let mut engine = engine(Some(Vector::new(0.0, 9.81)), 0.0);
    spawn(&mut engine, "floor", [-1.0, 10.0], [18.0, 1.0], f64::INFINITY, [0.0, 0.0]);
    for number in 0..10_u32 {
        spawn(&mut engine, &format!("box {number}"), [7.5, 9.0 - f64::from(number)], [1.0, 1.0], 1.0, [0.0, 0.0]);
    }
    let mut table = String::from("step   top of the stack   worst overlap\n");
    for _ in 0..6 {
        let top = engine.world().bodies[10].rect.origin.y;
        let overlap = engine.world().deepest_overlap();
        writeln!(table, "{:4}   {top:14.6} m   {overlap:11.6} m", engine.current_step()).unwrap();
        advance(&mut engine, 120);
    }
    assert_text("handout-stack-that-sinks", &table);
}

/// Tunnelling, described in the last paragraph of the handout.
#[test]
fn a_fast_bullet_passes_through_a_wall() {
    let mut table = String::from("speed (m/s)   after 30 steps\n");
    for speed in [20.0, 40.0, 60.0, 80.0, 120.0, 240.0] {
        let mut engine = engine(None, 1.0);
        spawn(&mut engine, "wall", [8.0, 0.0], [0.2, 9.0], f64::INFINITY, [0.0, 0.0]);
        spawn(&mut engine, "bullet", [1.0, 4.25], [0.5, 0.5], 0.1, [speed, 0.0]);
        advance(&mut engine, 30);
        let bullet = &engine.world().bodies[1];
        let outcome = if bullet.velocity.x < 0.0 { "bounced back" } else { "passed through" };
        writeln!(table, "{speed:11}   {outcome}, x = {} m", bullet.rect.origin.x).unwrap();
    }
    assert_text("handout-bullet-that-passes", &table);
}
