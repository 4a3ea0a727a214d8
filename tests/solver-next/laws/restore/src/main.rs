//! Laws of the engine's interface on scenes: `restore SCENE.toml…`. One line per scene that breaks one, then the count.
//!
//! 1. An engine restored from the snapshot of any step goes on to the bit: states, collisions, and the snapshots after.
//! 2. Looking ahead with `world_after` changes nothing, and at the end of the step it shows the next state.
//! 3. After an error, `step` returns the same error again and moves nothing.

use edmd::physics::{Collision, Engine, StepError, World};
use edmd::scene::Scene;

/// What a run of a step left: the world, its collisions, the error.
type Outcome = (World, Vec<Collision>, Option<StepError>);

fn step(engine: &mut Engine, scene: &Scene, number: u64) -> Outcome {
    let mut collisions = Vec::new();
    let error = engine.step(&mut collisions).err();
    if error.is_none() {
        scene.apply(engine, number);
    }
    (engine.world().clone(), collisions, error)
}

fn same(a: &Outcome, b: &Outcome) -> bool {
    let bits = |world: &World| -> Vec<(u32, [u64; 4])> {
        world
            .bodies
            .iter()
            .map(|body| {
                let numbers = [body.rect.origin.x, body.rect.origin.y, body.velocity.x, body.velocity.y];
                (body.id, numbers.map(|number| (number + 0.0).to_bits()))
            })
            .collect()
    };
    bits(&a.0) == bits(&b.0) && a.1 == b.1 && a.2 == b.2
}

fn unlike(a: &Outcome, b: &Outcome) -> String {
    let body = a.0.bodies.iter().zip(&b.0.bodies).find(|(a, b)| a.rect.origin != b.rect.origin || a.velocity != b.velocity);
    let body = body.map(|(a, b)| {
        format!("{} at {:?} with {:?} becomes {:?} with {:?}", a.name, a.rect.origin, a.velocity, b.rect.origin, b.velocity)
    });
    format!("{}; {} collisions become {}; {:?} becomes {:?}", body.unwrap_or_default(), a.1.len(), b.1.len(), a.2, b.2)
}

/// The first law that a scene breaks, with the steps concerned.
fn broken(scene: &Scene) -> Option<String> {
    let mut engine = Engine::new(scene.config());
    scene.apply(&mut engine, 0);
    let mut snapshots = vec![engine.snapshot()];
    let mut outcomes: Vec<Outcome> = Vec::new();
    for number in 1..=scene.steps() {
        let before = engine.clone();
        let ahead = engine.world_after(0.5 / scene.rate(), &mut Vec::new()).map(|_| ());
        if engine.snapshot() != before.snapshot() {
            return Some(format!("step {number}: world_after changes the engine"));
        }
        let outcome = step(&mut engine, scene, number);
        if outcome.2.is_none() && ahead.is_err() {
            return Some(format!("step {number}: world_after fails where the step does not"));
        }
        let failed = outcome.2.clone();
        outcomes.push(outcome);
        if let Some(error) = failed {
            let bodies = engine.world().bodies.clone();
            let again = engine.step(&mut Vec::new()).err();
            if again.as_ref() != Some(&error) {
                return Some(format!("step {number}: after the error {error} the next step gives {again:?}"));
            }
            if engine.world().bodies != bodies {
                return Some(format!("step {number}: a step after the error moves bodies"));
            }
            break;
        }
        snapshots.push(engine.snapshot());
    }
    for (start, snapshot) in snapshots.iter().enumerate() {
        let mut other = match Engine::restore(scene.config(), snapshot.clone()) {
            Ok(other) => other,
            Err(error) => return Some(format!("the snapshot of step {start} is refused: {error}")),
        };
        if &other.snapshot() != snapshot {
            return Some(format!("the snapshot of step {start} is another after it was restored"));
        }
        for (place, outcome) in outcomes.iter().enumerate().skip(start) {
            let number = place as u64 + 1;
            let again = step(&mut other, scene, number);
            if !same(&again, outcome) {
                return Some(format!("restored at step {start}, step {number} is another: {}", unlike(outcome, &again)));
            }
            if outcome.2.is_none() && other.snapshot() != snapshots[place + 1] {
                return Some(format!("restored at step {start}, the snapshot of step {number} is another"));
            }
        }
    }
    None
}

fn main() {
    let mut count = [0, 0];
    for path in std::env::args().skip(1) {
        let scene = Scene::parse(&std::fs::read_to_string(&path).expect("a file"));
        count[0] += 1;
        if let Some(text) = broken(&scene) {
            count[1] += 1;
            println!("{path}: {text}");
        }
    }
    println!("{} scenes, {} differ", count[0], count[1]);
}
