use super::axes::{Axes, AxisTitles, Range, Scale};
use super::panels::{Layout, TITLE};
use crate::physics::{Axis, BodyId, Collision, Observer, Rect, Vector, larger, smaller};
use crate::picture::layers::bodies::draw_box;
use crate::picture::layers::footer::{Entry, Legend, gap_entries, quoted};
use crate::picture::number::{TimeFormat, Unit};
use crate::picture::text::{Line, truncated};
use crate::picture::{Color, DisplayList, DrawingMetrics, Ink, RenderError, Shape, Style, color};
use std::collections::BTreeSet;

/// The velocities of one run.
#[derive(Clone, Debug, PartialEq)]
pub struct VelocityRun {
    /// Title, shown if there are several runs.
    pub title: String,
    /// The velocities to show.
    pub velocities: Velocities,
}

/// The velocities of two bodies during a run, or of many at one instant.
#[derive(Clone, Debug, PartialEq)]
pub enum Velocities {
    /// Those of two bodies along an axis.
    Pair(Box<VelocityPath>),
    /// Those of many bodies at one instant.
    Cloud {
        /// The instant, s.
        time: f64,
        /// The velocity, m/s, and the colour of each body.
        bodies: Vec<(Vector, Color)>,
    },
}

/// The path of two bodies in the plane of (√m₁·v₁, √m₂·v₂), in which their kinetic energy is half the square of the
/// distance from the origin. Each collision is a straight line of the path, and so is the motion between two collisions
/// under constant accelerations. Memory is bounded by the resolution.
#[derive(Clone, Debug, PartialEq)]
pub struct VelocityPath {
    /// The names of the bodies.
    names: [String; 2],
    ids: [BodyId; 2],
    roots: [f64; 2],
    axis: Axis,
    /// Position at the start, √J.
    start: Vector,
    now: Vector,
    /// The collisions since the last state.
    impacts: Vec<PairImpact>,
    /// The lines of collisions.
    chords: CellLines,
    /// The lines between collisions.
    flights: CellLines,
    /// The ends of the line since the last collision, √J.
    flight: [Vector; 2],
    /// The number of collisions.
    count: u64,
}

/// A collision of one of two bodies, or of both.
#[derive(Clone, Copy, Debug, PartialEq)]
struct PairImpact {
    /// Seconds since the last state.
    time: f64,
    /// The components of the position before and after the collision, √J, of each body that takes part.
    ends: [Option<[f64; 2]>; 2],
}

/// The largest number of collisions that are kept between two states.
const MAX_IMPACTS: usize = 4096;

/// Lines in cells of a resolution, which follows the most distant end. Lines in the same cells are one.
#[derive(Clone, Debug, Default, PartialEq)]
struct CellLines {
    /// The ends in cells.
    lines: BTreeSet<[[i64; 2]; 2]>,
    /// Width of a cell, √J; 0 without lines.
    cell: f64,
}

impl CellLines {
    /// Lines whose cells are as wide as those of ends at this distance from the origin, √J.
    fn with_reach(reach: f64) -> CellLines {
        CellLines { lines: BTreeSet::new(), cell: reach / CELLS }
    }

    /// Adds the line between two points, unless they are nearer to each other than cells.
    fn add(&mut self, ends: [Vector; 2]) {
        let reach = larger(ends[0].norm(), ends[1].norm());
        if !(reach > 0.0 && reach.is_finite()) {
            return;
        }
        if self.cell == 0.0 {
            self.cell = reach / CELLS;
        }
        while reach > 2.0 * CELLS * self.cell {
            self.cell *= 2.0;
            let coarser = |[x, y]: &[i64; 2]| [x.div_euclid(2), y.div_euclid(2)];
            self.lines = self.lines.iter().map(|ends| ends.each_ref().map(coarser)).collect();
        }
        if ends[1].sub(ends[0]).norm() >= self.cell / 2.0 {
            self.lines.insert(ends.map(|end| [end.x, end.y].map(|at| (at / self.cell).round() as i64)));
        }
    }

    /// The ends of the lines, √J.
    fn segments(&self) -> impl Iterator<Item = [Vector; 2]> {
        let at = |[x, y]: [i64; 2]| Vector::new(x as f64 * self.cell, y as f64 * self.cell);
        self.lines.iter().map(move |ends| ends.map(at))
    }
}

