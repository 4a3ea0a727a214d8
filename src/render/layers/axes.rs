use super::super::text::Line;
use super::super::{Ink, Shape};
use super::Page;
use super::grid::{multiples, number, spacing};
use crate::physics::{Rect, Vector};
use crate::scene::Overlay;

/// Scales in metres on the left of the window and below it.
pub fn draw(page: &Page, shapes: &mut Vec<Shape>) {
    if !page.view.style.shows(Overlay::Axes) {
        return;
    }
    let (window, line) = (page.camera.window, page.look.line);
    let far = window.far_corner();
    let ink = Ink::from(page.look.palette.muted);
    let bar = |x: f64, y: f64, width: f64, height: f64| Shape::Rect {
        rect: Rect::new(Vector::new(x, y), width, height),
        ink,
    };
    shapes.push(bar(window.origin.x - line, window.origin.y, line, window.height() + line));
    shapes.push(bar(window.origin.x, far.y, window.width(), line));
    let tick = (0.3 * page.look.text).round();
    for at in seen_multiples(page, 0) {
        let x = page.camera.point(Vector::new(at, 0.0)).x.round();
        shapes.push(bar(x, far.y, line, tick));
        below(at, x, page, shapes);
    }
    for at in seen_multiples(page, 1) {
        let y = page.camera.point(Vector::new(0.0, at)).y.round();
        shapes.push(bar(window.origin.x - tick, y, tick, line));
        beside(at, y, page, shapes);
    }
}

fn seen_multiples(page: &Page, axis: usize) -> Vec<f64> {
    multiples(&page.camera.seen(), axis, spacing(page))
}

/// The number of a tick below the window; the last that has room for it also has the unit.
fn below(at: f64, x: f64, page: &Page, shapes: &mut Vec<Shape>) {
    let far = page.camera.window.far_corner();
    let is_last = x + spacing(page) * page.camera.scale > far.x;
    let line = text(at, if is_last { " m" } else { "" }, page);
    let place = Vector::new((x - line.width / 2.0).round(), (far.y + 1.15 * page.look.text).round());
    if place.x >= page.camera.window.origin.x - page.look.text && place.x + line.width <= f64::from(page.camera.size[0])
    {
        shapes.push(Shape::Text { line, at: place, ink: Ink::from(page.look.palette.muted) });
    }
}

/// The number of a tick on the left of the window; the first has the unit.
fn beside(at: f64, y: f64, page: &Page, shapes: &mut Vec<Shape>) {
    let window = page.camera.window;
    let is_first = y - spacing(page) * page.camera.scale < window.origin.y;
    let line = text(at, if is_first { " m" } else { "" }, page);
    let place =
        Vector::new((window.origin.x - 0.5 * page.look.text - line.width).round(), (y + line.height() / 2.0).round());
    if place.y - line.height() >= 0.0 && place.y <= window.far_corner().y && place.x >= 0.0 {
        shapes.push(Shape::Text { line, at: place, ink: Ink::from(page.look.palette.muted) });
    }
}

fn text(at: f64, unit: &str, page: &Page) -> Line {
    Line::plain(&format!("{}{unit}", number(at, spacing(page))).replace('-', "−"), 0.7 * page.look.text)
}
