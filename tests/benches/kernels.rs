//! The inner loops one by one, for whoever changes them: `cargo bench --bench kernels [NAME]`
//!
//! Parts of the exact solver that are private to it are compiled once more as modules of this
//! program. What whole runs cost beside their errors is told by `rebond report`.

#![allow(dead_code, unused_imports)]

use divan::{Bencher, black_box, counter::ItemsCount};
use physics::{CollisionCount, Engine, Event, Rect, Restitution, Settings, SolverKind, Spawn, Vector, handout};
use rebond::recording::{Header, SceneText, Versions, Writer};
use rebond::render::{self, Appearance, Frame, Metadata, Painter, Picture, Sprite, Style, View, png};
use std::{io, sync::Arc};

/// What those parts know as `crate::physics`.
mod physics {
    pub(crate) use super::event_driven;
    pub use rebond::physics::*;
}

#[path = "../../src/physics/event_driven"]
mod event_driven {
    pub mod calendar;
    pub mod double_double;
    pub mod instant;
    pub mod least_change;
    pub mod meeting;
    pub mod motion;
    pub mod motions;
    pub mod mover;
    pub mod schedule;
}

#[path = "../../src/render/lzw.rs"]
mod lzw;

use event_driven::calendar::Calendar;
use event_driven::instant::{Clock, Instant};
use event_driven::least_change::{Group, least_change};
use event_driven::meeting::{State, meeting};
use event_driven::motion::Motion;
use event_driven::motions::Motions;
use event_driven::mover::Mover;
use event_driven::schedule::{Schedule, Turn};

fn main() {
    divan::main();
}

fn settings(solver: SolverKind) -> Settings {
    let restitution = Restitution::new(1.0, &[]);
    Settings { solver, rate: 60.0, gravity: None, restitution, events_per_step: 1_000_000 }
}

/// Unit boxes in rows, each on a way of its own.
fn engine(solver: SolverKind, bodies: u32) -> Engine {
    let mut engine = Engine::new(settings(solver));
    for number in 0..bodies {
        let at = Vector::new(f64::from(number % 32) * 2.0, f64::from(number / 32) * 2.0);
        let part = |prime: u32| f64::from(number * prime % 97) / 97.0 - 0.5;
        engine.apply(&Event::Spawn(Spawn {
            name: format!("#{number}"),
            rect: Rect::new(at, 1.0, 1.0),
            mass: 1.0,
            velocity: Vector::new(part(31), part(57)),
            force: Vector::ZERO,
            material: String::new(),
        }));
    }
    engine
}

/// The handout's look at a pair that is apart, and at one that collides.
#[divan::bench(args = [2.0, 0.9])]
fn handout_pair(bencher: Bencher, distance: f64) {
    let mut world = engine(SolverKind::Handout, 2).world().clone();
    world.bodies[1].rect.origin.x = distance;
    bencher
        .counter(ItemsCount::new(2_u32))
        .with_inputs(|| world.clone())
        .bench_refs(|world| handout::step(world, 0, 1.0 / 60.0, &mut CollisionCount::default()));
}

fn mover(x: f64, y: f64, velocity: [f64; 2], acceleration: f64) -> Mover {
    let since = Instant::start_of(0);
    let along = |position: f64, velocity: f64, acceleration: f64| Motion { position, velocity, acceleration, since };
    Mover {
        motion: Motions::new([along(x, velocity[0], 0.0), along(y, velocity[1], acceleration)]),
        size: [1.0; 2],
        since,
        generation: 0,
        place: 0,
        infinite: false,
        held: [[false; 2]; 2],
        hurry: [0; 2],
    }
}

/// When two boxes meet: never, on straight lines, on parabolas.
#[divan::bench(args = ["apart", "straight", "falling"])]
fn pair_meeting(bencher: Bencher, way: &str) {
    let clock = Clock::new(60.0);
    let first = mover(0.0, 0.0, [0.0; 2], 0.0);
    let second = match way {
        "apart" => mover(5.0, 0.3, [1.0, 0.5], 0.0),
        "straight" => mover(5.0, 0.3, [-3.0, 0.1], 0.0),
        _ => mover(0.2, -5.0, [0.1, 0.0], 9.81),
    };
    let state = State::new(&clock, &first, Instant::start_of(0));
    bencher.bench_local(|| meeting(black_box(&clock), black_box(&state), black_box(&second), f64::INFINITY));
}

