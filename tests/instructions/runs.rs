//! Six fixed workloads whose instructions the script tests/instructions/run counts: `instructions NAME`

use rebond::internals::{
    physics::CollisionCount,
    picture::{self, Metadata, Painter, View, png},
    recording::{Header, RunEnd, SceneText, Writer},
    replay, scene,
};
use std::io;

fn main() {
    match std::env::args().nth(1).as_deref() {
        Some("gas") => _ = run_scene(&gas("event-driven", 1000, 120)),
        Some("pile") => _ = run_scene(&pile(300, 240, "")),
        Some("pile-beside-forces") => _ = run_scene(&pile(300, 240, PRESSED_PAIR)),
        Some("handout") => _ = run_scene(&gas("handout", 100, 600)),
        Some("recording") => recording(&gas("event-driven", 300, 120)),
        Some("drawing") => drawing(&gas("event-driven", 50, 1)),
        Some(_) | None => panic!("expected gas, pile, pile-beside-forces, handout, recording or drawing"),
    }
}

/// Unit boxes between walls that fill a fifth of the area, e = 1.
fn gas(solver: &str, bodies: u32, steps: u32) -> scene::Scene {
    let side = (f64::from(bodies) * 5.0).sqrt();
    parse(&format!(
        "[world]\nsize = [{side}, {side}]\nwalls = true\n[run]\nrate = 60\nsteps = {steps}\nsolver = \"{solver}\"\n\
         [[scatter]]\ncount = {bodies}\nseed = 1\nregion = [0.0, 0.0, {side}, {side}]\nsize = [[1.0, 1.0], [1.0, 1.0]]\n\
         mass = [1.0, 1.0]\nvelocity = [[-5.0, -5.0], [5.0, 5.0]]\n"
    ))
}

/// Two distant boxes that are pressed together by forces of their own.
const PRESSED_PAIR: &str = "[[spawn]]\nat = [1000.0, 0.0]\nsize = [1.0, 1.0]\nmass = 1.0\nforce = [2.0, 0.0]\n\
                            [[spawn]]\nat = [1001.0, 0.0]\nsize = [1.0, 1.0]\nmass = 1.0\nforce = [1.0, 0.0]\n";

/// Boxes of sides 0.6–1.4 m that fall into a bin, e = 0.3, and other bodies.
fn pile(bodies: u32, steps: u32, others: &str) -> scene::Scene {
    let (width, height) = ((f64::from(bodies) * 3.6).sqrt(), (f64::from(bodies) * 2.3).sqrt());
    parse(&format!(
        "[world]\nsize = [{width}, {height}]\nwalls = true\ngravity = [0.0, 9.81]\n[run]\nrate = 60\nsteps = {steps}\n\
         solver = \"event-driven\"\n[restitution]\ndefault = 0.3\n\
         [[scatter]]\ncount = {bodies}\nseed = 1\nregion = [0.0, 0.0, {width}, {height}]\nsize = [[0.6, 0.6], [1.4, 1.4]]\n\
         mass = [1.0, 1.0]\nvelocity = [[-3.0, 0.0], [3.0, 0.0]]\n{others}"
    ))
}

fn parse(text: &str) -> scene::Scene {
    scene::parse("fixed.toml", text).unwrap_or_else(|error| panic!("{error}"))
}

fn start(scene: &scene::Scene) -> replay::Run {
    let mut run = replay::Run::new(scene);
    run.apply_inputs(Vec::new(), |error| Err(error.into())).expect("the scene's own events");
    run
}

/// Runs a scene to its end.
fn run_scene(scene: &scene::Scene) -> replay::Run {
    let mut run = start(scene);
    let mut collisions = CollisionCount::default();
    (0..scene.run.steps).for_each(|_| run.step(&mut collisions).expect("finite numbers"));
    run
}

/// Records every state of a gas to memory.
fn recording(scene: &scene::Scene) {
    let mut run = start(scene);
    let text = SceneText { file_name: "fixed.toml".into(), text: scene.source.text.clone() };
    let steps = scene.run.steps;
    let header = Header::new(replay::engine_config(scene), steps, text);
    let mut writer = Writer::new(io::Cursor::new(Vec::new()), &header).expect("memory");
    for _ in 0..steps {
        writer.write_state(run.engine()).expect("memory");
        run.step(&mut CollisionCount::default()).expect("finite numbers");
    }
    writer.finish(RunEnd::default()).expect("memory");
}

/// Draws three frames of a scene and encodes them as PNG.
fn drawing(scene: &scene::Scene) {
    let run = run_scene(scene);
    let [width, height] = scene.size;
    let view = View::new(rebond::internals::physics::Vector::new(width, height), picture::Style::default());
    let view = view.expect("a view");
    let sprites = run.engine().world().bodies.iter().map(|body| {
        let appearance = picture::Appearance {
            id: body.id,
            name: body.name.clone(),
            material: String::new(),
            color: None,
            image: None,
            mass: body.mass,
            force: rebond::internals::physics::Vector::ZERO,
            is_wall: body.is_infinite(),
        };
        picture::Sprite { appearance: appearance.into(), rect: body.rect, velocity: body.velocity, trail: Vec::new() }
    });
    let frame = picture::Frame { step: 0, time: 0.0, sprites: sprites.collect(), collisions: Vec::new() };
    let mut painter = Painter::new();
    for _ in 0..3 {
        let picture = painter.draw(&picture::compose(&frame, &view));
        png::encode(&picture, &Metadata::default(), png::PngEffort::Fast, io::sink())
            .expect("a sink accepts all bytes");
    }
}
