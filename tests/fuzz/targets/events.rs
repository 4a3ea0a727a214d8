//! Any line is an event or an error, and a run that skips invalid lines continues to its end.

use std::io;

use rebond::internals::{
    cli::ErrorReport,
    replay::{LiveEvents, OnBadEvent, RecordOptions, record},
    scene::{self, Scene, live},
};

/// The scene to which the events are added.
const SCENE: &str = r#"
[world]
size = [16.0, 9.0]
walls = true
gravity = [0.0, 9.81]
[run]
rate = 60
steps = 4
solver = "event-driven"
events_per_step = 1000
[[spawn]]
name = "a"
at = [4.0, 4.0]
size = [1.0, 1.0]
mass = 1.0
"#;

/// Parses the lines one by one, and as the live events of a run.
pub fn read(lines: &[u8]) {
    refuse(lines);
    run(lines);
}

/// Formats the error of each invalid line.
fn refuse(lines: &[u8]) {
    let text = String::from_utf8_lossy(lines);
    for (number, line) in (1..).zip(text.lines()) {
        if let Err(error) = live::parse_line(number, line) {
            for report in ErrorReport::of_scene(&error) {
                let _ = format!("{:?}", miette::Report::new(report));
            }
        }
    }
}

fn run(lines: &[u8]) {
    let scene: Scene = scene::parse("scene.toml", SCENE).expect("a scene");
    let options = RecordOptions::complete(&scene);
    let mut live = LiveEvents::new(lines, OnBadEvent::Skip, options.steps);
    let recorded = record(&scene, options, Some(&mut live), io::sink(), |_| ()).expect("nothing that ends a run");
    assert!(recorded.error.is_some() || recorded.trailer.steps == options.steps);
}
