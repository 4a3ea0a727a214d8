//! Writing and reading together.

use std::{
    cell::Cell,
    collections::BTreeMap,
    io::{self, Cursor},
    num::NonZero,
};

use super::{
    Change, Damage, Error, Health, Item, Playback, RecordedEvent, Recording, Recovery, recover,
    testing::{body, bounce, drop_and_delete, record, record_on},
};
use crate::{
    physics::{CollisionCount, Engine, Rect, SolverKind, Spawn, Vector},
    replay::replay,
};

fn read(bytes: &[u8]) -> Result<Recording<Cursor<&[u8]>>, Error> {
    Recording::read(Cursor::new(bytes))
}

/// All items and the health of a recording whose head can be read.
fn items(bytes: &[u8]) -> (Vec<Item>, Health) {
    let mut recording = read(bytes).unwrap();
    let items = recording.by_ref().map(|item| item.unwrap()).collect();
    (items, recording.health())
}

fn states(items: &[Item]) -> Vec<u64> {
    items.iter().filter_map(|item| if let Item::State(state) = item { Some(state.step) } else { None }).collect()
}

#[test]
fn what_was_written_is_read() {
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
    let Some(Item::End(end)) = items.last() else { panic!("no end") };
    assert_eq!((end.steps, end.bodies, end.events, &end.error), (50, 7, 8, &None));
}

#[test]
fn the_same_run_gives_the_same_bytes() {
    assert_eq!(record(&bounce(50)), record(&bounce(50)));
}

#[test]
fn the_bytes_do_not_depend_on_the_processors() {
    let run = bounce(50);
    let [one, two] = [1, 2].map(|processors| record_on(NonZero::new(processors).unwrap(), &run));
    assert!(one == two, "a thread of its own writes other bytes");
}

/// So wide that every state is a batch, and a chunk is full before its second is.
#[test]
fn the_bytes_of_a_wide_recording_do_not_depend_on_the_processors() {
    let mut run = bounce(40);
    run.header.settings.solver = SolverKind::EventDriven;
    run.header.settings.gravity = None;
    let row = |id: u32| Spawn {
        rect: Rect::new(Vector::new(f64::from(id) * 2.0, 9.0), 1.0, 1.0),
        velocity: Vector::new(0.0, 1.0 / f64::from(id + 1)),
        ..body(&format!("#{id}"))
    };
    run.events = (0..8000)
        .map(|id| RecordedEvent { step: 0, change: Change::Spawn { id, spawn: row(id), color: None } })
        .collect();
    let [one, two, many] = [1, 2, 64].map(|processors| record_on(NonZero::new(processors).unwrap(), &run));
    assert!(one.len() > 2_000_000, "{} bytes are not many", one.len());
    assert!(one == two && one == many, "a thread of its own writes other bytes");
}

#[test]
fn playback_shows_every_state_of_the_engine() {
    let run = bounce(50);
    let bytes = record(&run);
    let frames: Vec<_> = Playback::new(read(&bytes).unwrap()).map(Result::unwrap).collect();
    let mut engine = Engine::new(run.header.settings.clone());
    for frame in &frames {
        for event in run.events.iter().filter(|event| event.step == frame.step) {
            engine.apply(&event.change.event());
        }
        let shown: Vec<_> = frame.bodies.iter().map(|body| (body.known.id, body.position, body.velocity)).collect();
        let there: Vec<_> =
            engine.world().bodies.iter().map(|body| (body.id, body.rect.origin, body.velocity)).collect();
        assert_eq!(shown, there);
        engine.step(&mut CollisionCount::default()).unwrap();
    }
    assert_eq!(frames.len(), 51);
}

