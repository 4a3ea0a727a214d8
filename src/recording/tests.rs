//! Tests of writing and reading together.

use std::{
    cell::Cell,
    collections::BTreeMap,
    io::{self, Cursor},
    num::NonZero,
    ops::RangeInclusive,
};

use mcap::{MAGIC, records::op};

use super::{
    BodyInfo, Change, Damage, Error, Gap, Health, Item, MissingEnd, Playback, RecordedEvent, RecordedState, Recording,
    Recovery,
    chunk_reader::{ChunkReader, RawMessage},
    record_reader::{PREFIX_BYTES, RecordHeader, RecordReader},
    recover,
    testing::{body, bounce, drop_and_delete, record, record_altered, record_in_small_chunks, record_with_processors},
};
use crate::{
    physics::{CollisionCount, Engine, Rect, SolverKind, Spawn, Vector},
    replay::{ALL_STEPS, Replayer},
    text::counted,
};

fn read(bytes: &[u8]) -> Result<Recording<Cursor<&[u8]>>, Error> {
    Recording::read(Cursor::new(bytes))
}

/// Returns all items and the health of a recording whose header is readable.
fn items(bytes: &[u8]) -> (Vec<Item>, Health) {
    let mut recording = read(bytes).unwrap();
    let items = recording.by_ref().map(|item| item.unwrap()).collect();
    (items, recording.health())
}

/// Returns the end of a recording that was cut, or the condition if it was not.
fn cut_end(health: &Health) -> Result<MissingEnd, &Health> {
    health.missing().and_then(|missing| missing.end).filter(|end| end.is_cut && health.damage().is_none()).ok_or(health)
}

fn states(items: &[Item]) -> Vec<u64> {
    items.iter().filter_map(|item| if let Item::State(state) = item { Some(state.step) } else { None }).collect()
}

#[test]
fn reading_inverts_writing() {
    let run = bounce(50);
    let bytes = record(&run);
    let recording = read(&bytes).unwrap();
    assert_eq!(recording.header, run.header);
    let (items, health) = items(&bytes);
    assert_eq!(health, Health::Whole);
    assert_eq!(states(&items), (0..=50).collect::<Vec<_>>());
    let events: Vec<_> = items
        .iter()
        .filter_map(|item| if let Item::Event(event) = item { Some(event.clone()) } else { None })
        .collect();
    assert_eq!(events, run.events);
    let Some(Item::Trailer(trailer)) = items.last() else { panic!("no end record") };
    assert_eq!((trailer.steps, trailer.bodies, trailer.events, &trailer.error), (50, 7, 8, &None));
}

#[test]
fn the_same_run_gives_the_same_bytes() {
    assert_eq!(record(&bounce(50)), record(&bounce(50)));
}

#[test]
fn the_bytes_do_not_depend_on_the_number_of_processors() {
    let run = bounce(50);
    let [one, two] = [1, 2].map(|processors| record_with_processors(NonZero::new(processors).unwrap(), &run));
    assert!(one == two, "the writer thread writes different bytes");
}

/// The run has so many bodies that every state is a batch of its own, and a chunk is full in less than one
/// simulated second.
#[test]
fn the_bytes_of_a_large_recording_do_not_depend_on_the_number_of_processors() {
    let mut run = bounce(40);
    run.header.config.solver = SolverKind::EventDriven;
    run.header.config.gravity = None;
    let row = |id: u32| Spawn {
        rect: Rect::new(Vector::new(f64::from(id) * 2.0, 9.0), 1.0, 1.0),
        velocity: Vector::new(0.0, 1.0 / f64::from(id + 1)),
        ..body(&format!("#{id}"))
    };
    run.events = (0..8000)
        .map(|id| RecordedEvent { step: 0, change: Change::Spawn(BodyInfo::new(id, row(id)).into()) })
        .collect();
    let [one, two, many] = [1, 2, 64].map(|processors| record_with_processors(NonZero::new(processors).unwrap(), &run));
    assert!(one.len() > 2_000_000, "only {} bytes", one.len());
    assert!(one == two && one == many, "the writer thread writes different bytes");
}

