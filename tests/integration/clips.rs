//! Animations and sequences: what is in the file is what was drawn, shown when it should be.

use crate::frames::{WORLD, moving, view};
use rebond::render::{
    Frame, Metadata, Painter, Picture, RenderError, Sampling, Thinning, Timeline, View, compose, png, write_apng,
    write_gif, write_png_sequence,
};
use rebond::scene::{ColorBy, Overlay, Theme};
use std::io::Cursor;
use std::num::NonZero;

/// So many boxes that a frame has more than 256 colours.
const MANY: u32 = 120;

/// A tiny picture: what is tested here does not hang on its size.
fn small(theme: Theme, show: &[Overlay], color_by: ColorBy) -> View {
    View::fit(WORLD, [320, 180], view(theme, show, color_by).style).unwrap()
}

fn sampling() -> Sampling {
    Sampling::new(0..=79, 60.0, Thinning::Every(2))
}

fn frames(count: u32) -> Vec<Frame> {
    (0..80).filter(|&step| sampling().shows(step)).map(|step| moving(count, step)).collect()
}

fn gif(frames: &[Frame], view: &View, threads: usize) -> Vec<u8> {
    let metadata = Metadata { entries: vec![("rebond steps".into(), "0 to 79 every 2".into())] };
    let mut file = Vec::new();
    let frames = frames.iter().cloned().map(Ok::<_, RenderError>);
    write_gif(frames, view, &Timeline::from(sampling()), &metadata, NonZero::new(threads).unwrap(), &mut file).unwrap();
    file
}

/// What a viewer shows: pictures and how long each stays, 1/100 s.
fn shown(file: &[u8]) -> Vec<(Picture, u16)> {
    let mut options = gif::DecodeOptions::new();
    options.set_color_output(gif::ColorOutput::RGBA);
    options.check_frame_consistency(true);
    let mut decoder = options.read_info(file).unwrap();
    let size = [u32::from(decoder.width()), u32::from(decoder.height())];
    let mut screen = Picture { size, pixels: vec![[0; 4]; (size[0] * size[1]) as usize] };
    let mut pictures = Vec::new();
    while let Some(frame) = decoder.read_next_frame().unwrap() {
        assert_eq!(frame.dispose, gif::DisposalMethod::Keep);
        lay(&mut screen, frame);
        pictures.push((screen.clone(), frame.delay));
    }
    pictures
}

fn lay(screen: &mut Picture, frame: &gif::Frame) {
    let (left, top, width) = (usize::from(frame.left), usize::from(frame.top), usize::from(frame.width));
    for (row, from) in frame.buffer.as_chunks::<4>().0.chunks_exact(width).enumerate() {
        let start = (top + row) * screen.size[0] as usize + left;
        for (to, from) in screen.pixels[start..][..width].iter_mut().zip(from) {
            if from[3] != 0 {
                *to = *from;
            }
        }
    }
}

fn drawn(frames: &[Frame], view: &View) -> Vec<Picture> {
    frames.iter().map(|frame| Painter::new().draw(&compose(frame, view))).collect()
}

#[test]
fn a_gif_shows_the_drawn_pixels() {
    for theme in Theme::ALL {
        let view = small(*theme, &[Overlay::Name, Overlay::Clock, Overlay::Grid], ColorBy::Body);
        let frames = frames(5);
        let shown: Vec<Picture> = shown(&gif(&frames, &view, 1)).into_iter().map(|(picture, _)| picture).collect();
        assert!(shown == drawn(&frames, &view), "a frame differs");
    }
}

#[test]
fn a_gif_of_too_many_colours_shows_near_ones() {
    let view = small(Theme::Light, Overlay::ALL, ColorBy::Speed);
    let frames = frames(MANY);
    let drawn = drawn(&frames, &view);
    let colors: std::collections::BTreeSet<[u8; 4]> = drawn[0].pixels.iter().copied().collect();
    assert!(colors.len() > 256, "{} colours are not too many", colors.len());
    for ((shown, _), drawn) in shown(&gif(&frames, &view, 1)).iter().zip(&drawn) {
        let pairs = shown.pixels.iter().flatten().zip(drawn.pixels.iter().flatten());
        let differences: Vec<u64> = pairs.map(|(a, b)| u64::from(a.abs_diff(*b))).collect();
        assert!(differences.iter().all(|&difference| difference < 24), "{:?}", differences.iter().max());
        let mean = differences.iter().sum::<u64>() as f64 / differences.len() as f64;
        assert!(mean < 0.2, "differs by {mean} on average");
    }
}

