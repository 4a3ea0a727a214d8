use super::log_axes::{LogAxes, Scale};
use super::panels::Panels;
use crate::physics::{Rect, Vector};
use crate::render::area::{inset, overlap};
use crate::render::layers::legend::{Entry, Legend};
use crate::render::text::Line;
use crate::render::{Color, DisplayList, Ink, Look, Shape, palette};
use crate::scene::Theme;

/// Numbers against numbers on logarithmic scales.
#[derive(Clone, Debug, PartialEq)]
pub struct Diagram {
    /// What is written above it.
    pub title: String,
    /// What the horizontal scale is called, as markup.
    pub x: String,
    /// What the vertical scale is called, as markup.
    pub y: String,
    /// Drawn in this order.
    pub curves: Vec<Curve>,
}

/// A line through points, which stand for themselves.
#[derive(Clone, Debug, PartialEq)]
pub struct Curve {
    /// What its colour means; curves of one name have one colour in all diagrams.
    pub name: String,
    /// What is written at its last point; nothing if empty.
    pub label: String,
    /// In order.
    pub points: Vec<Point>,
}

/// A point of a curve; both numbers positive, or zero.
#[derive(Clone, Debug, PartialEq)]
pub struct Point {
    /// Across.
    pub x: f64,
    /// Upwards.
    pub y: f64,
    /// What is written beside it; nothing if empty.
    pub label: String,
}

/// How a page of diagrams looks.
#[derive(Clone, Debug, PartialEq)]
pub struct DiagramOptions {
    /// Width and height, px; as many as suit the diagrams if absent.
    pub size: Option<[u32; 2]>,
    /// Light or dark.
    pub theme: Theme,
    /// What is written below; nothing if empty.
    pub caption: String,
}

/// Colours in the order of names, told apart on light and on dark.
const COLORS: [usize; 7] = [4, 5, 6, 1, 2, 0, 3];

/// Several diagrams on one page, with one legend.
pub fn diagrams(diagrams: &[Diagram], options: &DiagramOptions) -> DisplayList {
    let columns = columns(diagrams.len());
    let rows = diagrams.len().div_ceil(columns).max(1);
    let size = options.size.unwrap_or_else(|| page(columns, rows));
    let look = look(options.theme, size, columns, rows);
    let mut names: Vec<&str> = Vec::new();
    for curve in diagrams.iter().flat_map(|diagram| &diagram.curves) {
        if !names.contains(&curve.name.as_str()) {
            names.push(&curve.name);
        }
    }
    let entries = names.iter().enumerate().map(|(number, name)| Entry::new(color(number), name));
    let mut panels = Panels::on(size, look, &options.caption, &Legend { entries: entries.collect() });
    let titles: Vec<&str> = diagrams.iter().map(|diagram| diagram.title.as_str()).collect();
    let places = panels.titled(&titles, columns);
    for (diagram, place) in diagrams.iter().zip(&places) {
        let color_of = |curve: &Curve| color(names.iter().position(|name| *name == curve.name).unwrap_or(0));
        draw(diagram, place, color_of, &mut panels);
    }
    panels.finish()
}

fn columns(count: usize) -> usize {
    match count {
        0 | 1 => 1,
        2..=4 => 2,
        _ => 3,
    }
}

fn page(columns: usize, rows: usize) -> [u32; 2] {
    match (columns, rows) {
        (1, _) => [1280, 720],
        (columns, rows) => [columns as u32 * 560, rows as u32 * 400 + 60],
    }
}

/// Letters as large as suits a diagram, not the page.
fn look(theme: Theme, [width, height]: [u32; 2], columns: usize, rows: usize) -> Look {
    let across = f64::from(width) / columns as f64 / 560.0;
    let down = f64::from(height) / rows as f64 / 400.0;
    let unit = if across < down { across } else { down };
    let whole = |length: f64| if length < 1.0 { 1.0 } else { length.round() };
    Look {
        text: whole(19.0 * if unit > 1.4 { 1.4 } else { unit }),
        line: whole(2.0 * unit),
        ..Look::new(theme, [width, height])
    }
}

fn color(number: usize) -> Color {
    palette::BODIES[COLORS[number % COLORS.len()]]
}

