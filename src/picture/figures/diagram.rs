use super::axes::{Axes, AxisTitles, Scale};
use super::panels::{Layout, Panels};
use crate::physics::{Rect, Vector, smaller};
use crate::picture::layers::footer::{Entry, Legend};
use crate::picture::layers::labels::LabelPlacer;
use crate::picture::raster::color::CURVE_COLORS;
use crate::picture::text::Line;
use crate::picture::{Color, DisplayList, DrawingMetrics, Ink, RenderError, Shape};
use crate::picture::{Language, Look, PictureOptions, Theme};

/// A diagram with logarithmic scales.
#[derive(Clone, Debug, PartialEq)]
pub struct Diagram {
    /// Title above the diagram.
    pub title: String,
    /// Title of the horizontal axis, as markup.
    pub x: String,
    /// Title of the vertical axis, as markup.
    pub y: String,
    /// Curves, in drawing order.
    pub curves: Vec<Curve>,
}

/// A curve: points joined by straight lines.
#[derive(Clone, Debug, PartialEq)]
pub struct Curve {
    /// Name in the legend. Curves of the same name have the same colour in all diagrams.
    pub name: String,
    /// Label of the last point; none if empty.
    pub label: String,
    /// Points, in drawing order.
    pub points: Vec<Point>,
}

/// A point of a curve. Coordinates must be positive or zero.
#[derive(Clone, Debug, PartialEq)]
pub struct Point {
    /// Horizontal coordinate.
    pub x: f64,
    /// Vertical coordinate.
    pub y: f64,
    /// Label next to the point; none if empty.
    pub label: String,
}

/// Draws diagrams on one page, with a common legend. Uses size, theme and caption of the options; an open size is
/// derived from the number of diagrams.
///
/// # Errors
/// If the page is too small.
pub fn diagrams(diagrams: &[Diagram], options: &PictureOptions) -> Result<DisplayList, RenderError> {
    let columns = columns(diagrams.len());
    let rows = diagrams.len().div_ceil(columns).max(1);
    let size = options.size.unwrap_or_else(|| page_size(columns, rows));
    let mut names: Vec<&str> = Vec::new();
    for curve in diagrams.iter().flat_map(|diagram| &diagram.curves) {
        if !names.contains(&curve.name.as_str()) {
            names.push(&curve.name);
        }
    }
    let entries: Vec<Entry> = names.iter().enumerate().map(|(number, name)| Entry::new(color(number), name)).collect();
    let layout = Layout {
        size,
        metrics: metrics(options.theme.unwrap_or(Look::default().theme), size, columns, rows),
        caption: options.caption.as_deref().unwrap_or_default(),
        legend: &|_| Legend { entries: entries.clone() },
        titles: &diagrams.iter().map(|diagram| diagram.title.as_str()).collect::<Vec<&str>>(),
        shape: Vector::new(560.0, 400.0),
        text_height: 0.0,
        fits: &|cell, metrics| cell.width() >= 13.0 * metrics.font_size && cell.height() >= 9.0 * metrics.font_size,
    };
    let (mut panels, cells) = layout.lay_out()?;
    for (diagram, cell) in diagrams.iter().zip(&cells) {
        let color_of = |curve: &Curve| color(names.iter().position(|name| *name == curve.name).unwrap_or(0));
        panels.clip(cell, |panels| draw(diagram, cell, color_of, panels));
    }
    Ok(panels.finish())
}

fn columns(count: usize) -> usize {
    match count {
        0 | 1 => 1,
        2..=4 => 2,
        _ => 3,
    }
}

fn page_size(columns: usize, rows: usize) -> [u32; 2] {
    match (columns, rows) {
        (1, _) => [1280, 720],
        (columns, rows) => [columns as u32 * 560, rows as u32 * 400 + 60],
    }
}

/// DrawingMetrics that suit the size of one diagram rather than of the page.
fn metrics(theme: Theme, [width, height]: [u32; 2], columns: usize, rows: usize) -> DrawingMetrics {
    let scale_x = f64::from(width) / columns as f64 / 560.0;
    let scale_y = f64::from(height) / rows as f64 / 400.0;
    let unit = smaller(scale_x, scale_y);
    let at_least_one_pixel = |length: f64| if length < 1.0 { 1.0 } else { length.round() };
    DrawingMetrics {
        font_size: at_least_one_pixel(19.0 * smaller(unit, 1.4)),
        line_width: at_least_one_pixel(2.0 * unit),
        ..DrawingMetrics::new(theme, Language::English, [width, height])
    }
}

