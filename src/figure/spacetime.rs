use super::axes::{Axes, Range, Titles};
use super::panels::Panels;
use super::run::legend;
use super::{FigureOptions, Run};
use crate::physics::{BodyId, Rect, Vector};
use crate::render::area::{larger, smaller};
use crate::render::layers::bodies::border_color;
use crate::render::text::Line;
use crate::render::{Aim, Color, DisplayList, Ink, Look, Palette, Shape, Sprite, palette};
use crate::scene::Overlay;
use std::collections::BTreeMap;

/// Which coordinate a diagram shows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Axis {
    /// To the right.
    X,
    /// Downwards, and drawn so.
    Y,
}

/// More bodies than that are not named.
const NAMED: usize = 24;

/// Where each body is over time: a band as wide as the body, so that bands that touch are
/// bodies that touch. Several runs have the same scales.
pub fn spacetime(runs: &[Run], axis: Axis, options: &FigureOptions) -> DisplayList {
    let mut panels = Panels::new(options, &legend(runs, options));
    let bands: Vec<Vec<Band>> = runs.iter().map(|run| bands(run, axis, options)).collect();
    let Some((time, place)) = ranges(runs, &bands, axis, options) else { return panels.finish() };
    let (place, titles) = match axis {
        Axis::X => (place, Titles { x: "t / \"s\"", y: "x / \"m\"" }),
        Axis::Y => (Range { from: place.to, to: place.from }, Titles { x: "t / \"s\"", y: "y / \"m\"" }),
    };
    let names: Vec<&str> = runs.iter().map(|run| run.title.as_str()).collect();
    // Several runs have a legend.
    let is_named = options.style.shows(Overlay::Name) && runs.len() == 1;
    for (room, bands) in panels.titled(&names, runs.len()).iter().zip(&bands) {
        let labels = if is_named { labels(bands, place, &panels.look) } else { Vec::new() };
        let right = labels.iter().map(|label| label.line.width + 2.0 * panels.look.text).fold(0.0, larger);
        let axes = Axes::within(room, time, place, right.ceil(), &panels.look);
        axes.draw(&titles, &panels.look, &mut panels.shapes);
        let drawn: Vec<Shape> =
            bands.iter().filter(|band| !band.is_backdrop(place)).flat_map(|band| band.draw(&axes, &panels)).collect();
        panels.shapes.push(Shape::Clip { window: axes.frame, shapes: drawn });
        name(labels, &axes, &mut panels);
    }
    panels.finish()
}

/// One body as long as it is alive.
struct Band {
    name: String,
    color: Color,
    is_wall: bool,
    /// Whether it never moves, whatever hits it.
    is_scenery: bool,
    spans: Vec<Span>,
}

/// Where a body is at one instant.
#[derive(Clone, Copy)]
struct Span {
    /// s.
    time: f64,
    /// m.
    from: f64,
    /// m.
    to: f64,
    /// What it is drawn in from here on.
    color: Color,
}

fn bands(run: &Run, axis: Axis, options: &FigureOptions) -> Vec<Band> {
    let wall = Palette::of(options.style.theme).wall;
    let mut bands: BTreeMap<BodyId, Band> = BTreeMap::new();
    for frame in &run.frames {
        for sprite in &frame.sprites {
            let band = bands.entry(sprite.appearance.id).or_insert_with(|| Band {
                name: sprite.appearance.name.clone(),
                color: if sprite.appearance.is_wall { wall } else { palette::body_color(sprite, &options.style) },
                is_wall: sprite.appearance.is_wall,
                is_scenery: sprite.appearance.mass == f64::INFINITY,
                spans: Vec::new(),
            });
            let [from, to] = extent(sprite, axis);
            let color = if band.is_wall { wall } else { palette::body_color(sprite, &options.style) };
            band.spans.push(Span { time: frame.time, from, to, color });
        }
    }
    let mut bands: Vec<Band> = bands.into_values().filter(|band| !band.is_wall || band.is_beside(run, axis)).collect();
    // What moves is seen in front of what does not.
    bands.sort_by_key(|band| !band.is_scenery);
    bands
}

fn extent(sprite: &Sprite, axis: Axis) -> [f64; 2] {
    let (near, far) = (sprite.rect.origin, sprite.rect.far_corner());
    match axis {
        Axis::X => [near.x, far.x],
        Axis::Y => [near.y, far.y],
    }
}

/// The whole time, and all places where a body ever is, or those in the window aimed at.
fn ranges(runs: &[Run], bands: &[Vec<Band>], axis: Axis, options: &FigureOptions) -> Option<(Range, Range)> {
    let time = Range::of(runs.iter().flat_map(|run| &run.frames).map(|frame| frame.time))?;
    if let Aim::Window(area) = &options.aim {
        let (near, far) = (area.origin, area.far_corner());
        let [from, to] = match axis {
            Axis::X => [near.x, far.x],
            Axis::Y => [near.y, far.y],
        };
        return Some((time, Range { from, to }));
    }
    let of = |scenery: bool| {
        let bands = bands.iter().flatten().filter(move |band| band.is_scenery == scenery);
        Range::of(bands.flat_map(|band| band.spans.iter().flat_map(|span| [span.from, span.to])))
    };
    let places = of(false).or(of(true))?;
    let world = runs.iter().map(|run| if axis == Axis::X { run.world.x } else { run.world.y }).fold(0.0, larger);
    // What has left the world is not followed, or the rest would be seen as a line.
    let seen = Range { from: larger(places.from, 0.0), to: smaller(places.to, world) };
    let place = if seen.from < seen.to { seen } else { places };
    Some((time, place.widened(0.05)))
}

