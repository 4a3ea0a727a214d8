//! Mechanics on random scenes: no overlap, positive impulses, energy, momentum, time reversal.

use super::{
    Law, check,
    kinds::{random_gas, random_scene},
    run::{Run, State, larger},
    scene::{Scene, SceneBody},
};
use crate::world_builder::INFINITE;
use rebond::internals::physics::{Axis, Collision, Engine, World};

/// Returns the error of a run that should have none: a body may be crushed, or have no room at e = 1; moving infinite
/// masses may press a body between them through more events than are allowed.
fn ended(scene: &Scene, run: &Run) -> Result<(), String> {
    let moving = |body: &SceneBody| body.spec.mass == INFINITE && body.spec.velocity != [0.0; 2];
    let is_squeezed = scene.bodies.iter().any(moving);
    match &run.error {
        Some(error) if error.contains("crushed") || is_squeezed && error.contains("more than") => Ok(()),
        Some(error)
            if (error.contains("endlessly") || error.contains("more than"))
                && scene.restitutions().any(|e| e == 1.0) =>
        {
            Ok(())
        }
        Some(error) => Err(error.clone()),
        None => Ok(()),
    }
}

#[test]
fn no_two_boxes_overlap_by_more_than_a_few_ulps() {
    check("overlap", random_scene, |scene| {
        if scene.has_overlapping_spawns() {
            return Ok(Law::DoesNotApply);
        }
        let mut worst = None;
        let run = scene.run_with(|engine| {
            let world = engine.world();
            let overlap = world.deepest_overlap();
            if overlap > 16.0 * f64::EPSILON * reach(world) && worst.is_none() {
                worst = Some(format!("step {}: {overlap:e} m", engine.current_step()));
            }
        });
        ended(scene, &run)?;
        worst.map_or(Ok(Law::Holds), Err)
    });
}

/// The largest coordinate of a face of a body of finite mass, m.
fn reach(world: &World) -> f64 {
    let finite = world.bodies.iter().filter(|body| !body.is_infinite());
    let faces = finite.flat_map(|body| [body.rect.along(Axis::X), body.rect.along(Axis::Y)]).flatten();
    faces.fold(0.0, |most, x| larger(most, x.abs()))
}

#[test]
fn impulses_are_positive_and_reverse_the_approach_by_the_coefficient_of_restitution() {
    check("impulses", random_scene, |scene| {
        let run = scene.run();
        ended(scene, &run)?;
        let top = run.collisions.iter().fold(0.0, |most, collision| larger(most, collision.normal_velocity[0].abs()));
        for collision in &run.collisions {
            let ([before, after], e) = (collision.normal_velocity, scene.restitution_of(collision.bodies));
            // The limit of an infinite sequence has the speed 0 after it.
            let obeys = after == 0.0 || (after + e * before).abs() <= 1e-9 * top;
            let is_impact = before < 0.0 && collision.impulse >= 0.0 && (collision.impulse > 0.0 || after == 0.0);
            if !is_impact || !obeys || collision.restitution != e {
                return Err(format!("e = {e}: {collision:?}"));
            }
        }
        Ok(Law::Holds)
    });
}

/// The energy of a collision: it takes ½·(1 − e)·c·J from the bodies, and a moving mass that does not change its
/// velocity gives J times its velocity.
fn gain(collision: &Collision) -> f64 {
    let [before, after] = collision.normal_velocity;
    let k = usize::from(collision.axis == Axis::Y);
    let lost = -0.5 * (before + after) * collision.impulse;
    let normal = [collision.normal.x, collision.normal.y][k];
    let along = |velocity: rebond::internals::physics::Vector| [velocity.x, velocity.y][k];
    let work = (0..2).filter(|&side| collision.before[side] == collision.after[side]).map(|side| {
        // The impulse on the other body.
        let impulse = if side == 0 { -normal } else { normal } * collision.impulse;
        along(collision.before[side]) * impulse
    });
    work.sum::<f64>() - lost
}

#[test]
fn the_energy_changes_by_the_work_of_moving_masses_and_the_losses_of_impacts() {
    check("energy", random_scene, |scene| {
        let moving = |scene: &Scene| {
            let infinite = scene.bodies.iter().filter(|body| body.spec.mass == INFINITE);
            infinite.filter(|body| body.spec.velocity != [0.0; 2]).count()
        };
        // A moving mass that presses a body does work that no collision shows. In its own frame it does none.
        let scene = &match scene.bodies.iter().find(|body| body.spec.mass == INFINITE) {
            Some(body) if moving(scene) > 0 && scene.is_dyadic => {
                let [x, y] = body.spec.velocity;
                scene.moved([0.0; 2], [-x, -y])
            }
            _ => scene.clone(),
        };
        let presses = scene.acceleration() > 0.0 || scene.restitutions().any(|e| e > 0.0 && e < 1.0);
        if moving(scene) > 0 && presses || scene.changes_in_motion() {
            return Ok(Law::DoesNotApply);
        }
        let mut energies = Vec::new();
        let run = scene.run_with(|engine| energies.push(energy(engine)));
        ended(scene, &run)?;
        let mut collisions = run.collisions.iter().peekable();
        let (mut expected, mut turned_over) = (energies[0].0, 0.0);
        // The limit of an infinite burst takes energy that no collision shows.
        let is_exact = scene.restitutions().all(|e| e == 0.0 || e == 1.0);
        for (step, (energy, scale)) in energies.into_iter().enumerate() {
            while let Some(collision) = collisions.next_if(|collision| collision.step < step as u64) {
                expected += gain(collision);
                turned_over += gain(collision).abs();
            }
            let tolerance = 1e-9 * (scale + turned_over);
            if energy > expected + tolerance || is_exact && energy < expected - tolerance {
                return Err(format!("step {step}: {energy} J, expected {expected} J"));
            }
        }
        Ok(Law::Holds)
    });
}

