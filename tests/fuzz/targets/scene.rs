//! Any text is a scene or gives an error that can be printed.

use rebond::internals::{cli::ErrorReport, scene};

/// Parses the text as a scene, and formats the error if it is invalid.
pub fn read(text: &str) {
    if asks_for_many(text) {
        return;
    }
    match scene::parse("scene.toml", text) {
        Ok(scene) => assert_eq!(scene.source.text, text.replace("\r\n", "\n")),
        Err(error) => {
            for report in ErrorReport::of_scene(&error) {
                let _ = format!("{:?}", miette::Report::new(report));
            }
        }
    }
}

/// True if the text may scatter more than 999 bodies: a valid scene may have a million, which would take too long.
fn asks_for_many(text: &str) -> bool {
    let mut digits = 0;
    text.bytes().any(|byte| {
        digits = if byte.is_ascii_hexdigit() || byte == b'_' { digits + 1 } else { 0 };
        digits > 3 && text.contains("scatter")
    })
}
