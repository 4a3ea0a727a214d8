//! Prints the digests that must equal `snapshots/digests.txt` on every machine:
//!
//! ```sh
//! cargo run --release --example digests -- target/release/rebond
//! cargo run --release --example digests -- qemu-s390x -L /usr/s390x-linux-gnu /path/to/rebond
//! ```

mod artefacts;

use artefacts::Program;
use std::process::ExitCode;

fn main() -> ExitCode {
    let words: Vec<String> = std::env::args().skip(1).collect();
    let Some((file, arguments)) = words.split_first() else {
        eprintln!("usage: digests PROGRAM [ARGUMENT…], the command that runs rebond");
        return ExitCode::from(2);
    };
    print!("{}", artefacts::digests(&Program { file: file.into(), arguments: arguments.to_vec() }));
    ExitCode::SUCCESS
}
