//! `record --viewer`: recordings with scene updates for Foxglove and Lichtblick.
//!
//! `tests/readers` compares the scene updates with states and pictures, in Python.

use crate::rebond::Workplace;

const SCENE: &str = include_str!("../readers/viewer.toml");

fn recorded() -> Workplace {
    let workplace = Workplace::with_scene(SCENE);
    workplace.done("record scene.toml -o run.mcap --viewer");
    workplace
}

#[test]
fn scene_updates_change_nothing_else() {
    let workplace = recorded();
    let plain = workplace.done("record scene.toml -o plain.mcap").output.replace("plain", "run");
    assert_eq!(workplace.done("record scene.toml -o run.mcap --viewer --force").output, plain);
    assert!(workplace.read("run.mcap").len() > workplace.read("plain.mcap").len());
    assert_eq!(workplace.done("replay run.mcap").output, "same: 40 steps, 9 bodies\n");
    assert_eq!(workplace.done("replay run.mcap --from 30 --to 35").output, "same: 5 steps, 9 bodies\n");
    let export = |name| workplace.done(&format!("export {name} --from 24 --to 31")).output;
    assert_eq!(export("run.mcap"), export("plain.mcap"));
}

#[test]
fn the_profile_is_ros2_exactly_if_there_are_no_scene_updates() {
    let workplace = recorded();
    workplace.done("record scene.toml -o plain.mcap");
    for (name, profile) in [("plain.mcap", "ros2"), ("run.mcap", "")] {
        let bytes = workplace.read(name);
        let mut records = mcap::read::LinearReader::new(&bytes).unwrap();
        let Some(Ok(mcap::records::Record::Header(header))) = records.next() else { panic!("{name} has no header") };
        assert_eq!(header.profile, profile, "{name}");
    }
}

#[test]
fn recovery_keeps_scene_updates() {
    let workplace = recorded();
    workplace.done("recover run.mcap -o same.mcap");
    assert!(workplace.read("same.mcap") == workplace.read("run.mcap"), "a complete recording recovers to itself");
    let complete = workplace.read("run.mcap");
    std::fs::write(workplace.path("cut.mcap"), &complete[..complete.len() / 2]).unwrap();
    assert_eq!(workplace.rebond("replay cut.mcap").code, 4);
    workplace.done("recover cut.mcap -o fixed.mcap");
    assert!(workplace.done("replay fixed.mcap").output.starts_with("same: "));
    let fixed = workplace.read("fixed.mcap");
    assert!(fixed.windows(6).any(|window| window == b"/scene"), "the index contains the topic");
}