#[test]
fn playback_returns_every_state_of_the_engine() {
    let run = bounce(50);
    let bytes = record(&run);
    let samples: Vec<_> = Playback::new(read(&bytes).unwrap()).map(Result::unwrap).collect();
    let mut engine = Engine::new(run.header.config.clone());
    for sample in &samples {
        for event in run.events.iter().filter(|event| event.step == sample.step) {
            engine.apply(&event.change.event());
        }
        let recorded: Vec<_> = sample.bodies.iter().map(|body| (body.info.id, body.position, body.velocity)).collect();
        let expected: Vec<_> =
            engine.world().bodies.iter().map(|body| (body.id, body.rect.origin, body.velocity)).collect();
        assert_eq!(recorded, expected);
        engine.step(&mut CollisionCount::default()).unwrap();
    }
    assert_eq!(samples.len(), 51);
}

#[test]
fn a_cut_recording_keeps_all_complete_chunks() {
    let bytes = record(&bounce(50));
    let (complete, _) = items(&bytes);
    let mut kept = 0;
    let mut table = Vec::new();
    // In debug builds every 11th cut, and all of the last chunk and the index.
    let is_tried = |cut: usize| !cfg!(debug_assertions) || cut.is_multiple_of(11) || cut + 500 > bytes.len();
    for cut in (0..bytes.len()).filter(|cut| is_tried(*cut)) {
        if let Err(error) = read(&bytes[..cut]) {
            assert!(matches!(error, Error::TruncatedHeader), "cut at {cut}: {error}");
            assert_eq!(kept, 0, "cut at {cut} loses items of a shorter part");
            add_result(&mut table, cut, error.to_string());
            continue;
        }
        let (part, health) = items(&bytes[..cut]);
        let after = states(&part).last().copied();
        assert_eq!(cut_end(&health).unwrap().after, after, "cut at {cut}");
        assert_eq!(part, complete[..part.len()], "cut at {cut}");
        assert!(part.len() >= kept, "cut at {cut} loses items of a shorter part");
        kept = part.len();
        add_result(&mut table, cut, format!("{} states, truncated after {after:?}", states(&part).len()));
    }
    assert_eq!(kept, complete.len());
    print_results(&table);
}

/// The first and last offset of each range of cuts with the same result.
type ResultRanges = Vec<(usize, usize, String)>;

fn add_result(table: &mut ResultRanges, offset: usize, result: String) {
    match table.last_mut() {
        Some((_, last, previous)) if *previous == result => *last = offset,
        Some(_) | None => table.push((offset, offset, result)),
    }
}

fn print_results(table: &ResultRanges) {
    println!("\n{:>17}   result", "cut at bytes");
    for (first, last, result) in table {
        println!("{first:>7} to {last:>6}   {result}");
    }
}

#[test]
fn every_flipped_bit_is_detected_and_costs_at_most_one_chunk() {
    const STATES_PER_CHUNK: usize = 4;
    let bytes = record(&drop_and_delete());
    let (complete, _) = items(&bytes);
    let mut table = BTreeMap::new();
    // In release builds every bit. Otherwise every 29th, which covers all bit positions within a byte.
    let stride = if cfg!(debug_assertions) { 29 } else { 1 };
    for bit in (0..bytes.len() * 8).step_by(stride) {
        let mut flipped = bytes.clone();
        flipped[bit / 8] ^= 1 << (bit % 8);
        let (part, health) = items(&flipped);
        let Health::Corrupt { damage: Damage { offset, reason, .. }, .. } = health else {
            panic!("bit {bit}: {health:?}")
        };
        assert!(offset <= bit as u64 / 8, "the damage of bit {bit} is located at byte {offset}: {reason}");
        let kept = states(&part).len();
        assert!(kept + STATES_PER_CHUNK >= states(&complete).len(), "bit {bit} leaves {kept} states");
        for item in part.iter().filter(|item| !matches!(item, Item::Damaged(_))) {
            assert!(complete.contains(item), "bit {bit} creates {item:?}");
        }
        let (flips, least) = table.entry(without_numbers(&reason)).or_insert((0, kept));
        (*flips, *least) = (*flips + 1, kept.min(*least));
    }
    println!("\n{:>7} {:>20}   reason", "flips", "states kept, of 13");
    table.iter().for_each(|(reason, (flips, least))| println!("{flips:>7} {least:>17} up   {reason}"));
}

