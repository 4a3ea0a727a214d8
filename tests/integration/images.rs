//! Images in boxes: in every output, in recordings, and hostile files.

use crate::forge::{self, Item, Layout};
use crate::rebond::{Outcome, Workplace};
use rebond::internals::picture::png;
use std::io::Cursor;

const SCENE: &str = "title = \"Cars\"\n[world]\nsize = [16.0, 9.0]\n[run]\nrate = 20\nsteps = 20\n\
                     [[spawn]]\nname = \"c\"\nat = [2.0, 2.0]\nsize = [4.0, 4.0]\nmass = 1.0\nvelocity = [4.0, 0.0]\n\
                     image = \"img/car.png\"\n[figure]\nshow = [\"clock\"]\nsize = [320, 180]\n";

/// A PNG file of red, green, blue and transparent quarters.
fn car(side: u32) -> Vec<u8> {
    let pixel = |at: u32| match (at % side < side / 2, at / side < side / 2) {
        (true, true) => [255, 0, 0, 255],
        (false, true) => [0, 255, 0, 255],
        (true, false) => [0, 0, 255, 255],
        (false, false) => [0, 0, 0, 0],
    };
    let pixels: Vec<u8> = (0..side * side).flat_map(pixel).collect();
    encoded([side, side], &pixels)
}

/// A PNG file of these pixels.
pub fn encoded([width, height]: [u32; 2], rgba: &[u8]) -> Vec<u8> {
    let mut file = Vec::new();
    let mut encoder = ::png::Encoder::new(&mut file, width, height);
    encoder.set_color(::png::ColorType::Rgba);
    encoder.write_header().unwrap().write_image_data(rgba).unwrap();
    file
}

/// An animation of two frames, each this picture of 8 × 8 pixels.
fn animated(still: &[u8]) -> Vec<u8> {
    let mut file = Vec::new();
    let mut encoder = ::png::Encoder::new(&mut file, 8, 8);
    encoder.set_color(::png::ColorType::Rgba);
    encoder.set_animated(2, 0).unwrap();
    let mut writer = encoder.write_header().unwrap();
    let (picture, _) = png::decode(Cursor::new(still)).unwrap();
    (0..2).for_each(|_| writer.write_image_data(&picture.pixels.concat()).unwrap());
    drop(writer);
    file
}

#[cfg(unix)]
#[test]
fn an_image_that_is_a_pipe_is_refused_and_not_waited_for() {
    let workplace = workplace(SCENE, &car(8));
    workplace.done("record scene.toml -o scene.mcap");
    std::fs::remove_file(workplace.path("img/car.png")).unwrap();
    let status = std::process::Command::new("mkfifo").arg(workplace.path("img/car.png")).status().unwrap();
    assert!(status.success());
    for line in ["record scene.toml -o new.mcap", "check scene.mcap"] {
        let refused = workplace.rebond(line);
        let text = refused.output.clone() + &refused.errors;
        assert!(refused.code == 1 && text.contains("it is no regular file"), "{line}: {refused:?}");
    }
}

fn workplace(scene: &str, png: &[u8]) -> Workplace {
    let workplace = Workplace::with_scene(scene);
    std::fs::create_dir(workplace.path("img")).unwrap();
    std::fs::write(workplace.path("img/car.png"), png).unwrap();
    workplace
}

/// The colours in the middle of the four quarters of the box at its place at the start, and the page beside it.
fn quarters(file: &[u8]) -> [[u8; 4]; 5] {
    let (picture, _) = png::decode(Cursor::new(file)).unwrap();
    let metre = |x: f64, y: f64, area: [f64; 3]| [area[0] + x * area[2], area[1] + y * area[2]];
    let area = world_area(picture.size);
    [[3.0, 3.0], [5.0, 3.0], [3.0, 5.0], [5.0, 5.0], [10.0, 3.0]].map(|[x, y]| {
        let [x, y] = metre(x, y, area).map(|at| at.round() as usize);
        picture.pixels[y * picture.size[0] as usize + x]
    })
}

