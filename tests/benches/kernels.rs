//! Microbenchmarks of the inner loops: `cargo bench --bench kernels [NAME]`
//!
//! Private modules of the event-driven solver are compiled again as modules of this program, because the library keeps
//! them private. `rebond report` measures cost and error of complete runs.

#![allow(dead_code, unused_imports)]

use divan::{Bencher, black_box, counter::ItemsCount};
use physics::{
    CollisionCount, Engine, EngineConfig, Event, Rect, Restitution, Side, SolverKind, Spawn, Vector, handout,
};
use rebond::internals::picture::encode::{lzw, quantize::IndexedImage};
use rebond::internals::picture::{
    self, Appearance, Color, DisplayList, Frame, Metadata, Painter, Picture, Shape, Sprite, Style, View, png,
};
use rebond::internals::recording::{Header, SceneText, Versions, Writer};
use std::{io, sync::Arc};

/// The path `crate::physics` of the modules below.
mod physics {
    pub(crate) use super::event_driven;
    pub use rebond::internals::physics::*;
}

#[path = "../../src/physics/event_driven"]
mod event_driven {
    pub mod axis_trajectory;
    pub mod body_state;
    pub mod contact_group;
    pub mod decimal;
    pub mod double_double;
    pub mod event_queue;
    pub mod instant;
    pub mod pair_event;
    #[cfg(test)]
    pub mod pseudo_random;
    pub mod trajectory;
}

use event_driven::axis_trajectory::AxisTrajectory;
use event_driven::body_state::{BodyState, Load};
use event_driven::contact_group::ContactGroup;
use event_driven::event_queue::{EventQueue, Precision, ScheduledEvent};
use event_driven::instant::{Clock, Instant};
use event_driven::pair_event::{Sample, predict_pair_event};
use event_driven::trajectory::Trajectory;

fn main() {
    divan::main();
}

fn config(solver: SolverKind) -> EngineConfig {
    let restitution = Restitution::new(1.0, &[]);
    EngineConfig::new(solver, 60.0).with_restitution(restitution)
}

/// Unit boxes in rows with different velocities.
fn engine(solver: SolverKind, bodies: u32) -> Engine {
    let mut engine = Engine::new(config(solver));
    for number in 0..bodies {
        let at = Vector::new(f64::from(number % 32) * 2.0, f64::from(number / 32) * 2.0);
        let component = |prime: u32| f64::from(number * prime % 97) / 97.0 - 0.5;
        let spawn = Spawn::new(format!("#{number}"), Rect::new(at, 1.0, 1.0), 1.0);
        engine.apply(&Event::Spawn(spawn.with_velocity(Vector::new(component(31), component(57)))));
    }
    engine
}

/// A step of the handout solver with a pair that is separated and with one that collides.
#[divan::bench(args = [2.0, 0.9])]
fn handout_pair(bencher: Bencher, distance: f64) {
    let mut world = engine(SolverKind::Handout, 2).world().clone();
    world.bodies[1].rect.origin.x = distance;
    bencher
        .counter(ItemsCount::new(2_u32))
        .with_inputs(|| world.clone())
        .bench_refs(|world| handout::step(world, 0, 1.0 / 60.0, &mut CollisionCount::default()));
}

fn body(x: f64, y: f64, velocity: [f64; 2], acceleration: f64) -> BodyState {
    let since = Instant::START;
    let along =
        |position: f64, velocity: f64, acceleration: f64| AxisTrajectory { position, velocity, acceleration, since };
    BodyState {
        trajectory: Trajectory::new([along(x, velocity[0], 0.0), along(y, velocity[1], acceleration)]),
        size: [1.0; 2],
        since,
        generation: 0,
        world_index: 0,
        infinite: false,
        load: [Load::GravityOnly; 2],
    }
}

/// Predicts the event of two boxes: none, in uniform motion, in accelerated motion.
#[divan::bench(args = ["separated", "uniform", "falling"])]
fn pair_event(bencher: Bencher, motion: &str) {
    let first = body(0.0, 0.0, [0.0; 2], 0.0);
    let second = match motion {
        "separated" => body(5.0, 0.3, [1.0, 0.5], 0.0),
        "uniform" => body(5.0, 0.3, [-3.0, 0.1], 0.0),
        _ => body(0.2, -5.0, [0.1, 0.0], 9.81),
    };
    let sample = Sample::new(&first, Instant::START);
    bencher.bench_local(|| {
        predict_pair_event(black_box(&sample), black_box(&second), Side::Low, f64::INFINITY, Instant::START)
    });
}