/// Writes the records of all chunks outside of chunks, without checksums, index and summary.
fn without_chunks(bytes: &[u8]) -> Vec<u8> {
    fn push(file: &mut Vec<u8>, opcode: u8, body: &[u8]) {
        file.push(opcode);
        file.extend_from_slice(&(body.len() as u64).to_le_bytes());
        file.extend_from_slice(body);
    }
    let (mut file, mut chunks) = (MAGIC.to_vec(), ChunkReader::new());
    let mut records = RecordReader::new(Cursor::new(bytes)).unwrap();
    while let Some(RecordHeader { offset, opcode }) = records.next_record().unwrap() {
        match opcode {
            op::CHUNK => {
                chunks.open(offset, &records.body).unwrap();
                while let Some(record) = chunks.next_record().unwrap() {
                    push(&mut file, record.opcode, record.body);
                }
            }
            op::MESSAGE_INDEX => {}
            op::DATA_END => break,
            _ => push(&mut file, opcode, &records.body),
        }
    }
    push(&mut file, op::DATA_END, &[0; 4]);
    push(&mut file, op::FOOTER, &[0; 20]);
    file.extend_from_slice(MAGIC);
    file
}

/// Outside of chunks, only opcode and length of a record have no check of their own that finds where the next one
/// starts.
#[test]
fn a_flipped_bit_before_a_message_outside_of_chunks_costs_the_states_up_to_the_next_keyframe() {
    const STEPS: u64 = 70;
    const STEPS_PER_KEYFRAME: u64 = 20;
    let bytes = without_chunks(&record(&bounce(STEPS)));
    let (complete, health) = items(&bytes);
    assert_eq!((states(&complete).len(), health), (STEPS as usize + 1, Health::Whole));
    let mut records = RecordReader::new(Cursor::new(&bytes)).unwrap();
    let mut tried = 0;
    // In release builds every bit.
    let stride = if cfg!(debug_assertions) { 7 } else { 1 };
    while let Some(record) = records.next_record().unwrap() {
        if record.opcode != op::MESSAGE {
            continue;
        }
        let message = RawMessage::parse(&records.body).unwrap();
        let step = message.log_time * 20 / 1_000_000_000;
        for bit in (step as usize % stride..8 * PREFIX_BYTES).step_by(stride) {
            let mut flipped = bytes.clone();
            flipped[record.offset as usize + bit / 8] ^= 1 << (bit % 8);
            let (part, health) = items(&flipped);
            let what = format!("bit {bit} of byte {} in step {step}", record.offset);
            assert!(health.damage().is_some(), "{what}: {health:?}");
            let kept = states(&part);
            let next_keyframe = (step + 1).next_multiple_of(STEPS_PER_KEYFRAME);
            let lost =
                (0..=STEPS).filter(|step| !kept.contains(step)).find(|lost| *lost < step || *lost >= next_keyframe);
            assert_eq!(lost, None, "{what}: {kept:?}, {health:?}");
            for item in part.iter().filter(|item| !matches!(item, Item::Damaged(_) | Item::Gap(_))) {
                assert!(complete.contains(item), "{what} creates {item:?}");
            }
            tried += 1;
        }
    }
    assert!(tried * stride as u64 > 71 * STEPS, "{tried} bits");
}

/// Removes the numbers from a reason, so that equal kinds of damage are counted together.
fn without_numbers(reason: &str) -> String {
    let start = |word: &str| word.trim_start_matches(['(', '`', '"']).to_owned();
    let is_word = |word: &&str| !start(word).starts_with(|c: char| c.is_ascii_digit() || c.is_ascii_uppercase());
    let (first, rest) = reason.split_once(' ').unwrap_or((reason, ""));
    std::iter::once(first).chain(rest.split(' ').filter(is_word)).take(8).collect::<Vec<_>>().join(" ")
}

#[test]
fn thinned_out_states_have_digests() {
    let mut run = bounce(50);
    run.header.every = 10;
    let (items, health) = items(&record(&run));
    assert_eq!(health, Health::Whole);
    let full_states = items.iter().filter(|item| matches!(item, Item::State(state) if !state.id.is_empty())).count();
    assert_eq!((states(&items).len(), full_states), (51, 6));
}

