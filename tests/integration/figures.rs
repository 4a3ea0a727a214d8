//! Lecture figures of two small runs, in both themes.

use crate::reference::assert_reference;
use rebond::figure::{self, Axis, EnergySample, FigureOptions};
use rebond::physics::{Collision, Engine, Event, Rect, Restitution, Settings, SolverKind, Spawn, Vector, invariants};
use rebond::render::{Appearance, DisplayList, Frame, Metadata, Painter, Sprite, Style, svg};
use rebond::scene::{ColorBy, Overlay, Theme};
use std::sync::Arc;

const WORLD: Vector = Vector::new(8.0, 4.5);

/// A run of the handout's solver, kept whole.
struct Run {
    bodies: Vec<Arc<Appearance>>,
    frames: Vec<Frame>,
    energy: Vec<EnergySample>,
    collisions: Vec<Collision>,
}

/// Name, x, y, width, height, velocity; masses are 1 kg, those of walls infinite.
type Given = (&'static str, [f64; 4], [f64; 2]);

fn run(given: &[Given], gravity: Option<Vector>, rate: f64, steps: u64) -> Run {
    let restitution = Restitution::new(0.8, &[]);
    let settings = Settings { solver: SolverKind::Handout, rate, gravity, restitution, events_per_step: 1000 };
    let mut engine = Engine::new(settings);
    let mut run = Run { bodies: Vec::new(), frames: Vec::new(), energy: Vec::new(), collisions: Vec::new() };
    for given in given {
        engine.apply(&Event::Spawn(spawn(given)));
        let id = run.bodies.len() as u32;
        run.bodies.push(Arc::new(appearance(id, given)));
    }
    for _ in 0..=steps {
        run.keep(&engine, rate);
        engine.step(&mut run.collisions).unwrap();
    }
    run
}

fn spawn((name, [x, y, width, height], [vx, vy]): &Given) -> Spawn {
    Spawn {
        name: (*name).into(),
        rect: Rect::new(Vector::new(*x, *y), *width, *height),
        mass: mass(name),
        velocity: Vector::new(*vx, *vy),
        force: Vector::ZERO,
        material: String::new(),
    }
}

fn appearance(id: u32, (name, _, _): &Given) -> Appearance {
    let is_wall = name.starts_with("wall-");
    Appearance { id, name: (*name).into(), material: String::new(), color: None, mass: mass(name), is_wall }
}

fn mass(name: &str) -> f64 {
    if name.starts_with("wall-") { f64::INFINITY } else { 1.0 }
}

impl Run {
    fn keep(&mut self, engine: &Engine, rate: f64) {
        let (step, world) = (engine.present_step(), engine.world());
        let time = step as f64 / rate;
        let sprite = |body: &rebond::physics::Body| Sprite {
            appearance: self.bodies[body.id as usize].clone(),
            rect: body.rect,
            velocity: body.velocity,
            trail: Vec::new(),
        };
        let sprites = world.bodies.iter().map(sprite).collect();
        self.frames.push(Frame { step, time, sprites, collisions: Vec::new() });
        let (kinetic, potential) = (invariants::kinetic_energy(world), invariants::potential_energy(world));
        self.energy.push(EnergySample { time, kinetic, potential, momentum: invariants::momentum(world) });
    }

    fn every(&self, steps: usize) -> Vec<Frame> {
        self.frames.iter().step_by(steps).cloned().collect()
    }

    /// The first collision that gave an impulse, and the two it is of.
    fn first_collision(&self) -> (&Collision, [&Appearance; 2]) {
        let collision = self.collisions.iter().find(|collision| collision.impulse != 0.0).unwrap();
        (collision, collision.bodies.map(|id| &*self.bodies[id as usize]))
    }
}

/// Two boxes that fly at each other.
fn pair() -> Run {
    let given: [Given; 2] = [("c", [1.0, 1.2, 2.0, 1.2], [2.5, 0.5]), ("b", [4.3, 1.9, 1.6, 1.6], [-1.2, -0.4])];
    run(&given, None, 6.0, 12)
}

/// Three boxes that fall on a floor and meet.
fn fall() -> Run {
    let given: [Given; 6] = [
        ("wall-bottom", [-1.0, 4.5, 10.0, 1.0], [0.0, 0.0]),
        ("wall-left", [-1.0, 0.0, 1.0, 4.5], [0.0, 0.0]),
        ("wall-right", [8.0, 0.0, 1.0, 4.5], [0.0, 0.0]),
        ("left", [1.0, 0.5, 0.8, 0.8], [1.5, 0.0]),
        ("middle", [3.5, 1.5, 1.0, 0.6], [0.0, 0.0]),
        ("right", [6.0, 1.0, 0.6, 0.8], [-1.5, 0.0]),
    ];
    run(&given, Some(Vector::new(0.0, 9.81)), 60.0, 120)
}

fn options(theme: Theme, caption: Option<&str>) -> FigureOptions {
    let style = Style {
        theme,
        show: vec![Overlay::Name, Overlay::Grid],
        color_by: ColorBy::Body,
        top_speed: 8.0,
        materials: Vec::new(),
    };
    FigureOptions { size: [800, 450], world: WORLD, style, caption: caption.map(str::to_owned) }
}

/// Every kind, in a theme.
fn figures(theme: Theme) -> Vec<(&'static str, DisplayList)> {
    let (pair, fall) = (pair(), fall());
    let plain = options(theme, None);
    let captioned = options(theme, Some("Three boxes let fall, e = 0.8"));
    let (met, met_bodies) = pair.first_collision();
    let (hit, hit_bodies) = fall.first_collision();
    vec![
        ("collision", figure::collision(met, met_bodies, &plain)),
        ("collision-close", figure::collision(hit, hit_bodies, &captioned)),
        ("minkowski", figure::minkowski(met, met_bodies, &plain)),
        ("minkowski-close", figure::minkowski(hit, hit_bodies, &captioned)),
        ("strobe", figure::strobe(&fall.every(6), &captioned)),
        ("filmstrip", figure::filmstrip(&fall.every(20), &captioned)),
        ("spacetime-x", figure::spacetime(&fall.frames, Axis::X, &plain)),
        ("spacetime-y", figure::spacetime(&fall.frames, Axis::Y, &captioned)),
        ("energy", figure::energy(&fall.energy, &captioned)),
    ]
}

#[test]
fn each_kind_in_both_themes() {
    for theme in Theme::ALL {
        for (kind, list) in figures(*theme) {
            assert_reference(&format!("figure-{kind}-{}", theme.name()), &Painter::new().draw(&list));
        }
    }
}

#[test]
fn a_figure_as_svg_is_held_as_text() {
    let (run, mut file) = (pair(), Vec::new());
    let (collision, bodies) = run.first_collision();
    let metadata = Metadata { entries: vec![("rebond steps".into(), collision.step.to_string())] };
    svg::encode(&figure::minkowski(collision, bodies, &options(Theme::Light, None)), &metadata, &mut file).unwrap();
    crate::snapshot::assert_text("figure-minkowski.svg", &String::from_utf8(file).unwrap());
}

#[test]
fn figures_of_nothing_are_empty_pages() {
    let options = options(Theme::Light, Some("nothing"));
    for list in [
        figure::strobe(&[], &options),
        figure::filmstrip(&[], &options),
        figure::spacetime(&[], Axis::X, &options),
        figure::energy(&[], &options),
    ] {
        assert_eq!(list.leaves().count(), 1, "{list}");
    }
}

/// Whatever a solver makes of its bodies, the figure is of what can be shown.
#[test]
fn figures_of_what_is_beyond_all_measure_are_drawn_without_harm() {
    let run = fall();
    let (collision, bodies) = run.first_collision();
    let places = [1e300, f64::INFINITY, f64::NAN, 1e-300, -0.0];
    for place in places {
        let vector = Vector::new(place, -place);
        let mut strange = collision.clone();
        (strange.penetration, strange.before[0], strange.impulse) = (vector, vector, place);
        strange.rects[0].origin = vector;
        let mut frame = run.frames[0].clone();
        frame.sprites[3].rect.origin = vector;
        let sample = EnergySample { time: place, kinetic: place, potential: -place, momentum: vector };
        let (frames, options) = ([frame.clone(), frame], options(Theme::Dark, None));
        for list in [
            figure::collision(&strange, bodies, &options),
            figure::minkowski(&strange, bodies, &options),
            figure::strobe(&frames, &options),
            figure::filmstrip(&frames, &options),
            figure::spacetime(&frames, Axis::Y, &options),
            figure::energy(&[sample, sample], &options),
        ] {
            Painter::new().draw(&list);
        }
    }
}