/// The least number of cells from the origin to the most distant point: a pixel of the largest page that a lecture
/// needs.
const CELLS: f64 = 2048.0;

impl Velocities {
    /// The largest distance from the origin, √J or m/s.
    fn reach(&self) -> f64 {
        match self {
            Velocities::Pair(path) => path.reach(),
            Velocities::Cloud { bodies, .. } => bodies.iter().map(|(velocity, _)| velocity.norm()).fold(0.0, larger),
        }
    }
}

impl VelocityPath {
    /// The path of two bodies of these names, ids, finite masses (kg) and velocities at the start (m/s) along an axis.
    pub fn new(bodies: [(String, BodyId, f64, Vector); 2], axis: Axis) -> VelocityPath {
        let roots = bodies.each_ref().map(|(_, _, mass, _)| mass.sqrt());
        let [x, y] = [0, 1].map(|at| roots[at] * bodies[at].3[axis]);
        let start = Vector::new(x, y);
        let ids = bodies.each_ref().map(|(_, id, ..)| *id);
        let names = bodies.map(|(name, ..)| name);
        let lines = CellLines::with_reach(start.norm());
        VelocityPath {
            names,
            ids,
            roots,
            axis,
            start,
            now: start,
            impacts: Vec::new(),
            chords: lines.clone(),
            flights: lines,
            flight: [start; 2],
            count: 0,
        }
    }

    /// Continues the path to the velocities (m/s) of bodies in a state, through the collisions in the `duration` (s)
    /// since the last one. Between collisions, velocities change evenly.
    pub fn advance(&mut self, velocities: impl Iterator<Item = (BodyId, Vector)>, duration: f64) {
        let end = self.position(velocities);
        self.pass_impacts([end.x, end.y].map(|at| Some((duration, at))));
        self.fly_to(end);
    }

    /// Continues the path at the velocities (m/s) of bodies, after a part of the run that is unknown.
    pub fn restart(&mut self, velocities: impl Iterator<Item = (BodyId, Vector)>) {
        self.impacts.clear();
        let at = self.position(velocities);
        self.begin_flight(at);
    }

    /// The position at the velocities (m/s) of bodies, √J. A body that is not among them keeps its velocity.
    fn position(&self, velocities: impl Iterator<Item = (BodyId, Vector)>) -> Vector {
        let mut at = [self.now.x, self.now.y];
        for (id, velocity) in velocities {
            for body in [0, 1].into_iter().filter(|&body| self.ids[body] == id) {
                at[body] = self.roots[body] * velocity[self.axis];
            }
        }
        Vector::new(at[0], at[1])
    }

    /// Continues the path through the collisions since the last state. `end` is the time and the component of the
    /// position of each body in the next state, if these are known.
    fn pass_impacts(&mut self, end: [Option<(f64, f64)>; 2]) {
        let impacts = std::mem::take(&mut self.impacts);
        // The time and the component after which each body is at the beginning of each collision.
        let (mut next, mut following) = (end, Vec::with_capacity(impacts.len()));
        for impact in impacts.iter().rev() {
            for (next, ends) in next.iter_mut().zip(impact.ends) {
                *next = ends.map(|[before, _]| (impact.time, before)).or(*next);
            }
            following.push(next);
        }
        let mut last = [(0.0, self.now.x), (0.0, self.now.y)];
        for (impact, next) in impacts.iter().zip(following.into_iter().rev()) {
            let before = [0, 1].map(|body| between(last[body], next[body], impact.time));
            let after = [0, 1].map(|body| impact.ends[body].map_or(before[body], |[_, after]| after));
            self.fly_to(Vector::new(before[0], before[1]));
            self.chords.add([Vector::new(before[0], before[1]), Vector::new(after[0], after[1])]);
            self.begin_flight(Vector::new(after[0], after[1]));
            last = after.map(|at| (impact.time, at));
        }
    }

