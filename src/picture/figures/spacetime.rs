use super::axes::{Axes, AxisTitles, Range, Scale};
use super::panels::{Layout, Panels, TITLE};
use super::timeline::{Timeline, draw_timeline, timeline_legend};
use super::{TimeCurve, legend_of_bodies};
use crate::physics::{Axis, BodyId, Rect, Vector, larger, smaller};
use crate::picture::layers::bodies::{border_color, draw_box};
use crate::picture::number::Unit;
use crate::picture::text::{Line, truncated};
use crate::picture::{
    Appearance, CameraTarget, Color, DisplayList, DrawingMetrics, Ink, Overlay, Palette, RenderError, Shape, Sprite,
};
use crate::picture::{Style, color};
use std::collections::BTreeMap;
use std::sync::Arc;

/// Maximum number of labelled bodies; with more bodies there are no labels.
const MAX_LABELS: usize = 24;

/// The positions of the bodies of one run along an axis over time. Memory is bounded by the width of the page.
#[derive(Clone, Debug, PartialEq)]
pub struct SpacetimeRun {
    /// Title, shown if there are several runs.
    pub title: String,
    /// Spawns, deletes and gaps.
    pub timeline: Timeline,
    /// Width and height of the world, m.
    world: Vector,
    axis: Axis,
    /// Width of the columns of curves, s.
    column: f64,
    bands: BTreeMap<BodyId, Band>,
}

/// The band of one body during its lifetime.
#[derive(Clone, Debug, PartialEq)]
struct Band {
    appearance: Arc<Appearance>,
    /// Extent of the body along the axis, m.
    size: f64,
    /// Parts of one colour: the positions of the lower end, m. Each part extends to the start of the next one.
    parts: Vec<(Color, TimeCurve)>,
    /// Time of the start of the last part and of the last position, s, and that position, m.
    started: f64,
    last: [f64; 2],
}

impl SpacetimeRun {
    /// Creates a run without positions in a world of `world` metres, for curves with columns of `column` seconds.
    pub fn new(title: String, world: Vector, axis: Axis, column: f64) -> SpacetimeRun {
        SpacetimeRun { title, timeline: Timeline::default(), world, axis, column, bands: BTreeMap::new() }
    }

    /// Adds the position of a body; times must not decrease.
    pub fn push(&mut self, time: f64, sprite: &Sprite, style: &Style) {
        let wall = Palette::of(style.look.theme).wall;
        let color = if sprite.appearance.is_wall { wall } else { color::body_color(sprite, style) };
        let [from, to] = sprite.rect.along(self.axis);
        let band = self.bands.entry(sprite.appearance.id).or_insert_with(|| Band {
            appearance: sprite.appearance.clone(),
            size: to - from,
            parts: Vec::new(),
            started: f64::NEG_INFINITY,
            last: [time, from],
        });
        band.push(time, from, color, self.column);
    }

    /// Interrupts all bands: the next positions are not joined to the last ones.
    pub fn interrupt(&mut self) {
        self.bands.values_mut().for_each(|band| band.started = f64::NEG_INFINITY);
    }

    /// The bands that are drawn: static ones first, so that moving bodies are drawn over them, and no wall that spans
    /// the world.
    fn drawn(&self) -> Vec<&Band> {
        let bounds_world = |band: &&Band| !band.appearance.is_wall || band.bounds_world(self.world[self.axis]);
        let mut bands: Vec<&Band> = self.bands.values().filter(bounds_world).collect();
        bands.sort_by_key(|band| !band.is_static());
        bands
    }
}

