//! Animations and picture sequences contain exactly the drawn frames with the right display times.

use crate::frames::{WORLD, moving, resized, view};
use rebond::internals::picture::{
    AnimationSchedule, ColorBy, Frame, Instant, Metadata, Overlay, Painter, Picture, RenderError, StepGrid, Theme,
    Thinning, View, compose, png, write_apng, write_gif, write_png_sequence,
};
use std::io::Cursor;
use std::num::NonZero;

/// A number of boxes with which a frame has more than 256 colours.
const MANY: u32 = 120;

/// A small picture, because these tests do not depend on the size.
fn small(theme: Theme, show: &[Overlay], color_by: ColorBy) -> View {
    View::new(WORLD, resized([320, 180], view(theme, show, color_by).style)).unwrap()
}

fn grid() -> StepGrid {
    StepGrid::new(0..=79, 60.0, Thinning::Every(2))
}

fn frames(count: u32) -> Vec<Frame> {
    (0..80).filter(|&step| grid().contains(step)).map(|step| moving(count, step)).collect()
}

fn instants(frames: &[Frame]) -> impl Iterator<Item = Result<Instant, RenderError>> {
    frames.iter().cloned().map(|frame| Ok(frame.into()))
}

fn gif(frames: &[Frame], view: &View, threads: usize) -> Vec<u8> {
    let (stage, schedule, mut file) = (view.clone().into(), AnimationSchedule::from(grid()), Vec::new());
    write_gif(instants(frames), &stage, &schedule, &metadata(), NonZero::new(threads).unwrap(), &mut file).unwrap();
    file
}

fn metadata() -> Metadata {
    Metadata { entries: vec![("rebond steps".into(), "0 to 79 every 2".into())] }
}

/// The composited frames of a GIF file and their delays, 1/100 s.
fn decode_gif(file: &[u8]) -> Vec<(Picture, u16)> {
    let mut options = gif::DecodeOptions::new();
    options.set_color_output(gif::ColorOutput::RGBA);
    options.check_frame_consistency(true);
    let mut decoder = options.read_info(file).unwrap();
    let size = [u32::from(decoder.width()), u32::from(decoder.height())];
    let mut canvas = Picture { size, pixels: vec![[0; 4]; (size[0] * size[1]) as usize] };
    let mut pictures = Vec::new();
    while let Some(frame) = decoder.read_next_frame().unwrap() {
        assert_eq!(frame.dispose, gif::DisposalMethod::Keep);
        blend(&mut canvas, frame);
        pictures.push((canvas.clone(), frame.delay));
    }
    pictures
}

fn blend(canvas: &mut Picture, frame: &gif::Frame) {
    let (left, top, width) = (usize::from(frame.left), usize::from(frame.top), usize::from(frame.width));
    for (row, from) in frame.buffer.as_chunks::<4>().0.chunks_exact(width).enumerate() {
        let start = (top + row) * canvas.size[0] as usize + left;
        for (to, from) in canvas.pixels[start..][..width].iter_mut().zip(from) {
            if from[3] != 0 {
                *to = *from;
            }
        }
    }
}

fn draw(frames: &[Frame], view: &View) -> Vec<Picture> {
    frames.iter().map(|frame| Painter::new().draw(&compose(frame, view))).collect()
}

#[test]
fn a_gif_contains_the_drawn_pixels() {
    for theme in Theme::ALL {
        let view = small(*theme, &[Overlay::Name, Overlay::Clock, Overlay::Grid], ColorBy::Body);
        let frames = frames(5);
        let decoded: Vec<Picture> =
            decode_gif(&gif(&frames, &view, 1)).into_iter().map(|(picture, _)| picture).collect();
        assert!(decoded == draw(&frames, &view), "a frame differs");
    }
}

#[test]
fn a_gif_quantizes_frames_of_more_than_256_colours() {
    let of_few_colours = |overlay: &&Overlay| !matches!(overlay, Overlay::Momentum | Overlay::Com);
    let overlays: Vec<Overlay> = Overlay::ALL.iter().filter(of_few_colours).copied().collect();
    let view = small(Theme::Light, &overlays, ColorBy::Speed);
    let frames = frames(MANY);
    let drawn = draw(&frames, &view);
    let colors: std::collections::BTreeSet<[u8; 4]> = drawn[0].pixels.iter().copied().collect();
    assert!(colors.len() > 256, "only {} colours", colors.len());
    for ((decoded, _), drawn) in decode_gif(&gif(&frames, &view, 1)).iter().zip(&drawn) {
        let pairs = decoded.pixels.iter().flatten().zip(drawn.pixels.iter().flatten());
        let differences: Vec<u64> = pairs.map(|(a, b)| u64::from(a.abs_diff(*b))).collect();
        assert!(differences.iter().all(|&difference| difference < 24), "{:?}", differences.iter().max());
        let mean = differences.iter().sum::<u64>() as f64 / differences.len() as f64;
        assert!(mean < 0.2, "differs by {mean} on average");
    }
}

