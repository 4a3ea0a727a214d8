use super::axes::{Axes, Range, Titles};
use super::panels::Panels;
use super::run::legend;
use super::{FigureOptions, Run};
use crate::physics::{BodyId, Vector};
use crate::render::labels::Labels;
use crate::render::layers::bodies::border_color;
use crate::render::text::Line;
use crate::render::{Aim, Color, DisplayList, Ink, Palette, Shape, Sprite, palette};
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
    let mut panels = Panels::new(options, &legend(runs, &options.style));
    let bands: Vec<Vec<Band>> = runs.iter().map(|run| bands(run, axis, options)).collect();
    let Some((time, place)) = ranges(runs, &bands, axis, options) else { return panels.finish() };
    let (place, titles) = match axis {
        Axis::X => (place, Titles { x: "t / \"s\"", y: "x / \"m\"" }),
        Axis::Y => (Range { from: place.to, to: place.from }, Titles { x: "t / \"s\"", y: "y / \"m\"" }),
    };
    let names: Vec<&str> = runs.iter().map(|run| run.title.as_str()).collect();
    for (room, bands) in panels.titled(&names, runs.len()).iter().zip(&bands) {
        diagram(bands, &Axes::within(room, time, place, &panels.look), &titles, &mut panels, options);
    }
    panels.finish()
}

fn diagram(bands: &[Band], axes: &Axes, titles: &Titles, panels: &mut Panels, options: &FigureOptions) {
    axes.draw(titles, &panels.look, &mut panels.shapes);
    let drawn: Vec<Shape> = bands.iter().flat_map(|band| band.draw(axes, panels)).collect();
    panels.shapes.push(Shape::Clip { window: axes.frame, shapes: drawn });
    if options.style.shows(Overlay::Name) && bands.len() <= NAMED {
        name(bands, axes, panels);
    }
}

/// One body as long as it is alive.
struct Band {
    name: String,
    color: Color,
    is_wall: bool,
    /// Time, and from where to where.
    spans: Vec<[f64; 3]>,
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
                spans: Vec::new(),
            });
            let [from, to] = extent(sprite, axis);
            band.spans.push([frame.time, from, to]);
        }
    }
    bands.into_values().filter(|band| !band.is_wall || band.is_beside(run, axis)).collect()
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
    let places = bands
        .iter()
        .flatten()
        .filter(|band| !band.is_wall)
        .flat_map(|band| band.spans.iter().flat_map(|&[_, from, to]| [from, to]));
    Some((time, Range::of(places)?.widened(0.05)))
}

impl Band {
    /// Whether a wall bounds the world along the axis, and does not span it.
    fn is_beside(&self, run: &Run, axis: Axis) -> bool {
        let extent = match axis {
            Axis::X => run.world.x,
            Axis::Y => run.world.y,
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