/// Inserts and removes one event per body.
#[divan::bench(args = [100, 10_000])]
fn event_queue(bencher: Bencher, bodies: u32) {
    let clock = Clock::new(60.0);
    bencher
        .counter(ItemsCount::new(bodies))
        .with_inputs(|| EventQueue::new(clock, 0, bodies as usize))
        .bench_local_refs(|queue| {
            for slot in 0..bodies {
                let offset = f64::from(slot * 7919 % bodies) / f64::from(bodies) / 60.0;
                let event = ScheduledEvent {
                    at: Instant::START.after(offset),
                    pair: [slot; 2],
                    pair_event: None,
                    partner_generation: 0,
                    precision: Precision::Exact,
                };
                queue.set(slot, Some(event));
            }
            while let Some(event) = queue.pop(Instant::START.after(1.0 / 60.0)) {
                black_box(event);
            }
        });
}

/// Schedules one cell crossing per body within eight steps and collects it.
#[divan::bench(args = [100, 10_000])]
fn cell_crossings(bencher: Bencher, bodies: u32) {
    let mut due = Vec::new();
    let mut queue = EventQueue::new(Clock::new(60.0), 0, bodies as usize);
    bencher.counter(ItemsCount::new(bodies)).bench_local(move || {
        (0..bodies).for_each(|slot| queue.set_crossing(slot, Some(1 + slot % 8)));
        (0..8).for_each(|_| queue.begin_next_step(&mut due));
        due.clear();
    });
}

/// Solves the accelerations of a stack of boxes whose lowest has just lost its support.
#[divan::bench(args = [2, 10, 100])]
fn contact_accelerations(bencher: Bencher, bodies: usize) {
    let mut group = ContactGroup::default();
    for body in 0..bodies {
        let force = 9.81 + (body % 3) as f64;
        group.add(force.into(), 1.0.into(), force.into());
        if body > 0 {
            group.connect([body - 1, body]);
        }
    }
    bencher.counter(ItemsCount::new(bodies)).bench(|| black_box(&group).accelerations());
}

/// Records one state; another thread compresses it.
#[divan::bench(args = [100, 10_000])]
fn write_state(bencher: Bencher, bodies: u32) {
    let engine = engine(SolverKind::EventDriven, bodies);
    let scene = SceneText { file_name: "bench.toml".into(), text: String::new() };
    let header = Header::new(config(SolverKind::EventDriven), u64::MAX, scene);
    let mut writer = Writer::new(io::Cursor::new(Vec::new()), &header).expect("memory");
    bencher.counter(ItemsCount::new(bodies)).bench_local(move || writer.write_state(&engine).expect("memory"));
}

fn view() -> View {
    View::new(Vector::new(64.0, 36.0), Style::default()).expect("a view")
}

/// A frame of fifty named boxes.
fn frame() -> Frame {
    let engine = engine(SolverKind::Handout, 50);
    let sprites = engine.world().bodies.iter().map(|body| {
        let appearance = Appearance {
            id: body.id,
            name: body.name.clone(),
            material: String::new(),
            color: None,
            image: None,
            mass: 1.0,
            force: Vector::ZERO,
            is_wall: false,
        };
        Sprite { appearance: Arc::new(appearance), rect: body.rect, velocity: body.velocity, trail: Vec::new() }
    });
    Frame { step: 0, time: 0.0, sprites: sprites.collect(), collisions: Vec::new() }
}

fn picture() -> Picture {
    Painter::new().draw(&picture::compose(&frame(), &view()))
}

/// Draws 1280×720 pixels with fifty boxes.
#[divan::bench]
fn frame_draw(bencher: Bencher) {
    let (frame, view, mut painter) = (frame(), view(), Painter::new());
    bencher.bench_local(move || painter.draw(&picture::compose(&frame, &view)));
}

