//! Laws of the event-driven solver, checked on random scenes of coincident events.
//!
//! Each law is a function of a [`Scene`]. `REBOND_LAW_SCENES` sets the number of scenes per law, or a range of seeds:
//! `REBOND_LAW_SCENES=10000 cargo test --release -- laws`, `REBOND_LAW_SCENES=137..138 cargo test -- laws::mirror`. A failure
//! prints its seed and a scene that was made as simple as it can be without holding the law.

mod accelerations;
mod bursts;
mod crowds;
mod decimals;
mod extremes;
mod instants;
mod kinds;
mod lattice;
mod long_paths;
mod mechanics;
pub mod random;
mod run;
mod scene;
mod seams;
mod starts;
mod symmetries;

use scene::Scene;
use std::{
    ops::Range,
    panic::{AssertUnwindSafe, catch_unwind},
};

/// The result of a law that holds.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Law {
    Holds,
    /// It holds as far as the accuracy of the result is known, and not beyond.
    HoldsToTheHorizon,
    /// The law says nothing of this scene, e.g. that of momentum about a scene with walls.
    DoesNotApply,
}

/// The most collisions of a scene, so that a few scenes with long bursts do not take most of the time.
const MOST_COLLISIONS: usize = if cfg!(debug_assertions) { 60 } else { 5000 };

/// The seeds of the scenes.
fn seeds() -> Range<u64> {
    seeds_of("REBOND_LAW_SCENES", if cfg!(debug_assertions) { 180 } else { 1120 })
}

/// The seeds that an environment variable selects, which is a number or a range; without it a standard number.
pub fn seeds_of(variable: &str, standard: u64) -> Range<u64> {
    let Ok(text) = std::env::var(variable) else { return 0..standard };
    let number = |text: &str| text.parse().unwrap_or_else(|_| panic!("{variable} is a number or FIRST..END"));
    text.split_once("..").map_or_else(|| 0..number(&text), |(first, end)| number(first)..number(end))
}

/// Checks a law on random scenes. Panics with the seeds of those that break it, and the simplest of the first one.
fn check(name: &str, scene_of: impl Fn(u64) -> Scene, law: impl Fn(&Scene) -> Result<Law, String>) {
    let judge = |scene: &Scene| {
        let judge = || if scene.has_more_collisions_than(MOST_COLLISIONS) { Ok(Law::DoesNotApply) } else { law(scene) };
        catch_unwind(AssertUnwindSafe(judge)).unwrap_or_else(|panic| {
            let text = panic.downcast_ref::<String>().cloned();
            Err(text.unwrap_or_else(|| "a panic".into()))
        })
    };
    let (mut applied, mut cut, mut failures) = (0_u64, 0_u64, Vec::new());
    for seed in seeds() {
        match judge(&scene_of(seed)) {
            Ok(law) => {
                applied += u64::from(law != Law::DoesNotApply);
                cut += u64::from(law == Law::HoldsToTheHorizon);
            }
            Err(difference) => failures.push((seed, difference)),
        }
    }
    let scenes = seeds().count();
    println!(
        "{name}: {scenes} scenes, {applied} of them apply and hold, {cut} of these only to the horizon, {} fail",
        failures.len()
    );
    let Some((seed, _)) = failures.first() else { return };
    let (scene, difference) = shrunk(scene_of(*seed), &judge);
    let list = failures.iter().map(|(seed, text)| format!("  {} {seed}: {text}\n", scene_of(*seed).kind));
    panic!(
        "{name}: {} of {scenes} scenes fail\n{}the first one, made simpler: {difference}\n{}",
        failures.len(),
        list.take(40).collect::<String>(),
        scene.toml()
    );
}

/// Makes a failing scene simpler as long as it fails, and returns how it does.
fn shrunk(mut scene: Scene, judge: &impl Fn(&Scene) -> Result<Law, String>) -> (Scene, String) {
    let mut difference = judge(&scene).err().unwrap_or_default();
    while let Some((simpler, text)) =
        scene.simpler().into_iter().find_map(|simpler| judge(&simpler).err().map(|text| (simpler, text)))
    {
        (scene, difference) = (simpler, text);
    }
    (scene, difference)
}
