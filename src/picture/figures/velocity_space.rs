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
    Pair(VelocityPath),
    /// Those of many bodies at one instant.
    Cloud {
        /// The instant, s.
        time: f64,
        /// The velocity, m/s, and the colour of each body.
        bodies: Vec<(Vector, Color)>,
    },
}

/// The path of two bodies in the plane of (√m₁·v₁, √m₂·v₂), in which their kinetic energy is half the square of the
/// distance from the origin. Each collision is a straight line of the path. Memory is bounded by the resolution.
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
    /// The ends of the lines in cells of the resolution.
    lines: BTreeSet<[[i64; 2]; 2]>,
    /// Width of a cell, √J.
    cell: f64,
    /// The number of collisions.
    count: u64,
}

/// The number of cells from the origin to the start: a pixel of the largest page that a lecture needs.
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
        let cell = larger(start.norm(), f64::MIN_POSITIVE) / CELLS;
        let ids = bodies.each_ref().map(|(_, id, ..)| *id);
        let names = bodies.map(|(name, ..)| name);
        VelocityPath { names, ids, roots, axis, start, now: start, lines: BTreeSet::new(), cell, count: 0 }
    }

    /// Continues the path at the velocities (m/s) of bodies, after a part of the run that is unknown.
    pub fn restart(&mut self, velocities: impl Iterator<Item = (BodyId, Vector)>) {
        let mut now = [self.now.x, self.now.y];
        for (id, velocity) in velocities {
            for at in [0, 1].into_iter().filter(|&at| self.ids[at] == id) {
                now[at] = self.roots[at] * velocity[self.axis];
            }
        }
        self.now = Vector::new(now[0], now[1]);
    }

    fn at_cell(&self, at: Vector) -> [i64; 2] {
        [at.x, at.y].map(|at| (at / self.cell).round() as i64)
    }

    /// The ends of the lines, √J.
    fn segments(&self) -> impl Iterator<Item = [Vector; 2]> {
        let at = |[x, y]: [i64; 2]| Vector::new(x as f64 * self.cell, y as f64 * self.cell);
        self.lines.iter().map(move |ends| ends.map(at))
    }

    /// The largest distance from the origin, √J.
    fn reach(&self) -> f64 {
        self.segments().flatten().map(Vector::norm).fold(self.start.norm(), larger)
    }
}

impl Observer for VelocityPath {
    fn collision(&mut self, collision: &Collision) {
        if collision.axis != self.axis || collision.impulse == 0.0 {
            return;
        }
        let mut next = [self.now.x, self.now.y];
        for (id, after) in collision.bodies.iter().zip(&collision.after) {
            for at in [0, 1].into_iter().filter(|&at| self.ids[at] == *id) {
                next[at] = self.roots[at] * after[self.axis];
            }
        }
        let next = Vector::new(next[0], next[1]);
        if next != self.now {
            self.lines.insert([self.at_cell(self.now), self.at_cell(next)]);
            self.count += 1;
            self.now = next;
        }
    }
}

/// Draws velocities in their own space. Of two bodies, each collision is a chord: of the circle of constant energy if it
/// is elastic. Of many bodies, each is a point (v_x, v_y).
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
    let run_titles: Vec<&str> = runs.iter().map(|run| run.title.as_str()).collect();
    let layout = Layout {
        legend: &|_| {
            let entry = |color: Color, name: &str| Entry { name: quoted(name), ..Entry::new(color, "") };
            let entries = vec![
                entry(chord, language.of("collisions", "collisions")),
                entry(circle, language.of("energy at the start", "énergie initiale")),
                entry(metrics.palette.penetration, language.of("start", "début")),
            ];
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

impl VelocityRun {
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
                let width = if path.lines.len() > 200 { 0.5 } else { 1.0 };
                shapes.extend(path.segments().map(|segment| line(segment, width, chord)));
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
