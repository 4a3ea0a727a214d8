//! Recordings nobody wrote by accident, and outputs that fail.

use std::{
    io::{self, Cursor, Write},
    num::NonZero,
    sync::{Arc, Mutex},
};

use mcap::records::op;

use super::{
    Change, Error, Health, Item, Outcome, Playback, Recording, Versions, Writer, cdr,
    container::Container,
    limits, metadata,
    testing::{bounce, drop_and_delete, record},
    topic::Topic,
};
use crate::{
    physics::{CollisionCount, Engine},
    replay::replay,
};

/// Reads to the end: what was wrong, in words.
fn complaint(bytes: Vec<u8>) -> String {
    let mut recording = match Recording::read(Cursor::new(bytes)) {
        Ok(recording) => recording,
        Err(error) => return error.to_string(),
    };
    recording.by_ref().for_each(|item| drop(item.unwrap()));
    match recording.health() {
        Health::Corrupt(damage) => damage.what,
        Health::Whole | Health::Truncated { .. } => "nothing".into(),
    }
}

/// A recording whose only message is `bytes`.
fn with_message(topic: Topic, bytes: &[u8]) -> Vec<u8> {
    let header = drop_and_delete().header;
    let mut container = Container::new(Vec::new(), metadata::of_header(&header), &header.scene).unwrap();
    container.message(topic, 0, bytes).unwrap();
    container.flush().unwrap();
    container.finish(metadata::Map::new()).unwrap()
}

fn offset_of_first_chunk(bytes: &[u8]) -> usize {
    bytes.windows(8).position(|window| window == b"\x04\0\0\0zstd").unwrap() - 37
}

#[test]
fn a_chunk_of_100_gigabytes_is_refused() {
    let mut bytes = record(&drop_and_delete());
    let chunk = offset_of_first_chunk(&bytes);
    assert_eq!(bytes[chunk], op::CHUNK);
    bytes[chunk + 1..chunk + 9].copy_from_slice(&100_000_000_000_u64.to_le_bytes());
    assert_eq!(complaint(bytes), "record with opcode 06 length exceeds limit: `100000000000`");
}

#[test]
fn a_chunk_that_inflates_beyond_the_limit_is_refused() {
    let mut bytes = record(&drop_and_delete());
    let chunk = offset_of_first_chunk(&bytes);
    bytes[chunk + 25..chunk + 33].copy_from_slice(&(limits::RECORD_BYTES as u64 + 1).to_le_bytes());
    assert_eq!(complaint(bytes), format!("chunk (de)compressed length exceeds limit: `{}`", limits::RECORD_BYTES + 1));
}

#[test]
fn a_text_of_4_gigabytes_is_refused() {
    let mut bytes = record(&drop_and_delete());
    let name = bytes.windows(6).position(|window| window == b"rebond").unwrap();
    let metadata = name + bytes[name + 6..].windows(6).position(|window| window == b"rebond").unwrap() + 6;
    bytes[metadata - 4..metadata].copy_from_slice(&u32::MAX.to_le_bytes());
    assert_eq!(complaint(bytes), "the metadata is damaged");
}

#[test]
fn a_state_of_4_thousand_million_bodies_is_refused() {
    let mut message = cdr::HEADER.to_vec();
    message.extend([0; 16]);
    message.extend(u32::MAX.to_le_bytes());
    message.extend([0; 64]);
    assert_eq!(complaint(with_message(Topic::States, &message)), "the state is cut short");
}

#[test]
fn messages_that_go_on_or_contradict_themselves_are_refused() {
    let complaints = |bytes: &[u8]| complaint(with_message(Topic::States, bytes));
    let state = |id: Vec<u32>, x: Vec<f64>| {
        let state = super::RecordedState { id, y: x.clone(), vx: x.clone(), vy: x.clone(), x, ..Default::default() };
        let mut bytes = Vec::new();
        state.encode(&mut bytes);
        bytes
    };
    let mut longer = state(vec![], vec![]);
    longer.push(0);
    assert_eq!(complaints(&longer), "1 bytes follow the message");
    assert_eq!(complaints(b"\0\0\0\0"), "the message does not start as little-endian CDR");
    assert_eq!(complaints(&state(vec![1], vec![])), "state 0 has columns of different lengths");
    assert_eq!(complaints(&state(vec![2, 1], vec![0.0, 0.0])), "state 0 has ids out of order");
    assert_eq!(complaints(&state(vec![1], vec![0.0])), "state 0 has other bodies than the events made");
    assert_eq!(complaints(&state(vec![], vec![])), "state 0 does not fit its digest");
}

#[test]
fn a_newer_format_is_refused_by_its_number() {
    let mut run = drop_and_delete();
    run.header.versions.format = 99;
    let found = complaint(record(&run));
    assert_eq!(found, "the recording has format version 99, this rebond reads up to 2; read it with a newer rebond");
}

#[test]
fn other_semantics_are_shown_but_not_replayed() {
    let mut run = drop_and_delete();
    run.header.versions = Versions { semantics: 99, ..run.header.versions };
    let recording = || Recording::read(Cursor::new(record(&run))).unwrap();
    assert_eq!(Playback::new(recording()).count(), 13);
    let replayed = replay(recording(), 0..=u64::MAX, &mut CollisionCount::default(), &mut |_| {});
    assert!(matches!(replayed, Err(Error::OtherSemantics { found: 99 })));
}