impl Band {
    /// Where the middle of the body is last between two places, m.
    fn last_within(&self, low: f64, high: f64) -> Option<f64> {
        let middles = self.spans.iter().rev().map(|span| (span.from + span.to) / 2.0);
        middles.into_iter().find(|&middle| low <= middle && middle <= high)
    }

    fn label(&self, look: &Look) -> Line {
        let kept: String = self.name.chars().take(LONGEST).collect();
        let name = if kept.len() < self.name.len() { format!("{}…", kept.trim_end()) } else { kept };
        Line::plain(&name, 0.8 * look.text)
    }

    /// Whether a wall bounds the world along the axis, and does not span it.
    fn is_beside(&self, run: &Run, axis: Axis) -> bool {
        let extent = match axis {
            Axis::X => run.world.x,
            Axis::Y => run.world.y,
        };
        self.spans.iter().all(|span| span.to <= 0.0 || span.from >= extent)
    }

    /// Whether it is scenery that spans most of what the scale shows, such as a floor along x.
    fn is_backdrop(&self, place: Range) -> bool {
        let (low, high) = (smaller(place.from, place.to), larger(place.from, place.to));
        let covered = |from: f64, to: f64| smaller(to, high) - larger(from, low);
        self.is_scenery && self.spans.iter().all(|span| covered(span.from, span.to) > (high - low) / 2.0)
    }

    fn draw(&self, axes: &Axes, panels: &Panels) -> Vec<Shape> {
        let mut shapes = Vec::new();
        let mut rest = &self.spans[..];
        // A piece for each colour reaches to where the next one begins.
        while let Some(first) = rest.first() {
            let same = rest.iter().take_while(|span| span.color == first.color).count();
            let piece = &rest[..(same + 1).min(rest.len())];
            let (one, other) = (edge(piece, |span| span.from, axes), edge(piece, |span| span.to, axes));
            let points = one.into_iter().chain(other.into_iter().rev()).collect();
            shapes.push(Shape::Polygon { points, ink: Ink { color: first.color, opacity: 150 } });
            rest = &rest[same..];
        }
        let border = border_color(self.color, &panels.look).into();
        let line = |points| Shape::Polyline { points, width: 0.75 * panels.look.line, ink: border };
        shapes.extend([line(edge(&self.spans, |span| span.from, axes)), line(edge(&self.spans, |span| span.to, axes))]);
        shapes
    }
}

/// One side of a band, as fine as can be seen.
fn edge(spans: &[Span], side: impl Fn(&Span) -> f64, axes: &Axes) -> Vec<Vector> {
    let points = spans.iter().map(|span| axes.point(span.time, side(span)));
    let mut seen: Vec<Vector> = Vec::new();
    for at in points.filter(|at| at.is_finite()) {
        if seen.last().is_none_or(|last| at.sub(*last).norm() >= 0.5) {
            seen.push(at);
        }
    }
    seen
}

/// Letters of a name at most.
const LONGEST: usize = 20;

/// What is written beside the end of a band.
struct BandLabel {
    /// Where the body is last within the scale, m.
    at: f64,
    color: Color,
    line: Line,
}

/// The names of bodies where the scale shows them, from above to below.
fn labels(bands: &[Band], place: Range, look: &Look) -> Vec<BandLabel> {
    let (low, high) = (smaller(place.from, place.to), larger(place.from, place.to));
    let named = bands.iter().filter(|band| !band.is_wall && !band.is_backdrop(place));
    let label =
        |band: &Band| Some(BandLabel { at: band.last_within(low, high)?, color: band.color, line: band.label(look) });
    let mut labels: Vec<BandLabel> = named.filter_map(label).collect();
    if labels.len() > NAMED {
        return Vec::new();
    }
    labels.sort_by(|a, b| a.at.total_cmp(&b.at));
    if place.to > place.from {
        labels.reverse();
    }
    labels
}

/// Names on the right of the diagram, each beside the end of its band with its colour before it,
/// moved apart where they would meet.
fn name(labels: Vec<BandLabel>, axes: &Axes, panels: &mut Panels) {
    let look = panels.look;
    let (apart, x) = (1.15 * look.text, axes.frame.far_corner().x + 0.4 * look.text);
    let far = axes.frame.far_corner().y;
    let mut heights: Vec<f64> = labels.iter().map(|label| axes.point(0.0, label.at).y).collect();
    for at in 1..heights.len() {
        heights[at] = larger(heights[at], heights[at - 1] + apart);
    }
    let mut lowest = far;
    for height in heights.iter_mut().rev() {
        *height = smaller(*height, lowest);
        lowest = *height - apart;
    }
    for (BandLabel { color, line, .. }, y) in labels.into_iter().zip(heights) {
        let side = (0.6 * look.text).round();
        let swatch = Rect::new(Vector::new(x.round(), (y - side / 2.0).round()), side, side);
        panels.shapes.push(Shape::Rect { rect: swatch, ink: color.into() });
        let at = Vector::new((x + side + 0.4 * look.text).round(), (y + line.height() / 2.0).round());
        panels.shapes.push(Shape::Text { line, at, ink: look.palette.ink.into() });
    }
}
