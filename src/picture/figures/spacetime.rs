use super::FigureRun;
use super::axes::{Axes, AxisTitles, Range, Scale};
use super::panels::Panels;
use crate::physics::{Axis, BodyId, Rect, Vector, larger, smaller};
use crate::picture::Overlay;
use crate::picture::figures::legend;
use crate::picture::layers::bodies::border_color;
use crate::picture::text::{Line, truncated};
use crate::picture::{CameraTarget, Color, DisplayList, DrawingMetrics, Ink, Palette, Shape, Style, color};
use std::collections::BTreeMap;

/// Maximum number of labelled bodies; with more bodies there are no labels.
const MAX_LABELS: usize = 24;

/// Draws the position of each body along an axis over time, as a band as wide as the body: bands touch where bodies
/// touch. The y axis points downwards, as in the world. Several runs have the same scales.
pub fn spacetime(runs: &[FigureRun], axis: Axis, style: &Style) -> DisplayList {
    let mut panels = Panels::new(style, &legend(runs, style));
    let bands: Vec<Vec<Band>> = runs.iter().map(|run| bands(run, axis, style)).collect();
    let Some((time, positions)) = ranges(runs, &bands, axis, style) else { return panels.finish() };
    let (positions, titles) = match axis {
        Axis::X => (positions, AxisTitles { x: "t / \"s\"", y: "x / \"m\"" }),
        Axis::Y => (Range { from: positions.to, to: positions.from }, AxisTitles { x: "t / \"s\"", y: "y / \"m\"" }),
    };
    let names: Vec<&str> = runs.iter().map(|run| run.title.as_str()).collect();
    // Figures of several runs have a legend instead.
    let has_labels = style.shows(Overlay::Name) && runs.len() == 1;
    for (panel, bands) in panels.titled_cells(&names, runs.len()).iter().zip(&bands) {
        let labels = if has_labels { labels(bands, positions, &panels.metrics) } else { Vec::new() };
        let right = labels.iter().map(|label| label.line.width + 2.0 * panels.metrics.font_size).fold(0.0, larger);
        let axes = Axes::within(panel, Scale::Linear(time), Scale::Linear(positions), right.ceil(), &panels.metrics);
        axes.draw(&titles, &panels.metrics, &mut panels.shapes);
        let shapes: Vec<Shape> = bands
            .iter()
            .filter(|band| !band.spans_axis(positions))
            .flat_map(|band| band.draw(&axes, &panels))
            .collect();
        panels.shapes.push(Shape::Clip { window: axes.plot_area, shapes });
        draw_labels(labels, &axes, &mut panels);
    }
    panels.finish()
}

/// The band of one body during its lifetime.
struct Band {
    name: String,
    color: Color,
    is_wall: bool,
    /// True for static bodies (of infinite mass).
    is_static: bool,
    samples: Vec<BandSample>,
}

/// The extent of a body at one instant.
#[derive(Clone, Copy)]
struct BandSample {
    /// Simulated time, s.
    time: f64,
    /// Lower end, m.
    from: f64,
    /// Upper end, m.
    to: f64,
    /// The colour of the band from this instant on.
    color: Color,
}

fn bands(run: &FigureRun, axis: Axis, style: &Style) -> Vec<Band> {
    let wall = Palette::of(style.look.theme).wall;
    let mut bands: BTreeMap<BodyId, Band> = BTreeMap::new();
    for frame in &run.frames {
        for sprite in &frame.sprites {
            let band = bands.entry(sprite.appearance.id).or_insert_with(|| Band {
                name: sprite.appearance.name.clone(),
                color: if sprite.appearance.is_wall { wall } else { color::body_color(sprite, style) },
                is_wall: sprite.appearance.is_wall,
                is_static: sprite.appearance.mass == f64::INFINITY,
                samples: Vec::new(),
            });
            let [from, to] = sprite.rect.along(axis);
            let color = if band.is_wall { wall } else { color::body_color(sprite, style) };
            band.samples.push(BandSample { time: frame.time, from, to, color });
        }
    }
    let mut bands: Vec<Band> =
        bands.into_values().filter(|band| !band.is_wall || band.bounds_world(run, axis)).collect();
    // Moving bodies are drawn over static ones.
    bands.sort_by_key(|band| !band.is_static);
    bands
}

/// The ranges of the two axes: the time span of all runs, and the positions of all bodies or the camera's window.
fn ranges(runs: &[FigureRun], bands: &[Vec<Band>], axis: Axis, style: &Style) -> Option<(Range, Range)> {
    let time = Range::of(runs.iter().flat_map(|run| &run.frames).map(|frame| frame.time))?;
    if let CameraTarget::Window(area) = &style.look.camera_target {
        let [from, to] = area.along(axis);
        return Some((time, Range { from, to }));
    }
    let of = |is_static: bool| {
        let bands = bands.iter().flatten().filter(move |band| band.is_static == is_static);
        Range::of(bands.flat_map(|band| band.samples.iter().flat_map(|sample| [sample.from, sample.to])))
    };
    let all_positions = of(false).or(of(true))?;
    let world = runs.iter().map(|run| run.world[axis]).fold(0.0, larger);
    // Bodies that have left the world do not extend the range, which would shrink the others to lines.
    let within_world = Range { from: larger(all_positions.from, 0.0), to: smaller(all_positions.to, world) };
    let positions = if within_world.from < within_world.to { within_world } else { all_positions };
    Some((time, positions.widened(0.05)))
}