#[test]
fn a_gif_lasts_as_long_as_its_steps() {
    let view = small(Theme::Light, &[], ColorBy::Body);
    let decoded = decode_gif(&gif(&frames(3), &view, 1));
    assert_eq!(decoded.len(), 40);
    assert_eq!(decoded.iter().map(|(_, delay)| u64::from(*delay)).sum::<u64>(), 133, "40 frames of 2 steps at 60 Hz");
    assert!(decoded.iter().all(|(_, delay)| [3, 4].contains(delay)));
}

#[test]
fn a_gif_repeats_endlessly_and_contains_its_metadata() {
    let file = gif(&frames(1), &small(Theme::Light, &[], ColorBy::Body), 1);
    let contains = |bytes: &[u8]| file.windows(bytes.len()).any(|window| window == bytes);
    assert!(contains(b"NETSCAPE2.0\x03\x01\x00\x00\x00"));
    assert!(contains(b"\x21\xfe\x1erebond steps: 0 to 79 every 2\n\x00"));
}

#[test]
fn a_gif_stores_only_changed_pixels() {
    let view = small(Theme::Light, &[], ColorBy::Body);
    let still = vec![moving(5, 0); 40];
    let mut decoder = gif::DecodeOptions::new().read_info(Cursor::new(gif(&still, &view, 1))).unwrap();
    let mut sizes = Vec::new();
    while let Some(frame) = decoder.read_next_frame().unwrap() {
        sizes.push([frame.width, frame.height]);
    }
    assert_eq!(sizes[0], [320, 180]);
    assert_eq!(sizes[1..], [[1, 1]; 39]);
}

#[test]
#[cfg_attr(debug_assertions, ignore = "slow in debug")]
fn the_bytes_of_a_gif_do_not_depend_on_the_number_of_threads() {
    for (count, show) in [(5, [Overlay::Name].as_slice()), (MANY, Overlay::ALL)] {
        let view = small(Theme::Dark, show, ColorBy::Speed);
        let frames = frames(count);
        let one = gif(&frames, &view, 1);
        assert!(one == gif(&frames, &view, 2), "2 threads write different bytes");
        assert!(one == gif(&frames, &view, 5), "5 threads write different bytes");
    }
}

/// The snapshot of a long animation contains a hash of each picture. To see a change, render both versions.
#[test]
#[cfg_attr(debug_assertions, ignore = "slow in debug")]
fn a_long_animation_matches_the_hashes_of_its_pictures() {
    use rebond::internals::picture::{Animation, Clip, Overlays, PictureOptions, Sequence, Source, Timing};
    use std::fmt::Write;
    let recordings = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("recordings");
    let mut hashes = String::new();
    for (name, theme) in [("click-session", Theme::Light), ("falling-heap", Theme::Dark)] {
        let source = Source::open(&recordings.join(format!("{name}.mcap"))).unwrap();
        let mut options = PictureOptions::default();
        (options.every, options.size) = (Some(5), Some([320, 180]));
        (options.theme, options.show) = (Some(theme), Some(Overlays::all()));
        let sources = [source];
        let Sequence { steps, every, look, titles } = options.resolve_sequence(&sources).unwrap();
        let animation = Animation { steps, every, timing: Timing::REAL_TIME };
        let Clip { stage, instants, .. } = Clip::new(&animation, &look, &titles, &sources, &mut |_, _| ()).unwrap();
        let mut painter = Painter::new();
        for instant in instants {
            let instant = instant.unwrap();
            let drawn = painter.draw(&stage.compose(&instant));
            let hash = xxhash_rust::xxh3::xxh3_64(drawn.pixels.as_flattened());
            writeln!(hashes, "{name} {:04} {hash:016x}", instant.step).unwrap();
        }
    }
    crate::snapshot::assert_text("clip-hashes", &hashes);
}

fn apng(frames: &[Frame], view: &View, threads: usize) -> Vec<u8> {
    let (stage, schedule, mut file) = (view.clone().into(), AnimationSchedule::from(grid()), Vec::new());
    write_apng(instants(frames), &stage, &schedule, &metadata(), NonZero::new(threads).unwrap(), &mut file).unwrap();
    file
}

