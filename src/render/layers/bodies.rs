use super::super::area::{inset, larger, overlap, smaller};
use super::super::{Color, Frame, Ink, Look, Shape, Sprite, palette};
use super::{Page, names};
use crate::physics::{Rect, Vector};

/// The boxes, each with a border inside its edge.
pub fn draw(frame: &Frame, page: &Page, shapes: &mut Vec<Shape>) {
    let boxes = frame.sprites.iter().filter(|sprite| !sprite.appearance.is_wall).count();
    for sprite in frame.sprites.iter().filter(|sprite| !sprite.appearance.is_wall) {
        let Some(rect) = seen(sprite, page) else { continue };
        let fill = palette::body_color(sprite, &page.view.style);
        draw_box(&rect, fill, &page.look, shapes);
        if sprite.appearance.mass == f64::INFINITY {
            bolts(&rect, border_color(fill, &page.look), page, shapes);
        }
        shapes.extend(names::inside(sprite, &rect, fill, boxes, page));
    }
}

/// Where a body is seen, px, if any of it is.
pub fn seen(sprite: &Sprite, page: &Page) -> Option<Rect> {
    let rect = page.camera.rect(&sprite.rect);
    overlap(&rect, &page.camera.window).map(|_| rect)
}

/// The colour of a box's border.
pub fn border_color(fill: Color, look: &Look) -> Color {
    fill.mix(look.palette.border, 45)
}

/// A box of that colour with a border inside its edge.
///
/// The border is drawn first and the fill over it: two rectangles are cheaper than a frame of four.
///
/// A box too small for a border is all border, and never less than a pixel.
pub fn draw_box(rect: &Rect, fill: Color, look: &Look, shapes: &mut Vec<Shape>) {
    let border = if smaller(rect.width(), rect.height()) < 8.0 * look.line { 1.0 } else { look.line };
    let rect = Rect::new(rect.origin, larger(rect.width(), 1.0), larger(rect.height(), 1.0));
    let inner = inset(&rect, border);
    if inner.width() < 1.0 || inner.height() < 1.0 {
        shapes.push(Shape::Rect { rect, ink: Ink::from(fill) });
        return;
    }
    shapes.push(Shape::Rect { rect, ink: Ink::from(border_color(fill, look)) });
    shapes.push(Shape::Rect { rect: inner, ink: Ink::from(fill) });
}

/// A bolt in each corner tells a body that is never pushed.
fn bolts(rect: &Rect, color: Color, page: &Page, shapes: &mut Vec<Shape>) {
    let (size, margin) = (2.0 * page.look.line, 3.0 * page.look.line);
    if smaller(rect.width(), rect.height()) < 2.0 * (size + margin) + size {
        return;
    }
    let near = rect.origin.add(Vector::new(margin, margin));
    let far = rect.far_corner().sub(Vector::new(margin + size, margin + size));
    for corner in [near, Vector::new(far.x, near.y), Vector::new(near.x, far.y), far] {
        shapes.push(Shape::Rect { rect: Rect::new(corner, size, size), ink: Ink::from(color) });
    }
}