    /// Continues the path without a collision. Motion in one direction is one line.
    fn fly_to(&mut self, to: Vector) {
        let [from, now] = self.flight;
        let (way, next) = (now.sub(from), to.sub(now));
        let is_straight = (way.x * next.y - way.y * next.x).abs() <= 1e-9 * way.norm() * next.norm();
        if is_straight && way.dot(next) >= 0.0 {
            self.flight[1] = to;
        } else {
            self.flights.add(self.flight);
            self.flight = [now, to];
        }
        self.now = to;
    }

    /// Ends the line since the last collision, and begins another one.
    fn begin_flight(&mut self, at: Vector) {
        self.flights.add(self.flight);
        (self.flight, self.now) = ([at; 2], at);
    }

    /// The lines between collisions, with that since the last one.
    fn all_flights(&self) -> CellLines {
        let mut flights = self.flights.clone();
        flights.add(self.flight);
        flights
    }

    /// The largest distance from the origin, √J.
    fn reach(&self) -> f64 {
        let flights = self.all_flights();
        self.chords.segments().chain(flights.segments()).flatten().map(Vector::norm).fold(self.start.norm(), larger)
    }
}

/// The value at a time between the last known value and the next one, each with its time.
fn between((from, start): (f64, f64), next: Option<(f64, f64)>, time: f64) -> f64 {
    match next {
        Some((to, end)) if to > from => start + (end - start) * ((time - from) / (to - from)),
        Some(_) | None => start,
    }
}

impl Observer for VelocityPath {
    fn collision(&mut self, collision: &Collision) {
        if collision.axis != self.axis || collision.impulse == 0.0 {
            return;
        }
        let ends = [0, 1].map(|body| {
            let at = collision.bodies.iter().position(|id| *id == self.ids[body])?;
            Some([collision.before[at], collision.after[at]].map(|velocity| self.roots[body] * velocity[self.axis]))
        });
        if ends != [None; 2] {
            self.impacts.push(PairImpact { time: collision.time, ends });
            self.count += 1;
        }
        if self.impacts.len() >= MAX_IMPACTS {
            self.pass_impacts([None; 2]);
        }
    }
}

/// Draws velocities in their own space. Of two bodies, each collision is a chord: of the circle of constant energy if
/// it is elastic. Of many bodies, each is a point (v_x, v_y).
///
/// # Errors
/// If the page is too small.
pub fn velocity_space(runs: &[VelocityRun], style: &Style) -> Result<DisplayList, RenderError> {
    let language = style.look.language;
    // Several runs have the same scale, if they show the same quantity.
    let reach = |run: &VelocityRun| {
        let is_alike =
            |other: &&VelocityRun| std::mem::discriminant(&other.velocities) == std::mem::discriminant(&run.velocities);
        let reach = runs.iter().filter(is_alike).map(|run| run.velocities.reach()).fold(0.0, larger);
        if reach > 0.0 && reach.is_finite() { 1.12 * reach } else { 1.0 }
    };
    let notes: Vec<String> = runs.iter().map(|run| note(run, style.time_format)).collect();
    let titles: Vec<[String; 2]> = runs.iter().map(|run| axis_titles(run, scale(run, reach(run)))).collect();
    let fits = |cell: &Rect, metrics: &DrawingMetrics| {
        let width = |text: &String, part: f64| Line::math(text, metrics.text(part)).width;
        let is_legible = |([x, y], note): (&[String; 2], &String)| {
            let above = width(y, 0.9) + metrics.font_size + width(note, 0.8);
            square(cell, metrics).width() - 5.0 * metrics.font_size >= larger(above, width(x, 0.9))
        };
        square(cell, metrics).width() >= 14.0 * metrics.font_size && titles.iter().zip(&notes).all(is_legible)
    };
    let metrics = DrawingMetrics::new(style.look.theme, style.look.language, style.look.size);
    let has_pair = runs.iter().any(|run| matches!(run.velocities, Velocities::Pair(_)));
    let [chord, circle] = chord_and_circle(&metrics);
    let has_flights = runs.iter().any(VelocityRun::has_flights);
    let run_titles: Vec<&str> = runs.iter().map(|run| run.title.as_str()).collect();
    let layout = Layout {
        legend: &|_| {
            let entry = |color: Color, name: &str| Entry { name: quoted(name), ..Entry::new(color, "") };
            let mut entries = vec![entry(chord, language.of("collisions", "collisions"))];
            if has_flights {
                entries.push(entry(flight(&metrics), language.of("between collisions", "entre les collisions")));
            }
            entries.extend([
                entry(circle, language.of("energy at the start", "énergie initiale")),
                entry(metrics.palette.penetration, language.of("start", "début")),
            ]);
            let mut legend = if has_pair { Legend { entries } } else { Legend::of_colors(style) };
            legend.entries.extend(gap_entries(&style.gaps, language, metrics.palette.muted));
            legend
        },
        shape: Vector::new(1.0, 1.1),
        text_height: TITLE,
        ..Layout::new(style, &run_titles, &fits)
    };
    let (mut panels, cells) = layout.lay_out()?;
    for (((run, note), titles), cell) in runs.iter().zip(&notes).zip(&titles).zip(&cells) {
        panels.clip(cell, |panels| {
            let metrics = panels.metrics;
            let axes = isometric(&square(cell, &metrics), scale(run, reach(run)), &metrics);
            axes.draw(&AxisTitles { x: &titles[0], y: &titles[1] }, &metrics, &mut panels.shapes);
            let shapes = run.shapes(&axes, reach(run), &metrics);
            panels.shapes.push(Shape::Clip { window: axes.plot_area, shapes });
            axes.draw_note(Line::math(note, metrics.text(0.8)), &metrics, &mut panels.shapes);
        });
    }
    Ok(panels.finish())
}

