//! All artefacts have the same bits on all machines.

#[path = "../cross/artefacts.rs"]
mod artefacts;

use artefacts::Program;
use std::{fs, path::Path};

#[test]
fn every_artefact_has_the_expected_digests() {
    let program = Program { file: env!("CARGO_BIN_EXE_rebond").into(), arguments: Vec::new() };
    let found = artefacts::digests(&program);
    let expected = Path::new(env!("CARGO_MANIFEST_DIR")).join("snapshots/digests.txt");
    if std::env::var_os("REBOND_ACCEPT").is_some_and(|value| value == "1") {
        fs::write(&expected, found).unwrap();
        return;
    }
    let expected = fs::read_to_string(&expected).unwrap();
    let expected_lines: Vec<&str> = expected.lines().collect();
    let unexpected: Vec<&str> = found.lines().filter(|line| !expected_lines.contains(line)).collect();
    assert!(unexpected.is_empty(), "not in snapshots/digests.txt:\n{}\n{ADVICE}", unexpected.join("\n"));
    assert_eq!(found, expected, "{ADVICE}");
}

const ADVICE: &str = "to accept intended changes, run REBOND_ACCEPT=1 cargo test";
