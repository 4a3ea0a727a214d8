use super::super::text::Line;
use super::super::{Camera, Ink, Shape};
use super::Page;
use crate::physics::{Rect, Vector};
use crate::render::area::contains;
use crate::scene::Overlay;

/// Lines every 1, 2 or 5 × 10ⁿ m where the world is seen, with their place in metres unless axes
/// beside the picture tell it.
pub fn draw(page: &Page, shapes: &mut Vec<Shape>) {
    let area = area(&page.camera);
    let spacing = spacing(page);
    for axis in [0, 1] {
        for at in multiples(&area, axis, spacing) {
            let extent = ends(&area, axis);
            // The world's border has its walls.
            if extent[0] < at && at < extent[1] {
                shapes.push(grid_line(page, &area, axis, at));
            }
            if !page.view.style.shows(Overlay::Axes) && at > extent[0] {
                shapes.push(label(page, &area, axis, at, spacing));
            }
        }
    }
}

/// m from one line to the next.
pub fn spacing(page: &Page) -> f64 {
    round_spacing(5.0 * page.look.text / page.camera.scale)
}

/// The world if all of it is seen, or else what is seen, m.
fn area(camera: &Camera) -> Rect {
    let (world, seen) = (Rect::new(Vector::ZERO, camera.world.x, camera.world.y), camera.seen());
    if contains(&seen, &world) { world } else { seen }
}

/// From where to where a rectangle reaches along an axis (0 is x).
fn ends(area: &Rect, axis: usize) -> [f64; 2] {
    let far = area.far_corner();
    [[area.origin.x, far.x], [area.origin.y, far.y]][axis]
}

/// More lines than that are not drawn: no rounding may make them endless.
const MOST: u64 = 500;

/// The multiples of `spacing` within an area along an axis, both ends included.
pub fn multiples(area: &Rect, axis: usize, spacing: f64) -> Vec<f64> {
    let [from, to] = ends(area, axis);
    let (first, last) = ((from / spacing - 1e-9).ceil(), (to / spacing + 1e-9).floor());
    let count = if last >= first { (last - first) as u64 } else { return Vec::new() };
    (0..=count.min(MOST)).map(|place| (first + place as f64) * spacing + 0.0).collect()
}

/// The smallest 1, 2 or 5 × 10ⁿ that is at least `least`.
///
/// Found by counting up and down from 1, for want of logarithms that are the same everywhere.
pub fn round_spacing(least: f64) -> f64 {
    let mut ten = 1.0;
    while ten < least {
        ten *= 10.0;
    }
    while ten / 10.0 >= least && ten > f64::MIN_POSITIVE {
        ten /= 10.0;
    }
    [ten / 5.0, ten / 2.0].into_iter().find(|&part| part >= least).unwrap_or(ten)
}

/// A line across the area at `at` m along an axis.
fn grid_line(page: &Page, area: &Rect, axis: usize, at: f64) -> Shape {
    let width = if page.look.line < 2.0 { 1.0 } else { (page.look.line / 2.0).round() };
    let (near, far) = (page.camera.point(area.origin), page.camera.point(area.far_corner()));
    let seen = page.camera.point(Vector::new(at, at));
    let rect = match axis {
        0 => Rect::new(Vector::new(seen.x.round(), near.y), width, far.y - near.y),
        _ => Rect::new(Vector::new(near.x, seen.y.round()), far.x - near.x, width),
    };
    Shape::Rect { rect, ink: Ink::from(page.look.palette.grid) }
}

/// The number of a line, inside the area beside its upper or left border; the last has the unit.
fn label(page: &Page, area: &Rect, axis: usize, at: f64, spacing: f64) -> Shape {
    let unit = if at + spacing > ends(area, axis)[1] + 1e-9 * spacing { " m" } else { "" };
    let line = Line::plain(&format!("{}{unit}", number(at, spacing)), 0.7 * page.look.text);
    let (near, seen) = (page.camera.point(area.origin), page.camera.point(Vector::new(at, at)));
    let gap = 2.0 * page.look.line;
    let place = match axis {
        0 => Vector::new(seen.x - line.width - gap, near.y + line.height() + 1.5 * gap),
        _ => Vector::new(near.x + gap, seen.y - gap),
    };
    Shape::Text { line, at: place, ink: Ink::from(page.look.palette.muted) }
}

/// A multiple of `spacing` with as many decimals as the spacing has; beyond six digits, and for
/// tiny ones, with a power of ten.
pub fn number(value: f64, spacing: f64) -> String {
    let mut decimals = 0;
    let mut unit = 1.0;
    while spacing < unit * (1.0 - 1e-9) && decimals < 12 {
        unit /= 10.0;
        decimals += 1;
    }
    format!("{value:.decimals$}")
}