/// Left and upper edge of the world on the page, px, and its scale, px/m.
fn world_area(size: [u32; 2]) -> [f64; 3] {
    let [width, height] = size.map(f64::from);
    let strip = if height < 324.0 { 17.0 } else { (height / 18.0).floor() };
    let margin = (height / 40.0).floor();
    let [wide, high] = [(width - 2.0 * margin) / 16.0, (height - strip - 2.0 * margin) / 9.0];
    let scale = if wide < high { wide } else { high };
    [(width - 16.0 * scale) / 2.0, (height - strip - 9.0 * scale) / 2.0, scale]
}

const QUARTERS: [[u8; 4]; 5] =
    [[255, 0, 0, 255], [0, 255, 0, 255], [0, 0, 255, 255], [255, 255, 255, 255], [255, 255, 255, 255]];

#[test]
fn an_image_fills_its_box_in_every_output() {
    for side in [2, 6, 64, 400] {
        let workplace = workplace(SCENE, &car(side));
        workplace.done("render scene.toml --at 0 -o still.png");
        assert_eq!(quarters(&workplace.read("still.png")), QUARTERS, "{side} px");
    }
    let workplace = workplace(SCENE, &car(8));
    workplace.done("record scene.toml -o run.mcap");
    // The recording draws without the file.
    std::fs::remove_dir_all(workplace.path("img")).unwrap();
    for output in ["run.apng", "run.gif", "at.svg --at 0", "at.pdf --at 0", "frames/"] {
        workplace.done(&format!("render run.mcap -o {output}"));
    }
    assert_eq!(quarters(&workplace.read("run.apng")), QUARTERS);
    assert_eq!(quarters(&std::fs::read(workplace.path("frames/000000.png")).unwrap()), QUARTERS);
    let gif = workplace.read("run.gif");
    let mut decoder = gif::DecodeOptions::new();
    decoder.set_color_output(gif::ColorOutput::RGBA);
    let mut decoder = decoder.read_info(Cursor::new(gif)).unwrap();
    let pixels = decoder.read_next_frame().unwrap().unwrap().buffer.to_vec();
    for color in [[255, 0, 0, 255], [0, 255, 0, 255], [0, 0, 255, 255]] {
        assert!(pixels.as_chunks::<4>().0.contains(&color), "{color:?}");
    }
    let svg = String::from_utf8(workplace.read("at.svg")).unwrap();
    assert_eq!(svg.matches("<image id=\"i0\" width=\"8\" height=\"8\"").count(), 1, "{svg}");
    assert_eq!(svg.matches("<use href=\"#i0\"").count(), 1, "{svg}");
    let pdf = workplace.read("at.pdf");
    assert!(pdf.windows(8).any(|bytes| bytes == b"/XObject") && pdf.windows(6).any(|bytes| bytes == b"/SMask"));
    for kind in ["strobe", "filmstrip"] {
        workplace.done(&format!("figure {kind} run.mcap -o {kind}.svg"));
        assert!(String::from_utf8(workplace.read(&format!("{kind}.svg"))).unwrap().contains("<use href=\"#i0\""));
    }
    // Colours with a meaning are shown instead.
    workplace.done("render run.mcap --at 0 --color-by speed -o speed.svg");
    assert!(!String::from_utf8(workplace.read("speed.svg")).unwrap().contains("<image"));
}

#[test]
fn the_image_is_a_part_of_the_recording_and_of_its_identity() {
    let workplace = workplace(SCENE, &car(8));
    workplace.done("record scene.toml -o a.mcap");
    workplace.done("replay a.mcap");
    workplace.done("check a.mcap");
    // An image of a scene is no picture without provenance.
    let checked = workplace.done("check . --report report").output;
    assert!(checked.contains("a.mcap: same") && !checked.contains("car.png"), "{checked}");
    workplace.done("recover a.mcap -o recovered.mcap");
    assert!(workplace.read("recovered.mcap") == workplace.read("a.mcap"));
    workplace.done("render a.mcap --at 3 -o a.png");
    let source = rebond::Source::open(&workplace.path("a.mcap")).unwrap();
    assert!(rebond::redraw(&workplace.read("a.png"), &[source]).unwrap() == workplace.read("a.png"));
    let identity = |name: &str| {
        let info = workplace.done(&format!("info {name}")).output;
        info.lines().find(|line| line.starts_with("identity")).unwrap().to_owned()
    };
    let table = workplace.done("export a.mcap --table bodies").output;
    assert!(!table.contains("car.png"), "{table}");
    let (old, states) = (identity("a.mcap"), workplace.done("export a.mcap").output);
    std::fs::write(workplace.path("img/car.png"), car(10)).unwrap();
    workplace.done("record scene.toml -o b.mcap");
    assert_ne!(identity("b.mcap"), old);
    assert_eq!(workplace.done("export b.mcap").output, states);
    // The check of the old recording notices the new image.
    std::fs::rename(workplace.path("a.mcap"), workplace.path("scene.mcap")).unwrap();
    let checked = workplace.rebond("check scene.mcap");
    assert!(checked.code == 3 && checked.output.contains("img/car.png"), "{checked:?}");
}