fn draw(diagram: &Diagram, place: &Rect, color: impl Fn(&Curve) -> Color, panels: &mut Panels) {
    let points = || diagram.curves.iter().flat_map(|curve| &curve.points);
    let axes = LogAxes::within(
        place,
        Scale::of(points().map(|point| point.x)),
        Scale::of(points().map(|point| point.y)),
        &panels.look,
    );
    axes.draw([&diagram.x, &diagram.y], &panels.look, &mut panels.shapes);
    let at = |point: &Point| axes.point(point.x, point.y);
    let mut taken: Vec<Rect> = points().map(|point| around(at(point), 0.35 * panels.look.text)).collect();
    for curve in &diagram.curves {
        let ink = Ink::from(color(curve));
        let seen: Vec<Vector> = curve.points.iter().map(at).collect();
        let width = panels.look.line;
        panels.shapes.push(Shape::Polyline { points: seen.clone(), width, ink });
        taken.extend(seen.windows(2).flat_map(|ends| along(ends[0], ends[1], 0.5 * panels.look.text, width)));
        panels.shapes.extend(seen.iter().map(|&at| dot(at, 0.3 * panels.look.text, ink)));
    }
    // Names of curves come first: a rate without room is missed less.
    for curve in &diagram.curves {
        if let Some(last) = curve.points.last() {
            write(&curve.label, at(last), color(curve).into(), &axes.frame, &mut taken, panels);
        }
    }
    for curve in &diagram.curves {
        for point in &curve.points {
            write(&point.label, at(point), panels.look.palette.muted.into(), &axes.frame, &mut taken, panels);
        }
    }
}

/// An octagon for a dot.
fn dot(at: Vector, radius: f64, ink: Ink) -> Shape {
    const HALF: f64 = 0.414_213_562_373_095;
    let corner = |x: f64, y: f64| at.add(Vector::new(x * radius, y * radius));
    let corners = [
        (1.0, HALF),
        (HALF, 1.0),
        (-HALF, 1.0),
        (-1.0, HALF),
        (-1.0, -HALF),
        (-HALF, -1.0),
        (HALF, -1.0),
        (1.0, -HALF),
    ];
    Shape::Polygon { points: corners.map(|(x, y)| corner(x, y)).into(), ink }
}

/// Writes beside a point where there is room: on its right, above, below or left; else nowhere.
fn write(label: &str, point: Vector, ink: Ink, frame: &Rect, taken: &mut Vec<Rect>, panels: &mut Panels) {
    if label.is_empty() {
        return;
    }
    let line = Line::plain(label, 0.7 * panels.look.text);
    let (width, height, gap) = (line.width, line.height(), 0.45 * panels.look.text);
    let middle = point.sub(Vector::new(width / 2.0, height / 2.0));
    let aside = width / 2.0 + gap;
    let over = height / 2.0 + gap;
    let ways = [
        (aside, 0.0),
        (0.0, -over),
        (0.0, over),
        (-aside, 0.0),
        (aside, -over),
        (aside, over),
        (-aside, -over),
        (-aside, over),
    ];
    let places = ways.map(|(x, y)| Rect::new(middle.add(Vector::new(x, y)), width, height));
    let inside = |place: &Rect| {
        overlap(place, frame).is_some_and(|seen| seen.width() >= width - 0.5 && seen.height() >= height - 0.5)
    };
    let free = |place: &&Rect| inside(place) && !taken.iter().any(|other| overlap(place, other).is_some());
    if let Some(place) = places.iter().find(free) {
        // A letter's width apart from what is written next.
        taken.push(inset(place, -0.2 * panels.look.text));
        let at = Vector::new(place.origin.x.round(), (place.origin.y + height).round());
        panels.shapes.push(Shape::Text { line, at, ink });
    }
}

/// The room a line between two points takes, as squares along it.
fn along(from: Vector, to: Vector, spacing: f64, width: f64) -> Vec<Rect> {
    let count = (to.sub(from).norm() / spacing).ceil().clamp(1.0, 1000.0) as u32;
    let at = |number: u32| from.add(to.sub(from).mult(f64::from(number) / f64::from(count)));
    (0..=count).map(|number| around(at(number), width)).collect()
}

fn around(point: Vector, radius: f64) -> Rect {
    Rect::new(point.sub(Vector::new(radius, radius)), 2.0 * radius, 2.0 * radius)
}
