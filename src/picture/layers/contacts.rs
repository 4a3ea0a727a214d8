use super::arrows::IMPULSE;
use super::{LabeledArrow, LayoutContext};
use crate::physics::{Axis, Collision, Rect, Vector, larger, smaller};
use crate::picture::Overlay;
use crate::picture::number::Unit;
use crate::picture::{Arrow, Frame, Ink, Shape};

/// Draws the overlap of the boxes of each collision of the frame.
pub fn draw_overlaps(frame: &Frame, context: &LayoutContext, shapes: &mut Vec<Shape>) {
    if !context.view.style.shows(Overlay::Penetration) {
        return;
    }
    let ink = Ink { color: context.metrics.palette.penetration, opacity: 140 };
    let overlaps = frame.collisions.iter().filter_map(|collision| overlap_rect(collision, context));
    shapes.extend(overlaps.map(|rect| Shape::Rect { rect, ink }));
}

fn overlap_rect(collision: &Collision, context: &LayoutContext) -> Option<Rect> {
    let [c, b] = collision.rects.map(|rect| context.camera.rect(&rect));
    c.intersection(&b)
}

/// Impulses are labelled with their values in frames of at most this many collisions; more labels would be unreadable.
const MAX_LABELED: usize = 4;

/// Penetration vectors, normals and impulses of the collisions of the frame.
pub fn arrows(frame: &Frame, context: &LayoutContext) -> Vec<LabeledArrow> {
    let is_labeled = frame.collisions.iter().filter(|collision| collision.impulse != 0.0).count() <= MAX_LABELED;
    let mut arrows = Vec::new();
    for collision in &frame.collisions {
        if context.view.style.shows(Overlay::Penetration) {
            arrows.extend(penetration(collision, context).map(LabeledArrow::from));
        }
        if context.view.style.shows(Overlay::Normal) {
            arrows.push(normal(collision, context).into());
        }
        if context.view.style.shows(Overlay::Impulse) && collision.impulse != 0.0 {
            arrows.extend(impulses(collision, is_labeled, context));
        }
    }
    arrows
}

/// The vector that separates the two boxes.
fn penetration(collision: &Collision, context: &LayoutContext) -> Option<Arrow> {
    let vector = collision.penetration.mult(context.camera.scale);
    let from = overlap_rect(collision, context)?.center().sub(vector.mult(0.5));
    Some(Arrow::new(from, from.add(vector), context.metrics.line_width, context.metrics.palette.penetration))
}

/// The unit normal from the middle of the contact, 2.5 times the font size long.
fn normal(collision: &Collision, context: &LayoutContext) -> Arrow {
    let from = context.camera.point(contact_center(&collision.rects));
    let to = from.add(collision.normal.mult(2.5 * context.metrics.font_size));
    Arrow::new(from, to, 1.5 * context.metrics.line_width, context.metrics.palette.normal)
}

/// The impulses on the two bodies: +j·n̂ on c, labelled with j, and −j·n̂ on b.
fn impulses(collision: &Collision, is_labeled: bool, context: &LayoutContext) -> Vec<LabeledArrow> {
    // Offset from the normal if that is shown, too.
    let offset = if context.view.style.shows(Overlay::Normal) { 4.0 * context.metrics.line_width } else { 0.0 };
    let offset = Vector::new(-collision.normal.y, collision.normal.x).mult(offset);
    let from = context.camera.point(contact_center(&collision.rects)).add(offset);
    let (style, metrics) = (&context.view.style, &context.metrics);
    let (scale, width) = (IMPULSE.scale(style, metrics), IMPULSE.width(style, metrics));
    let along = collision.normal.mult(collision.impulse * scale);
    let arrow =
        |vector: Vector| Arrow::of_vector(from, vector, width, metrics.palette.impulse, style.top_impulse * scale);
    let impulse = || metrics.language.decimal(Unit::NEWTON_SECOND.format(collision.impulse, 3));
    let label = if is_labeled { format!("j = {}", impulse()) } else { String::new() };
    let first = arrow(along).map(|arrow| LabeledArrow { arrow, key: None, label });
    first.into_iter().chain(arrow(along.mult(-1.0)).map(LabeledArrow::from)).collect()
}

/// The middle of the intersection of two rectangles or of the gap between them.
pub fn contact_center([c, b]: &[Rect; 2]) -> Vector {
    let [x, y] = Axis::BOTH.map(|axis| {
        let ([low_c, high_c], [low_b, high_b]) = (c.along(axis), b.along(axis));
        (larger(low_c, low_b) + smaller(high_c, high_b)) / 2.0
    });
    Vector::new(x, y)
}