/// Draws the position of each body along an axis over `time` (s), as a band as wide as the body: bands touch where
/// bodies touch. The y axis points downwards, as in the world. Several runs have the same scales.
///
/// # Errors
/// If the page is too small.
pub fn spacetime(runs: &[SpacetimeRun], time: Range, axis: Axis, style: &Style) -> Result<DisplayList, RenderError> {
    let bands: Vec<Vec<&Band>> = runs.iter().map(SpacetimeRun::drawn).collect();
    let positions = position_range(runs, &bands, axis, style);
    let visible = || bands.iter().flatten().filter(|band| band.last_within(positions).is_some());
    let bodies = || visible().filter_map(|band| Some((&*band.appearance, band.parts.first()?.0)));
    let legend = |metrics: &DrawingMetrics| {
        let mut legend = legend_of_bodies(bodies(), runs.len(), style);
        legend.entries.extend(timeline_legend(runs.iter().map(|run| &run.timeline), style.look.language, metrics));
        legend
    };
    let (scale, symbol) = match axis {
        Axis::X => (positions, "x"),
        Axis::Y => (Range { from: positions.to, to: positions.from }, "y"),
    };
    let [x, y] = [Scale::linear(time, Unit::SECOND), Scale::linear(scale, Unit::METRE)];
    // Figures of several runs have a legend instead.
    let has_labels = style.shows(Overlay::Name) && runs.len() == 1;
    let labels_of = |bands: &[&Band], metrics: &DrawingMetrics| {
        if has_labels { labels(bands, scale, metrics) } else { Vec::new() }
    };
    let axes_of = |cell: &Rect, labels: &[BandLabel], metrics: &DrawingMetrics| {
        let right = labels.iter().map(|label| label.line.width + 2.0 * metrics.font_size).fold(0.0, larger);
        Axes::within(cell, x, y, right.ceil(), metrics)
    };
    let fits = |cell: &Rect, metrics: &DrawingMetrics| {
        let labels = bands.first().map_or_else(Vec::new, |bands| labels_of(bands, metrics));
        let area = axes_of(cell, &labels, metrics).plot_area;
        let label_height = labels.len() as f64 * LABEL_SPACING * metrics.font_size;
        area.width() >= 6.0 * metrics.font_size && area.height() >= larger(3.0 * metrics.font_size, label_height)
    };
    let titles: Vec<&str> = runs.iter().map(|run| run.title.as_str()).collect();
    let layout = Layout { legend: &legend, text_height: TITLE, ..Layout::new(style, &titles, &fits) };
    let (mut panels, cells) = layout.lay_out()?;
    for ((cell, bands), run) in cells.iter().zip(&bands).zip(runs) {
        panels.clip(cell, |panels| {
            let labels = labels_of(bands, &panels.metrics);
            let axes = axes_of(cell, &labels, &panels.metrics);
            axes.draw(&AxisTitles { x: &x.title("t"), y: &y.title(symbol) }, &panels.metrics, &mut panels.shapes);
            let visible: Vec<&&Band> = bands.iter().filter(|band| !band.spans_axis(positions)).collect();
            // All edges are above all areas, so that no band hides another one.
            let areas = visible.iter().flat_map(|band| band.areas(&axes));
            let edges = visible.iter().flat_map(|band| band.edges(&axes, panels));
            let shapes = areas.chain(edges).collect();
            panels.shapes.push(Shape::Clip { window: axes.plot_area, shapes });
            draw_timeline(&run.timeline, &axes, panels);
            draw_labels(labels, &axes, panels);
        });
    }
    Ok(panels.finish())
}

/// Distance of labels, in font sizes.
const LABEL_SPACING: f64 = 1.15;

/// The positions of all bodies, or the camera's window.
fn position_range(runs: &[SpacetimeRun], bands: &[Vec<&Band>], axis: Axis, style: &Style) -> Range {
    if let CameraTarget::Window(area) = &style.look.camera_target {
        let [from, to] = area.along(axis);
        return Range { from, to };
    }
    let of = |is_static: bool| {
        let bands = bands.iter().flatten().filter(move |band| band.is_static() == is_static);
        Range::of(bands.flat_map(|band| band.positions().flat_map(|from| [from, from + band.size])))
    };
    let world = runs.iter().map(|run| run.world[axis]).fold(0.0, larger);
    let all_positions = of(false).or(of(true)).unwrap_or(Range { from: 0.0, to: larger(world, 1.0) });
    // Bodies that have left the world do not extend the range, which would shrink the others to lines.
    let within_world = Range { from: larger(all_positions.from, 0.0), to: smaller(all_positions.to, world) };
    let positions = if within_world.from < within_world.to { within_world } else { all_positions };
    positions.widened(0.05)
}

impl Band {
    fn push(&mut self, time: f64, from: f64, color: Color, column: f64) {
        // A colour lasts for a column at least, so that the number of parts is bounded.
        let is_new_color = self.parts.last().is_none_or(|(last, _)| *last != color) && time - self.started >= column;
        if is_new_color || self.started == f64::NEG_INFINITY {
            let mut curve = TimeCurve::new(column);
            if let Some((_, part)) = self.parts.last_mut().filter(|_| self.started != f64::NEG_INFINITY) {
                part.push(time, from);
            }
            curve.push(time, from);
            self.parts.push((color, curve));
            self.started = time;
        } else if let Some((_, curve)) = self.parts.last_mut() {
            curve.push(time, from);
        }
        self.last = [time, from];
    }