#[test]
fn a_cut_anywhere_keeps_all_whole_chunks() {
    let bytes = record(&bounce(50));
    let (whole, _) = items(&bytes);
    let mut kept = 0;
    let mut table = Vec::new();
    for cut in 0..bytes.len() {
        if let Err(error) = read(&bytes[..cut]) {
            assert!(matches!(error, Error::CutHead), "cut at {cut}: {error}");
            assert_eq!(kept, 0, "cut at {cut} loses what was there before");
            note(&mut table, cut, error.to_string());
            continue;
        }
        let (part, health) = items(&bytes[..cut]);
        let after = states(&part).last().copied();
        assert_eq!(health, Health::Truncated { after }, "cut at {cut}");
        assert_eq!(part, whole[..part.len()], "cut at {cut}");
        assert!(part.len() >= kept, "cut at {cut} loses what was there before");
        kept = part.len();
        note(&mut table, cut, format!("{} states, truncated after {after:?}", states(&part).len()));
    }
    assert_eq!(kept, whole.len());
    print_runs(&table);
}

/// First and last place of each run of equal outcomes.
type Runs = Vec<(usize, usize, String)>;

fn note(table: &mut Runs, place: usize, outcome: String) {
    match table.last_mut() {
        Some((_, last, before)) if *before == outcome => *last = place,
        Some(_) | None => table.push((place, place, outcome)),
    }
}

fn print_runs(table: &Runs) {
    println!("\n{:>17}   what is read", "cut at bytes");
    for (first, last, outcome) in table {
        println!("{first:>7} to {last:>6}   {outcome}");
    }
}

#[test]
fn every_flipped_bit_is_noticed_and_costs_one_chunk_at_most() {
    const STATES_PER_CHUNK: usize = 4;
    let bytes = record(&drop_and_delete());
    let (whole, _) = items(&bytes);
    let mut table = BTreeMap::new();
    // Every bit where that takes seconds; without optimisation every 13th, each of a byte's in turn.
    let stride = if cfg!(debug_assertions) { 13 } else { 1 };
    for bit in (0..bytes.len() * 8).step_by(stride) {
        let mut flipped = bytes.clone();
        flipped[bit / 8] ^= 1 << (bit % 8);
        let (part, health) = items(&flipped);
        let Health::Corrupt(Damage { offset, what, .. }) = health else { panic!("bit {bit}: {health:?}") };
        assert!(offset <= bit as u64 / 8, "bit {bit} is blamed on byte {offset}");
        let kept = states(&part).len();
        assert!(kept + STATES_PER_CHUNK >= states(&whole).len(), "bit {bit} leaves {kept} states");
        for item in part.iter().filter(|item| !matches!(item, Item::Damaged(_))) {
            assert!(whole.contains(item), "bit {bit} invents {item:?}");
        }
        let (flips, least) = table.entry(without_numbers(&what)).or_insert((0, kept));
        (*flips, *least) = (*flips + 1, kept.min(*least));
    }
    println!("\n{:>7} {:>20}   noticed as", "flips", "states kept, of 13");
    table.iter().for_each(|(what, (flips, least))| println!("{flips:>7} {least:>17} up   {what}"));
}

/// What was found with its numbers left out, so that like goes with like.
fn without_numbers(what: &str) -> String {
    let start = |word: &str| word.trim_start_matches(['(', '`', '"']).to_owned();
    let is_word = |word: &&str| !start(word).starts_with(|c: char| c.is_ascii_digit() || c.is_ascii_uppercase());
    let (first, rest) = what.split_once(' ').unwrap_or((what, ""));
    std::iter::once(first).chain(rest.split(' ').filter(is_word)).take(8).collect::<Vec<_>>().join(" ")
}

#[test]
fn thinned_states_have_their_digest() {
    let mut run = bounce(50);
    run.header.every = 10;
    let (items, health) = items(&record(&run));
    assert_eq!(health, Health::Whole);
    let full = items.iter().filter(|item| matches!(item, Item::State(state) if !state.id.is_empty())).count();
    assert_eq!((states(&items).len(), full), (51, 6));
}

