//! A scene that the parser accepts starts: its events can be applied.

use super::random::Random;
use rebond::{Collision, Run, parse_scene};

/// A scene with few names, which are spawned and deleted at random steps, in random order. It has no clicks: the parser
/// cannot know which body a click deletes.
fn random_text(seed: u64) -> String {
    let mut random = Random::new(seed);
    let walls = random.chance(60);
    let mut text =
        format!("[world]\nsize = [16.0, 9.0]\nwalls = {walls}\n[run]\nsteps = 6\nsolver = \"event-driven\"\n");
    let names = ["a", "b", "c", "wall-top", "wall-left"];
    for n in 0..random.below(5) {
        let choices = if random.chance(90) { &names[..3] } else { &names[..] };
        let name = random.pick(choices);
        let step = random.pick(&[0, 0, 1, 2, 4]);
        let (at, mass) = ([n as f64 * 3.0 + 1.0, 4.0], random.pick(&["1.0", "inf"]));
        text +=
            &format!("[[spawn]]\nname = \"{name}\"\nstep = {step}\nat = {at:?}\nsize = [1.0, 1.0]\nmass = {mass}\n");
    }
    for _ in 0..random.below(4) {
        let (name, step) = (random.pick(&names), random.pick(&[0, 1, 2, 4, 5]));
        text += &format!("[[delete]]\nname = \"{name}\"\nstep = {step}\n");
    }
    text
}

#[test]
fn a_scene_that_the_parser_accepts_starts_and_applies_all_its_events() {
    let mut accepted = 0;
    for seed in super::seeds() {
        let text = random_text(seed);
        let Ok(scene) = parse_scene("random.toml", &text) else { continue };
        accepted += 1;
        let mut collisions: Vec<Collision> = Vec::new();
        let result = Run::new(&scene).go_to(6, &mut collisions);
        assert!(result.is_ok(), "seed {seed}: {}\n{text}", result.unwrap_err());
    }
    println!("starts: {} scenes, {accepted} accepted", super::seeds().count());
}
