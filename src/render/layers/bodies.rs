use super::super::{Color, Frame, Ink, Shape, Sprite, palette};
use super::{Page, names};
use crate::physics::{Rect, Vector};
use crate::scene::Overlay;

/// The boxes, each with a border inside its edge and its name if that fits.
pub fn draw(frame: &Frame, page: &Page, shapes: &mut Vec<Shape>) {
    for sprite in frame.sprites.iter().filter(|sprite| !sprite.appearance.is_wall) {
        let Some(rect) = seen(sprite, page) else { continue };
        let fill = palette::body_color(sprite, &page.view.style);
        filled(&rect, fill, page, shapes);
        if sprite.appearance.mass == f64::INFINITY {
            bolts(&rect, border_color(fill, page), page, shapes);
        }
        if page.view.style.shows(Overlay::Name) {
            shapes.extend(names::inside(sprite, &rect, fill, page));
        }
    }
}

/// Where a body is seen, px, if any of it is.
pub fn seen(sprite: &Sprite, page: &Page) -> Option<Rect> {
    let rect = page.view.camera.rect(&sprite.rect);
    overlap(&rect, &page.view.camera.window()).map(|_| rect)
}

/// The part two rectangles share, if it has an area.
pub fn overlap(a: &Rect, b: &Rect) -> Option<Rect> {
    let (far_a, far_b) = (a.far_corner(), b.far_corner());
    let x = [larger(a.origin.x, b.origin.x), smaller(far_a.x, far_b.x)];
    let y = [larger(a.origin.y, b.origin.y), smaller(far_a.y, far_b.y)];
    (x[0] < x[1] && y[0] < y[1]).then(|| Rect::new(Vector::new(x[0], y[0]), x[1] - x[0], y[1] - y[0]))
}

pub const fn larger(a: f64, b: f64) -> f64 {
    if a > b { a } else { b }
}

pub const fn smaller(a: f64, b: f64) -> f64 {
    if a < b { a } else { b }
}

fn border_color(fill: Color, page: &Page) -> Color {
    fill.mix(page.palette.border, 45)
}

/// The border first and the fill over it: two rectangles are cheaper than a frame of four.
///
/// A box too small for a border is all border, and never less than a pixel.
fn filled(rect: &Rect, fill: Color, page: &Page, shapes: &mut Vec<Shape>) {
    let border = if smaller(rect.width(), rect.height()) < 8.0 * page.line { 1.0 } else { page.line };
    let rect = Rect::new(rect.origin, larger(rect.width(), 1.0), larger(rect.height(), 1.0));
    let inner = inset(&rect, border);
    if inner.width() < 1.0 || inner.height() < 1.0 {
        shapes.push(Shape::Rect { rect, ink: Ink::from(fill) });
        return;
    }
    shapes.push(Shape::Rect { rect, ink: Ink::from(border_color(fill, page)) });
    shapes.push(Shape::Rect { rect: inner, ink: Ink::from(fill) });
}

/// The rectangle `by` px inside another.
pub fn inset(rect: &Rect, by: f64) -> Rect {
    Rect::new(rect.origin.add(Vector::new(by, by)), rect.width() - 2.0 * by, rect.height() - 2.0 * by)
}

/// A bolt in each corner tells a body that is never pushed.
fn bolts(rect: &Rect, color: Color, page: &Page, shapes: &mut Vec<Shape>) {
    let (size, margin) = (2.0 * page.line, 3.0 * page.line);
    if smaller(rect.width(), rect.height()) < 2.0 * (size + margin) + size {
        return;
    }
    let near = rect.origin.add(Vector::new(margin, margin));
    let far = rect.far_corner().sub(Vector::new(margin + size, margin + size));
    for corner in [near, Vector::new(far.x, near.y), Vector::new(near.x, far.y), far] {
        shapes.push(Shape::Rect { rect: Rect::new(corner, size, size), ink: Ink::from(color) });
    }
}
