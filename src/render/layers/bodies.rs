use super::super::area::{inset, intersection, larger, smaller};
use super::super::{Color, Frame, Ink, Metrics, Shape, Sprite, palette};
use super::{LayoutContext, body_labels};
use crate::physics::{Rect, Vector};

/// Draws the boxes, each with a border inside its edge.
pub fn draw(frame: &Frame, context: &LayoutContext, shapes: &mut Vec<Shape>) {
    let box_count = frame.sprites.iter().filter(|sprite| !sprite.appearance.is_wall).count();
    for sprite in frame.sprites.iter().filter(|sprite| !sprite.appearance.is_wall) {
        let Some(rect) = visible_rect(sprite, context) else { continue };
        let fill = palette::body_color(sprite, &context.view.style);
        draw_box(&rect, fill, &context.metrics, shapes);
        if sprite.appearance.mass == f64::INFINITY {
            draw_bolts(&rect, border_color(fill, &context.metrics), context, shapes);
        }
        shapes.extend(body_labels::inside(sprite, &rect, fill, box_count, context));
    }
}

/// The page rectangle of a body, px, if it intersects the viewport.
pub fn visible_rect(sprite: &Sprite, context: &LayoutContext) -> Option<Rect> {
    let rect = context.camera.rect(&sprite.rect);
    intersection(&rect, &context.camera.viewport).map(|_| rect)
}

/// The border colour of a box.
pub fn border_color(fill: Color, metrics: &Metrics) -> Color {
    fill.mix(metrics.palette.border, 45)
}

/// Draws a box with a border inside its edge, at least one pixel wide and high. A box too small for a border is drawn
/// without one.
///
/// The fill is drawn over a rectangle in the border colour: two rectangles are cheaper than four edges.
pub fn draw_box(rect: &Rect, fill: Color, metrics: &Metrics, shapes: &mut Vec<Shape>) {
    let border = if smaller(rect.width(), rect.height()) < 8.0 * metrics.line_width { 1.0 } else { metrics.line_width };
    let rect = Rect::new(rect.origin, larger(rect.width(), 1.0), larger(rect.height(), 1.0));
    let inner = inset(&rect, border);
    if inner.width() < 1.0 || inner.height() < 1.0 {
        shapes.push(Shape::Rect { rect, ink: Ink::from(fill) });
        return;
    }
    shapes.push(Shape::Rect { rect, ink: Ink::from(border_color(fill, metrics)) });
    shapes.push(Shape::Rect { rect: inner, ink: Ink::from(fill) });
}

/// Marks a static body with a bolt in each corner.
fn draw_bolts(rect: &Rect, color: Color, context: &LayoutContext, shapes: &mut Vec<Shape>) {
    let (size, margin) = (2.0 * context.metrics.line_width, 3.0 * context.metrics.line_width);
    if smaller(rect.width(), rect.height()) < 2.0 * (size + margin) + size {
        return;
    }
    let near = rect.origin.add(Vector::new(margin, margin));
    let far = rect.far_corner().sub(Vector::new(margin + size, margin + size));
    for corner in [near, Vector::new(far.x, near.y), Vector::new(near.x, far.y), far] {
        shapes.push(Shape::Rect { rect: Rect::new(corner, size, size), ink: Ink::from(color) });
    }
}