#[test]
fn seeking_equals_stepping_for_every_step_and_backwards_too() {
    let bytes = record(&bounce(50));
    let frames: Vec<_> = Playback::new(read(&bytes).unwrap()).map(Result::unwrap).collect();
    let cut = &bytes[..bytes.len() * 3 / 4];
    for (bytes, last) in [(bytes.as_slice(), 50), (cut, states(&items(cut).0).last().copied().unwrap())] {
        let mut playback = Playback::new(read(bytes).unwrap());
        for step in (0..=last).chain((0..=last).rev()) {
            playback.seek(step).unwrap();
            assert_eq!(playback.next().unwrap().unwrap(), frames[step as usize]);
        }
        playback.seek(last + 1).unwrap();
        assert!(playback.next().is_none());
    }
}

#[test]
fn seeking_reads_little() {
    let bytes = record(&bounce(2000));
    let mut recording = read(&bytes).unwrap();
    recording.seek(1990).unwrap();
    let (items, chunk) = (recording.by_ref().map(Result::unwrap).collect::<Vec<_>>(), recording.chunks());
    let Some(Item::Keyframe(keyframe)) = items.first() else { panic!("no keyframe first") };
    assert_eq!(keyframe.step, 1980);
    assert_eq!(states(&items), (1980..=2000).collect::<Vec<_>>());
    assert_eq!(recording.health(), Health::Whole);
    let mut whole = read(&bytes).unwrap();
    whole.by_ref().for_each(drop);
    assert_eq!(chunk, whole.chunks());
}

/// Counts what is read.
struct Counting<'a>(Cursor<&'a [u8]>, &'a Cell<usize>);

impl io::Read for Counting<'_> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let count = self.0.read(buffer)?;
        self.1.set(self.1.get() + count);
        Ok(count)
    }
}

impl io::Seek for Counting<'_> {
    fn seek(&mut self, to: io::SeekFrom) -> io::Result<u64> {
        self.0.seek(to)
    }
}

#[test]
fn the_outline_events_and_one_state_are_found_without_reading_the_rest() {
    let bytes = record(&bounce(20_000));
    let count = Cell::new(0);
    let mut recording = Recording::read(Counting(Cursor::new(&bytes), &count)).unwrap();
    let outline = recording.outline().unwrap().unwrap();
    let mut events = Vec::new();
    recording.events(|event| events.push(event)).unwrap();
    let mut playback = Playback::new(recording);
    playback.seek(9_999).unwrap();
    assert_eq!(playback.next().unwrap().unwrap().step, 9_999);
    assert!(count.get() < bytes.len() / 2, "{} of {} bytes were read", count.get(), bytes.len());
    assert_eq!(events, bounce(20_000).events);
    let all = items(&bytes).0;
    assert_eq!(Some(&Item::End(outline.end)), all.last());
    let keyframes = all.iter().filter(|item| matches!(item, Item::Keyframe(_))).count() as u64;
    assert_eq!((outline.states, outline.keyframes), (20_001, keyframes));
}

#[test]
fn an_unfinished_or_damaged_index_tells_no_outline_but_all_events() {
    let bytes = record(&bounce(50));
    let cut = &bytes[..bytes.len() - 20];
    let mut flipped = bytes.clone();
    flipped[bytes.len() - 60] ^= 1;
    for broken in [cut, &flipped] {
        let mut recording = read(broken).unwrap();
        assert_eq!(recording.outline().unwrap(), None);
        let mut events = Vec::new();
        recording.events(|event| events.push(event)).unwrap();
        assert_eq!(events, bounce(50).events);
        assert_eq!(recording.by_ref().next().unwrap().unwrap(), Item::Event(events[0].clone()), "it starts again");
    }
}