impl Band {
    /// The last position of the body's middle between two positions, m.
    fn last_within(&self, low: f64, high: f64) -> Option<f64> {
        let middles = self.samples.iter().rev().map(|sample| (sample.from + sample.to) / 2.0);
        middles.into_iter().find(|&middle| low <= middle && middle <= high)
    }

    fn label(&self, metrics: &DrawingMetrics) -> Line {
        Line::plain(&truncated(&self.name, MAX_LABEL_CHARS), 0.8 * metrics.font_size)
    }

    /// Returns true if a wall bounds the world along the axis rather than spanning it.
    fn bounds_world(&self, run: &FigureRun, axis: Axis) -> bool {
        self.samples.iter().all(|sample| sample.to <= 0.0 || sample.from >= run.world[axis])
    }

    /// Returns true for a static body that spans most of the axis, such as a floor along x.
    fn spans_axis(&self, positions: Range) -> bool {
        let (low, high) = (smaller(positions.from, positions.to), larger(positions.from, positions.to));
        let covered = |from: f64, to: f64| smaller(to, high) - larger(from, low);
        self.is_static && self.samples.iter().all(|sample| covered(sample.from, sample.to) > (high - low) / 2.0)
    }

    fn draw(&self, axes: &Axes, panels: &Panels) -> Vec<Shape> {
        let mut shapes = Vec::new();
        let mut rest = &self.samples[..];
        // One polygon per colour, which extends to the start of the next one.
        while let Some(first) = rest.first() {
            let count = rest.iter().take_while(|sample| sample.color == first.color).count();
            let section = &rest[..(count + 1).min(rest.len())];
            let (lower, upper) = (edge(section, |sample| sample.from, axes), edge(section, |sample| sample.to, axes));
            let points = lower.into_iter().chain(upper.into_iter().rev()).collect();
            shapes.push(Shape::Polygon { points, ink: Ink { color: first.color, opacity: 150 } });
            rest = &rest[count..];
        }
        let border = border_color(self.color, &panels.metrics).into();
        let line = |points| Shape::Polyline { points, width: 0.75 * panels.metrics.line_width, ink: border };
        shapes.extend([
            line(edge(&self.samples, |sample| sample.from, axes)),
            line(edge(&self.samples, |sample| sample.to, axes)),
        ]);
        shapes
    }
}

/// One edge of a band. Points closer than half a pixel to the one before are dropped.
fn edge(samples: &[BandSample], side: impl Fn(&BandSample) -> f64, axes: &Axes) -> Vec<Vector> {
    let points = samples.iter().map(|sample| axes.point(sample.time, side(sample)));
    let mut vertices: Vec<Vector> = Vec::new();
    for at in points.filter(|at| at.is_finite()) {
        if vertices.last().is_none_or(|last| at.sub(*last).norm() >= 0.5) {
            vertices.push(at);
        }
    }
    vertices
}

/// Maximum number of characters of a label.
const MAX_LABEL_CHARS: usize = 20;

/// The label at the end of a band.
struct BandLabel {
    /// The last position of the body within the range of the axis, m.
    at: f64,
    color: Color,
    line: Line,
}

/// The labels of the bodies visible in the diagram, from top to bottom.
fn labels(bands: &[Band], positions: Range, metrics: &DrawingMetrics) -> Vec<BandLabel> {
    let (low, high) = (smaller(positions.from, positions.to), larger(positions.from, positions.to));
    let named = bands.iter().filter(|band| !band.is_wall && !band.spans_axis(positions));
    let label = |band: &Band| {
        Some(BandLabel { at: band.last_within(low, high)?, color: band.color, line: band.label(metrics) })
    };
    let mut labels: Vec<BandLabel> = named.filter_map(label).collect();
    if labels.len() > MAX_LABELS {
        return Vec::new();
    }
    labels.sort_by(|a, b| a.at.total_cmp(&b.at));
    if positions.to > positions.from {
        labels.reverse();
    }
    labels
}

/// Draws labels on the right of the diagram, each at the height of the end of its band with a swatch of its colour,
/// moved apart where they would overlap.
fn draw_labels(labels: Vec<BandLabel>, axes: &Axes, panels: &mut Panels) {
    let metrics = panels.metrics;
    let (spacing, x) = (1.15 * metrics.font_size, axes.plot_area.far_corner().x + 0.4 * metrics.font_size);
    let far = axes.plot_area.far_corner().y;
    let mut heights: Vec<f64> = labels.iter().map(|label| axes.point(0.0, label.at).y).collect();
    for at in 1..heights.len() {
        heights[at] = larger(heights[at], heights[at - 1] + spacing);
    }
    let mut limit = far;
    for height in heights.iter_mut().rev() {
        *height = smaller(*height, limit);
        limit = *height - spacing;
    }
    for (BandLabel { color, line, .. }, y) in labels.into_iter().zip(heights) {
        let side = (0.6 * metrics.font_size).round();
        let swatch = Rect::new(Vector::new(x.round(), (y - side / 2.0).round()), side, side);
        panels.shapes.push(Shape::Rect { rect: swatch, ink: color.into() });
        let at = Vector::new((x + side + 0.4 * metrics.font_size).round(), (y + line.height() / 2.0).round());
        panels.shapes.push(Shape::Text { line, at, ink: metrics.palette.ink.into() });
    }
}
