use super::LayoutContext;
use crate::physics::Vector;
use crate::picture::Overlay;
use crate::picture::{Color, DrawingMetrics, Frame, Ink, Shape, Sprite};

/// An arrow between two points of the page, drawn with a halo that separates it from the background.
pub struct Arrow {
    /// Start of the shaft, px.
    pub from: Vector,
    /// The tip, px.
    pub to: Vector,
    /// Width of the shaft, px.
    pub width: f64,
    /// Colour of shaft and head.
    pub color: Color,
}

impl Arrow {
    /// Appends the arrow to `shapes`, on a halo in the background colour. Appends nothing if the arrow is shorter
    /// than its shaft is wide.
    pub fn draw(&self, metrics: &DrawingMetrics, shapes: &mut Vec<Shape>) {
        let direction = self.to.sub(self.from);
        let length = direction.norm();
        // A zero vector has no direction, and an arrow of infinite length cannot be drawn.
        if length >= self.width && length.is_finite() {
            let direction = direction.mult(1.0 / length);
            shapes.extend(self.shaft_and_head(direction, length, metrics.line_width / 2.0, metrics.palette.background));
            shapes.extend(self.shaft_and_head(direction, length, 0.0, self.color));
        }
    }

    /// Shaft and head, expanded by `margin` px on all sides. A short arrow has a smaller head.
    fn shaft_and_head(&self, direction: Vector, length: f64, margin: f64, color: Color) -> [Shape; 2] {
        let normal = Vector::new(-direction.y, direction.x);
        let point = |ahead: f64, side: f64| self.from.add(direction.mult(ahead)).add(normal.mult(side));
        let full = 5.0 * self.width;
        let head = if length < 2.0 * full { length / 2.0 } else { full };
        let half_width = HEAD_SLOPE * head + self.width / 4.0 + 1.5 * margin;
        let (neck, tip) = (length - head - margin, length + 2.0 * margin);
        let ink = Ink::from(color);
        // The shaft extends into the head, so that there is no gap between them.
        let shaft = vec![self.from, point(length - head / 2.0, 0.0)];
        let corners = vec![point(neck, half_width), point(tip, 0.0), point(neck, -half_width)];
        let width = self.width + 2.0 * margin;
        [Shape::Polyline { points: shaft, width, ink }, Shape::Polygon { points: corners, ink }]
    }
}

/// Half the width of an arrow head divided by its length.
const HEAD_SLOPE: f64 = 0.38;

/// An arrow with a label at its tip.
pub struct LabeledArrow {
    /// The arrow.
    pub arrow: Arrow,
    /// The label as markup for [`crate::picture::text::Line::math`]; none if empty.
    pub label: String,
}

impl From<Arrow> for LabeledArrow {
    fn from(arrow: Arrow) -> LabeledArrow {
        LabeledArrow { arrow, label: String::new() }
    }
}

/// The velocity arrows, from the middle of each box.
pub fn velocities(frame: &Frame, context: &LayoutContext) -> Vec<LabeledArrow> {
    if !context.view.style.shows(Overlay::Velocity) {
        return Vec::new();
    }
    let (top, ink) = (context.view.style.top_speed, context.metrics.palette.ink);
    from_centers(frame, |sprite| to_arrow(sprite.velocity, top, context), ink, context)
}

/// An arrow for the sum of weight and constant force, from the middle of each box. Contact forces are not part of a
/// recording.
pub fn forces(frame: &Frame, context: &LayoutContext) -> Vec<LabeledArrow> {
    if !context.view.style.shows(Overlay::Force) {
        return Vec::new();
    }
    let (top, color) = (context.view.style.top_force, context.metrics.palette.force);
    from_centers(frame, |sprite| to_arrow(sprite.appearance.force, top, context), color, context)
}

/// Arrows from the middle of each visible box; thinner if there are many bodies.
fn from_centers(
    frame: &Frame,
    vector: impl Fn(&Sprite) -> Vector,
    color: Color,
    context: &LayoutContext,
) -> Vec<LabeledArrow> {
    let has_many_bodies = f64::from(context.view.style.body_count) > MANY_BODIES;
    let line_width = context.metrics.line_width;
    let width = if has_many_bodies { (line_width / 2.0).ceil() } else { line_width };
    let boxes = frame.sprites.iter().filter(|sprite| !sprite.appearance.is_wall);
    let arrow = |sprite: &Sprite| {
        let from = context.visible_rect(sprite)?.center();
        Some(Arrow { from, to: from.add(vector(sprite)), width, color }.into())
    };
    boxes.filter_map(arrow).collect()
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
