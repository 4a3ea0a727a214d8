//! Any text is a scene or a refusal that can be printed.

use rebond::internals::{cli::SceneReport, scene};

/// Reads the text as a scene.
pub fn read(text: &str) {
    if asks_for_many(text) {
        return;
    }
    match scene::parse("scene.toml", text) {
        Ok(scene) => assert_eq!(scene.source.text, text),
        Err(error) => {
            let _ = format!("{:?}", miette::Report::new(SceneReport::from(error)));
        }
    }
}

/// A scene may scatter a million bodies, which is much honest work: here a count has three
/// digits at most.
fn asks_for_many(text: &str) -> bool {
    let mut digits = 0;
    text.bytes().any(|byte| {
        digits = if byte.is_ascii_hexdigit() || byte == b'_' { digits + 1 } else { 0 };
        digits > 3 && text.contains("scatter")
    })
}
