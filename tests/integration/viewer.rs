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
    for range in ["--from 30 --to 35", "--from 1s --to 1.17s"] {
        assert_eq!(workplace.done(&format!("replay run.mcap {range}")).output, "same: 5 steps, 9 bodies\n", "{range}");
    }
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
    assert_eq!(workplace.rebond("recover cut.mcap -o fixed.mcap").code, 4);
    let replayed = workplace.rebond("replay fixed.mcap");
    assert!(replayed.code == 4 && replayed.output.starts_with("incomplete: recovered; "), "{replayed:?}");
    let fixed = workplace.read("fixed.mcap");
    assert!(fixed.windows(6).any(|window| window == b"/scene"), "the index contains the topic");
}

/// Plots refer to a body by its topic, whichever bodies are spawned and deleted.
#[test]
fn an_exported_topic_has_the_states_of_one_body_throughout_the_run() {
    let workplace = Workplace::with_scene(
        "[run]\nsteps = 20\n\
         [[spawn]]\nname = \"a b\"\nat = [1.0, 1.0]\nsize = [1.0, 1.0]\nmass = 1.0\nvelocity = [1.0, 0.5]\n\
         [[spawn]]\nname = \"a-b\"\nat = [5.0, 1.0]\nsize = [1.0, 1.0]\nmass = 1.0\nvelocity = [0.1, 0.5]\n\
         [[delete]]\nname = \"a b\"\nstep = 7\n\
         [[spawn]]\nname = \"a b\"\nstep = 9\nat = [9.0, 1.0]\nsize = [1.0, 1.0]\nmass = 2.0\nvelocity = [0.0, -0.5]\n",
    );
    workplace.done("export scene.toml -o plot.mcap");
    let table = workplace.done("export scene.toml").output;
    let file = workplace.read("plot.mcap");
    let mut found: Vec<String> = Vec::new();
    let mut topics = std::collections::BTreeMap::new();
    for message in mcap::MessageStream::new(&file).unwrap() {
        let message = message.unwrap();
        let numbers: Vec<String> = message.data[4..]
            .chunks(8)
            .map(|bytes| format!("{:?}", f64::from_le_bytes(bytes.try_into().unwrap())))
            .collect();
        *topics.entry(message.channel.topic.clone()).or_insert(0) += 1;
        found.push(format!("{},{}", message.channel.metadata["name"], numbers.join(",")));
    }
    let expected: Vec<String> =
        table.lines().skip(1).map(|row| row.splitn(3, ',').nth(2).expect("name and numbers").to_owned()).collect();
    assert_eq!(found, expected);
    let topics: Vec<(String, u32)> = topics.into_iter().collect();
    let expected = [("/body/a_b", 7), ("/body/a_b_id1", 21), ("/body/a_b_id2", 12)];
    assert_eq!(topics, expected.map(|(topic, count)| (topic.to_owned(), count)));
    for refused in ["export scene.toml scene.toml -o two.mcap", "export scene.toml --table energy -o e.mcap"] {
        assert_eq!(workplace.rebond(refused).code, 2, "{refused}");
    }
}
