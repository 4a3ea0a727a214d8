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
            let halo = Ink { color: look.palette.background, opacity: 200 };
            let along = along.mult(1.0 / length);
            shapes.push(self.outline(along, length, look.line / 2.0, halo));
            shapes.push(self.outline(along, length, 0.0, Ink::from(self.color)));
        }
    }

    /// The arrow grown by `grow` px on all sides; its head shrinks with a short shaft.
    fn outline(&self, along: Vector, length: f64, grow: f64, ink: Ink) -> Shape {
        let aside = Vector::new(-along.y, along.x);
        let place = |forth: f64, side: f64| self.from.add(along.mult(forth)).add(aside.mult(side));
        let full = 5.0 * self.width;
        let head = if length < 2.0 * full { length / 2.0 } else { full };
        let half = self.width / 2.0 + grow;
        let wing = HEAD_SLOPE * head + self.width / 4.0 + 1.5 * grow;
        let (tail, neck, tip) = (-grow, length - head - grow, length + 2.0 * grow);
        let points = vec![
            place(tail, half),
            place(neck, half),
            place(neck, wing),
            place(tip, 0.0),
            place(neck, -wing),
            place(neck, -half),
            place(tail, -half),
        ];
        Shape::Polygon { points, ink }
    }
}

/// Half the width of a head for its length.
const HEAD_SLOPE: f64 = 0.38;