/// The composited frames of an animated PNG file and their delays as fractions of a second.
fn decode_apng(file: &[u8]) -> Vec<(Picture, [u16; 2])> {
    let mut reader = ::png::Decoder::new(Cursor::new(file)).read_info().unwrap();
    let size = [reader.info().width, reader.info().height];
    let count = reader.info().animation_control.unwrap().num_frames;
    let mut canvas = Picture { size, pixels: vec![[0; 4]; (size[0] * size[1]) as usize] };
    let mut bytes = vec![0; reader.output_buffer_size().unwrap()];
    let mut pictures = Vec::new();
    for _ in 0..count {
        reader.next_frame(&mut bytes).unwrap();
        let control = *reader.info().frame_control().unwrap();
        assert_eq!((control.dispose_op, control.blend_op), (::png::DisposeOp::None, ::png::BlendOp::Over));
        let pixels = bytes.as_chunks::<4>().0.chunks_exact(control.width as usize);
        for (row, from) in (control.y_offset..).zip(pixels.take(control.height as usize)) {
            let start = (row * size[0] + control.x_offset) as usize;
            for (to, from) in canvas.pixels[start..].iter_mut().zip(from).filter(|(_, from)| from[3] != 0) {
                *to = *from;
            }
        }
        pictures.push((canvas.clone(), [control.delay_num, control.delay_den]));
    }
    pictures
}

#[test]
fn an_animated_png_contains_the_drawn_pixels_with_exact_delays() {
    let view = small(Theme::Light, Overlay::ALL, ColorBy::Speed);
    let frames = frames(MANY);
    let (pictures, delays): (Vec<Picture>, Vec<[u16; 2]>) = decode_apng(&apng(&frames, &view, 1)).into_iter().unzip();
    assert!(pictures == draw(&frames, &view), "a frame differs");
    assert_eq!(delays, [[2, 60]; 40]);
}

#[test]
fn an_animated_png_is_readable_as_a_still_and_contains_its_metadata() {
    let view = small(Theme::Light, &[], ColorBy::Body);
    let frames = frames(3);
    let (picture, metadata) = png::decode(Cursor::new(apng(&frames, &view, 2))).unwrap();
    assert!(picture == draw(&frames, &view)[0], "not the first frame");
    assert_eq!(metadata.entries, [("rebond steps".to_owned(), "0 to 79 every 2".to_owned())]);
}

#[test]
fn the_bytes_of_an_animated_png_do_not_depend_on_the_number_of_threads() {
    let view = small(Theme::Dark, &[Overlay::Name], ColorBy::Body);
    let frames = frames(9);
    assert!(apng(&frames, &view, 1) == apng(&frames, &view, 3), "3 threads write different bytes");
}

#[test]
fn an_animated_png_of_too_few_frames_is_an_error() {
    let view = small(Theme::Light, &[], ColorBy::Body);
    let frames = frames(1);
    let end = write_apng(
        instants(&frames[..39]),
        &view.into(),
        &AnimationSchedule::from(grid()),
        &Metadata::default(),
        NonZero::<usize>::MIN,
        std::io::sink(),
    );
    let expected = "only 39 of 40 frames can be drawn, because states are missing or damaged, and an animated PNG starts \
                    with their number: recover the recording first, or draw a GIF";
    assert_eq!(end.unwrap_err().to_string(), expected);
}

fn sequence(frames: &[Frame], view: &View, threads: usize) -> Vec<(u64, Vec<u8>)> {
    let mut files = Vec::new();
    let metadata = |step: u64| Metadata { entries: vec![("rebond steps".into(), step.to_string())] };
    write_png_sequence(
        instants(frames),
        &view.clone().into(),
        metadata,
        NonZero::new(threads).unwrap(),
        |step, file| {
            files.push((step, file));
            Ok(())
        },
    )
    .unwrap();
    files
}

#[test]
fn a_sequence_contains_each_drawn_frame_in_order() {
    let view = small(Theme::Light, Overlay::ALL, ColorBy::Material);
    let frames = frames(5);
    let files = sequence(&frames, &view, 2);
    assert_eq!(files.len(), 40);
    for (((step, file), frame), drawn) in files.iter().zip(&frames).zip(draw(&frames, &view)) {
        let (picture, metadata) = png::decode(Cursor::new(file)).unwrap();
        assert_eq!(*step, frame.step);
        assert_eq!(metadata.entries, [("rebond steps".to_owned(), step.to_string())]);
        assert!(picture == drawn, "the picture of step {step} differs");
    }
}

#[test]
fn the_bytes_of_a_sequence_depend_neither_on_threads_nor_on_shards() {
    let view = small(Theme::Light, &[Overlay::Name, Overlay::Clock], ColorBy::Body);
    let frames = frames(MANY);
    let one = sequence(&frames, &view, 1);
    assert!(one == sequence(&frames, &view, 3), "3 threads write different bytes");
    let joined = [sequence(&frames[..17], &view, 1), sequence(&frames[17..], &view, 2)].concat();
    assert!(one == joined, "two shards differ from the whole");
}