/// The colours of the lines of collisions and of the circle of constant energy.
fn chord_and_circle(metrics: &DrawingMetrics) -> [Color; 2] {
    [color::BODY_COLORS[4], metrics.palette.muted].map(|color| metrics.palette.line(color))
}

/// The colour of the lines between collisions.
fn flight(metrics: &DrawingMetrics) -> Color {
    metrics.palette.line(color::BODY_COLORS[5])
}

impl VelocityRun {
    /// Returns true if velocities change between collisions.
    fn has_flights(&self) -> bool {
        match &self.velocities {
            Velocities::Pair(path) => !path.all_flights().lines.is_empty(),
            Velocities::Cloud { .. } => false,
        }
    }

    /// The lines through the origin and the velocities, on axes up to `reach`.
    fn shapes(&self, axes: &Axes, reach: f64, metrics: &DrawingMetrics) -> Vec<Shape> {
        let at = |velocity: Vector| axes.point(velocity.x, velocity.y);
        let line = |[from, to]: [Vector; 2], width: f64, color: Color| Shape::Polyline {
            points: vec![at(from), at(to)],
            width: width * metrics.line_width,
            ink: Ink::from(color),
        };
        let through_origin = |axis: Axis| [-2.0, 2.0].map(|part| Vector::along(axis, part * reach));
        let mut shapes: Vec<Shape> =
            Axis::BOTH.map(|axis| line(through_origin(axis), 0.5, metrics.palette.muted)).into();
        match &self.velocities {
            Velocities::Pair(path) => {
                let [chord, circle] = chord_and_circle(metrics);
                let radius = path.start.norm();
                let points = unit_circle().into_iter().map(|on_circle| at(on_circle.mult(radius))).collect();
                shapes.push(Shape::Polyline { points, width: metrics.line_width, ink: Ink::from(circle) });
                let flights = path.all_flights();
                shapes.extend(flights.segments().map(|segment| line(segment, 0.5, flight(metrics))));
                let width = if path.chords.lines.len() > 200 { 0.5 } else { 1.0 };
                shapes.extend(path.chords.segments().map(|segment| line(segment, width, chord)));
                shapes.push(mark(at(path.start), 3.0 * metrics.line_width, metrics.palette.penetration));
            }
            Velocities::Cloud { bodies, .. } => {
                let size = cloud_mark(bodies.len(), &axes.plot_area, metrics);
                for (velocity, color) in bodies {
                    draw_box(&mark_area(at(*velocity), size), metrics.palette.line(*color), metrics, &mut shapes);
                }
            }
        }
        shapes
    }
}

/// The scale of both axes for velocities up to `reach`.
fn scale(run: &VelocityRun, reach: f64) -> Scale {
    let unit = match &run.velocities {
        Velocities::Pair(_) => Unit::ROOT_JOULE,
        Velocities::Cloud { .. } => Unit::METRE_PER_SECOND,
    };
    Scale::linear(Range { from: -reach, to: reach }, unit)
}

