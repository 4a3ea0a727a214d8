use super::FigureOptions;
use super::axes::{Axes, Range, Titles};
use super::labels::Labels;
use super::panels::Panels;
use crate::physics::{BodyId, Vector};
use crate::render::layers::bodies::border_color;
use crate::render::text::Line;
use crate::render::{Color, DisplayList, Frame, Ink, Palette, Shape, Sprite, palette};
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
/// bodies that touch.
pub fn spacetime(frames: &[Frame], axis: Axis, options: &FigureOptions) -> DisplayList {
    let mut panels = Panels::new(options);
    let bands = bands(frames, axis, options);
    let Some((time, place)) = ranges(frames, &bands) else { return panels.finish() };
    let (place, titles) = match axis {
        Axis::X => (place, Titles { x: "t / \"s\"", y: "x / \"m\"" }),
        Axis::Y => (Range { from: place.to, to: place.from }, Titles { x: "t / \"s\"", y: "y / \"m\"" }),
    };
    let axes = Axes::within(&panels.room, time, place, &panels.look);
    axes.draw(&titles, &panels.look, &mut panels.shapes);
    let drawn: Vec<Shape> = bands.iter().flat_map(|band| band.draw(&axes, &panels)).collect();
    panels.shapes.push(Shape::Clip { window: axes.frame, shapes: drawn });
    if bands.len() <= NAMED {
        name(&bands, &axes, &mut panels);
    }
    panels.finish()
}

/// One body as long as it is alive.
struct Band {
    name: String,
    color: Color,
    is_wall: bool,
    /// Time, and from where to where.
    spans: Vec<[f64; 3]>,
}

fn bands(frames: &[Frame], axis: Axis, options: &FigureOptions) -> Vec<Band> {
    let wall = Palette::of(options.style.theme).wall;
    let mut bands: BTreeMap<BodyId, Band> = BTreeMap::new();
    for frame in frames {
        for sprite in &frame.sprites {
            let band = bands.entry(sprite.appearance.id).or_insert_with(|| Band {
                name: sprite.appearance.name.clone(),
                color: if sprite.appearance.is_wall { wall } else { palette::body_color(sprite, &options.style) },
                is_wall: sprite.appearance.is_wall,
                spans: Vec::new(),
            });
            let [from, to] = extent(sprite, axis);
            band.spans.push([frame.time, from, to]);
        }
    }
    bands.into_values().filter(|band| !band.is_wall || band.is_beside(options, axis)).collect()
}

fn extent(sprite: &Sprite, axis: Axis) -> [f64; 2] {
    let (near, far) = (sprite.rect.origin, sprite.rect.far_corner());
    match axis {
        Axis::X => [near.x, far.x],
        Axis::Y => [near.y, far.y],
    }
}

/// The whole time, and all places where a body ever is.
fn ranges(frames: &[Frame], bands: &[Band]) -> Option<(Range, Range)> {
    let time = Range::of(frames.iter().map(|frame| frame.time))?;
    let places = bands
        .iter()
        .filter(|band| !band.is_wall)
        .flat_map(|band| band.spans.iter().flat_map(|&[_, from, to]| [from, to]));
    Some((time, Range::of(places)?.widened(0.05)))
}

impl Band {
    /// Whether a wall bounds the world along the axis, and does not span it.
    fn is_beside(&self, options: &FigureOptions, axis: Axis) -> bool {
        let extent = match axis {
            Axis::X => options.world.x,
            Axis::Y => options.world.y,
        };
        self.spans.iter().all(|&[_, from, to]| to <= 0.0 || from >= extent)
    }

    fn draw(&self, axes: &Axes, panels: &Panels) -> Vec<Shape> {
        let edge = |side: usize| -> Vec<Vector> {
            let points = self.spans.iter().map(|span| axes.point(span[0], span[side]));
            let mut seen: Vec<Vector> = Vec::new();
            for at in points.filter(|at| at.is_finite()) {
                if seen.last().is_none_or(|last| at.sub(*last).norm() >= 0.5) {
                    seen.push(at);
                }
            }
            seen
        };
        let (one, other) = (edge(1), edge(2));
        let around = one.iter().chain(other.iter().rev()).copied().collect();
        let ink = Ink { color: self.color, opacity: 150 };
        let border = border_color(self.color, &panels.look).into();
        let line = |points| Shape::Polyline { points, width: 0.75 * panels.look.line, ink: border };
        vec![Shape::Polygon { points: around, ink }, line(one), line(other)]
    }
}

/// Each name at the beginning of its band, inside if the band is wide enough.
fn name(bands: &[Band], axes: &Axes, panels: &mut Panels) {
    let mut labels = Labels::within(axes.frame);
    for band in bands.iter().filter(|band| !band.is_wall) {
        let Some(&[time, from, to]) = band.spans.first() else { continue };
        let at = axes.point(time, (from + to) / 2.0);
        let line = Line::plain(&band.name, 0.8 * panels.look.text);
        let (color, gap) = (panels.look.palette.ink, 0.4 * panels.look.text);
        labels.place(line, at, Vector::new(1.0, 0.0), gap, color).draw(&panels.look, &mut panels.shapes);
    }
}
