//! Drawing and compression of a scene with many bodies on various numbers of threads.

use crate::rebond::Workplace;

/// More boxes than GIF has colours, so that the palette must be quantized, and trails, so that the drawing time
/// varies between frames.
const SCENE: &str = r#"
[world]
size = [64.0, 36.0]
[run]
rate = 60
steps = 24
solver = "event-driven"
[[scatter]]
count = 700
seed = 3
region = [0.5, 0.5, 63.0, 35.0]
size = [[0.2, 0.2], [0.8, 0.8]]
mass = [1.0, 9.0]
velocity = [[-9.0, -9.0], [9.0, 9.0]]
[figure]
size = [320, 180]
show = ["velocity", "trail", "clock"]
color_by = "speed"
"#;

/// A folder with a recording of [`SCENE`].
fn workplace() -> Workplace {
    let workplace = Workplace::with_scene(SCENE);
    workplace.done("record scene.toml -o wide.mcap");
    workplace
}

#[test]
fn animations_do_not_depend_on_the_number_of_threads() {
    let workplace = workplace();
    for kind in ["gif", "apng"] {
        let drawn = [1, 2, 8].map(|jobs| {
            workplace.done(&format!("render wide.mcap -o {jobs}.{kind} --every 4 --jobs {jobs}"));
            workplace.read(&format!("{jobs}.{kind}"))
        });
        assert!(drawn.iter().all(|file| *file == drawn[0]), "{kind} depends on the number of threads");
    }
}

#[test]
fn pictures_do_not_depend_on_the_number_of_threads_or_on_the_range_of_steps() {
    let workplace = workplace();
    workplace.done("render wide.mcap -o whole --from 13 --to 20 --jobs 1");
    workplace.done("render wide.mcap -o threads --from 13 --to 20 --jobs 8");
    workplace.done("render wide.mcap -o parts --from 13 --to 16 --jobs 3");
    workplace.done("render wide.mcap -o parts --from 17 --to 20 --jobs 2");
    for step in 13..=20 {
        let [whole, threads, parts] =
            ["whole", "threads", "parts"].map(|folder| workplace.read(&format!("{folder}/{step:06}.png")));
        assert!(whole == threads && whole == parts, "step {step} depends on threads or range");
    }
}
