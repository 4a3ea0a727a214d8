//! Measures the cost of drawing, in ms per 1280×720 frame on one thread, including encoding and writing to a
//! file: `cargo bench --bench drawing`
//!
//! Prints the median and the range of several runs. `tests/peers/pictures.py` draws the same animation with
//! other programs.

use rebond::internals::physics::{Rect, Vector};
use rebond::internals::picture::{
    self, AnimationSchedule, Appearance, ColorBy, Frame, Look, Metadata, Overlay, Painter, Sprite, StepGrid, Style,
    Thinning, View, png,
};
use std::{fs::File, io::BufWriter, num::NonZero, sync::Arc, time::Instant};

const RUNS: usize = 7;
const FRAMES: u64 = 60;
const WORLD: Vector = Vector::new(16.0, 9.0);
const LECTURE: [Overlay; 4] = [Overlay::Velocity, Overlay::Name, Overlay::Grid, Overlay::Clock];

fn main() {
    println!("ms per frame                       PNG                    GIF                    animated PNG");
    for (name, boxes, show, color_by) in [
        ("50 boxes, plain", 50, &[][..], ColorBy::Body),
        ("50 boxes, lecture", 50, &LECTURE[..], ColorBy::Body),
        ("50 boxes, lecture, by speed", 50, &LECTURE[..], ColorBy::Speed),
        ("1000 boxes, plain", 1000, &[][..], ColorBy::Body),
        ("1000 boxes, lecture", 1000, &LECTURE[..], ColorBy::Body),
    ] {
        let look = Look { show: show.iter().copied().collect(), color_by, ..Look::default() };
        let style = Style { look, top_speed: 4.0, body_count: boxes, ..Style::default() };
        let view = View::new(WORLD, style).expect("a view");
        let frames: Vec<Frame> = (0..FRAMES).map(|step| frame(boxes, step)).collect();
        let [stills, gif, apng] = [stills, gif, apng].map(|draw| measure(|| draw(&frames, &view)));
        println!("{name:30} {stills:22} {gif:22} {apng}");
    }
}

/// Returns median and range of `RUNS` measurements after one warm-up, ms per frame.
fn measure(mut run: impl FnMut()) -> String {
    let mut time = || {
        let start = Instant::now();
        run();
        start.elapsed().as_secs_f64() * 1e3 / FRAMES as f64
    };
    time();
    let mut figures: Vec<f64> = (0..RUNS).map(|_| time()).collect();
    figures.sort_by(f64::total_cmp);
    format!("{:6.2} ({:.2}–{:.2})", figures[RUNS / 2], figures[0], figures[RUNS - 1])
}

fn temporary_file() -> BufWriter<File> {
    BufWriter::new(tempfile::tempfile().expect("a temporary file"))
}

fn stills(frames: &[Frame], view: &View) {
    let mut painter = Painter::new();
    for frame in frames {
        let picture = painter.draw(&picture::compose(frame, view));
        png::encode(&picture, &Metadata::default(), png::PngEffort::Fast, temporary_file())
            .expect("space for a picture");
    }
}

fn schedule() -> AnimationSchedule {
    AnimationSchedule::from(StepGrid::new(0..=FRAMES - 1, 60.0, Thinning::All))
}

fn gif(frames: &[Frame], view: &View) {
    let instants = frames.iter().cloned().map(|frame| Ok::<_, picture::RenderError>(frame.into()));
    let (one, stage) = (NonZero::<usize>::MIN, picture::Stage::from(view.clone()));
    picture::write_gif(instants, &stage, &schedule(), &Metadata::default(), one, temporary_file())
        .expect("space for an animation");
}

fn apng(frames: &[Frame], view: &View) {
    let instants = frames.iter().cloned().map(|frame| Ok::<_, picture::RenderError>(frame.into()));
    let (one, stage) = (NonZero::<usize>::MIN, picture::Stage::from(view.clone()));
    picture::write_apng(instants, &stage, &schedule(), &Metadata::default(), one, temporary_file())
        .expect("space for an animation");
}

/// Boxes in uniform motion, reflected at the borders.
fn frame(boxes: u32, step: u64) -> Frame {
    let time = step as f64 / 60.0;
    let unit = (50.0 / f64::from(boxes)).sqrt();
    let sprites = (0..boxes).map(|number| {
        let fraction = |k: u32| f64::from((number * k + 3) % 997) / 997.0;
        let (width, height) = ((0.4 + fraction(31)) * unit, (0.4 + fraction(57)) * unit);
        let velocity = Vector::new(6.0 * fraction(11) - 3.0, 6.0 * fraction(23) - 3.0);
        let x = reflected(fraction(41) * 15.0 + velocity.x * time, WORLD.x - width);
        let y = reflected(fraction(73) * 8.0 + velocity.y * time, WORLD.y - height);
        let appearance = Appearance {
            id: number,
            name: format!("#{number}"),
            material: String::new(),
            color: None,
            image: None,
            mass: 1.0,
            force: Vector::ZERO,
            is_wall: false,
        };
        let rect = Rect::new(Vector::new(x, y), width, height);
        Sprite { appearance: Arc::new(appearance), rect, velocity, trail: Vec::new() }
    });
    Frame { step, time, sprites: sprites.collect(), collisions: Vec::new() }
}

/// The position of a point reflected at 0 and `range` whose unreflected position is `position`.
fn reflected(position: f64, range: f64) -> f64 {
    let phase = position.rem_euclid(2.0 * range);
    if phase < range { phase } else { 2.0 * range - phase }
}