/// The ends of the lines of 500 arrows, px.
fn lines() -> Vec<[[f32; 2]; 2]> {
    let line = |number: u32| {
        let [x, y] = [number % 25 * 50, number / 25 * 35].map(|at| 10.0 + at as f32);
        [[x, y], [x + 20.0 + (number % 7) as f32 * 5.0, y + (number % 11) as f32 * 3.0]]
    };
    (0..500).map(line).collect()
}

/// The width of the lines, px.
const LINE_WIDTH: f32 = 2.5;

/// Draws 500 lines with round caps on 1280×720 pixels.
#[divan::bench]
fn lines_draw(bencher: Bencher) {
    let shape = |ends: [[f32; 2]; 2]| Shape::Polyline {
        points: ends.map(|[x, y]| Vector::new(x.into(), y.into())).to_vec(),
        width: LINE_WIDTH.into(),
        ink: Color::hex(0).into(),
    };
    let shapes = lines().into_iter().map(shape).collect();
    let list = DisplayList { size: [1280, 720], background: Color::hex(0xffffff), backdrop: Vec::new(), shapes };
    let mut painter = Painter::new();
    bencher.bench_local(move || painter.draw(black_box(&list)));
}

/// The same with tiny-skia, which fills the outline of each line.
#[divan::bench]
fn lines_draw_tiny_skia(bencher: Bencher) {
    use tiny_skia::{LineCap, Paint, PathBuilder, Pixmap, Stroke, Transform};
    let lines = lines();
    let (paint, stroke) =
        (Paint::default(), Stroke { width: LINE_WIDTH, line_cap: LineCap::Round, ..Stroke::default() });
    bencher.bench(|| {
        let mut pixmap = Pixmap::new(1280, 720).expect("a size of pictures");
        pixmap.fill(tiny_skia::Color::WHITE);
        for [from, to] in black_box(&lines) {
            let mut path = PathBuilder::new();
            path.move_to(from[0], from[1]);
            path.line_to(to[0], to[1]);
            let path = path.finish().expect("a line of some length");
            pixmap.stroke_path(&path, &paint, &stroke, Transform::identity(), None);
        }
        pixmap
    });
}

#[divan::bench]
fn png_encode(bencher: Bencher) {
    let picture = picture();
    bencher.bench(|| png::encode(&picture, &Metadata::default(), png::PngEffort::Fast, io::sink()));
}

/// 1280×720 pixels in bands of seven colours.
fn bands() -> Vec<u8> {
    (0..1280 * 720_usize).map(|index| (index / 40 % 7) as u8).collect()
}

/// Compresses bands of colour with LZW, as for GIF.
#[divan::bench]
fn lzw_compress(bencher: Bencher) {
    let pixels = bands();
    bencher.counter(divan::counter::BytesCount::of_slice(&pixels)).bench(|| lzw::compress(black_box(&pixels)));
}

/// The same with weezl, of which the gif crate uses an earlier version.
#[divan::bench]
fn lzw_compress_weezl(bencher: Bencher) {
    let pixels = bands();
    let encode = || weezl::encode::Encoder::new(weezl::BitOrder::Lsb, 3).encode(black_box(&pixels));
    bencher.counter(divan::counter::BytesCount::of_slice(&pixels)).bench(encode);
}

/// Boxes with antialiased edges in 1668 colours, 960×540 pixels.
fn many_colors() -> Vec<[u8; 4]> {
    let color = |run: usize| {
        let number = if run.is_multiple_of(8) { run % 1668 } else { run % 8 };
        [number as u8, (number >> 3) as u8, (number / 7) as u8, 255]
    };
    (0..960 * 540_usize).map(|index| color(index / 14)).collect()
}

/// Chooses 256 of many colours, as for GIF.
#[divan::bench]
fn quantize(bencher: Bencher) {
    let pixels = many_colors();
    bencher.bench(|| IndexedImage::quantized(black_box(&pixels)));
}

/// The same with the quantiser of the gif crate, at its best quality that is usual for GIF.
#[divan::bench]
fn neuquant(bencher: Bencher) {
    const SAMPLING: i32 = 10;
    let pixels = many_colors();
    let bytes = pixels.as_flattened();
    bencher.bench(|| {
        let colors = color_quant::NeuQuant::new(SAMPLING, 256, black_box(bytes));
        pixels.iter().map(|pixel| colors.index_of(pixel)).sum::<usize>()
    });
}
