use super::super::{Arrow, Frame, Sprite};
use super::bodies::visible_rect;
use super::{LabeledArrow, LayoutContext};
use crate::physics::Vector;
use crate::scene::Overlay;

/// The velocity arrows, from the middle of each box.
pub fn arrows(frame: &Frame, context: &LayoutContext) -> Vec<LabeledArrow> {
    if !context.view.style.shows(Overlay::Velocity) {
        return Vec::new();
    }
    let sprites = frame.sprites.iter().filter(|sprite| !sprite.appearance.is_wall);
    sprites.filter_map(|sprite| arrow(sprite, context)).map(LabeledArrow::from).collect()
}

fn arrow(sprite: &Sprite, context: &LayoutContext) -> Option<Arrow> {
    let from = visible_rect(sprite, context)?.center();
    let to = from.add(to_arrow(sprite.velocity, context.view.style.top_speed, context));
    Some(Arrow { from, to, width: arrow_width(context), color: context.metrics.palette.ink })
}

/// Width of arrows, px; thinner if there are many bodies.
pub fn arrow_width(context: &LayoutContext) -> f64 {
    let has_many_bodies = f64::from(context.view.style.body_count) > MANY_BODIES;
    if has_many_bodies { (context.metrics.line_width / 2.0).ceil() } else { context.metrics.line_width }
}

/// Length of the longest arrow, in font sizes.
const MAX_LENGTH: f64 = 5.0;

/// With more bodies than this, arrows are shorter, so that their density stays about the same.
const MANY_BODIES: f64 = 40.0;

/// Scales a vector to an arrow, px. Vectors of length `top` and longer become arrows of the maximum length.
pub fn to_arrow(vector: Vector, top: f64, context: &LayoutContext) -> Vector {
    let length = vector.norm();
    let limited = if length > top { vector.mult(top / length) } else { vector };
    let body_count = f64::from(context.view.style.body_count);
    let shrink = if body_count > MANY_BODIES { (MANY_BODIES / body_count).sqrt() } else { 1.0 };
    limited.mult(shrink * MAX_LENGTH * context.metrics.font_size / top)
}