/// The titles of the horizontal and of the vertical axis, as markup.
fn axis_titles(run: &VelocityRun, scale: Scale) -> [String; 2] {
    const MAX_NAME_CHARS: usize = 16;
    match &run.velocities {
        Velocities::Pair(path) => path.names.each_ref().map(|name| {
            let name = truncated(name, MAX_NAME_CHARS).replace('"', "″");
            scale.title(&format!("√m v \"({name})\""))
        }),
        Velocities::Cloud { .. } => ["v_x", "v_y"].map(|symbol| scale.title(symbol)),
    }
}

/// A closed polygon of 180 corners on the unit circle, each turned by 2° from the one before.
fn unit_circle() -> Vec<Vector> {
    const COS: f64 = 0.999_390_827_019_095_8;
    const SIN: f64 = 0.034_899_496_702_500_97;
    let turn = |at: &Vector| Some(Vector::new(COS * at.x - SIN * at.y, SIN * at.x + COS * at.y));
    std::iter::successors(Some(Vector::new(1.0, 0.0)), turn).take(181).collect()
}

/// Axes with equal lengths for equal velocities, in an area that is almost square.
fn isometric(area: &Rect, scale: Scale, metrics: &DrawingMetrics) -> Axes {
    let plot_area = Axes::within(area, scale, scale, 0.0, metrics).plot_area;
    let shorter = smaller(plot_area.width(), plot_area.height());
    let [x, y] = [plot_area.width(), plot_area.height()].map(|side| match scale {
        Scale::Linear { range, unit } => {
            let part = side / shorter;
            Scale::Linear { range: Range { from: part * range.from, to: part * range.to }, unit }
        }
        Scale::Log { .. } => scale,
    });
    Axes::within(area, x, y, 0.0, metrics)
}

/// The area of a square diagram in the middle of a cell.
fn square(cell: &Rect, metrics: &DrawingMetrics) -> Rect {
    let side = smaller(cell.width() - 2.0 * metrics.font_size, cell.height());
    Rect::new(cell.center().sub(Vector::new(side / 2.0, side / 2.0)), side, side)
}

fn mark(at: Vector, side: f64, color: Color) -> Shape {
    Shape::Rect { rect: mark_area(at, side), ink: color.into() }
}

/// A square of this side around a point.
fn mark_area(at: Vector, side: f64) -> Rect {
    Rect::new(at.sub(Vector::new(side, side).mult(0.5)), side, side)
}

/// The side of the marks of a cloud, px: all marks together cover a twentieth of the diagram, as far as each remains
/// visible and is smaller than a letter.
fn cloud_mark(count: usize, plot_area: &Rect, metrics: &DrawingMetrics) -> f64 {
    let side = (plot_area.width() * plot_area.height() / 20.0 / count.max(1) as f64).sqrt();
    smaller(larger(side, 1.5 * metrics.line_width), 0.6 * metrics.font_size).round()
}

