use super::{Color, Ink, Look, Shape};
use crate::physics::Vector;

/// An arrow from one point to another in px, and what sets it off from what is beneath.
pub struct Arrow {
    /// Where it begins, px.
    pub from: Vector,
    /// Where its tip is, px.
    pub to: Vector,
    /// Thickness of the shaft, px.
    pub width: f64,
    /// What it is drawn with.
    pub color: Color,
}

impl Arrow {
    /// Adds the arrow on a halo of the page's colour; nothing if it is too short to be seen.
    pub fn draw(&self, look: &Look, shapes: &mut Vec<Shape>) {
        let along = self.to.sub(self.from);
        let length = along.norm();
        // An arrow of no direction is none, and one of no finite length cannot be drawn.
        if length >= self.width && length.is_finite() {
            let along = along.mult(1.0 / length);
            shapes.extend(self.grown(along, length, look.line / 2.0, look.palette.background));
            shapes.extend(self.grown(along, length, 0.0, self.color));
        }
    }

    /// Shaft and head, grown by `grow` px on all sides; the head shrinks with a short shaft.
    fn grown(&self, along: Vector, length: f64, grow: f64, color: Color) -> [Shape; 2] {
        let aside = Vector::new(-along.y, along.x);
        let place = |forth: f64, side: f64| self.from.add(along.mult(forth)).add(aside.mult(side));
        let full = 5.0 * self.width;
        let head = if length < 2.0 * full { length / 2.0 } else { full };
        let wing = HEAD_SLOPE * head + self.width / 4.0 + 1.5 * grow;
        let (neck, tip) = (length - head - grow, length + 2.0 * grow);
        let ink = Ink::from(color);
        // The shaft reaches into the head, so that no gap is seen between them.
        let shaft = vec![self.from, place(length - head / 2.0, 0.0)];
        let corners = vec![place(neck, wing), place(tip, 0.0), place(neck, -wing)];
        let width = self.width + 2.0 * grow;
        [Shape::Polyline { points: shaft, width, ink }, Shape::Polygon { points: corners, ink }]
    }
}

/// Half the width of a head for its length.
const HEAD_SLOPE: f64 = 0.38;