/// An output that takes so many bytes and no more.
#[derive(Clone)]
struct Full {
    taken: Arc<Mutex<Vec<u8>>>,
    room: usize,
}

impl Write for Full {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let mut taken = self.taken.lock().unwrap();
        let count = bytes.len().min(self.room - taken.len());
        taken.extend_from_slice(&bytes[..count]);
        if count == 0 { Err(io::ErrorKind::StorageFull.into()) } else { Ok(count) }
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

/// Runs and records until something fails.
fn record_into(output: Full, processors: NonZero<usize>) -> Result<(), Error> {
    let run = bounce(50);
    let mut writer = Writer::on(processors, output, &run.header)?;
    let mut engine = Engine::new(run.header.settings.clone());
    for step in 0..=50 {
        for event in run.events.iter().filter(|event| event.step == step) {
            engine.apply(&event.change.event());
            writer.event(event)?;
        }
        writer.state(&engine)?;
        engine.step(&mut CollisionCount::default()).unwrap();
    }
    writer.finish(Outcome::default()).map(drop)
}

#[test]
fn a_full_disk_is_an_error_and_what_was_written_is_readable() {
    let [one, two] = [1, 2].map(|processors| NonZero::new(processors).unwrap());
    let whole = Full { taken: Arc::default(), room: usize::MAX };
    record_into(whole.clone(), two).unwrap();
    let total = whole.taken.lock().unwrap().len();
    let rooms = || (0..total).step_by(211).chain([total - 1]);
    for (room, processors) in rooms().map(|room| (room, one)).chain(rooms().map(|room| (room, two))) {
        let output = Full { taken: Arc::default(), room };
        let error = record_into(output.clone(), processors).expect_err("a full disk goes unnoticed");
        assert!(error.to_string().starts_with("the recording cannot be written: "), "{error}");
        let taken = output.taken.lock().unwrap().clone();
        assert_eq!(taken, whole.taken.lock().unwrap()[..room]);
    }
}

/// An output that remembers how much had come at each flush.
#[derive(Clone, Default)]
struct Flushed {
    taken: Arc<Mutex<(Vec<u8>, Vec<usize>)>>,
}

impl Write for Flushed {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.taken.lock().unwrap().0.extend_from_slice(bytes);
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        let mut taken = self.taken.lock().unwrap();
        let length = taken.0.len();
        taken.1.push(length);
        Ok(())
    }
}

#[test]
fn a_flush_follows_every_batch_of_events_and_every_second() {
    let run = bounce(50);
    let output = Flushed::default();
    let mut engine = Engine::new(run.header.settings.clone());
    let mut writer = Writer::new(output.clone(), &run.header).unwrap();
    for step in 0..=50 {
        for event in run.events.iter().filter(|event| event.step == step) {
            engine.apply(&event.change.event());
            writer.event(event).unwrap();
        }
        writer.state(&engine).unwrap();
        engine.step(&mut CollisionCount::default()).unwrap();
    }
    drop(writer);
    let mut due: Vec<u64> = run.events.iter().map(|event| event.step).chain([19, 39]).collect();
    due.sort_unstable();
    due.dedup();
    let (bytes, flushes) = output.taken.lock().unwrap().clone();
    let last_state = |length: &usize| {
        let recording = Recording::read(Cursor::new(&bytes[..*length])).unwrap();
        recording.filter_map(|item| if let Item::State(state) = item.unwrap() { Some(state.step) } else { None }).last()
    };
    let mut readable: Vec<u64> = flushes.iter().filter_map(last_state).collect();
    readable.dedup();
    assert_eq!(readable, due);
}

#[test]
fn a_writer_dropped_leaves_what_was_flushed() {
    let output = Full { taken: Arc::default(), room: usize::MAX };
    let run = bounce(50);
    let mut engine = Engine::new(run.header.settings.clone());
    let mut writer = Writer::new(output.clone(), &run.header).unwrap();
    for step in 0..20 {
        for event in run.events.iter().filter(|event| event.step == step) {
            engine.apply(&event.change.event());
            writer.event(event).unwrap();
        }
        writer.state(&engine).unwrap();
        engine.step(&mut CollisionCount::default()).unwrap();
    }
    drop(writer);
    let taken = output.taken.lock().unwrap().clone();
    let mut recording = Recording::read(Cursor::new(taken)).unwrap();
    let states = recording.by_ref().filter(|item| matches!(item, Ok(Item::State(_)))).count();
    assert_eq!((states, recording.health()), (20, Health::Truncated { after: Some(19) }));
}

#[test]
fn an_event_that_was_not_recorded_is_an_error() {
    let run = drop_and_delete();
    let mut engine = Engine::new(run.header.settings.clone());
    let Change::Spawn { .. } = run.events[0].change else { panic!("the first event is a spawn") };
    engine.apply(&run.events[0].change.event());
    let mut writer = Writer::new(Vec::new(), &run.header).unwrap();
    let result = writer.state(&engine).and_then(|()| writer.finish(Outcome::default()).map(drop));
    assert!(matches!(result, Err(Error::Unrecorded { step: 0 })));
}