    /// Returns true for a body of infinite mass that does not move along the axis.
    fn is_static(&self) -> bool {
        let mut positions = self.positions();
        let first = positions.next();
        self.appearance.mass == f64::INFINITY && positions.all(|position| Some(position) == first)
    }

    /// The positions of the lower end, m.
    fn positions(&self) -> impl Iterator<Item = f64> {
        self.parts.iter().flat_map(|(_, curve)| curve.values())
    }

    /// The middle of the part of the body within a range of positions, m, the last time that there is one.
    fn last_within(&self, positions: Range) -> Option<f64> {
        let (low, high) = (smaller(positions.from, positions.to), larger(positions.from, positions.to));
        let visible = |from: f64| {
            let [from, to] = [larger(from, low), smaller(from + self.size, high)];
            (from <= to).then_some((from + to) / 2.0)
        };
        visible(self.last[1]).or_else(|| self.positions().filter_map(visible).last())
    }

    fn label(&self, metrics: &DrawingMetrics) -> Line {
        Line::plain(&truncated(&self.appearance.name, MAX_LABEL_CHARS), metrics.text(0.8))
    }

    /// Returns true if a wall bounds a world of `extent` metres along the axis rather than spanning it.
    fn bounds_world(&self, extent: f64) -> bool {
        self.positions().all(|from| from + self.size <= 0.0 || from >= extent)
    }

    /// Returns true for a static body that spans most of the axis, such as a floor along x.
    fn spans_axis(&self, positions: Range) -> bool {
        let (low, high) = (smaller(positions.from, positions.to), larger(positions.from, positions.to));
        let covered = |from: f64| smaller(from + self.size, high) - larger(from, low);
        self.is_static() && self.positions().all(|from| covered(from) > (high - low) / 2.0)
    }

    /// The lower and the upper end of the body over time in each part of its curve, px, with the colour of the part.
    fn ends(&self, axes: &Axes) -> impl Iterator<Item = (Color, [Vec<Vector>; 2])> {
        let on_page = |end: Vec<[f64; 2]>| {
            let points = end.into_iter().map(|[time, at]| axes.point(time, at));
            let mut points: Vec<Vector> = points.filter(|at| at.is_finite()).collect();
            points.dedup();
            // A single state is a mark instead of a line without length.
            let half = Vector::new((axes.plot_area.width() / 200.0).ceil(), 0.0);
            match points.as_slice() {
                [at] => vec![at.sub(half), at.add(half)],
                _ => points,
            }
        };
        let parts = self.parts.iter();
        let ends = parts.flat_map(|(color, curve)| curve.bands(self.size).into_iter().map(|ends| (*color, ends)));
        ends.map(move |(color, ends)| (color, ends.map(on_page)))
    }

    /// The areas between both ends.
    fn areas(&self, axes: &Axes) -> Vec<Shape> {
        let area = |(color, [low, high]): (Color, [Vec<Vector>; 2])| {
            let points = low.into_iter().chain(high.into_iter().rev()).collect();
            Shape::Polygon { points, ink: Ink { color, opacity: 150 } }
        };
        self.ends(axes).map(area).collect()
    }

    /// The lines along both ends.
    fn edges(&self, axes: &Axes, panels: &Panels) -> Vec<Shape> {
        let color = self.parts.first().map_or(panels.metrics.palette.muted, |(color, _)| *color);
        let ink = border_color(color, &panels.metrics).into();
        let line = |points| Shape::Polyline { points, width: 0.75 * panels.metrics.line_width, ink };
        self.ends(axes).flat_map(|(_, ends)| ends.map(line)).collect()
    }
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
fn labels(bands: &[&Band], positions: Range, metrics: &DrawingMetrics) -> Vec<BandLabel> {
    let named = bands.iter().filter(|band| !band.appearance.is_wall && !band.spans_axis(positions));
    let label = |band: &&Band| {
        let color = band.parts.first()?.0;
        Some(BandLabel { at: band.last_within(positions)?, color, line: band.label(metrics) })
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
    let (spacing, x) = (LABEL_SPACING * metrics.font_size, axes.plot_area.far_corner().x + 0.4 * metrics.font_size);
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
        draw_box(&swatch, color, &metrics, &mut panels.shapes);
        let at = Vector::new((x + side + 0.4 * metrics.font_size).round(), (y + line.height() / 2.0).round());
        panels.shapes.push(Shape::Text { line, at, ink: metrics.palette.ink.into() });
    }
}