fn note(run: &VelocityRun, format: TimeFormat) -> String {
    match &run.velocities {
        Velocities::Pair(path) => format!("n = {}", path.count),
        Velocities::Cloud { time, bodies } => {
            format!("N = {},  t = {} \"{}\"", bodies.len(), format.number(*time), format.unit())
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::physics::{Engine, EngineConfig, Event, SolverKind, Spawn};

    /// The path along y of two balls that begin with these velocities, 3 m and 5 m above a floor, in `steps` steps at
    /// 60 Hz, and their collisions along y.
    fn bounces(solver: SolverKind, velocities: [f64; 2], gravity: f64, steps: u64) -> (VelocityPath, Vec<Collision>) {
        let mut engine = Engine::new(EngineConfig::new(solver, 60.0).with_gravity(Some(Vector::new(0.0, gravity))));
        let at = |x: f64, y: f64| Rect::new(Vector::new(x, y), 1.0, 1.0);
        let floor = Spawn::new("floor", Rect::new(Vector::new(0.0, 8.0), 9.0, 1.0), f64::INFINITY);
        let balls = [Spawn::new("low", at(1.0, 4.0), 4.0), Spawn::new("high", at(5.0, 2.0), 9.0)];
        let spawns = balls.into_iter().zip(velocities);
        let spawns = spawns.map(|(spawn, y)| spawn.with_velocity(Vector::new(0.0, y)));
        spawns.chain([floor]).for_each(|spawn| engine.apply(&Event::Spawn(spawn)));
        let body = |at: usize| {
            let body = &engine.world().bodies[at];
            (body.name.clone(), body.id, body.mass, body.velocity)
        };
        let (mut path, mut collisions) = (VelocityPath::new([body(0), body(1)], Axis::Y), Vec::new());
        for _ in 0..steps {
            engine.step(&mut (Both { path: &mut path, all: &mut collisions })).unwrap();
            path.advance(engine.world().bodies.iter().map(|body| (body.id, body.velocity)), 1.0 / 60.0);
        }
        (path, collisions)
    }

    struct Both<'a> {
        path: &'a mut VelocityPath,
        all: &'a mut Vec<Collision>,
    }

    impl Observer for Both<'_> {
        fn collision(&mut self, collision: &Collision) {
            self.path.collision(collision);
            self.all.extend((collision.impulse != 0.0).then(|| collision.clone()));
        }
    }

    /// Every collision is a chord of its length, and begins where its body is; motion under weight continues the path
    /// along the acceleration.
    #[test]
    fn chords_join_the_velocities_before_and_after_each_collision() {
        for velocities in [[0.0, 0.0], [-3.0, 0.0], [0.0, 1e-9]] {
            let (path, collisions) = bounces(SolverKind::EventDriven, velocities, 9.81, 420);
            assert!(
                path.count as usize == collisions.len() && collisions.len() > 5,
                "{} of {}",
                path.count,
                collisions.len()
            );
            let chords: Vec<[Vector; 2]> = path.chords.segments().collect();
            for collision in &collisions {
                let (body, at) = if collision.bodies[0] == 0 { (Axis::X, 0) } else { (Axis::Y, 0) };
                let root = path.roots[usize::from(body == Axis::Y)];
                let ends = [collision.before[at].y, collision.after[at].y].map(|velocity| root * velocity);
                let is_shown = |chord: &&[Vector; 2]| {
                    [0, 1].into_iter().all(|end| (chord[end][body] - ends[end]).abs() <= path.chords.cell)
                        && (chord[0][body.other()] - chord[1][body.other()]).abs() <= path.chords.cell
                };
                assert!(chords.iter().any(|chord| is_shown(&chord)), "{collision:?}: {chords:?}");
            }
            let flights: Vec<[Vector; 2]> = path.all_flights().segments().collect();
            assert!((3..=collisions.len() + 1).contains(&flights.len()), "{flights:?}");
            for [from, to] in flights {
                let slope = (to.y - from.y) / (to.x - from.x);
                let rounding = 4.0 * path.flights.cell / (to.x - from.x).abs();
                assert!((slope - 1.5).abs() <= rounding, "accelerated by {slope}: {from:?} {to:?}");
            }
            assert!(path.reach() > 20.0 && path.reach() < 60.0, "{}", path.reach());
        }
    }

    #[test]
    fn velocities_without_weight_change_in_collisions_alone() {
        for solver in [SolverKind::EventDriven, SolverKind::Handout] {
            let (path, collisions) = bounces(solver, [4.0, 2.0], 0.0, 200);
            assert_eq!((path.count as usize, path.all_flights().lines.len()), (collisions.len(), 0));
            assert!(path.chords.lines.len() == 2 && path.reach() < 1.001 * path.start.norm(), "{path:?}");
        }
    }

    #[test]
    fn cells_grow_with_the_reach_of_the_path() {
        let mut lines = CellLines::with_reach(1e-6);
        for reach in [1e-7, 1e-3, 1.0, 1e3] {
            lines.add([Vector::ZERO, Vector::new(reach, -reach)]);
        }
        let ends: Vec<Vector> = lines.segments().map(|line| line[1]).collect();
        assert!(ends.iter().any(|end| (end.x - 1e3).abs() < 1.0 && (end.y + 1e3).abs() < 1.0), "{ends:?}");
    }
}