fn color(number: usize) -> Color {
    CURVE_COLORS[number % CURVE_COLORS.len()]
}

fn draw(diagram: &Diagram, cell: &Rect, color_of: impl Fn(&Curve) -> Color, panels: &mut Panels) {
    let points = || diagram.curves.iter().flat_map(|curve| &curve.points);
    let metrics = panels.metrics;
    let [x, y] = [Scale::log(points().map(|point| point.x)), Scale::log(points().map(|point| point.y))];
    let axes = Axes::within(cell, x, y, 0.5 * metrics.font_size, &metrics);
    axes.draw(&AxisTitles { x: &diagram.x, y: &diagram.y }, &metrics, &mut panels.shapes);
    let at = |point: &Point| axes.point(point.x, point.y);
    // Labels may extend half a pixel beyond the plot area.
    let mut placer = LabelPlacer::within(axes.plot_area.inset(-0.5));
    points().for_each(|point| placer.avoid(square_around(at(point), 0.35 * metrics.font_size), 1.0));
    for curve in &diagram.curves {
        let ink = Ink::from(color_of(curve));
        let positions: Vec<Vector> = curve.points.iter().map(at).collect();
        let width = metrics.line_width;
        panels.shapes.push(Shape::Polyline { points: positions.clone(), width, ink });
        for ends in positions.windows(2) {
            let squares = squares_along(ends[0], ends[1], 0.5 * metrics.font_size, width);
            squares.for_each(|square| placer.avoid(square, 1.0));
        }
        panels.shapes.extend(positions.iter().map(|&at| dot(at, 0.3 * metrics.font_size, ink)));
    }
    // Labels of curves first: they are more important than those of points.
    for curve in &diagram.curves {
        if let Some(last) = curve.points.last() {
            draw_label(&curve.label, at(last), metrics.palette.label(color_of(curve)).into(), &mut placer, panels);
        }
    }
    for point in points() {
        draw_label(&point.label, at(point), metrics.palette.muted.into(), &mut placer, panels);
    }
}

/// A dot, drawn as an octagon.
pub fn dot(at: Vector, radius: f64, ink: Ink) -> Shape {
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

/// Draws a label at the first free position around a point: right, above, below, left, then diagonally. Omits the label
/// if there is none.
fn draw_label(label: &str, point: Vector, ink: Ink, placer: &mut LabelPlacer, panels: &mut Panels) {
    if label.is_empty() {
        return;
    }
    let line = Line::plain(label, panels.metrics.text(0.7));
    let (width, height, gap) = (line.width, line.height(), 0.45 * panels.metrics.font_size);
    let middle = point.sub(Vector::new(width / 2.0, height / 2.0));
    let right = width / 2.0 + gap;
    let down = height / 2.0 + gap;
    let offsets = [
        (right, 0.0),
        (0.0, -down),
        (0.0, down),
        (-right, 0.0),
        (right, -down),
        (right, down),
        (-right, -down),
        (-right, down),
    ];
    let candidates = offsets.map(|(x, y)| Rect::new(middle.add(Vector::new(x, y)), width, height));
    if let Some(bounds) = placer.first_free(candidates) {
        // Keeps a distance of about one letter from later labels.
        placer.avoid(bounds.inset(-0.2 * panels.metrics.font_size), 1.0);
        let at = Vector::new(bounds.origin.x.round(), (bounds.origin.y + height).round());
        panels.shapes.push(Shape::Text { line, at, ink });
    }
}

/// The area of a line between two points, as squares along it.
fn squares_along(from: Vector, to: Vector, spacing: f64, width: f64) -> impl Iterator<Item = Rect> {
    let count = (to.sub(from).norm() / spacing).ceil().clamp(1.0, 1000.0) as u32;
    let at = move |number: u32| from.add(to.sub(from).mult(f64::from(number) / f64::from(count)));
    (0..=count).map(move |number| square_around(at(number), width))
}

fn square_around(point: Vector, radius: f64) -> Rect {
    Rect::new(point, 0.0, 0.0).inset(-radius)
}
