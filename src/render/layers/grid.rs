use super::super::text::Line;
use super::super::{Ink, Shape};
use super::Page;
use crate::physics::{Rect, Vector};

/// Lines every 1, 2 or 5 × 10ⁿ m inside the world, with their place in metres.
pub fn draw(page: &Page, shapes: &mut Vec<Shape>) {
    let camera = &page.view.camera;
    let spacing = round_spacing(5.0 * page.look.text / camera.scale);
    let line = if page.look.line < 2.0 { 1.0 } else { (page.look.line / 2.0).round() };
    for (axis, extent) in [camera.world.x, camera.world.y].into_iter().enumerate() {
        let count = (extent / spacing * (1.0 + 1e-9)).floor() as u64;
        for place in 1..=count {
            let at = place as f64 * spacing;
            // The world's border has its walls.
            if at < extent {
                shapes.push(grid_line(page, axis, at, line));
            }
            shapes.push(label(page, axis, at, spacing, extent));
        }
    }
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

/// A line across the world at `at` m along an axis (0 is x).
fn grid_line(page: &Page, axis: usize, at: f64, width: f64) -> Shape {
    let camera = &page.view.camera;
    let (near, far) = (camera.point(Vector::ZERO), camera.point(camera.world));
    let seen = camera.point(Vector::new(at, at));
    let rect = match axis {
        0 => Rect::new(Vector::new(seen.x.round(), near.y), width, far.y - near.y),
        _ => Rect::new(Vector::new(near.x, seen.y.round()), far.x - near.x, width),
    };
    Shape::Rect { rect, ink: Ink::from(page.look.palette.grid) }
}

/// The number of a line, inside the world beside the upper or left border.
fn label(page: &Page, axis: usize, at: f64, spacing: f64, extent: f64) -> Shape {
    let camera = &page.view.camera;
    let unit = if at + spacing > extent * (1.0 + 1e-9) { " m" } else { "" };
    let line = Line::plain(&format!("{}{unit}", number(at, spacing)), 0.7 * page.look.text);
    let (near, seen) = (camera.point(Vector::ZERO), camera.point(Vector::new(at, at)));
    let gap = 2.0 * page.look.line;
    let place = match axis {
        0 => Vector::new(seen.x - line.width - gap, near.y + line.height() + 1.5 * gap),
        _ => Vector::new(near.x + gap, seen.y - gap),
    };
    Shape::Text { line, at: place, ink: Ink::from(page.look.palette.muted) }
}

/// A multiple of `spacing` with as many decimals as the spacing has.
pub fn number(value: f64, spacing: f64) -> String {
    let mut decimals = 0;
    let mut unit = 1.0;
    while spacing < unit * (1.0 - 1e-9) && decimals < 12 {
        unit /= 10.0;
        decimals += 1;
    }
    format!("{value:.decimals$}")
}
