//! Files whose lengths lie, or that inflate to much more than they are.
//!
//! `cargo test --release hostile -- --nocapture` prints what each of them costs.

use crate::rebond::Workplace;
use std::{
    fs,
    io::{Read, Write},
    process::Command,
    thread,
    time::Duration,
};

/// What reading any of them may take, bytes.
const MOST: u64 = 100_000_000;

/// The largest chunk there may be, and the largest message in it.
const CHUNK: usize = rebond::recording::limits::RECORD_BYTES;
const MESSAGE: usize = rebond::recording::limits::MESSAGE_BYTES;

/// Places of our topics in the list of channels.
const EVENTS: u16 = 1;
const STATES: u16 = 2;
const BODIES: u16 = 3;

fn record(opcode: u8, body: &[u8]) -> Vec<u8> {
    [&[opcode], &(body.len() as u64).to_le_bytes() as &[u8], body].concat()
}

/// A chunk that says it inflates to `declared` bytes.
fn chunk_saying(declared: usize, records: &[u8]) -> Vec<u8> {
    let data = zstd::bulk::compress(records, 1).unwrap();
    let checksum = crc32fast::hash(records).to_le_bytes();
    let sizes = [&[0; 16], &(declared as u64).to_le_bytes() as &[u8], &checksum].concat();
    let name = b"\x04\0\0\0zstd";
    record(6, &[&sizes, &name[..], &(data.len() as u64).to_le_bytes(), &data].concat())
}

fn chunk(records: &[u8]) -> Vec<u8> {
    chunk_saying(records.len(), records)
}

/// A message whose first numbers are those and whose rest is zeros.
fn message(channel: u16, length: usize, start: &[&[u8]]) -> Vec<u8> {
    let mut data = [&channel.to_le_bytes() as &[u8], &[0; 20], &[0, 1, 0, 0], &start.concat()].concat();
    data.resize(22 + length, 0);
    record(5, &data)
}

/// What stands in a recording of ours before its first chunk.
fn head() -> Vec<u8> {
    let workplace = Workplace::with_scene(include_str!("../readers/viewer.toml"));
    workplace.done("record scene.toml -o run.mcap --steps 1");
    let whole = workplace.read("run.mcap");
    let first = whole.windows(8).position(|window| window == b"\x04\0\0\0zstd").unwrap() - 37;
    whole[..first].to_vec()
}

fn of_length(length: u64) -> Vec<u8> {
    [&[6], &length.to_le_bytes() as &[u8], &[0; 100]].concat()
}

/// Name, what follows the head, and what is to be said of it.
fn hostile() -> Vec<(&'static str, Vec<u8>, &'static str)> {
    let many = u32::MAX.to_le_bytes();
    let crowd = keyframe_of(190_000);
    let bodies = |bytes_each: usize| ((MESSAGE / bytes_each) as u32).to_le_bytes();
    vec![
        ("a chunk of 100 GB", of_length(100_000_000_000), "length exceeds limit"),
        ("a chunk of 2^64 bytes", of_length(u64::MAX), "length exceeds limit"),
        ("a chunk that inflates to 100 GB", chunk_saying(100_000_000_000, &[0; 9]), "length exceeds limit"),
        ("a chunk that inflates to more than it says", chunk_saying(1000, &vec![0; 1 << 30]), "corrupt chunk 1"),
        ("a chunk that inflates to less than it says", chunk_saying(CHUNK, &[0; 9]), "corrupt chunk 1"),
        ("the largest chunk, of one record", chunk(&record(0, &vec![0; CHUNK - 9])), "does not belong into a chunk"),
        ("2^32 bodies", chunk(&message(STATES, 100, &[&[0; 16], &many])), "the state is cut short"),
        ("bodies that are zero", chunk(&message(STATES, MESSAGE, &[&[0; 16], &bodies(36)])), "state"),
        ("one long column", chunk(&message(STATES, MESSAGE, &[&[0; 20], &bodies(8)])), "state"),
        ("a text of 4 GB", chunk(&message(EVENTS, 100, &[&[0; 8], &[1, 0, 0, 0, 0, 0, 0, 0], &many])), "not CDR"),
        ("a long text", chunk(&message(EVENTS, MESSAGE, &[&[0; 8], &[1, 0, 0, 0, 0, 0, 0, 0], &bodies(2)])), "bytes"),
        ("2^32 spawns", chunk(&message(EVENTS, 100, &[&[0; 8], &many])), "not CDR"),
        ("a keyframe of 2^32 bodies", chunk(&message(BODIES, 100, &[&[0; 12], &many])), "not CDR"),
        ("a keyframe of bodies never spawned", chunk(&message(BODIES, crowd.len() + 4, &[&crowd])), "other bodies"),
        ("a keyframe of zeros", chunk(&message(BODIES, 28 << 20, &[&[0; 12], &bodies(128)])), "corrupt chunk 1"),
    ]
}