#[test]
fn seeking_equals_stepping_forwards_and_backwards() {
    let bytes = record(&bounce(50));
    let samples: Vec<_> = Playback::new(read(&bytes).unwrap()).map(Result::unwrap).collect();
    let cut = &bytes[..bytes.len() * 3 / 4];
    for (bytes, last) in [(bytes.as_slice(), 50), (cut, states(&items(cut).0).last().copied().unwrap())] {
        let mut playback = Playback::new(read(bytes).unwrap());
        for step in (0..=last).chain((0..=last).rev()) {
            playback.seek(step).unwrap();
            assert_eq!(playback.next().unwrap().unwrap(), samples[step as usize]);
        }
        playback.seek(last + 1).unwrap();
        assert!(playback.next().is_none());
    }
}

#[test]
fn seeking_reads_only_from_the_last_keyframe() {
    let bytes = record(&bounce(2000));
    let mut recording = read(&bytes).unwrap();
    recording.seek(1990).unwrap();
    let (items, chunk) = (recording.by_ref().map(Result::unwrap).collect::<Vec<_>>(), recording.chunk_count());
    let Some(Item::Keyframe(keyframe)) = items.first() else { panic!("the first item is not a keyframe") };
    assert_eq!(keyframe.step, 1980);
    assert_eq!(states(&items), (1980..=2000).collect::<Vec<_>>());
    assert_eq!(recording.health(), Health::Whole);
    let mut complete = read(&bytes).unwrap();
    complete.by_ref().for_each(drop);
    assert_eq!(chunk, complete.chunk_count());
}

/// A source that counts the bytes read.
struct CountingSource<'a>(Cursor<&'a [u8]>, &'a Cell<usize>);

impl io::Read for CountingSource<'_> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let count = self.0.read(buffer)?;
        self.1.set(self.1.get() + count);
        Ok(count)
    }
}

impl io::Seek for CountingSource<'_> {
    fn seek(&mut self, to: io::SeekFrom) -> io::Result<u64> {
        self.0.seek(to)
    }
}

#[test]
fn the_summary_events_and_one_state_are_found_without_reading_the_rest() {
    let bytes = record(&bounce(40_000));
    let count = Cell::new(0);
    let mut recording = Recording::read(CountingSource(Cursor::new(&bytes), &count)).unwrap();
    let summary = recording.summary().unwrap().unwrap();
    let mut events = Vec::new();
    let add = |item| events.extend(if let Item::Event(event) = item { Some(event) } else { None });
    recording.for_each_event(add).unwrap();
    let mut playback = Playback::new(recording);
    playback.seek(19_999).unwrap();
    assert_eq!(playback.next().unwrap().unwrap().step, 19_999);
    assert!(count.get() < bytes.len() / 2, "{} of {} bytes were read", count.get(), bytes.len());
    assert_eq!(events, bounce(40_000).events);
    let all = items(&bytes).0;
    assert_eq!(Some(&Item::Trailer(summary.trailer)), all.last());
    let keyframes = all.iter().filter(|item| matches!(item, Item::Keyframe(_))).count() as u64;
    assert_eq!((summary.states, summary.keyframes), (40_001, keyframes));
}

/// A file that was cut has no index of the chunks that contain keyframes.
#[test]
fn many_chunks_without_keyframes_are_searched_once() {
    const STEPS: u64 = 1000;
    let bytes = record_in_small_chunks(&bounce(STEPS));
    let offset = bytes.windows(8).rposition(|window| window == b"\x04\0\0\0zstd").unwrap();
    for file in [&bytes, &bytes[..offset]] {
        let count = Cell::new(0);
        let mut playback = Playback::new(Recording::read(CountingSource(Cursor::new(file), &count)).unwrap());
        playback.seek(STEPS - 2).unwrap();
        assert_eq!(playback.next().unwrap().unwrap().step, STEPS - 2);
        let limit = 4 * file.len() + STEPS as usize * (4 << 10);
        assert!(count.get() < limit, "{} of {} bytes were read", count.get(), file.len());
    }
}

