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
    let tags = "-colorspace bt709 -color_primaries bt709 -color_trc iec61966-2-1 -color_range tv";
    assert!(arguments.contains(tags) && arguments.contains("out_color_matrix=bt709:out_range=tv"), "{arguments}");
    assert_eq!(bytes.trim().parse::<u64>().unwrap(), 10 * 64 * 36 * 4);
    let outcome = render(&workplace, "render scene.toml -o clip.webm --slow 0.5 --fps 30");
    assert_eq!(outcome.code, 0, "{outcome:?}");
    assert!(String::from_utf8(workplace.read("clip.webm")).unwrap().contains("libvpx-vp9"));
}

/// The values of a video stream as `ffprobe` prints them.
fn probe(workplace: &Workplace, file: &str) -> String {
    let entries = "stream=width,height,nb_read_frames,pix_fmt,color_range,color_space,color_transfer,color_primaries";
    let output = std::process::Command::new("ffprobe")
        .args(["-v", "error", "-count_frames", "-show_entries", entries, "-of", "default=nw=1"])
        .arg(workplace.path(file))
        .output()
        .expect("ffprobe can be run");
    String::from_utf8(output.stdout).unwrap()
}

#[test]
#[ignore = "needs ffmpeg and ffprobe; .ci/long runs it"]
fn videos_have_all_frames_and_colour_tags_that_agree_with_their_pixels() {
    let workplace = Workplace::with_scene(&SCENE.replace("size = [0.5, 0.5]", "size = [2.0, 1.5]"));
    for file in ["clip.mp4", "clip.webm"] {
        // An odd width and height are made even.
        workplace.done(&format!("render scene.toml -o {file} --size 127x71 --show none"));
        let values = probe(&workplace, file);
        for value in [
            "width=128",
            "height=72",
            "nb_read_frames=10",
            "pix_fmt=yuv420p",
            "color_range=tv",
            "color_space=bt709",
            "color_transfer=iec61966-2-1",
            "color_primaries=bt709",
        ] {
            assert!(values.lines().any(|line| line == value), "{file}: no {value} in\n{values}");
        }
    }
    // Decoded with the tags, the colour of the box is that of the picture, and the border is the background.
    let decoded = std::process::Command::new("ffmpeg")
        .args(["-v", "error", "-i"])
        .arg(workplace.path("clip.mp4"))
        .args(["-frames:v", "1", "-f", "rawvideo", "-pix_fmt", "rgb24", "-"])
        .output()
        .expect("ffmpeg can be run");
    let pixel = |x: usize, y: usize| <[u8; 3]>::try_from(&decoded.stdout[3 * (128 * y + x)..][..3]).unwrap();
    let is_close = |pixel: [u8; 3], color: [u8; 3]| pixel.iter().zip(color).all(|(a, b)| a.abs_diff(b) <= 24);
    assert!(is_close(pixel(127, 10), [255; 3]) && is_close(pixel(30, 71), [255; 3]), "{:?}", pixel(127, 10));
    workplace.done("render scene.toml --at 0 -o still.png --size 127x71 --show none");
    let mut decoder = png::Decoder::new(std::io::Cursor::new(workplace.read("still.png")));
    decoder.set_transformations(png::Transformations::EXPAND);
    let mut reader = decoder.read_info().unwrap();
    let mut pixels = vec![0; reader.output_buffer_size().unwrap()];
    let info = reader.next_frame(&mut pixels).unwrap();
    let samples = info.color_type.samples();
    let expected = |x: usize, y: usize| <[u8; 3]>::try_from(&pixels[samples * (127 * y + x)..][..3]).unwrap();
    let mut compared = 0;
    for (x, y) in (1..126).flat_map(|x| (1..70).map(move |y| (x, y))) {
        // Chroma has half the resolution, so only areas of one colour are compared.
        let color = expected(x, y);
        if (x - 1..=x + 1).all(|x| (y - 1..=y + 1).all(|y| expected(x, y) == color)) && color != [255; 3] {
            compared += 1;
            assert!(is_close(pixel(x, y), color), "({x}, {y}): {:?} is not {color:?}", pixel(x, y));
        }
    }
    assert!(compared > 0);
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
