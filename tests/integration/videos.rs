//! Videos: MP4 and WebM through ffmpeg, for which a script on the PATH stands in.
#![cfg(unix)]

use crate::rebond::{Outcome, Workplace};
use std::fs;
use std::os::unix::fs::PermissionsExt;

const SCENE: &str = r#"[world]
size = [8.0, 4.5]
[run]
rate = 30
steps = 9
solver = "handout"
[[spawn]]
at = [1.0, 2.0]
size = [0.5, 0.5]
mass = 1.0
velocity = [2.0, 0.0]
[figure]
size = [64, 36]
"#;

/// Writes its arguments and the number of bytes on its standard input to the output file.
const COUNTING_FFMPEG: &str = "#!/bin/sh
if [ \"$1\" = -version ]; then exit 0; fi
for last; do :; done
printf '%s\\n' \"$*\" | sed \"s#$last#OUT#\" > \"$last\"
wc -c >> \"$last\"
";

fn workplace(ffmpeg: Option<&str>) -> Workplace {
    let workplace = Workplace::with_scene(SCENE);
    fs::create_dir(workplace.path("bin")).unwrap();
    for tool in ["sh", "sed", "wc"] {
        let found =
            ["/bin", "/usr/bin"].iter().map(|folder| format!("{folder}/{tool}")).find(|path| fs::exists(path).unwrap());
        std::os::unix::fs::symlink(found.unwrap(), workplace.path(&format!("bin/{tool}"))).unwrap();
    }
    if let Some(script) = ffmpeg {
        workplace.write("bin/ffmpeg", script);
        fs::set_permissions(workplace.path("bin/ffmpeg"), fs::Permissions::from_mode(0o755)).unwrap();
    }
    workplace
}

fn render(workplace: &Workplace, line: &str) -> Outcome {
    workplace.rebond_on_path(line, &workplace.path("bin"))
}

#[test]
fn frames_are_piped_to_ffmpeg_as_raw_pixels() {
    let workplace = workplace(Some(COUNTING_FFMPEG));
    let outcome = render(&workplace, "render scene.toml -o clip.mp4");
    assert_eq!(outcome.code, 0, "{outcome:?}");
    assert!(
        outcome.output.starts_with("clip.mp4: ") && outcome.output.ends_with(" frames, every step, 30 frames/s\n"),
        "{outcome:?}"
    );
    let written = String::from_utf8(workplace.read("clip.mp4")).unwrap();
    let (arguments, bytes) = written.trim_end().rsplit_once('\n').unwrap();
    assert!(arguments.contains("-f rawvideo -pix_fmt rgba -s 64x36 -r 30 -i -"), "{arguments}");
    assert!(arguments.contains("libx264") && arguments.contains("rebond steps: 0 to 9 every 1"), "{arguments}");
    assert_eq!(bytes.trim().parse::<u64>().unwrap(), 10 * 64 * 36 * 4);
    let outcome = render(&workplace, "render scene.toml -o clip.webm --slow 0.5 --fps 30");
    assert_eq!(outcome.code, 0, "{outcome:?}");
    assert!(String::from_utf8(workplace.read("clip.webm")).unwrap().contains("libvpx-vp9"));
}

#[test]
fn freeze_frames_are_sent_repeatedly() {
    let falling = SCENE
        .replace("size = [8.0, 4.5]", "size = [8.0, 4.5]\nwalls = true")
        .replace("at = [1.0, 2.0]", "at = [7.3, 2.0]");
    let workplace = workplace(Some(COUNTING_FFMPEG));
    workplace.write("scene.toml", &falling);
    let outcome = render(&workplace, "render scene.toml -o clip.mp4 --hold 0.5 at collisions");
    assert!(outcome.output.contains("1 freeze frame of 0.5 s"), "{outcome:?}");
    let written = String::from_utf8(workplace.read("clip.mp4")).unwrap();
    let bytes: u64 = written.trim_end().lines().last().unwrap().trim().parse().unwrap();
    assert_eq!(bytes, (10 + 15) * 64 * 36 * 4, "half a second is 15 additional frames");
}

#[test]
fn without_ffmpeg_the_error_gives_advice_and_no_file_is_left() {
    let workplace = workplace(None);
    let outcome = render(&workplace, "render scene.toml -o clip.mp4");
    assert_eq!(outcome.code, 1);
    assert!(outcome.errors.contains("cannot write clip.mp4: ffmpeg cannot be run"), "{outcome:?}");
    assert!(outcome.errors.contains("https://ffmpeg.org") && outcome.errors.contains(".apng"), "{outcome:?}");
    assert_eq!(workplace.names(), ["bin", "scene.toml"]);
}

#[test]
fn an_error_of_ffmpeg_is_quoted_and_no_partial_file_is_left() {
    let failing = "#!/bin/sh\nif [ \"$1\" = -version ]; then exit 0; fi\nfor last; do :; done\necho half > \"$last\"\necho 'Unknown encoder' >&2\nexit 1\n";
    let workplace = workplace(Some(failing));
    let outcome = render(&workplace, "render scene.toml -o clip.mp4");
    assert_eq!(outcome.code, 1);
    assert!(outcome.errors.contains("cannot write clip.mp4: ffmpeg failed: Unknown encoder"), "{outcome:?}");
    assert_eq!(workplace.names(), ["bin", "scene.toml"]);
}

#[test]
fn an_existing_video_is_not_overwritten() {
    let workplace = workplace(Some(COUNTING_FFMPEG));
    workplace.write("clip.mp4", "old");
    let outcome = render(&workplace, "render scene.toml -o clip.mp4");
    assert_eq!((outcome.code, workplace.read("clip.mp4")), (1, b"old".to_vec()));
}
