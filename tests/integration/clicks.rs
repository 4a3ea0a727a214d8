//! The handout's mouse. The handout asks what happens without the line that tests the target of a click: the
//! clicked box is deleted, and the same click creates a new one. In rebond a click never does both.

use crate::rebond::Workplace;

const SCENE: &str = r#"
[world]
size = [16.0, 9.0]
walls = true
[run]
rate = 60
steps = 10
solver = "handout"
[[spawn]]
name = "below"
at = [4.0, 4.0]
size = [2.0, 2.0]
mass = 1.0
[[spawn]]
name = "above"
at = [5.0, 5.0]
size = [2.0, 2.0]
mass = inf
"#;

/// The names alive at the last step of the scene with `clicks` added.
fn names_after(clicks: &str) -> Vec<String> {
    let workplace = Workplace::with_scene(&format!("{SCENE}{clicks}"));
    workplace.done("record scene.toml -o run.mcap");
    let table = workplace.done("export run.mcap --from 10").output;
    let names = table.lines().skip(1).filter_map(|row| row.split(',').nth(2));
    names.filter(|name| !name.starts_with("wall-")).map(str::to_owned).collect()
}

#[test]
fn a_click_on_a_body_deletes_it_and_never_also_spawns() {
    let click = "[[click]]\nstep = 5\nat = [4.5, 4.5]\nspawn = { size = [0.5, 0.5], mass = 1.0 }\n";
    assert_eq!(names_after(click), ["above"]);
}

#[test]
fn a_click_on_no_body_spawns_one_around_the_point() {
    let click = "[[click]]\nstep = 5\nat = [10.0, 4.5]\nspawn = { size = [0.5, 0.5], mass = 1.0 }\n";
    assert_eq!(names_after(click), ["below", "above", "#3"]);
}

#[test]
fn a_click_ignores_infinite_masses() {
    let click = "[[click]]\nstep = 5\nat = [6.5, 6.5]\nspawn = { name = \"new\", size = [0.5, 0.5], mass = 1.0 }\n";
    assert_eq!(names_after(click), ["below", "above", "new"]);
}

#[test]
fn a_click_deletes_the_body_created_last_and_the_next_click_the_one_below() {
    let spawn = "spawn = { size = [2.0, 2.0], mass = 1.0 }";
    let clicks = format!(
        "[[click]]\nstep = 0\nat = [12.0, 4.0]\n{spawn}\n[[click]]\nstep = 0\nat = [13.5, 4.0]\n{spawn}\n\
         [[click]]\nstep = 0\nat = [12.75, 4.0]\n"
    );
    assert_eq!(names_after(&clicks), ["below", "above", "#3"]);
    assert_eq!(names_after(&format!("{clicks}[[click]]\nstep = 0\nat = [12.75, 4.0]\n")), ["below", "above"]);
}

#[test]
fn a_click_that_deletes_nothing_and_spawns_nothing_is_no_event() {
    assert_eq!(names_after("[[click]]\nstep = 5\nat = [1.0, 1.0]\n"), ["below", "above"]);
}
