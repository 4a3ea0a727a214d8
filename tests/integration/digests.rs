//! Every artefact has the bits it has on every other machine.

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
    let known: Vec<&str> = expected.lines().collect();
    let strange: Vec<&str> = found.lines().filter(|line| !known.contains(line)).collect();
    assert!(strange.is_empty(), "not in snapshots/digests.txt:\n{}\n{ADVICE}", strange.join("\n"));
    assert_eq!(found, expected, "{ADVICE}");
}

const ADVICE: &str = "if they are meant to be others now, accept them by REBOND_ACCEPT=1 cargo test";