/// The energy of the finite masses, and the sum of its parts without their signs, J.
fn energy(engine: &Engine) -> (f64, f64) {
    let (kinetic, potential) = (engine.world().kinetic_energy(), engine.world().potential_energy());
    let gravity = engine.world().gravity.map_or([0.0; 2], |gravity| [gravity.x.abs(), gravity.y.abs()]);
    let parts = engine.world().bodies.iter().filter(|body| !body.is_infinite()).map(|body| {
        let (force, center) = (body.constant_force, body.rect.center());
        (body.mass * gravity[0] + force.x.abs()) * center.x.abs()
            + (body.mass * gravity[1] + force.y.abs()) * center.y.abs()
    });
    (kinetic + potential, kinetic + parts.sum::<f64>())
}

#[test]
fn without_infinite_masses_the_momentum_changes_by_gravity_and_forces_only() {
    check("momentum", random_scene, |scene| {
        // Scenes with infinite masses lose them, so that what rested on them falls and collides.
        let mut scene = scene.clone();
        scene.bodies.retain(|body| body.spec.mass != INFINITE);
        if scene.bodies.is_empty() || scene.changes_in_motion() {
            return Ok(Law::DoesNotApply);
        }
        let mut momenta = Vec::new();
        let run = scene.run_with(|engine| {
            let scale = engine.world().bodies.iter().map(|body| body.mass * body.velocity.norm()).sum::<f64>();
            momenta.push((engine.world().momentum(), scale));
        });
        ended(&scene, &run)?;
        let force = |k: usize| {
            let forces = scene.bodies.iter().map(|body| body.spec.mass * scene.gravity[k] + body.spec.force[k]);
            forces.collect::<Vec<f64>>()
        };
        for (step, (momentum, scale)) in momenta.iter().enumerate() {
            let time = step as f64 / scene.rate;
            for k in 0..2 {
                let [start, now] = [momenta[0].0, *momentum].map(|p| [p.x, p.y][k]);
                let expected = start + force(k).iter().sum::<f64>() * time;
                let size = scale + momenta[0].1 + force(k).iter().map(|f| f.abs()).sum::<f64>() * time;
                if (now - expected).abs() > 1e-12 * size {
                    return Err(format!("step {step}: momentum {now} along axis {k}, expected {expected}"));
                }
            }
        }
        Ok(Law::Holds)
    });
}

/// Reverses all velocities at the last step. How many digits are left then follows from a run that starts 1e-12 m away.
#[test]
fn a_gas_whose_velocities_are_reversed_returns_to_its_start() {
    check("time reversal", random_gas, |scene| {
        let run = scene.run();
        ended(scene, &run)?;
        let last = run.states.last().expect("a state");
        let mut back = scene.clone();
        for (body, state) in back.bodies.iter_mut().zip(last) {
            (body.spec.at, body.spec.velocity) = (state.at, state.velocity.map(|v| 0.0 - v));
        }
        let growth = off(disturbed(scene).states.last().expect("a state"), last) / 1e-12;
        if growth * f64::EPSILON * 64.0 > 1e-9 {
            return Ok(Law::DoesNotApply);
        }
        let returned = back.run();
        ended(scene, &returned)?;
        let start: Vec<_> = run.states[0].clone();
        let error = off(returned.states.last().expect("a state"), &start);
        if error > 1e-9 || returned.collisions.len() != run.collisions.len() {
            return Err(format!(
                "{error:e} m from the start, {} collisions and {} back",
                run.collisions.len(),
                returned.collisions.len()
            ));
        }
        Ok(Law::Holds)
    });
}

/// The run of a scene whose bodies of finite mass start 1e-12 m from their places.
fn disturbed(scene: &Scene) -> Run {
    let mut scene = scene.clone();
    for body in scene.bodies.iter_mut().filter(|body| body.spec.mass != INFINITE) {
        body.spec.at = body.spec.at.map(|x| x + 1e-12);
    }
    scene.run()
}

/// The largest distance of two positions of a body, m.
fn off(one: &[State], two: &[State]) -> f64 {
    let distances = one.iter().zip(two).flat_map(|(a, b)| [0, 1].map(|k| (a.at[k] - b.at[k]).abs()));
    distances.fold(0.0, larger)
}
