//! Figures of small runs, in both themes.

use crate::reference_image::assert_reference_image;
use rebond::internals::physics::{
    Body, Collision, Engine, EngineConfig, Event, Observer, Rect, Restitution, SolverKind, Spawn, Vector, World,
};
use rebond::internals::picture::figures::{
    self, Axis, CollisionSubject, EnergyRun, EnergySample, FigureRun, LineRun, LineSubject, PressureRun, Range,
    ReferenceFrame, SpacetimeRun, SpeedRun, Velocities, VelocityPath, VelocityRun,
};
use rebond::internals::picture::{
    Appearance, CameraTarget, Color, ColorBy, DisplayList, Frame, Look, Metadata, Overlay, Overlays, Painter, Quantity,
    RenderError, Shape, Sprite, Style, TextAs, Theme, View, compose, svg,
};
use std::sync::Arc;

const WORLD: Vector = Vector::new(8.0, 4.5);

/// All states and collisions of a run.
struct RunStates {
    bodies: Vec<Arc<Appearance>>,
    frames: Vec<Frame>,
    energy: Vec<EnergySample>,
    worlds: Vec<World>,
    collisions: Vec<Collision>,
}

/// Name, [x, y, width, height] and velocity. The mass is 1 kg, infinite for names that begin with `wall-`.
type BodySpec = (&'static str, [f64; 4], [f64; 2]);

fn run(bodies: &[BodySpec], gravity: Option<Vector>, rate: f64, steps: u64) -> RunStates {
    run_with(SolverKind::Handout, bodies, gravity, rate, steps)
}

fn run_with(solver: SolverKind, bodies: &[BodySpec], gravity: Option<Vector>, rate: f64, steps: u64) -> RunStates {
    let restitution = Restitution::new(0.8, &[]);
    let config =
        EngineConfig::new(solver, rate).with_gravity(gravity).with_restitution(restitution).with_events_per_step(1000);
    let mut engine = Engine::new(config);
    let mut run = RunStates {
        bodies: Vec::new(),
        frames: Vec::new(),
        energy: Vec::new(),
        worlds: Vec::new(),
        collisions: Vec::new(),
    };
    for spec in bodies {
        engine.apply(&Event::Spawn(spawn(spec)));
        let id = run.bodies.len() as u32;
        run.bodies.push(Arc::new(appearance(id, spec)));
    }
    for _ in 0..=steps {
        run.add_state(&engine, rate);
        engine.step(&mut run.collisions).unwrap();
    }
    run
}

fn spawn((name, [x, y, width, height], [vx, vy]): &BodySpec) -> Spawn {
    let rect = Rect::new(Vector::new(*x, *y), *width, *height);
    Spawn::new(*name, rect, mass(name)).with_velocity(Vector::new(*vx, *vy))
}

fn appearance(id: u32, (name, _, _): &BodySpec) -> Appearance {
    let is_wall = name.starts_with("wall-");
    let (material, force) = (String::new(), Vector::ZERO);
    Appearance { id, name: (*name).into(), material, color: None, image: None, mass: mass(name), force, is_wall }
}

fn mass(name: &str) -> f64 {
    if name.starts_with("wall-") { f64::INFINITY } else { 1.0 }
}

impl RunStates {
    fn add_state(&mut self, engine: &Engine, rate: f64) {
        let (step, world) = (engine.current_step(), engine.world());
        let time = step as f64 / rate;
        let sprite = |body: &rebond::internals::physics::Body| Sprite {
            appearance: self.bodies[body.id as usize].clone(),
            rect: body.rect,
            velocity: body.velocity,
            trail: Vec::new(),
        };
        let sprites = world.bodies.iter().map(sprite).collect();
        self.frames.push(Frame { step, time, sprites, collisions: Vec::new() });
        self.energy.push(EnergySample::of(world, time));
        self.worlds.push(world.clone());
    }

    /// Every `steps`-th frame.
    fn every_nth(&self, steps: usize) -> FigureRun {
        FigureRun { title: String::new(), world: WORLD, frames: self.frames.iter().step_by(steps).cloned().collect() }
    }

    fn energies(&self) -> EnergyRun {
        let has_potential = self.energy.iter().any(|sample| sample.potential != 0.0);
        let mut run = EnergyRun::new(String::new(), 0.0, has_potential);
        self.energy.iter().for_each(|sample| run.push(sample));
        run
    }

    fn spacetime(&self, axis: Axis) -> SpacetimeRun {
        let mut run = SpacetimeRun::new(String::new(), WORLD, axis, 0.0);
        for frame in &self.frames {
            frame.sprites.iter().for_each(|sprite| run.push(frame.time, sprite, &Style::default()));
        }
        run
    }

    /// A quantity of all bodies of finite mass, or of all together.
    fn lines(&self, title: &str, quantity: Quantity) -> LineRun {
        let finite = || self.bodies.iter().filter(|body| body.mass.is_finite());
        let subject = match quantity {
            Quantity::Energy | Quantity::Momentum => LineSubject::System,
            _ => LineSubject::Bodies(finite().map(|body| (body.id, body.clone())).collect()),
        };
        let mut run = LineRun::new(title.to_owned(), quantity, subject, WORLD.y, 0.0);
        for (frame, world) in self.frames.iter().zip(&self.worlds) {
            run.push(frame.time, world);
        }
        run
    }

    fn speeds(&self, title: &str) -> SpeedRun {
        let mut run = SpeedRun::new(title.to_owned(), 15.0);
        let bodies = self.worlds.iter().flat_map(|world| &world.bodies);
        bodies.filter(|body| body.mass.is_finite()).for_each(|body| run.push(body.velocity.norm(), body.mass));
        run
    }

    /// The path of the first two bodies of finite mass along x.
    fn velocity_path(&self, title: &str) -> VelocityRun {
        let finite: Vec<&Body> = self.worlds[0].bodies.iter().filter(|body| body.mass.is_finite()).collect();
        let of_body = |body: &Body| (body.name.clone(), body.id, body.mass, body.velocity);
        let mut path = VelocityPath::new([of_body(finite[0]), of_body(finite[1 % finite.len()])], Axis::X);
        self.collisions.iter().for_each(|collision| path.collision(collision));
        VelocityRun { title: title.to_owned(), velocities: Velocities::Pair(path) }
    }

    fn velocity_cloud(&self, title: &str) -> VelocityRun {
        let frame = self.frames.last().unwrap();
        let bodies = frame.sprites.iter().filter(|sprite| !sprite.appearance.is_wall);
        let bodies = bodies.map(|sprite| (sprite.velocity, Color::hex(0x0072b2))).collect();
        VelocityRun { title: title.to_owned(), velocities: Velocities::Cloud { time: frame.time, bodies } }
    }

    /// The pressure on the bodies of infinite mass.
    fn pressure(&self, title: &str) -> PressureRun {
        let walls = self.bodies.iter().filter(|body| body.mass == f64::INFINITY);
        let walls = walls.map(|body| (body.id, body.clone())).collect();
        let mut run = PressureRun::new(title.to_owned(), WORLD, self.time(), walls);
        self.collisions.iter().for_each(|collision| run.collision(collision));
        self.frames.iter().zip(&self.worlds).for_each(|(frame, world)| run.push(frame.time, world));
        run
    }

    fn time(&self) -> Range {
        Range { from: 0.0, to: self.frames.last().unwrap().time }
    }

    /// The first collision with an impulse, and its bodies.
    fn first_collision(&self) -> CollisionSubject {
        let collision = self.collisions.iter().find(|collision| collision.impulse != 0.0).unwrap();
        let bodies = collision.bodies.map(|id| self.bodies[id as usize].clone());
        CollisionSubject { title: String::new(), collision: collision.clone(), bodies }
    }
}

/// Two boxes that approach each other.
fn pair() -> RunStates {
    let bodies: [BodySpec; 2] = [("c", [1.0, 1.2, 2.0, 1.2], [2.5, 0.5]), ("b", [4.3, 1.9, 1.6, 1.6], [-1.2, -0.4])];
    run(&bodies, None, 6.0, 12)
}

/// A heavy box that pushes a light one between itself and a wall (Galperin's billiard).
fn galperin() -> RunStates {
    let bodies: [BodySpec; 3] = [
        ("wall-left", [-1.0, 0.0, 1.0, 4.5], [0.0, 0.0]),
        ("small", [1.0, 2.0, 0.4, 0.4], [0.0, 0.0]),
        ("big", [3.0, 1.8, 0.8, 0.8], [-2.0, 0.0]),
    ];
    run_with(SolverKind::EventDriven, &bodies, None, 20.0, 60)
}

/// A gas of small boxes that a piston compresses.
fn piston() -> RunStates {
    let mut bodies: Vec<BodySpec> = vec![
        ("wall-piston", [-5.0, 0.0, 5.0, 4.5], [0.5, 0.0]),
        ("wall-right", [8.0, -1.0, 1.0, 6.5], [0.0, 0.0]),
        ("wall-top", [-1.0, -1.0, 10.0, 1.0], [0.0, 0.0]),
        ("wall-bottom", [-1.0, 4.5, 10.0, 1.0], [0.0, 0.0]),
    ];
    let speeds = |at: i32| [f64::from(at * 7 % 11) - 5.0, f64::from(at * 5 % 13) - 6.0];
    let place = |at: i32| [0.5 + 0.9 * f64::from(at % 8), 0.4 + 0.9 * f64::from(at / 8), 0.05, 0.05];
    bodies.extend((0..32).map(|at| ("gas", place(at), speeds(at))));
    run_with(SolverKind::EventDriven, &bodies, None, 10.0, 80)
}

/// Three boxes that fall on a floor and collide.
fn fall() -> RunStates {
    let bodies: [BodySpec; 6] = [
        ("wall-bottom", [-1.0, 4.5, 10.0, 1.0], [0.0, 0.0]),
        ("wall-left", [-1.0, 0.0, 1.0, 4.5], [0.0, 0.0]),
        ("wall-right", [8.0, 0.0, 1.0, 4.5], [0.0, 0.0]),
        ("left", [1.0, 0.5, 0.8, 0.8], [1.5, 0.0]),
        ("middle", [3.5, 1.5, 1.0, 0.6], [0.0, 0.0]),
        ("right", [6.0, 1.0, 0.6, 0.8], [-1.5, 0.0]),
    ];
    run(&bodies, Some(Vector::new(0.0, 9.81)), 60.0, 120)
}

fn options(theme: Theme, caption: &str) -> Style {
    let show = [Overlay::Name, Overlay::Grid].into();
    let look = Look { size: [800, 450], theme, show, caption: caption.to_owned(), ..Look::default() };
    Style { look, top_speed: 8.0, ..Style::default() }
}

/// Every kind of figure in a theme.
fn figures(theme: Theme) -> Vec<(&'static str, DisplayList)> {
    let (pair, fall) = (pair(), fall());
    let plain = options(theme, "");
    let captioned = options(theme, "Three boxes let fall, e = 0.8");
    let (pair_subjects, fall_subjects) = ([pair.first_collision()], [fall.first_collision()]);
    vec![
        ("collision", figures::collision(&pair_subjects, ReferenceFrame::Laboratory, &plain).unwrap()),
        ("collision-com", figures::collision(&pair_subjects, ReferenceFrame::CenterOfMass, &plain).unwrap()),
        ("pressure", figures::pressure(&[piston().pressure("")], piston().time(), &captioned).unwrap()),
        ("collision-close", figures::collision(&fall_subjects, ReferenceFrame::Laboratory, &captioned).unwrap()),
        ("minkowski", figures::minkowski(&pair_subjects, &plain).unwrap()),
        ("minkowski-close", figures::minkowski(&fall_subjects, &captioned).unwrap()),
        ("strobe", figures::strobe(&[fall.every_nth(6)], &captioned).unwrap()),
        ("filmstrip", figures::filmstrip(&[fall.every_nth(20)], &captioned).unwrap()),
        ("spacetime-x", figures::spacetime(&[fall.spacetime(Axis::X)], fall.time(), Axis::X, &plain).unwrap()),
        ("spacetime-y", figures::spacetime(&[fall.spacetime(Axis::Y)], fall.time(), Axis::Y, &captioned).unwrap()),
        ("energy", figures::energy(&[fall.energies()], fall.time(), &captioned).unwrap()),
        (
            "lines",
            figures::lines(&[fall.lines("", Quantity::Height)], fall.time(), Quantity::Height, &captioned).unwrap(),
        ),
        ("speeds", figures::speeds(&[fall.speeds("")], &captioned).unwrap()),
        ("velocity-space-pair", figures::velocity_space(&[galperin().velocity_path("")], &captioned).unwrap()),
        ("velocity-space-cloud", figures::velocity_space(&[fall.velocity_cloud("")], &plain).unwrap()),
    ]
}

/// Every kind of figure of two solvers side by side in a theme: the same projectile hits a plate thinner than the
/// distance it moves in one step.
fn side_by_side(theme: Theme) -> Vec<(&'static str, DisplayList)> {
    let bodies: [BodySpec; 2] =
        [("c", [0.5, 1.8, 0.6, 0.6], [12.0, 0.0]), ("wall-plate", [5.0, 0.5, 0.3, 3.5], [0.0, 0.0])];
    let solvers = [("handout", SolverKind::Handout), ("event-driven", SolverKind::EventDriven)];
    let both = solvers.map(|(title, solver)| (title.to_owned(), run_with(solver, &bodies, None, 20.0, 12)));
    let runs = both.each_ref().map(|(title, run)| FigureRun { title: title.clone(), ..run.every_nth(1) });
    let strips = both.each_ref().map(|(title, run)| FigureRun { title: title.clone(), ..run.every_nth(4) });
    let energies = both.each_ref().map(|(title, run)| {
        let mut energies = run.energies();
        energies.title.clone_from(title);
        energies
    });
    let bands = both.each_ref().map(|(title, run)| {
        let mut bands = run.spacetime(Axis::X);
        bands.title.clone_from(title);
        bands
    });
    let time = both[0].1.time();
    let lines = both.each_ref().map(|(title, run)| run.lines(title, Quantity::X));
    let subjects =
        both.each_ref().map(|(title, run)| CollisionSubject { title: title.clone(), ..run.first_collision() });
    let options = options(theme, "One shot, two solvers");
    vec![
        ("collision", figures::collision(&subjects, ReferenceFrame::Laboratory, &options).unwrap()),
        ("minkowski", figures::minkowski(&subjects, &options).unwrap()),
        ("strobe", figures::strobe(&runs, &options).unwrap()),
        ("filmstrip", figures::filmstrip(&strips, &options).unwrap()),
        ("spacetime", figures::spacetime(&bands, time, Axis::X, &options).unwrap()),
        ("energy", figures::energy(&energies, time, &options).unwrap()),
        ("lines", figures::lines(&lines, time, Quantity::X, &options).unwrap()),
    ]
}

#[test]
fn figures_of_two_runs_match_their_references_in_both_themes() {
    for theme in Theme::ALL {
        for (kind, list) in side_by_side(*theme) {
            assert_reference_image(&format!("figure-two-{kind}-{}", theme.name()), &Painter::new().draw(&list));
        }
    }
}

/// A camera that shows a window of the world, and one that follows a body.
#[test]
fn filmstrips_show_the_camera_target() {
    let fall = fall();
    let window = Rect::new(Vector::new(2.0, 0.5), 4.0, 2.25);
    let targets = [
        ("window", CameraTarget::Window(window)),
        ("follow", CameraTarget::Follow { name: "middle".into(), size: Vector::new(4.0, 2.25) }),
    ];
    for (name, camera_target) in targets {
        let mut options = options(Theme::Light, "");
        options.look.camera_target = camera_target;
        let strip = figures::filmstrip(&[fall.every_nth(20)], &options).unwrap();
        assert_reference_image(&format!("figure-filmstrip-{name}"), &Painter::new().draw(&strip));
    }
}

/// Labels neither overlap each other nor extend beyond the page.
#[test]
fn labels_neither_overlap_nor_leave_the_page() {
    for (kind, list) in [figures(Theme::Light), side_by_side(Theme::Light)].concat() {
        assert_legible(&list, kind);
    }
}

/// Asserts that texts are at least 8 px high, within the page and their panel, and do not overlap where they are visible,
/// and that everything that no panel clips is on the page.
pub fn assert_legible(list: &DisplayList, case: &str) {
    let [width, height] = list.size.map(f64::from);
    let mut texts: Vec<(usize, String, Rect)> = Vec::new();
    let mut covers: Vec<(usize, Rect)> = Vec::new();
    let page = Rect::new(Vector::ZERO, width, height);
    let mut count = 0;
    for shapes in [&list.backdrop, &list.shapes] {
        visit(shapes, &page, false, &mut count, &mut |number, shape, window, is_clipped| match shape {
            Shape::Text { line, at, .. } => {
                let height = 0.8 * line.height();
                let bounds = Rect::new(at.sub(Vector::new(0.0, height)), line.width, height);
                assert!(line.size >= 8.0, "{case}: {:?} has {} px", line.text, line.size);
                let is_within = window.inset(-0.51).contains(&bounds);
                assert!(is_within || line.text.is_empty(), "{case}: {:?} {bounds:?} leaves {window:?}", line.text);
                if !line.text.is_empty() {
                    texts.push((number, line.text.clone(), bounds));
                }
            }
            Shape::Rect { rect, ink } if ink.opacity == 255 => {
                assert!(is_clipped || page.inset(-0.51).contains(rect), "{case}: {rect:?} leaves the page");
                covers.extend(rect.intersection(window).map(|visible| (number, visible)));
            }
            Shape::Rect { .. } | Shape::Clip { .. } | Shape::Image { .. } => {}
            Shape::Polygon { points, .. } | Shape::Polyline { points, .. } => {
                let is_on_page = |at: &Vector| page.inset(-2.0).contains(&Rect::new(*at, 0.0, 0.0));
                assert!(is_clipped || points.iter().all(is_on_page), "{case}: {points:?} leaves the page");
            }
        });
    }
    for (at, (number, text, bounds)) in texts.iter().enumerate() {
        for (other_number, other, other_bounds) in &texts[..at] {
            let Some(common) = bounds.intersection(other_bounds) else { continue };
            let is_hidden = |(cover, rect): &(usize, Rect)| {
                (other_number..number).contains(&cover) && rect.inset(-0.51).contains(&common)
            };
            assert!(covers.iter().any(is_hidden), "{case}: {text:?} overlaps {other:?} in {common:?}");
        }
    }
}

/// Visits the shapes within `window` in drawing order, each with its number, its visible area, and whether a panel clips
/// it.
fn visit(
    shapes: &[Shape],
    window: &Rect,
    is_clipped: bool,
    number: &mut usize,
    visitor: &mut impl FnMut(usize, &Shape, &Rect, bool),
) {
    for shape in shapes {
        match shape {
            Shape::Clip { window: inner, shapes } => {
                if let Some(visible) = window.intersection(inner) {
                    visit(shapes, &visible, true, number, visitor);
                }
            }
            Shape::Rect { .. }
            | Shape::Polygon { .. }
            | Shape::Polyline { .. }
            | Shape::Text { .. }
            | Shape::Image { .. } => {
                *number += 1;
                visitor(*number, shape, window, is_clipped);
            }
        }
    }
}

/// The kinds of pictures of the layout test.
const KINDS: [&str; 14] = [
    "collision",
    "collision-com",
    "pressure",
    "minkowski",
    "strobe",
    "filmstrip",
    "spacetime-x",
    "spacetime-y",
    "energy",
    "lines",
    "speeds",
    "velocity-space-pair",
    "velocity-space-cloud",
    "frame",
];

/// A picture of `count` copies of a run.
fn picture_of(kind: &str, run: &RunStates, count: usize, style: &Style) -> Result<DisplayList, RenderError> {
    let titles: Vec<String> = (0..count).map(|at| format!("run {at} with a title of some length")).collect();
    let runs = |steps: usize| -> Vec<FigureRun> {
        titles.iter().map(|title| FigureRun { title: title.clone(), ..run.every_nth(steps) }).collect()
    };
    let subjects: Vec<CollisionSubject> =
        titles.iter().map(|title| CollisionSubject { title: title.clone(), ..run.first_collision() }).collect();
    let bands = |axis| -> Vec<SpacetimeRun> {
        let copy = |title: &String| {
            let mut bands = run.spacetime(axis);
            bands.title.clone_from(title);
            bands
        };
        titles.iter().map(copy).collect()
    };
    match kind {
        "collision" => figures::collision(&subjects, ReferenceFrame::Laboratory, style),
        "collision-com" => figures::collision(&subjects, ReferenceFrame::CenterOfMass, style),
        "pressure" => figures::pressure(
            &titles.iter().map(|title| run.pressure(title)).collect::<Vec<PressureRun>>(),
            run.time(),
            style,
        ),
        "minkowski" => figures::minkowski(&subjects, style),
        "strobe" => figures::strobe(&runs(run.frames.len() / 5 + 1), style),
        "filmstrip" => figures::filmstrip(&runs(run.frames.len() / 4 + 1), style),
        "spacetime-x" => figures::spacetime(&bands(Axis::X), run.time(), Axis::X, style),
        "spacetime-y" => figures::spacetime(&bands(Axis::Y), run.time(), Axis::Y, style),
        "lines" => {
            let runs: Vec<LineRun> = titles.iter().map(|title| run.lines(title, Quantity::Speed)).collect();
            figures::lines(&runs, run.time(), Quantity::Speed, style)
        }
        "speeds" => figures::speeds(&titles.iter().map(|title| run.speeds(title)).collect::<Vec<SpeedRun>>(), style),
        "velocity-space-pair" | "velocity-space-cloud" => {
            let of_run = |title: &String| match kind {
                "velocity-space-pair" => run.velocity_path(title),
                _ => run.velocity_cloud(title),
            };
            figures::velocity_space(&titles.iter().map(of_run).collect::<Vec<VelocityRun>>(), style)
        }
        "energy" => {
            let copy = |title: &String| {
                let mut energies = run.energies();
                energies.title.clone_from(title);
                energies
            };
            figures::energy(&titles.iter().map(copy).collect::<Vec<EnergyRun>>(), run.time(), style)
        }
        _ => {
            let mut frame = run.frames[run.frames.len() / 2].clone();
            frame.collisions = run.collisions.iter().take(3).cloned().collect();
            Ok(compose(&frame, &View::new(WORLD, style.clone())?))
        }
    }
}

/// Every kind of figure at any size, of 1 to 24 recordings, is legible, or is refused with a size at which it is.
#[test]
#[cfg_attr(debug_assertions, ignore = "slow in debug")]
fn pictures_of_every_size_and_number_of_recordings_are_legible_or_refused_with_a_sufficient_size() {
    let bullet: [BodySpec; 3] = [
        ("a body with a name that fits nowhere", [0.5, 1.8, 0.6, 0.6], [12.0, 0.0]),
        ("wall-plate", [5.0, 0.5, 0.3, 3.5], [0.0, 0.0]),
        ("speck", [3.0, 1.9, 1e-3, 1e-3], [1e-3, 0.0]),
    ];
    let scenes = [pair(), fall(), run_with(SolverKind::EventDriven, &bullet, None, 20.0, 24)];
    let sizes = [
        [64, 64],
        [90, 160],
        [200, 200],
        [320, 180],
        [360, 640],
        [1024, 128],
        [128, 1024],
        [800, 800],
        [1280, 720],
        [720, 1280],
        [2000, 250],
        [4096, 2160],
        [1024, 8192],
        [8192, 1024],
        [8192, 8192],
    ];
    let looks = [
        (Overlays::from([Overlay::Name, Overlay::Clock]), ""),
        (Overlays::all(), "A caption of two lines:\nwith $E = m c^2$ and many more words than a narrow page can hold"),
        (Overlays::from([Overlay::Velocity, Overlay::Grid, Overlay::Scale, Overlay::Name]), "short"),
    ];
    // Each size with each kind, and the other choices in turn.
    let mut number = 0_usize;
    for size in sizes {
        for kind in KINDS {
            for count in [1, [2, 3, 5, 24, 7, 12, 4][number % 7]] {
                number += 1;
                let ((show, caption), run) = (&looks[number % 3], &scenes[number / 3 % 3]);
                let theme = if number.is_multiple_of(2) { Theme::Light } else { Theme::Dark };
                let color_by = ColorBy::ALL[number / 2 % 3];
                let look =
                    Look { size, theme, show: show.clone(), caption: (*caption).into(), color_by, ..Look::default() };
                let materials = (0..25).map(|at| format!("material {at}")).collect();
                let style = Style { look, top_speed: 12.0, materials, ..Style::default() };
                let case = format!("{kind} of {count} at {size:?}, look {}, scene {}", number % 3, number / 3 % 3);
                match picture_of(kind, run, count, &style) {
                    Ok(list) => assert_legible(&list, &case),
                    Err(RenderError::TooSmall { needed: Some(needed), .. }) => {
                        let look = Look { size: needed, ..style.look.clone() };
                        let list = picture_of(kind, run, count, &Style { look, ..style.clone() });
                        assert_legible(&list.unwrap_or_else(|error| panic!("{case}: {error}")), &case);
                    }
                    Err(error) => panic!("{case}: {error}"),
                }
            }
        }
    }
}

/// Every text of figures 1 and 2 and the colours below it have a contrast of at least 4.5, whatever the colours of the
/// boxes.
#[test]
fn texts_of_collisions_contrast_with_the_boxes_below_them() {
    let colors = [0x0072b2, 0xd55e00, 0x56b4e9, 0xf0e442, 0x000000, 0xffffff, 0x7f7f7f, 0x808000];
    let mut texts_on_boxes = 0;
    for run in [pair(), fall()] {
        for (at, theme) in (0..colors.len()).flat_map(|at| Theme::ALL.iter().map(move |theme| (at, *theme))) {
            let mut subject = run.first_collision();
            for (body, shift) in subject.bodies.iter_mut().zip([0, 3]) {
                let color = Some(Color::hex(colors[(at + shift) % colors.len()]));
                *body = Arc::new(Appearance { color, ..(**body).clone() });
            }
            for size in [[800, 450], [450, 800], [1600, 500], [2400, 1600]] {
                let mut style = options(theme, "");
                style.look.size = size;
                let subjects = [subject.clone()];
                for list in [
                    figures::collision(&subjects, ReferenceFrame::Laboratory, &style),
                    figures::minkowski(&subjects, &style),
                ] {
                    texts_on_boxes += assert_contrast(&list.unwrap(), &format!("{at} {} {size:?}", theme.name()));
                }
            }
        }
    }
    assert!(texts_on_boxes > 500, "{texts_on_boxes} texts on boxes");
}

/// Asserts the contrast of all texts with the rectangles below them. Returns the number of texts on another colour than
/// that of the page.
fn assert_contrast(list: &DisplayList, case: &str) -> usize {
    let [width, height] = list.size.map(f64::from);
    let page = Rect::new(Vector::ZERO, width, height);
    let mut fills: Vec<(Rect, Rect, Color)> = vec![(page, page, list.background)];
    let mut on_boxes = 0;
    visit(&list.shapes, &page, false, &mut 0, &mut |_, shape, window, _| match shape {
        Shape::Rect { rect, ink } if ink.opacity == 255 => {
            // A box is a rectangle in the colour of its border and a smaller one in its own.
            if let Some((_, outer, color)) = fills.last_mut()
                && outer.contains(rect)
                && rect.contains(&outer.inset(8.0))
            {
                *color = ink.color;
            }
            fills.push((*window, *rect, ink.color));
        }
        Shape::Text { line, at, ink } if !line.text.is_empty() => {
            let bounds = Rect::new(at.sub(Vector::new(0.0, line.height())), line.width, line.height());
            let steps = [0.05, 0.25, 0.5, 0.75, 0.95];
            let points = steps.iter().flat_map(|x| steps.map(|y| [x * bounds.width(), y * bounds.height()]));
            let points = points.map(|[x, y]| Rect::new(bounds.origin.add(Vector::new(x, y)), 0.0, 0.0));
            let grounds: Vec<Color> = points
                .filter_map(|at| {
                    let is_below =
                        |(window, rect, _): &&(Rect, Rect, Color)| window.contains(&at) && rect.contains(&at);
                    fills.iter().rev().find(is_below).map(|(_, _, color)| *color)
                })
                .collect();
            for ground in &grounds {
                let contrast = ink.color.contrast(*ground);
                assert!(contrast >= 4.5, "{case}: {:?} in {} on {ground}: {contrast:.2}", line.text, ink.color);
            }
            on_boxes += usize::from(grounds.iter().any(|ground| *ground != list.background));
        }
        _ => {}
    });
    on_boxes
}

#[test]
fn each_kind_of_figure_matches_its_reference_in_both_themes() {
    for theme in Theme::ALL {
        for (kind, list) in figures(*theme) {
            assert_reference_image(&format!("figure-{kind}-{}", theme.name()), &Painter::new().draw(&list));
        }
    }
}

#[test]
fn an_svg_figure_matches_its_snapshot() {
    let (subjects, mut file) = ([pair().first_collision()], Vec::new());
    let metadata = Metadata { entries: vec![("rebond steps".into(), subjects[0].collision.step.to_string())] };
    let list = figures::minkowski(&subjects, &options(Theme::Light, "")).unwrap();
    svg::encode(&list, &metadata, TextAs::Outlines, &mut file).unwrap();
    crate::snapshot::assert_text("figure-minkowski.svg", &String::from_utf8(file).unwrap());
}

#[test]
fn figures_without_data_have_only_a_caption() {
    let options = options(Theme::Light, "nothing");
    for list in [
        figures::collision(&[], ReferenceFrame::Laboratory, &options).unwrap(),
        figures::minkowski(&[], &options).unwrap(),
        figures::strobe(&[], &options).unwrap(),
        figures::filmstrip(&[], &options).unwrap(),
        figures::spacetime(&[], Range { from: 0.0, to: 1.0 }, Axis::X, &options).unwrap(),
        figures::energy(&[], Range { from: 0.0, to: 1.0 }, &options).unwrap(),
        figures::lines(&[], Range { from: 0.0, to: 1.0 }, Quantity::X, &options).unwrap(),
    ] {
        assert_eq!(list.leaves().count(), 1, "{list}");
    }
}

/// Extreme and non-finite coordinates must not crash the drawing of a figure.
#[test]
fn extreme_coordinates_do_not_crash_a_figure() {
    let run = fall();
    let subject = run.first_collision();
    let coordinates = [1e300, f64::INFINITY, f64::NAN, 1e-300, -0.0];
    for coordinate in coordinates {
        let vector = Vector::new(coordinate, -coordinate);
        let mut extreme = subject.clone();
        let collision = &mut extreme.collision;
        (collision.penetration, collision.before[0], collision.impulse) = (vector, vector, coordinate);
        collision.rects[0].origin = vector;
        let mut frame = run.frames[0].clone();
        frame.sprites[3].rect.origin = vector;
        let sample = EnergySample { time: coordinate, kinetic: coordinate, potential: -coordinate, momentum: vector };
        let runs = [FigureRun { title: String::new(), world: WORLD, frames: vec![frame.clone(), frame.clone()] }];
        let mut energy = EnergyRun::new(String::new(), 0.0, true);
        (0..2).for_each(|_| energy.push(&sample));
        let mut bands = SpacetimeRun::new(String::new(), WORLD, Axis::Y, 0.0);
        frame.sprites.iter().for_each(|sprite| bands.push(coordinate, sprite, &Style::default()));
        let time = Range { from: 0.0, to: coordinate };
        let (subjects, options) = ([extreme], options(Theme::Dark, ""));
        for list in [
            figures::collision(&subjects, ReferenceFrame::Laboratory, &options).unwrap(),
            figures::minkowski(&subjects, &options).unwrap(),
            figures::strobe(&runs, &options).unwrap(),
            figures::filmstrip(&runs, &options).unwrap(),
            figures::spacetime(&[bands], time, Axis::Y, &options).unwrap(),
            figures::energy(&[energy], time, &options).unwrap(),
        ] {
            Painter::new().draw(&list);
        }
    }
}