#[test]
fn unusable_images_are_refused_in_one_sentence_with_their_place() {
    let mut bomb = car(8);
    // The header declares 60,000 × 60,000 pixels; its checksum is correct.
    bomb[16..24].copy_from_slice(&[0, 0, 0xea, 0x60, 0, 0, 0xea, 0x60]);
    let checksum = crc32fast::hash(&bomb[12..29]);
    bomb[29..33].copy_from_slice(&checksum.to_be_bytes());
    let mut cut = car(64);
    cut.truncate(cut.len() / 2);
    let mut flipped = car(64);
    let middle = flipped.len() / 2;
    flipped[middle] ^= 0x10;
    let wide = encoded([4097, 1], &vec![7; 4 * 4097]);
    let many = encoded([4096, 2049], &vec![0; 4 * 4096 * 2049]);
    let animation = animated(&car(8));
    let cases: [(&[u8], &str); 9] = [
        (b"GIF89a", "it is not a PNG file"),
        (b"", "it is not a PNG file"),
        (&bomb, "60000 × 60000 pixels"),
        (&cut, "not a valid PNG file"),
        (&flipped, "not a valid PNG file"),
        (&wide, "4097 × 1 pixels"),
        (&many, "pixels"),
        (&vec![0; (4 << 20) + 1], "more than 4 MiB"),
        (&animation, "it is an animation"),
    ];
    for (file, reason) in cases {
        let workplace = workplace(SCENE, file);
        for command in
            ["record scene.toml -o x.mcap", "render scene.toml -o x.gif", "figure strobe scene.toml -o x.svg"]
        {
            let Outcome { code, errors, .. } = workplace.rebond(command);
            assert_eq!(code, 1, "{command}: {errors}");
            let text = errors.split_whitespace().collect::<Vec<&str>>().join(" ");
            let text = text.replace(" │ ", " ");
            assert!(
                text.contains("the image \"img/car.png\" cannot be used:") && text.contains(reason),
                "{reason}: {text}"
            );
            assert!(errors.contains("scene.toml:13:"), "{errors}");
            assert!(!workplace.path("x.mcap").exists() && !workplace.path("x.gif").exists());
        }
    }
    let missing = Workplace::with_scene(SCENE).rebond("record scene.toml -o x.mcap");
    assert!(missing.code == 1 && missing.errors.contains("No such file") && missing.errors.contains("scene.toml:13:"));
    for (path, key) in
        [("/etc/car.png", "image"), ("C:/car.png", "image"), ("a\\\\b.png", "image"), ("car.gif", "image")]
    {
        let scene = SCENE.replace("img/car.png", path);
        let refused = Workplace::with_scene(&scene).rebond("record scene.toml -o x.mcap");
        assert!(refused.code == 1 && refused.errors.contains(&format!("`spawn.{key}` cannot be")), "{refused:?}");
    }
}