/// Each nine zeros are a record of length 0. A disk that lost power leaves such tails.
#[test]
fn zeros_are_searched_once_and_reported_in_a_few_places() {
    let recording = record(&bounce(50));
    let half = &recording[..recording.len() / 2];
    let zeros = vec![0; 1 << 20];
    for start in [&[][..], b"\x89MCAP0\r\n", half] {
        let bytes = [start, &zeros].concat();
        let count = Cell::new(0);
        let read = Recording::read(CountingSource(Cursor::new(&bytes), &count));
        let Ok(mut recording) = read else {
            assert!(start.len() < half.len() && count.get() < 10 * bytes.len(), "{} bytes were read", count.get());
            continue;
        };
        let damaged = recording.by_ref().filter(|item| matches!(item, Ok(Item::Damaged(_)))).count();
        assert!(damaged <= 3 && count.get() < 10 * bytes.len(), "{damaged} places, {} bytes were read", count.get());
        assert_eq!(recording.health().word(), "corrupt");
        let kept = recover(&mut recording, Vec::new()).unwrap().0.states;
        assert_eq!(kept, states(&items(half).0).len() as u64);
    }
}

#[test]
fn a_recording_with_a_missing_or_damaged_index_has_no_summary_but_all_events() {
    let bytes = record(&bounce(50));
    let cut = &bytes[..bytes.len() - 20];
    let mut flipped = bytes.clone();
    flipped[bytes.len() - 60] ^= 1;
    for damaged in [cut, &flipped] {
        let mut recording = read(damaged).unwrap();
        assert_eq!(recording.summary().unwrap(), None);
        let mut events = Vec::new();
        let add = |item| events.extend(if let Item::Event(event) = item { Some(event) } else { None });
        recording.for_each_event(add).unwrap();
        assert_eq!(events, bounce(50).events);
        assert_eq!(
            recording.by_ref().next().unwrap().unwrap(),
            Item::Event(events[0].clone()),
            "reading continues at the start"
        );
    }
}

#[test]
fn a_recording_of_the_first_format_replays_and_recovers_to_itself() {
    for solver in [SolverKind::Handout, SolverKind::EventDriven] {
        let mut run = bounce(50);
        run.header.versions.format = 1;
        run.header.config.solver = solver;
        let bytes = record(&run);
        assert_eq!(verdict(&bytes), "same: 50 steps, 7 bodies");
        assert_eq!(verdict_of(&bytes, 45..=50), "same: 5 steps, 7 bodies");
        assert!(recovered(&bytes).1 == bytes);
        let summary = read(&bytes).unwrap().summary().unwrap().unwrap();
        assert_eq!(summary.trailer.state_bounds, None);
    }
}

fn recovered(bytes: &[u8]) -> (Recovery, Vec<u8>) {
    recover(&mut read(bytes).unwrap(), Vec::new()).unwrap()
}

#[test]
fn a_complete_recording_recovers_to_itself() {
    let bytes = record(&bounce(50));
    let (recovery, recovered) = recovered(&bytes);
    assert!(recovered == bytes);
    assert_eq!(
        recovery.to_string(),
        "recovered 51 states up to step 50\nnothing was lost; the states were read, not replayed"
    );
}

#[test]
fn a_cut_recording_recovers_to_a_complete_one_that_replays_the_same() {
    let bytes = record(&bounce(50));
    for cut in (0..bytes.len()).step_by(97).filter(|cut| read(&bytes[..*cut]).is_ok()) {
        let (expected, _) = items(&bytes[..cut]);
        if states(&expected).is_empty() {
            let refused = recover(&mut read(&bytes[..cut]).unwrap(), Vec::new());
            assert!(matches!(refused, Err(Error::NothingToRecover { damage: None })), "cut at {cut}");
            continue;
        }
        let (recovery, fixed) = recovered(&bytes[..cut]);
        let (found, health) = items(&fixed);
        let missing = health.missing().filter(|missing| missing.recovered && health.damage().is_none());
        let missing = missing.unwrap_or_else(|| panic!("cut at {cut}: {health}"));
        assert_eq!(missing.end.map_or(50, |end| end.after.unwrap()), recovery.trailer.steps, "cut at {cut}");
        let without_trailer =
            |items: Vec<Item>| items.into_iter().filter(|item| !matches!(item, Item::Trailer(_))).collect();
        let (found, expected): (Vec<_>, Vec<_>) = (without_trailer(found), without_trailer(expected));
        assert_eq!(found, expected, "cut at {cut}");
        let steps = counted(recovery.trailer.steps, "step");
        assert_eq!(verdict(&fixed), format!("incomplete: {missing}; {steps} same"));
    }
}