/// A keyframe that could be one, of so many bodies without a name at one place.
fn keyframe_of(bodies: u32) -> Vec<u8> {
    let mut data = [&0_u64.to_le_bytes() as &[u8], &bodies.to_le_bytes(), &bodies.to_le_bytes()].concat();
    let numbers: [f64; 9] = [1.0, 1.0, 1.0, 1.0, 1.0, 0.0, 0.0, 0.0, 0.0];
    let no_text = [1, 0, 0, 0, 0, 0, 0, 0];
    for id in 0..bodies {
        data.extend([id.to_le_bytes(), [1, 0, 0, 0], [0; 4], [0; 4]].concat());
        data.extend(numbers.iter().flat_map(|number| number.to_le_bytes()));
        data.extend([no_text, no_text].concat());
    }
    for number in [1.0_f64, 1.0, 0.0, 0.0, 0.0, 0.0] {
        data.extend([bodies, 0].map(u32::to_le_bytes).concat());
        data.extend(number.to_le_bytes().repeat(bodies as usize));
    }
    data.extend([0; 8]);
    data
}

#[test]
fn hostile_lengths_are_refused_for_little_memory() {
    let head = head();
    let workplace = Workplace::new();
    println!("\n{:>9} {:>9}   what it is: what is said", "file, B", "peak, MB");
    for (what, rest, expected) in hostile() {
        let file = [head.as_slice(), &rest].concat();
        fs::write(workplace.path("hostile.mcap"), &file).unwrap();
        let (said, peak) = replay(&workplace);
        assert!(said.contains(expected), "{what}: {said}");
        println!("{:>9} {:>9.1}   {what}: {}", file.len(), peak as f64 / 1e6, said.trim());
        assert!(peak < MOST, "{what} takes {peak} bytes");
    }
}

/// What `replay` says of the file, and the most memory it took, bytes.
///
/// Its output is a pipe that is full, so that it waits there until it has been measured.
fn replay(workplace: &Workplace) -> (String, u64) {
    const PIPE: usize = 65536;
    let (mut reader, mut writer) = std::io::pipe().unwrap();
    writer.write_all(&[b' '; PIPE]).unwrap();
    let mut child = Command::new(env!("CARGO_BIN_EXE_rebond"))
        .args(["replay", "hostile.mcap"])
        .current_dir(workplace.path(""))
        .stdout(writer)
        .spawn()
        .unwrap();
    let peak = peak_when_asleep(child.id());
    let mut said = String::new();
    reader.read_to_string(&mut said).unwrap();
    assert_eq!(child.wait().unwrap().code(), Some(4), "{said}");
    (said.trim().to_owned(), peak)
}

/// The most memory a process has taken, bytes, once it has slept for a while.
fn peak_when_asleep(process: u32) -> u64 {
    let mut asleep = 0;
    loop {
        thread::sleep(Duration::from_millis(2));
        let status = fs::read_to_string(format!("/proc/{process}/status")).unwrap();
        let field = |name: &str| status.lines().find_map(|line| line.strip_prefix(name)).unwrap_or_default().trim();
        asleep = if field("State:").starts_with('S') { asleep + 1 } else { 0 };
        if asleep == 25 {
            return 1024 * field("VmHWM:").trim_end_matches(" kB").parse::<u64>().unwrap();
        }
    }
}