/// Each of so many bodies gets a turn, and has it.
#[divan::bench(args = [100, 10_000])]
fn schedule(bencher: Bencher, bodies: u32) {
    let clock = Clock::new(60.0);
    bencher.counter(ItemsCount::new(bodies)).with_inputs(|| Schedule::new(clock, 0, bodies as usize)).bench_local_refs(
        |schedule| {
            for slot in 0..bodies {
                let offset = f64::from(slot * 7919 % bodies) / f64::from(bodies) / 60.0;
                let at = Instant { step: 0.0, offset };
                schedule.set(slot, Some(Turn { at, pair: [slot; 2], meeting: None, generation: 0 }));
            }
            schedule.begin(0);
            while let Some(turn) = schedule.next(0) {
                black_box(turn);
            }
        },
    );
}

/// Each of so many bodies is noted, and due within eight steps.
#[divan::bench(args = [100, 10_000])]
fn calendar(bencher: Bencher, bodies: u32) {
    let mut due = Vec::new();
    let mut calendar = Calendar::new(0);
    (0..bodies).for_each(|_| calendar.add_body());
    bencher.counter(ItemsCount::new(bodies)).bench_local(move || {
        (0..bodies).for_each(|slot| calendar.note(slot, 1 + slot % 8));
        (0..8).for_each(|_| calendar.turn_page(&mut due));
        due.clear();
    });
}

/// A chain of boxes on each other whose lowest has just lost its support.
#[divan::bench(args = [2, 10, 100])]
fn accelerations_of_least_change(bencher: Bencher, bodies: usize) {
    let mut group = Group::default();
    for body in 0..bodies {
        group.add(9.81 + (body % 3) as f64, 1.0, [false; 2]);
        group.order.extend((body > 0).then(|| [body - 1, body]));
    }
    bencher.counter(ItemsCount::new(bodies)).bench(|| least_change(black_box(&group)));
}

/// Recording one state, compressed beside.
#[divan::bench(args = [100, 10_000])]
fn recorder_push(bencher: Bencher, bodies: u32) {
    let engine = engine(SolverKind::EventDriven, bodies);
    let scene = SceneText { file_name: "bench.toml".into(), text: String::new() };
    let settings = settings(SolverKind::EventDriven);
    let header = Header { versions: Versions::CURRENT, settings, steps: u64::MAX, every: 1, scene, gaps: Vec::new() };
    let mut writer = Writer::new(io::Cursor::new(Vec::new()), &header).expect("memory");
    bencher.counter(ItemsCount::new(bodies)).bench_local(move || writer.state(&engine).expect("memory"));
}

fn view() -> View {
    View::fit(Vector::new(64.0, 36.0), [1280, 720], Style::default()).expect("a view")
}

/// Fifty named boxes.
fn frame() -> Frame {
    let engine = engine(SolverKind::Handout, 50);
    let sprites = engine.world().bodies.iter().map(|body| {
        let appearance = Appearance {
            id: body.id,
            name: body.name.clone(),
            material: String::new(),
            color: None,
            mass: 1.0,
            force: Vector::ZERO,
            is_wall: false,
        };
        Sprite { appearance: Arc::new(appearance), rect: body.rect, velocity: body.velocity, trail: Vec::new() }
    });
    Frame { step: 0, time: 0.0, sprites: sprites.collect(), collisions: Vec::new() }
}

fn picture() -> Picture {
    Painter::new().draw(&render::compose(&frame(), &view()))
}

/// 1280×720 pixels of fifty boxes.
#[divan::bench]
fn frame_draw(bencher: Bencher) {
    let (frame, view, mut painter) = (frame(), view(), Painter::new());
    bencher.bench_local(move || painter.draw(&render::compose(&frame, &view)));
}

#[divan::bench]
fn png_encode(bencher: Bencher) {
    let picture = picture();
    bencher.bench(|| png::encode(&picture, &Metadata::default(), io::sink()));
}

/// The compression of GIF, of 1280×720 pixels in bands of colour.
#[divan::bench]
fn lzw_compress(bencher: Bencher) {
    let pixels: Vec<u8> = (0..1280 * 720_usize).map(|at| (at / 40 % 7) as u8).collect();
    bencher.counter(divan::counter::BytesCount::of_slice(&pixels)).bench(|| lzw::compress(black_box(&pixels)));
}