#[test]
fn live_events_may_use_the_images_of_the_scene_alone() {
    let workplace = workplace(SCENE, &car(8));
    let event = |image: &str| {
        format!(
            "{{\"spawn\": {{\"step\": 3, \"name\": \"d\", \"at\": [8, 2], \"size\": [2, 2], \"mass\": 1, \"image\": \"{image}\"}}}}\n"
        )
    };
    workplace.write("known.jsonl", &event("img/car.png"));
    workplace.done("record scene.toml --events known.jsonl -o known.mcap");
    workplace.done("render known.mcap --at 10 -o known.svg");
    assert_eq!(String::from_utf8(workplace.read("known.svg")).unwrap().matches("<use href=\"#i0\"").count(), 2);
    workplace.write("other.jsonl", &event("img/bike.png"));
    let refused = workplace.rebond("record scene.toml --events other.jsonl -o other.mcap");
    assert!(refused.code == 1 && refused.errors.contains("the image \"img/bike.png\" cannot be used"), "{refused:?}");
}

/// Applies a change to the attachment with the image, and puts the file together again without its checksum.
fn forged(workplace: &Workplace, change: impl Fn(&mut Vec<u8>) -> bool) -> Vec<u8> {
    let mut parts = forge::take_apart(&workplace.read("run.mcap"));
    parts.retain_mut(|item| match item {
        Item::Record((opcode, body)) if *opcode == mcap::records::op::ATTACHMENT => {
            if !body.windows(9).any(|bytes| bytes == b"image/png") {
                return true;
            }
            let is_kept = change(body);
            forge::seal_attachment(body);
            is_kept
        }
        _ => true,
    });
    forge::put_together(&parts, Layout::Zstd)
}

#[test]
fn an_altered_image_is_corrupt_and_a_lost_one_is_missing() {
    let workplace = workplace(SCENE, &car(8));
    workplace.done("record scene.toml -o run.mcap");
    let altered = forged(&workplace, |body| {
        let end = body.len();
        body[end - 30] ^= 1;
        true
    });
    std::fs::write(workplace.path("altered.mcap"), altered).unwrap();
    for command in ["info altered.mcap", "replay altered.mcap", "check altered.mcap"] {
        let done = workplace.rebond(command);
        assert!(done.code == 4 && done.output.contains("corrupt"), "{command}: {done:?}");
    }
    std::fs::write(workplace.path("lost.mcap"), forged(&workplace, |_| false)).unwrap();
    for command in ["info lost.mcap", "replay lost.mcap"] {
        let done = workplace.rebond(command);
        assert!(done.code == 4 && done.output.contains("the image \"img/car.png\" is missing"), "{command}: {done:?}");
    }
    // The box is drawn as one without an image.
    let drawn = workplace.rebond("render lost.mcap --at 0 -o lost.svg");
    assert!(drawn.code == 4 && !String::from_utf8(workplace.read("lost.svg")).unwrap().contains("<image"), "{drawn:?}");
    let recovered = workplace.rebond("recover lost.mcap -o recovered.mcap");
    assert!(recovered.code == 4 && recovered.output.contains("lost the image"), "{recovered:?}");
    assert_eq!(workplace.rebond("replay recovered.mcap").code, 4);
}

/// A recording by another program may contain anything under the name of an image.
#[test]
fn a_hostile_image_in_a_recording_is_refused_when_it_is_drawn() {
    let workplace = workplace(SCENE, &car(8));
    workplace.done("record scene.toml -o run.mcap");
    let scene = rebond::load_scene(&workplace.path("scene.toml")).unwrap();
    let mut header = rebond::internals::replay::header(&scene, rebond::RecordOptions::complete(&scene));
    header.images = vec![rebond::recordings::SceneImage::new("img/car.png", b"not a picture".to_vec())];
    let writer = rebond::internals::recording::Writer::new(Vec::new(), &header).unwrap();
    let mut writer = writer;
    let mut run = rebond::Run::new(&scene);
    for event in run.apply_inputs(Vec::new(), |error| Err(error.into())).unwrap() {
        writer.write_event(&event).unwrap();
    }
    writer.write_state(run.engine()).unwrap();
    let finished = writer.finish(rebond::internals::recording::RunEnd::default()).unwrap();
    std::fs::write(workplace.path("hostile.mcap"), finished.output).unwrap();
    let drawn = workplace.rebond("render hostile.mcap --at 0 -o x.png");
    assert!(drawn.code == 1, "{drawn:?}");
    assert!(drawn.errors.contains("hostile.mcap: the image \"img/car.png\" of its scene cannot be drawn"), "{drawn:?}");
}
