use super::{Color, Ink, Metrics, Shape};
use crate::physics::Vector;

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
    pub fn draw(&self, metrics: &Metrics, shapes: &mut Vec<Shape>) {
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
