//! Tests with hostile recordings and with failing outputs.

use std::{
    io::{self, Cursor, Write},
    num::NonZero,
    sync::{Arc, Mutex},
};

use mcap::records::op;

use super::{
    Change, Error, Health, Item, Playback, Recording, RunEnd, Versions, Writer, cdr, limits,
    mcap_writer::{McapWriter, Profile},
    metadata,
    testing::{bounce, drop_and_delete, record},
    topic::Topic,
};
use crate::{
    physics::{CollisionCount, Engine},
    replay::{ALL_STEPS, Replayer},
};

/// Reads a recording to its end and returns the reason of its damage.
fn damage(bytes: Vec<u8>) -> String {
    let mut recording = match Recording::read(Cursor::new(bytes)) {
        Ok(recording) => recording,
        Err(error) => return error.to_string(),
    };
    recording.by_ref().for_each(|item| drop(item.unwrap()));
    match recording.health() {
        Health::Corrupt { damage, .. } => damage.reason,
        Health::Whole | Health::Incomplete(_) => "no damage".into(),
    }
}

/// Returns a recording whose only message is `bytes`.
fn with_message(topic: Topic, bytes: &[u8]) -> Vec<u8> {
    let header = drop_and_delete().header;
    let mut mcap =
        McapWriter::new(Vec::new(), Profile::Ros2, metadata::header_map(&header), header.scene.as_ref(), &[]).unwrap();
    mcap.write_message(topic, 0, bytes).unwrap();
    mcap.flush().unwrap();
    mcap.finish(metadata::Map::new()).unwrap()
}

fn offset_of_first_chunk(bytes: &[u8]) -> usize {
    bytes.windows(8).position(|window| window == b"\x04\0\0\0zstd").unwrap() - 37
}

#[test]
fn a_chunk_of_100_gigabytes_is_rejected() {
    let mut bytes = record(&drop_and_delete());
    let chunk = offset_of_first_chunk(&bytes);
    assert_eq!(bytes[chunk], op::CHUNK);
    bytes[chunk + 1..chunk + 9].copy_from_slice(&100_000_000_000_u64.to_le_bytes());
    assert_eq!(damage(bytes), "record with opcode 06 length exceeds limit: `100000000000`");
}

#[test]
fn a_chunk_that_decompresses_beyond_the_limit_is_rejected() {
    let mut bytes = record(&drop_and_delete());
    let chunk = offset_of_first_chunk(&bytes);
    bytes[chunk + 25..chunk + 33].copy_from_slice(&(limits::RECORD_BYTES as u64 + 1).to_le_bytes());
    let (found, limit) = (limits::RECORD_BYTES + 1, limits::RECORD_BYTES);
    assert_eq!(damage(bytes), format!("the chunk has {found} bytes uncompressed, but at most {limit} are allowed"));
}

#[test]
fn a_string_of_4_gigabytes_is_rejected() {
    let mut bytes = record(&drop_and_delete());
    let name = bytes.windows(6).position(|window| window == b"rebond").unwrap();
    let metadata = name + bytes[name + 6..].windows(6).position(|window| window == b"rebond").unwrap() + 6;
    bytes[metadata - 4..metadata].copy_from_slice(&u32::MAX.to_le_bytes());
    assert_eq!(damage(bytes), "the metadata is damaged");
}

#[test]
fn a_state_of_4_billion_bodies_is_rejected() {
    let mut message = cdr::HEADER.to_vec();
    message.extend([0; 16]);
    message.extend(u32::MAX.to_le_bytes());
    message.extend([0; 64]);
    assert_eq!(damage(with_message(Topic::States, &message)), "the message of a state is too short");
}

#[test]
fn messages_that_are_too_long_or_inconsistent_are_rejected() {
    let state_damage = |bytes: &[u8]| damage(with_message(Topic::States, bytes));
    let state = |id: Vec<u32>, x: Vec<f64>| {
        let state = super::RecordedState { id, y: x.clone(), vx: x.clone(), vy: x.clone(), x, ..Default::default() };
        let mut bytes = Vec::new();
        state.encode(&mut bytes);
        bytes
    };
    let mut longer = state(vec![], vec![]);
    longer.push(0);
    assert_eq!(state_damage(&longer), "1 extra byte follows the message");
    assert_eq!(state_damage(b"\0\0\0\0"), "the message does not start with the header of little-endian CDR");
    assert_eq!(state_damage(&state(vec![1], vec![])), "state 0 has columns of different lengths");
    assert_eq!(state_damage(&state(vec![2, 1], vec![0.0, 0.0])), "the ids in state 0 are not in ascending order");
    assert_eq!(state_damage(&state(vec![1], vec![0.0])), "the ids in state 0 do not match the events");
    assert_eq!(state_damage(&state(vec![], vec![])), "state 0 does not match its digest");
}

#[test]
fn a_newer_format_is_rejected_with_its_version() {
    let mut run = drop_and_delete();
    run.header.versions.format = 99;
    let found = damage(record(&run));
    assert_eq!(
        found,
        "the recording has format version 99, but this rebond reads versions up to 3; use a newer rebond"
    );
}

#[test]
fn states_of_other_semantics_are_readable_but_not_replayed() {
    let mut run = drop_and_delete();
    run.header.versions = Versions { semantics: 99, ..run.header.versions };
    let recording = || Recording::read(Cursor::new(record(&run))).unwrap();
    assert_eq!(Playback::new(recording()).count(), 13);
    let replayed = Replayer::new(recording(), ALL_STEPS);
    assert!(matches!(replayed, Err(Error::OtherSemantics { found: 99 })));
}