#[test]
fn a_recording_of_the_first_format_replays_and_recovers_to_itself() {
    for solver in [SolverKind::Handout, SolverKind::EventDriven] {
        let mut run = bounce(50);
        run.header.versions.format = 1;
        run.header.settings.solver = solver;
        let bytes = record(&run);
        assert_eq!(verdict(&bytes), "same: 50 steps, 7 bodies");
        let from = replay(read(&bytes).unwrap(), 45..=50, &mut CollisionCount::default(), &mut |_| {}).unwrap();
        assert_eq!(from.to_string(), "same: 5 steps, 7 bodies");
        assert!(recovered(&bytes).1 == bytes);
        let outline = read(&bytes).unwrap().outline().unwrap().unwrap();
        assert_eq!(outline.end.extremes, None);
    }
}

fn recovered(bytes: &[u8]) -> (Recovery, Vec<u8>) {
    recover(&mut read(bytes).unwrap(), Vec::new()).unwrap()
}

#[test]
fn a_whole_recording_recovers_to_itself() {
    let bytes = record(&bounce(50));
    let (recovery, again) = recovered(&bytes);
    assert!(again == bytes);
    assert_eq!(recovery.to_string(), "recovered 51 states up to step 50\nnothing was lost");
}

#[test]
fn a_cut_recording_recovers_to_a_whole_one_that_replays_the_same() {
    let bytes = record(&bounce(50));
    for cut in (0..bytes.len()).step_by(97).filter(|cut| read(&bytes[..*cut]).is_ok()) {
        let (recovery, fixed) = recovered(&bytes[..cut]);
        let (there, health) = items(&fixed);
        assert_eq!(health, Health::Whole, "cut at {cut}");
        let (left, _) = items(&bytes[..cut]);
        let without_end = |items: Vec<Item>| items.into_iter().filter(|item| !matches!(item, Item::End(_))).collect();
        let (there, left): (Vec<_>, Vec<_>) = (without_end(there), without_end(left));
        assert_eq!(there, left, "cut at {cut}");
        let after = recovery.end.steps;
        assert_eq!(verdict(&fixed), format!("same: {after} steps, {} bodies", recovery.end.bodies));
    }
}

#[test]
fn a_damaged_recording_recovers_with_a_gap_and_replays_the_same() {
    let bytes = record(&bounce(100));
    for place in (0..bytes.len()).step_by(101) {
        let mut damaged = bytes.clone();
        damaged[place] ^= 0x10;
        let (recovery, fixed) = recovered(&damaged);
        let (there, health) = items(&fixed);
        assert_eq!(health, Health::Whole, "byte {place}");
        assert_eq!(states(&there), states(&items(&damaged).0), "byte {place}");
        assert!(verdict(&fixed).starts_with("same: "), "byte {place}: {}", verdict(&fixed));
        let missing: u64 = recovery.gaps.iter().map(|gap| gap.missing_states()).sum();
        let tail = 100 - recovery.end.steps;
        assert_eq!(recovery.states + missing + tail, 101, "byte {place}: {recovery}");
        assert!(recovered(&fixed).1 == fixed, "byte {place}: recovering twice changes something");
    }
}

fn verdict(bytes: &[u8]) -> String {
    replay(read(bytes).unwrap(), 0..=u64::MAX, &mut CollisionCount::default(), &mut |_| {}).unwrap().to_string()
}

#[test]
fn a_large_recording_cut_anywhere_keeps_all_whole_chunks() {
    let bytes = record(&bounce(1500));
    let (whole, _) = items(&bytes);
    let mut table = Vec::new();
    for cut in (0..bytes.len()).step_by(997).filter(|cut| read(&bytes[..*cut]).is_ok()) {
        let (part, health) = items(&bytes[..cut]);
        let after = states(&part).last().copied();
        assert_eq!(health, Health::Truncated { after }, "cut at {cut}");
        assert_eq!(part, whole[..part.len()], "cut at {cut}");
        note(&mut table, cut, format!("{} states, truncated after {after:?}", states(&part).len()));
    }
    print_runs(&table);
}
