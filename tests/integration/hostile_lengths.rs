//! Hostile files: false lengths, and chunks that decompress to far more than their size.
//!
//! `cargo test --release hostile -- --nocapture` prints the memory that each of them needs.

use crate::rebond::Workplace;
use std::{
    fs,
    io::{Read, Write},
    process::Command,
    thread,
    time::Duration,
};

/// The largest amount of memory that reading a file may need, bytes.
const MAX_MEMORY: u64 = 100_000_000;

/// The sizes of the largest valid chunk, and of the largest valid message in it, bytes.
const CHUNK: usize = rebond::internals::recording::limits::RECORD_BYTES;
const MESSAGE: usize = rebond::internals::recording::limits::MESSAGE_BYTES;

/// The channel ids of the topics.
const EVENTS: u16 = 1;
const STATES: u16 = 2;
const BODIES: u16 = 3;

fn record(opcode: u8, body: &[u8]) -> Vec<u8> {
    [&[opcode], &(body.len() as u64).to_le_bytes() as &[u8], body].concat()
}

/// A chunk with a declared uncompressed size of `declared` bytes.
fn chunk_declaring(declared: usize, records: &[u8]) -> Vec<u8> {
    let data = zstd::bulk::compress(records, 1).unwrap();
    let checksum = crc32fast::hash(records).to_le_bytes();
    let sizes = [&[0; 16], &(declared as u64).to_le_bytes() as &[u8], &checksum].concat();
    let name = b"\x04\0\0\0zstd";
    record(6, &[&sizes, &name[..], &(data.len() as u64).to_le_bytes(), &data].concat())
}

fn chunk(records: &[u8]) -> Vec<u8> {
    chunk_declaring(records.len(), records)
}

/// A message of `length` bytes that starts with `start` and continues with zeros.
fn message(channel: u16, length: usize, start: &[&[u8]]) -> Vec<u8> {
    let mut data = [&channel.to_le_bytes() as &[u8], &[0; 20], &[0, 1, 0, 0], &start.concat()].concat();
    data.resize(22 + length, 0);
    record(5, &data)
}

/// Returns the part of a recording before its first chunk.
fn header_section() -> Vec<u8> {
    let workplace = Workplace::with_scene(include_str!("../readers/viewer.toml"));
    workplace.done("record scene.toml -o run.mcap --steps 1");
    let file = workplace.read("run.mcap");
    let first = file.windows(8).position(|window| window == b"\x04\0\0\0zstd").unwrap() - 37;
    file[..first].to_vec()
}

fn chunk_of_length(length: u64) -> Vec<u8> {
    [&[6], &length.to_le_bytes() as &[u8], &[0; 100]].concat()
}

/// Returns name, bytes after the header section, and expected part of the verdict of each file.
fn hostile_files() -> Vec<(&'static str, Vec<u8>, &'static str)> {
    let many = u32::MAX.to_le_bytes();
    let large = keyframe_of(190_000);
    let count_of = |element_bytes: usize| ((MESSAGE / element_bytes) as u32).to_le_bytes();
    vec![
        ("a chunk of 100 GB", chunk_of_length(100_000_000_000), "length exceeds limit"),
        ("a chunk of 2^64 bytes", chunk_of_length(u64::MAX), "length exceeds limit"),
        ("a chunk that declares 100 GB uncompressed", chunk_declaring(100_000_000_000, &[0; 9]), "but at most"),
        (
            "a chunk that decompresses to more than it declares",
            chunk_declaring(1000, &vec![0; 1 << 30]),
            "corrupt chunk 1",
        ),
        ("a chunk that decompresses to less than it declares", chunk_declaring(CHUNK, &[0; 9]), "corrupt chunk 1"),
        ("the largest chunk, with one record", chunk(&record(0, &vec![0; CHUNK - 9])), "is not allowed in a chunk"),
        ("2^32 bodies", chunk(&message(STATES, 100, &[&[0; 16], &many])), "the message of a state is too short"),
        ("a state of zeros", chunk(&message(STATES, MESSAGE, &[&[0; 16], &count_of(36)])), "state"),
        ("one long column", chunk(&message(STATES, MESSAGE, &[&[0; 20], &count_of(8)])), "state"),
        (
            "a string of 4 GB",
            chunk(&message(EVENTS, 100, &[&[0; 8], &[1, 0, 0, 0, 0, 0, 0, 0], &many])),
            "not valid CDR",
        ),
        (
            "a long string",
            chunk(&message(EVENTS, MESSAGE, &[&[0; 8], &[1, 0, 0, 0, 0, 0, 0, 0], &count_of(2)])),
            "bytes",
        ),
        ("2^32 spawns", chunk(&message(EVENTS, 100, &[&[0; 8], &many])), "not valid CDR"),
        ("a keyframe of 2^32 bodies", chunk(&message(BODIES, 100, &[&[0; 12], &many])), "not valid CDR"),
        (
            "a keyframe of bodies that were never spawned",
            chunk(&message(BODIES, large.len() + 4, &[&large])),
            // The reader waits for the state of the step, which the file does not have.
            "the end is missing",
        ),
        ("a keyframe of zeros", chunk(&message(BODIES, 28 << 20, &[&[0; 12], &count_of(128)])), "corrupt chunk 1"),
    ]
}