/// An output with a limited capacity.
#[derive(Clone)]
struct LimitedOutput {
    written: Arc<Mutex<Vec<u8>>>,
    capacity: usize,
}

impl Write for LimitedOutput {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let mut written = self.written.lock().unwrap();
        let count = bytes.len().min(self.capacity - written.len());
        written.extend_from_slice(&bytes[..count]);
        if count == 0 { Err(io::ErrorKind::StorageFull.into()) } else { Ok(count) }
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

/// Records a run until an error occurs.
fn record_into(output: LimitedOutput, processors: NonZero<usize>) -> Result<(), Error> {
    let run = bounce(50);
    let mut writer = Writer::with_processors(processors, output, Profile::Ros2, &run.header)?;
    let mut engine = Engine::new(run.header.config.clone());
    for step in 0..=50 {
        for event in run.events.iter().filter(|event| event.step == step) {
            engine.apply(&event.change.event());
            writer.write_event(event)?;
        }
        writer.write_state(&engine)?;
        engine.step(&mut CollisionCount::default()).unwrap();
    }
    writer.finish(RunEnd::default()).map(drop)
}

#[test]
fn a_full_disk_is_an_error_and_the_output_is_a_prefix_of_the_recording() {
    let [one, two] = [1, 2].map(|processors| NonZero::new(processors).unwrap());
    let complete = LimitedOutput { written: Arc::default(), capacity: usize::MAX };
    record_into(complete.clone(), two).unwrap();
    let total = complete.written.lock().unwrap().len();
    let capacities = || (0..total).step_by(211).chain([total - 1]);
    let with = |processors| capacities().map(move |capacity| (capacity, processors));
    for (capacity, processors) in with(one).chain(with(two)) {
        let output = LimitedOutput { written: Arc::default(), capacity };
        let error = record_into(output.clone(), processors).expect_err("an error of the full disk");
        assert!(error.to_string().starts_with("the recording cannot be written: "), "{error}");
        let written = output.written.lock().unwrap().clone();
        assert_eq!(written, complete.written.lock().unwrap()[..capacity]);
    }
}

/// An output that records its length at each flush.
#[derive(Clone, Default)]
struct FlushRecorder {
    written: Arc<Mutex<(Vec<u8>, Vec<usize>)>>,
}

impl Write for FlushRecorder {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.written.lock().unwrap().0.extend_from_slice(bytes);
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        let mut written = self.written.lock().unwrap();
        let length = written.0.len();
        written.1.push(length);
        Ok(())
    }
}

#[test]
fn a_flush_follows_every_batch_of_events_and_every_second() {
    let run = bounce(50);
    let output = FlushRecorder::default();
    let mut engine = Engine::new(run.header.config.clone());
    let mut writer = Writer::new(output.clone(), &run.header).unwrap();
    for step in 0..=50 {
        for event in run.events.iter().filter(|event| event.step == step) {
            engine.apply(&event.change.event());
            writer.write_event(event).unwrap();
        }
        writer.write_state(&engine).unwrap();
        engine.step(&mut CollisionCount::default()).unwrap();
    }
    drop(writer);
    let mut expected: Vec<u64> = run.events.iter().map(|event| event.step).chain([19, 39]).collect();
    expected.sort_unstable();
    expected.dedup();
    let (bytes, flushes) = output.written.lock().unwrap().clone();
    let last_state = |length: &usize| {
        let recording = Recording::read(Cursor::new(&bytes[..*length])).unwrap();
        recording.filter_map(|item| if let Item::State(state) = item.unwrap() { Some(state.step) } else { None }).last()
    };
    let mut readable: Vec<u64> = flushes.iter().filter_map(last_state).collect();
    readable.dedup();
    assert_eq!(readable, expected);
}

#[test]
fn a_dropped_writer_leaves_all_flushed_data() {
    let output = LimitedOutput { written: Arc::default(), capacity: usize::MAX };
    let run = bounce(50);
    let mut engine = Engine::new(run.header.config.clone());
    let mut writer = Writer::new(output.clone(), &run.header).unwrap();
    for step in 0..20 {
        for event in run.events.iter().filter(|event| event.step == step) {
            engine.apply(&event.change.event());
            writer.write_event(event).unwrap();
        }
        writer.write_state(&engine).unwrap();
        engine.step(&mut CollisionCount::default()).unwrap();
    }
    drop(writer);
    let written = output.written.lock().unwrap().clone();
    let mut recording = Recording::read(Cursor::new(written)).unwrap();
    let states = recording.by_ref().filter(|item| matches!(item, Ok(Item::State(_)))).count();
    let Health::Incomplete(missing) = recording.health() else { panic!("{}", recording.health()) };
    assert_eq!((states, missing.to_string()), (20, "truncated after step 19 of 50".into()));
}

#[test]
fn an_event_that_was_not_recorded_is_an_error() {
    let run = drop_and_delete();
    let mut engine = Engine::new(run.header.config.clone());
    let Change::Spawn(_) = run.events[0].change else { panic!("the first event is a spawn") };
    engine.apply(&run.events[0].change.event());
    let mut writer = Writer::new(Vec::new(), &run.header).unwrap();
    let result = writer.write_state(&engine).and_then(|()| writer.finish(RunEnd::default()).map(drop));
    assert!(matches!(result, Err(Error::UnrecordedEvent { step: 0 })));
}
