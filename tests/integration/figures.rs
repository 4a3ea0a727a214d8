//! Lecture figures of two small runs, in both themes.

use crate::reference::assert_reference;
use rebond::figure::{self, Axis, EnergyRun, EnergySample, FigureOptions, Meeting, Run};
use rebond::physics::{Collision, Engine, Event, Rect, Restitution, Settings, SolverKind, Spawn, Vector, invariants};
use rebond::render::{Aim, Appearance, DisplayList, Frame, Metadata, Painter, Shape, Sprite, Style, svg};
use rebond::scene::{Overlay, Theme};
use std::sync::Arc;

const WORLD: Vector = Vector::new(8.0, 4.5);

/// A run of a solver, kept whole.
struct Kept {
    bodies: Vec<Arc<Appearance>>,
    frames: Vec<Frame>,
    energy: Vec<EnergySample>,
    collisions: Vec<Collision>,
}

/// Name, x, y, width, height, velocity; masses are 1 kg, those of walls infinite.
type Given = (&'static str, [f64; 4], [f64; 2]);

fn run(given: &[Given], gravity: Option<Vector>, rate: f64, steps: u64) -> Kept {
    run_by(SolverKind::Handout, given, gravity, rate, steps)
}

fn run_by(solver: SolverKind, given: &[Given], gravity: Option<Vector>, rate: f64, steps: u64) -> Kept {
    let restitution = Restitution::new(0.8, &[]);
    let settings = Settings { solver, rate, gravity, restitution, events_per_step: 1000 };
    let mut engine = Engine::new(settings);
    let mut run = Kept { bodies: Vec::new(), frames: Vec::new(), energy: Vec::new(), collisions: Vec::new() };
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
    let (material, force) = (String::new(), Vector::ZERO);
    Appearance { id, name: (*name).into(), material, color: None, mass: mass(name), force, is_wall }
}

fn mass(name: &str) -> f64 {
    if name.starts_with("wall-") { f64::INFINITY } else { 1.0 }
}

impl Kept {
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

    /// Every so many of its instants.
    fn every(&self, steps: usize) -> Run {
        Run { title: String::new(), world: WORLD, frames: self.frames.iter().step_by(steps).cloned().collect() }
    }

    fn energies(&self) -> EnergyRun {
        EnergyRun { title: String::new(), samples: self.energy.clone() }
    }

    /// The first collision that gave an impulse, and the two it is of.
    fn first_collision(&self) -> Meeting {
        let collision = self.collisions.iter().find(|collision| collision.impulse != 0.0).unwrap();
        let bodies = collision.bodies.map(|id| self.bodies[id as usize].clone());
        Meeting { title: String::new(), collision: collision.clone(), bodies }
    }
}

/// Two boxes that fly at each other.
fn pair() -> Kept {
    let given: [Given; 2] = [("c", [1.0, 1.2, 2.0, 1.2], [2.5, 0.5]), ("b", [4.3, 1.9, 1.6, 1.6], [-1.2, -0.4])];
    run(&given, None, 6.0, 12)
}

/// Three boxes that fall on a floor and meet.
fn fall() -> Kept {
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

fn options(theme: Theme, caption: &str) -> FigureOptions {
    let style = Style {
        theme,
        show: vec![Overlay::Name, Overlay::Grid],
        top_speed: 8.0,
        caption: caption.to_owned(),
        ..Style::default()
    };
    FigureOptions { size: [800, 450], aim: Aim::World, style }
}

/// Every kind, in a theme.
fn figures(theme: Theme) -> Vec<(&'static str, DisplayList)> {
    let (pair, fall) = (pair(), fall());
    let plain = options(theme, "");
    let captioned = options(theme, "Three boxes let fall, e = 0.8");
    let (met, hit) = ([pair.first_collision()], [fall.first_collision()]);
    vec![
        ("collision", figure::collision(&met, &plain)),
        ("collision-close", figure::collision(&hit, &captioned)),
        ("minkowski", figure::minkowski(&met, &plain)),
        ("minkowski-close", figure::minkowski(&hit, &captioned)),
        ("strobe", figure::strobe(&[fall.every(6)], &captioned)),
        ("filmstrip", figure::filmstrip(&[fall.every(20)], &captioned)),
        ("spacetime-x", figure::spacetime(&[fall.every(1)], Axis::X, &plain)),
        ("spacetime-y", figure::spacetime(&[fall.every(1)], Axis::Y, &captioned)),
        ("energy", figure::energy(&[fall.energies()], &captioned)),
    ]
}

/// Every kind of two solvers side by side, in a theme: the same shot at a plate as thin as a step
/// is long.
fn side_by_side(theme: Theme) -> Vec<(&'static str, DisplayList)> {
    let shot: [Given; 2] = [("c", [0.5, 1.8, 0.6, 0.6], [12.0, 0.0]), ("wall-plate", [5.0, 0.5, 0.3, 3.5], [0.0, 0.0])];
    let solvers = [("handout", SolverKind::Handout), ("event-driven", SolverKind::EventDriven)];
    let both = solvers.map(|(title, solver)| (title.to_owned(), run_by(solver, &shot, None, 20.0, 12)));
    let runs = both.each_ref().map(|(title, run)| Run { title: title.clone(), ..run.every(1) });
    let strips = both.each_ref().map(|(title, run)| Run { title: title.clone(), ..run.every(4) });
    let energies = both.each_ref().map(|(title, run)| EnergyRun { title: title.clone(), ..run.energies() });
    let met = both.each_ref().map(|(title, run)| Meeting { title: title.clone(), ..run.first_collision() });
    let options = options(theme, "One shot, two solvers");
    vec![
        ("collision", figure::collision(&met, &options)),
        ("minkowski", figure::minkowski(&met, &options)),
        ("strobe", figure::strobe(&runs, &options)),
        ("filmstrip", figure::filmstrip(&strips, &options)),
        ("spacetime", figure::spacetime(&runs, Axis::X, &options)),
        ("energy", figure::energy(&energies, &options)),
    ]
}

#[test]
fn several_runs_side_by_side_in_both_themes() {
    for theme in Theme::ALL {
        for (kind, list) in side_by_side(*theme) {
            assert_reference(&format!("figure-two-{kind}-{}", theme.name()), &Painter::new().draw(&list));
        }
    }
}

/// A window on a part of the world, and one that goes with a body.
#[test]
fn figures_of_what_a_camera_is_aimed_at() {
    let fall = fall();
    let window = Rect::new(Vector::new(2.0, 0.5), 4.0, 2.25);
    let aims = [
        ("window", Aim::Window(window)),
        ("follow", Aim::Follow { name: "middle".into(), size: Vector::new(4.0, 2.25) }),
    ];
    for (name, aim) in aims {
        let options = FigureOptions { aim, ..options(Theme::Light, "") };
        let strip = figure::filmstrip(&[fall.every(20)], &options);
        assert_reference(&format!("figure-filmstrip-{name}"), &Painter::new().draw(&strip));
    }
}

/// No label lies on another one or leaves the page.
#[test]
fn labels_keep_off_each_other_and_the_border() {
    let all = [figures(Theme::Light), side_by_side(Theme::Light)].concat();
    for (kind, list) in all {
        let places: Vec<(String, Rect)> = list.leaves().filter_map(text_place).collect();
        let [width, height] = list.size.map(f64::from);
        for (at, (text, place)) in places.iter().enumerate() {
            let far = place.far_corner();
            let is_within = place.origin.x >= 0.0 && place.origin.y >= 0.0 && far.x <= width && far.y <= height;
            assert!(is_within, "{kind}: {text:?} leaves the page: {place:?}");
            for (other, other_place) in places[..at].iter().filter(|(other, _)| other != text) {
                let apart = |from: f64, to: f64, low: f64, high: f64| to <= low || high <= from;
                let other_far = other_place.far_corner();
                let is_apart = apart(place.origin.x, far.x, other_place.origin.x, other_far.x)
                    || apart(place.origin.y, far.y, other_place.origin.y, other_far.y);
                assert!(is_apart, "{kind}: {text:?} lies on {other:?}");
            }
        }
    }
}

/// What a line of text covers, a little less than its capitals.
fn text_place(shape: &Shape) -> Option<(String, Rect)> {
    match shape {
        Shape::Text { line, at, .. } => {
            let height = 0.8 * line.height();
            Some((line.text.clone(), Rect::new(at.sub(Vector::new(0.0, height)), line.width, height)))
        }
        Shape::Rect { .. } | Shape::Polygon { .. } | Shape::Polyline { .. } | Shape::Clip { .. } => None,
    }
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
    let (meeting, mut file) = ([pair().first_collision()], Vec::new());
    let metadata = Metadata { entries: vec![("rebond steps".into(), meeting[0].collision.step.to_string())] };
    svg::encode(&figure::minkowski(&meeting, &options(Theme::Light, "")), &metadata, &mut file).unwrap();
    crate::snapshot::assert_text("figure-minkowski.svg", &String::from_utf8(file).unwrap());
}

#[test]
fn figures_of_nothing_are_empty_pages() {
    let options = options(Theme::Light, "nothing");
    for list in [
        figure::collision(&[], &options),
        figure::minkowski(&[], &options),
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
    let met = run.first_collision();
    let places = [1e300, f64::INFINITY, f64::NAN, 1e-300, -0.0];
    for place in places {
        let vector = Vector::new(place, -place);
        let mut strange = met.clone();
        let collision = &mut strange.collision;
        (collision.penetration, collision.before[0], collision.impulse) = (vector, vector, place);
        collision.rects[0].origin = vector;
        let mut frame = run.frames[0].clone();
        frame.sprites[3].rect.origin = vector;
        let sample = EnergySample { time: place, kinetic: place, potential: -place, momentum: vector };
        let runs = [Run { title: String::new(), world: WORLD, frames: vec![frame.clone(), frame] }];
        let samples = [EnergyRun { title: String::new(), samples: vec![sample, sample] }];
        let (meetings, options) = ([strange], options(Theme::Dark, ""));
        for list in [
            figure::collision(&meetings, &options),
            figure::minkowski(&meetings, &options),
            figure::strobe(&runs, &options),
            figure::filmstrip(&runs, &options),
            figure::spacetime(&runs, Axis::Y, &options),
            figure::energy(&samples, &options),
        ] {
            Painter::new().draw(&list);
        }
    }
}