/// A well-formed keyframe of `bodies` unnamed bodies at the same position.
fn keyframe_of(bodies: u32) -> Vec<u8> {
    let mut data = [&0_u64.to_le_bytes() as &[u8], &bodies.to_le_bytes(), &bodies.to_le_bytes()].concat();
    let numbers: [f64; 9] = [1.0, 1.0, 1.0, 1.0, 1.0, 0.0, 0.0, 0.0, 0.0];
    let empty_string = [1, 0, 0, 0, 0, 0, 0, 0];
    for id in 0..bodies {
        data.extend([id.to_le_bytes(), [1, 0, 0, 0], [0; 4], [0; 4]].concat());
        data.extend(numbers.iter().flat_map(|number| number.to_le_bytes()));
        data.extend([empty_string, empty_string].concat());
    }
    for number in [1.0_f64, 1.0, 0.0, 0.0, 0.0, 0.0] {
        data.extend([bodies, 0].map(u32::to_le_bytes).concat());
        data.extend(number.to_le_bytes().repeat(bodies as usize));
    }
    data.extend([0; 8]);
    data
}

#[test]
fn hostile_lengths_are_rejected_with_little_memory() {
    let header_section = header_section();
    let workplace = Workplace::new();
    println!("\n{:>9} {:>9}   file: verdict", "size, B", "peak, MB");
    for (name, rest, expected) in hostile_files() {
        let file = [header_section.as_slice(), &rest].concat();
        fs::write(workplace.path("hostile.mcap"), &file).unwrap();
        let (verdict, peak) = replay(&workplace);
        assert!(verdict.contains(expected), "{name}: {verdict}");
        println!("{:>9} {:>9.1}   {name}: {}", file.len(), peak as f64 / 1e6, verdict.trim());
        assert!(peak < MAX_MEMORY, "{name} needs {peak} bytes");
    }
}

/// Replays the file and returns the verdict and the peak memory, bytes.
///
/// The output is a full pipe, so that the process blocks there until its memory has been measured.
fn replay(workplace: &Workplace) -> (String, u64) {
    const PIPE_BYTES: usize = 65536;
    let (mut reader, mut writer) = std::io::pipe().unwrap();
    writer.write_all(&[b' '; PIPE_BYTES]).unwrap();
    let mut child = Command::new(env!("CARGO_BIN_EXE_rebond"))
        .args(["replay", "hostile.mcap"])
        .current_dir(workplace.path(""))
        .stdout(writer)
        .spawn()
        .unwrap();
    let peak = peak_when_asleep(child.id());
    let mut verdict = String::new();
    reader.read_to_string(&mut verdict).unwrap();
    assert_eq!(child.wait().unwrap().code(), Some(4), "{verdict}");
    (verdict.trim().to_owned(), peak)
}

/// Returns the peak memory of a process, bytes, once it has been sleeping for a while.
fn peak_when_asleep(process: u32) -> u64 {
    let mut sleeping_polls = 0;
    loop {
        thread::sleep(Duration::from_millis(2));
        let status = fs::read_to_string(format!("/proc/{process}/status")).unwrap();
        let field = |name: &str| status.lines().find_map(|line| line.strip_prefix(name)).unwrap_or_default().trim();
        sleeping_polls = if field("State:").starts_with('S') { sleeping_polls + 1 } else { 0 };
        if sleeping_polls == 25 {
            return 1024 * field("VmHWM:").trim_end_matches(" kB").parse::<u64>().unwrap();
        }
    }
}