#[test]
fn a_gif_lasts_as_long_as_what_it_shows() {
    let view = small(Theme::Light, &[], ColorBy::Body);
    let shown = shown(&gif(&frames(3), &view, 1));
    assert_eq!(shown.len(), 40);
    assert_eq!(shown.iter().map(|(_, delay)| u64::from(*delay)).sum::<u64>(), 133, "40 frames of 2 steps at 60 Hz");
    assert!(shown.iter().all(|(_, delay)| [3, 4].contains(delay)));
}

#[test]
fn a_gif_repeats_for_ever_and_tells_where_it_is_from() {
    let file = gif(&frames(1), &small(Theme::Light, &[], ColorBy::Body), 1);
    let holds = |bytes: &[u8]| file.windows(bytes.len()).any(|window| window == bytes);
    assert!(holds(b"NETSCAPE2.0\x03\x01\x00\x00\x00"));
    assert!(holds(b"\x21\xfe\x1erebond steps: 0 to 79 every 2\n\x00"));
}

#[test]
fn a_gif_holds_only_what_changes() {
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
fn the_bytes_of_a_gif_do_not_depend_on_the_threads() {
    for (count, show) in [(5, [Overlay::Name].as_slice()), (MANY, Overlay::ALL)] {
        let view = small(Theme::Dark, show, ColorBy::Speed);
        let frames = frames(count);
        let one = gif(&frames, &view, 1);
        assert!(one == gif(&frames, &view, 2), "2 threads write other bytes");
        assert!(one == gif(&frames, &view, 5), "5 threads write other bytes");
    }
}

/// A long clip is held by the hash of each picture: what a change did is seen by rendering it.
#[test]
fn every_picture_of_a_long_clip() {
    use rebond::illustration::{Source, Wish, WishedSubject, frames, timeline, view};
    use std::fmt::Write;
    let recordings = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("recordings");
    let mut hashes = String::new();
    for (name, theme) in [("click-session", Theme::Light), ("falling-heap", Theme::Dark)] {
        let sources = [Source::open(&recordings.join(format!("{name}.mcap"))).unwrap()];
        let wish = Wish {
            every: Some(5),
            size: Some([320, 180]),
            theme: Some(theme),
            show: Some(Overlay::ALL.to_vec()),
            ..Wish::new(WishedSubject::Sequence)
        };
        let request = wish.request(&sources, &mut |_, _| ()).unwrap();
        let timeline = timeline(&request, &sources[0], &mut |_, _| ()).unwrap();
        let view = view(&request, &sources[0], &mut |_, _| ()).unwrap();
        let mut painter = Painter::new();
        for frame in frames(&request, &sources[0], &timeline).unwrap() {
            let frame = frame.unwrap();
            let picture = painter.draw(&compose(&frame, &view));
            let hash = xxhash_rust::xxh3::xxh3_64(picture.pixels.as_flattened());
            writeln!(hashes, "{name} {:04} {hash:016x}", frame.step).unwrap();
        }
    }
    crate::snapshot::assert_text("clip-hashes", &hashes);
}

fn apng(frames: &[Frame], view: &View, threads: usize) -> Vec<u8> {
    let metadata = Metadata { entries: vec![("rebond steps".into(), "0 to 79 every 2".into())] };
    let mut file = Vec::new();
    let frames = frames.iter().cloned().map(Ok::<_, RenderError>);
    write_apng(frames, view, &Timeline::from(sampling()), &metadata, NonZero::new(threads).unwrap(), &mut file)
        .unwrap();
    file
}

/// What a viewer of animated PNG shows, and for how many parts of a second.
fn shown_apng(file: &[u8]) -> Vec<(Picture, [u16; 2])> {
    let mut reader = ::png::Decoder::new(Cursor::new(file)).read_info().unwrap();
    let size = [reader.info().width, reader.info().height];
    let count = reader.info().animation_control.unwrap().num_frames;
    let mut screen = Picture { size, pixels: vec![[0; 4]; (size[0] * size[1]) as usize] };
    let mut bytes = vec![0; reader.output_buffer_size().unwrap()];
    let mut pictures = Vec::new();
    for _ in 0..count {
        reader.next_frame(&mut bytes).unwrap();
        let control = *reader.info().frame_control().unwrap();
        assert_eq!((control.dispose_op, control.blend_op), (::png::DisposeOp::None, ::png::BlendOp::Over));
        let pixels = bytes.as_chunks::<4>().0.chunks_exact(control.width as usize);
        for (row, from) in (control.y_offset..).zip(pixels.take(control.height as usize)) {
            let start = (row * size[0] + control.x_offset) as usize;
            for (to, from) in screen.pixels[start..].iter_mut().zip(from).filter(|(_, from)| from[3] != 0) {
                *to = *from;
            }
        }
        pictures.push((screen.clone(), [control.delay_num, control.delay_den]));
    }
    pictures
}

#[test]
fn an_animated_png_shows_the_drawn_pixels_at_their_instants() {
    let view = small(Theme::Light, Overlay::ALL, ColorBy::Speed);
    let frames = frames(MANY);
    let (pictures, delays): (Vec<Picture>, Vec<[u16; 2]>) = shown_apng(&apng(&frames, &view, 1)).into_iter().unzip();
    assert!(pictures == drawn(&frames, &view), "a frame differs");
    assert_eq!(delays, [[2, 60]; 40]);
}

#[test]
fn an_animated_png_is_a_picture_that_tells_where_it_is_from() {
    let view = small(Theme::Light, &[], ColorBy::Body);
    let frames = frames(3);
    let (picture, metadata) = png::decode(Cursor::new(apng(&frames, &view, 2))).unwrap();
    assert!(picture == drawn(&frames, &view)[0], "not the first frame");
    assert_eq!(metadata.entries, [("rebond steps".to_owned(), "0 to 79 every 2".to_owned())]);
}

#[test]
fn the_bytes_of_an_animated_png_do_not_depend_on_the_threads() {
    let view = small(Theme::Dark, &[Overlay::Name], ColorBy::Body);
    let frames = frames(9);
    assert!(apng(&frames, &view, 1) == apng(&frames, &view, 3), "3 threads write other bytes");
}

#[test]
fn an_animated_png_of_too_few_frames_is_an_error() {
    let view = small(Theme::Light, &[], ColorBy::Body);
    let frames = frames(1)[..39].to_vec().into_iter().map(Ok::<_, RenderError>);
    let end = write_apng(
        frames,
        &view,
        &Timeline::from(sampling()),
        &Metadata::default(),
        NonZero::<usize>::MIN,
        std::io::sink(),
    );
    assert_eq!(end.unwrap_err().to_string(), "an animation of 40 pictures was to be written, but there are 39");
}

fn sequence(frames: &[Frame], view: &View, threads: usize) -> Vec<(u64, Vec<u8>)> {
    let mut files = Vec::new();
    let metadata = |step: u64| Metadata { entries: vec![("rebond steps".into(), step.to_string())] };
    let frames = frames.iter().cloned().map(Ok::<_, RenderError>);
    write_png_sequence(frames, view, metadata, NonZero::new(threads).unwrap(), |step, file| {
        files.push((step, file));
        Ok(())
    })
    .unwrap();
    files
}

#[test]
fn a_sequence_holds_each_drawn_frame_in_order() {
    let view = small(Theme::Light, Overlay::ALL, ColorBy::Material);
    let frames = frames(5);
    let files = sequence(&frames, &view, 2);
    assert_eq!(files.len(), 40);
    for (((step, file), frame), drawn) in files.iter().zip(&frames).zip(drawn(&frames, &view)) {
        let (picture, metadata) = png::decode(Cursor::new(file)).unwrap();
        assert_eq!(*step, frame.step);
        assert_eq!(metadata.entries, [("rebond steps".to_owned(), step.to_string())]);
        assert!(picture == drawn, "the picture of step {step} differs");
    }
}

#[test]
fn the_bytes_of_a_sequence_depend_neither_on_threads_nor_on_parts() {
    let view = small(Theme::Light, &[Overlay::Name, Overlay::Clock], ColorBy::Body);
    let frames = frames(MANY);
    let one = sequence(&frames, &view, 1);
    assert!(one == sequence(&frames, &view, 3), "3 threads write other bytes");
    let parts = [sequence(&frames[..17], &view, 1), sequence(&frames[17..], &view, 2)].concat();
    assert!(one == parts, "two parts differ from the whole");
}