/// Values or digest of a state are altered, with correct checksums. The keyframes are at the steps 20 and 40.
#[test]
fn an_altered_state_is_computed_again_or_lost_up_to_the_next_keyframe() {
    let run = bounce(50);
    let position: fn(&mut RecordedState) = |state| state.x[0] += 1e-3;
    let digest: fn(&mut RecordedState) = |state| state.digest ^= 1;
    let both: fn(&mut RecordedState) = |state| (state.x[0], state.digest) = (9.0, 9);
    for (alter, lost) in [(position, 0), (digest, 0), (both, 9)] {
        let altered = record_altered(&run, |state| {
            if state.step == 31 {
                alter(state)
            }
        });
        let (recovery, fixed) = recovered(&altered);
        assert_eq!((recovery.states, recovery.restored), (51 - lost, u64::from(lost == 0)), "{recovery}");
        assert_eq!(recovery.gaps.len(), usize::from(lost > 0), "{recovery}");
        let verdict = verdict(&fixed);
        assert!(verdict.starts_with("incomplete: recovered"), "{verdict}");
        assert!(lost > 0 || states_of(&fixed) == states_of(&record(&run)), "{recovery}");
    }
}

fn states_of(bytes: &[u8]) -> Vec<RecordedState> {
    let items = items(bytes).0.into_iter();
    items.filter_map(|item| if let Item::State(state) = item { Some(state) } else { None }).collect()
}

/// The steps of the states whose bodies are known.
fn usable_states(bytes: &[u8]) -> Vec<u64> {
    let mut recording = read(bytes).unwrap();
    let mut steps = Vec::new();
    while let Some(item) = recording.next() {
        if let (Item::State(state), Some(_)) = (item.unwrap(), recording.table()) {
            steps.push(state.step);
        }
    }
    steps
}

#[test]
fn a_damaged_recording_recovers_with_a_gap_and_replays_the_same() {
    let bytes = record(&bounce(100));
    for offset in (0..bytes.len()).step_by(101) {
        let mut damaged = bytes.clone();
        damaged[offset] ^= 0x10;
        let (recovery, fixed) = recovered(&damaged);
        let (found, health) = items(&fixed);
        assert!(health.missing().is_some_and(|missing| missing.recovered), "byte {offset}: {health}");
        assert_eq!(states(&found), usable_states(&damaged), "byte {offset}");
        let verdict = verdict(&fixed);
        assert!(verdict.starts_with("incomplete: recovered"), "byte {offset}: {verdict}");
        for Gap { after, before } in &recovery.gaps {
            let first = after.map_or(0, |after| after + 1);
            assert!(
                *before <= first + 1 || verdict.contains(&format!("steps {first} to {} are", before - 1)),
                "{verdict}"
            );
        }
        let missing: u64 = recovery.gaps.iter().map(|gap| gap.missing_states()).sum();
        let tail = 100 - recovery.trailer.steps;
        assert_eq!(recovery.states + missing + tail, 101, "byte {offset}: {recovery}");
        assert!(recovered(&fixed).1 == fixed, "byte {offset}: recovering twice changes the recording");
    }
}

fn verdict(bytes: &[u8]) -> String {
    verdict_of(bytes, ALL_STEPS)
}

fn verdict_of(bytes: &[u8], steps: RangeInclusive<u64>) -> String {
    let replayer = Replayer::new(read(bytes).unwrap(), steps).unwrap();
    replayer.run(&mut CollisionCount::default(), |_| ()).unwrap().to_string()
}

#[test]
fn a_cut_large_recording_keeps_all_complete_chunks() {
    let bytes = record(&bounce(1500));
    let (complete, _) = items(&bytes);
    let mut table = Vec::new();
    for cut in (0..bytes.len()).step_by(997).filter(|cut| read(&bytes[..*cut]).is_ok()) {
        let (part, health) = items(&bytes[..cut]);
        let after = states(&part).last().copied();
        assert_eq!(cut_end(&health).unwrap().after, after, "cut at {cut}");
        assert_eq!(part, complete[..part.len()], "cut at {cut}");
        add_result(&mut table, cut, format!("{} states, truncated after {after:?}", states(&part).len()));
    }
    print_results(&table);
}
