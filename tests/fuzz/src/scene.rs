//! Any text is a scene or a refusal that can be printed.
#![no_main]

mod memory;

use libfuzzer_sys::{Corpus, fuzz_target};
use rebond::scene;

fuzz_target!(|text: &str| -> Corpus {
    if asks_for_many(text) {
        return Corpus::Reject;
    }
    memory::bounded(|| match scene::parse("scene.toml", text) {
        Ok(scene) => assert_eq!(scene.source.text, text),
        Err(error) => {
            let _ = format!("{:?}", miette::Report::new(error));
        }
    });
    Corpus::Keep
});

/// A scene may scatter a million bodies, which is much honest work: here a count has three
/// digits at most.
fn asks_for_many(text: &str) -> bool {
    let mut digits = 0;
    text.bytes().any(|byte| {
        digits = if byte.is_ascii_hexdigit() || byte == b'_' { digits + 1 } else { 0 };
        digits > 3 && text.contains("scatter")
    })
}
