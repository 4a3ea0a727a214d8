//! Small recordings for tests, created by running the engine.

use std::{io::Cursor, num::NonZero};

use crate::physics::{
    CollisionCount, Engine, EngineConfig, Rect, Restitution, RestitutionPair, SolverKind, Spawn, Vector,
};

use super::{
    BodyInfo, Change, Finished, Header, Item, Paint, RecordedError, RecordedEvent, RecordedState, Recording, RunEnd,
    SceneText, Writer, cdr,
    mcap_writer::{McapWriter, Profile},
    messages::{BodiesMessage, EventMessage},
    metadata,
    topic::Topic,
};

/// A run to record: header, and events in order of their steps.
#[derive(Clone, Debug)]
pub struct Run {
    pub header: Header,
    pub events: Vec<RecordedEvent>,
}

/// Two boxes between four walls; a third is spawned at step 10, and the first is deleted at step 25.
pub fn bounce(steps: u64) -> Run {
    let restitution =
        Restitution::new(0.9, &[RestitutionPair { materials: ["steel".into(), "wood".into()], restitution: 0.7 }]);
    let config = EngineConfig::new(SolverKind::Handout, 20.0)
        .with_gravity(Some(Vector::new(0.0, 9.81)))
        .with_restitution(restitution);
    let scene = SceneText { file_name: "bounce.toml".into(), text: "title = \"Bounce\"\n".into() };
    let header = Header::new(config, steps, scene);
    let mut events = Vec::new();
    let mut spawn = |step, spawn: Spawn, color: Option<&str>| {
        let info = BodyInfo { id: events.len() as u32, spawn, paint: Paint::new(color, None) };
        events.push(RecordedEvent { step, change: Change::Spawn(info.into()) });
    };
    for (name, [x, y, width, height]) in [
        ("wall-top", [-1.0, -1.0, 10.0, 1.0]),
        ("wall-bottom", [-1.0, 6.0, 10.0, 1.0]),
        ("wall-left", [-1.0, 0.0, 1.0, 6.0]),
        ("wall-right", [8.0, 0.0, 1.0, 6.0]),
    ] {
        let rect = Rect::new(Vector::new(x, y), width, height);
        spawn(0, Spawn { rect, mass: f64::INFINITY, ..body(name) }, None);
    }
    spawn(0, Spawn { velocity: Vector::new(3.0, -1.0), material: "steel".into(), ..body("a") }, Some("#3366cc"));
    let rect = Rect::new(Vector::new(5.0, 3.0), 0.5, 1.5);
    spawn(0, Spawn { rect, mass: 2.0, force: Vector::new(-1.0, 0.0), material: "wood".into(), ..body("c") }, None);
    spawn(10, Spawn { rect: Rect::new(Vector::new(2.5, 0.5), 1.0, 1.0), ..body("b") }, None);
    events.push(RecordedEvent { step: 25, change: Change::Delete { id: 4 } });
    Run { header, events }
}

/// A minimal run whose recording has several chunks: one box falls and is deleted.
pub fn drop_and_delete() -> Run {
    let Run { mut header, .. } = bounce(12);
    header.config.rate = 4.0;
    let spawn = RecordedEvent { step: 0, change: Change::Spawn(BodyInfo::new(0, body("a")).into()) };
    let delete = RecordedEvent { step: 10, change: Change::Delete { id: 0 } };
    Run { header, events: vec![spawn, delete] }
}

/// A box of 1 m and 1 kg, at rest at (1, 1).
pub fn body(name: &str) -> Spawn {
    Spawn {
        name: name.into(),
        rect: Rect::new(Vector::new(1.0, 1.0), 1.0, 1.0),
        mass: 1.0,
        velocity: Vector::ZERO,
        force: Vector::ZERO,
        material: String::new(),
    }
}

/// Records a run, and returns the bytes of the file.
pub fn record(run: &Run) -> Vec<u8> {
    record_with_processors(NonZero::<usize>::MIN, run)
}

/// Records a run with a number of processors.
pub fn record_with_processors(processors: NonZero<usize>, run: &Run) -> Vec<u8> {
    let mut writer = Writer::with_processors(processors, Vec::new(), Profile::Ros2, &run.header).unwrap();
    let mut engine = Engine::new(run.header.config.clone());
    let mut collisions = CollisionCount::default();
    let mut run_end = RunEnd::default();
    loop {
        let step = engine.current_step();
        for event in run.events.iter().filter(|event| event.step == step) {
            engine.apply(&event.change.event());
            writer.write_event(event).unwrap();
        }
        writer.write_state(&engine).unwrap();
        if engine.current_step() == run.header.steps {
            break;
        }
        if let Err(error) = engine.step(&mut collisions) {
            run_end.error = Some(RecordedError::Step(error));
            break;
        }
    }
    run_end.collisions = Some(collisions.0);
    let Finished { output, .. } = writer.finish(run_end).unwrap();
    output
}

/// Records a run with altered states and correct checksums.
pub fn record_altered(run: &Run, mut alter: impl FnMut(&mut RecordedState)) -> Vec<u8> {
    rewrite(run, |mcap, item| match item {
        Item::State(mut state) => {
            alter(&mut state);
            write_item(mcap, run, Item::State(state));
        }
        item => write_item(mcap, run, item),
    })
}

/// Records a run with a chunk for each step and without the keyframes after step 0.
pub fn record_in_small_chunks(run: &Run) -> Vec<u8> {
    rewrite(run, |mcap, item| match item {
        Item::Keyframe(keyframe) if keyframe.step > 0 => {}
        item => {
            let is_last_of_step = matches!(item, Item::State(_));
            write_item(mcap, run, item);
            if is_last_of_step {
                mcap.flush().unwrap();
            }
        }
    })
}

/// Records a run, and writes its items to another file, which ends like the first.
fn rewrite(run: &Run, mut write: impl FnMut(&mut McapWriter<Vec<u8>>, Item)) -> Vec<u8> {
    let settings = metadata::header_map(&run.header);
    let mut mcap = McapWriter::new(Vec::new(), Profile::Ros2, settings, run.header.scene.as_ref(), &[]).unwrap();
    for item in Recording::read(Cursor::new(record(run))).unwrap() {
        match item.unwrap() {
            Item::Trailer(trailer) => return mcap.finish(metadata::trailer_map(&run.header, &trailer)).unwrap(),
            item => write(&mut mcap, item),
        }
    }
    panic!("a new recording has an end record")
}

fn write_item(mcap: &mut McapWriter<Vec<u8>>, run: &Run, item: Item) {
    let mut bytes = Vec::new();
    let (topic, step) = match item {
        Item::Event(event) => {
            cdr::encode(&EventMessage::new(&event), &mut bytes);
            (Topic::Events, event.step)
        }
        Item::Keyframe(keyframe) => {
            cdr::encode(&BodiesMessage::new(&keyframe, run.header.versions.format), &mut bytes);
            (Topic::Bodies, keyframe.step)
        }
        Item::State(state) => {
            state.encode(&mut bytes);
            (Topic::States, state.step)
        }
        Item::SceneUpdate { .. } | Item::SuspectState(_) | Item::Gap(_) | Item::Damaged(_) | Item::Trailer(_) => {
            panic!("a new recording is complete")
        }
    };
    mcap.write_message(topic, run.header.log_time(step), &bytes).unwrap();
}
