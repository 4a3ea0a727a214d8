//! `record --accuracy`: how long rounding does not matter.

use crate::rebond::Workplace;
use std::fs;

/// The line `accuracy` that `info` prints for a recording of a scene.
fn accuracy_of(scene: &str, options: &str) -> String {
    let workplace = Workplace::with_scene(scene);
    workplace.done(&format!("record scene.toml -o run.mcap {options}"));
    let info = workplace.done("info run.mcap").output;
    info.lines().find_map(|line| line.strip_prefix("accuracy: ")).expect("a line on accuracy").to_owned()
}

fn coincident(name: &str) -> String {
    let path = format!("{}/tests/coincident/{name}.toml", env!("CARGO_MANIFEST_DIR"));
    fs::read_to_string(path).expect("a scene")
}

/// A ball that bounces on the floor for ten seconds.
fn bounce(solver: &str) -> String {
    format!(
        "run = {{ duration = 10.0, solver = \"{solver}\" }}\nworld = {{ walls = true, gravity = [0.0, 9.81] }}\n\
         restitution.default = 0.7\n\
         [[spawn]]\nname = \"ball\"\nat = [1.0, 1.0]\nsize = [1.0, 1.0]\nmass = 1.0\nvelocity = [2.3, 0.0]\n"
    )
}

#[test]
fn the_estimate_ends_before_rounding_has_moved_a_position() {
    // The positions differ from those in arithmetic of 600 bits by more than 1e-10 of the largest box (2 m) from step
    // 54 on. The estimate must not be later, and not much earlier.
    let accuracy = accuracy_of(&coincident("precision-exhausted"), "--accuracy");
    let until: u64 = accuracy.strip_prefix("1e-10 until step ").expect("an end").parse().expect("a step");
    assert!((40..54).contains(&until), "{accuracy}");
}

#[test]
fn bounces_and_bursts_are_accurate_throughout() {
    assert_eq!(accuracy_of(&bounce("event-driven"), "--accuracy"), "1e-10 throughout");
    for scene in ["burst-row-at-wall", "burst-heavy-on-light", "mirror-a", "seam-tiles-1.6"] {
        assert_eq!(accuracy_of(&coincident(scene), "--accuracy"), "1e-10 throughout", "{scene}");
    }
}

/// Two light boxes are squeezed between a heavy one and a wall: the gaps shrink below the resolution of positions before
/// the heavy box has stopped, and from then on the order of creation replaces the order in time.
#[test]
fn accuracy_ends_where_the_resolution_of_positions_decides() {
    let scene = r#"
        [world]
        size = [16.0, 9.0]
        gravity = [0.0, 0.0]
        [run]
        rate = 32.0
        steps = 60
        solver = "event-driven"
        [restitution]
        default = 0.5
        [[spawn]]
        name = "heavy"
        at = [0.0, 3.0]
        size = [4.0, 2.0]
        mass = 1000.0
        velocity = [0.0, -1.0]
        [[spawn]]
        name = "left"
        at = [-1.0, 1.0]
        size = [2.0, 2.0]
        mass = 1.0
        [[spawn]]
        name = "right"
        at = [3.0, 1.0]
        size = [1.0, 2.0]
        mass = 1.0
        [[spawn]]
        name = "block"
        at = [0.0, -2.0]
        size = [4.0, 2.0]
        mass = inf
    "#;
    assert_eq!(accuracy_of(scene, "--accuracy"), "1e-10 until step 32");
}

#[test]
fn accuracy_is_not_computed_unless_it_is_asked_for_and_can_be() {
    assert_eq!(accuracy_of(&bounce("event-driven"), ""), "not computed");
    assert_eq!(accuracy_of(&bounce("handout"), "--accuracy"), "not computed");
}

#[test]
fn the_estimate_changes_no_state() {
    let workplace = Workplace::with_scene(&bounce("event-driven"));
    let identity = |options: &str| {
        let line = workplace.done(&format!("record scene.toml -o run.mcap --force {options}")).output;
        line.split("identity ").nth(1).expect("an identity").to_owned()
    };
    assert_eq!(identity("--accuracy"), identity(""));
    workplace.done("record scene.toml -o run.mcap --force --accuracy");
    assert!(workplace.done("replay run.mcap").output.starts_with("same: 600 steps"));
}
