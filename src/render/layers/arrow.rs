use super::super::{Ink, Shape};
use crate::physics::Vector;

/// An arrow from one point to another, `width` px thick; its head shrinks with a short shaft.
///
/// None when it would be too short to be seen.
pub fn arrow(from: Vector, to: Vector, width: f64, ink: Ink) -> Option<Shape> {
    let along = to.sub(from);
    let length = along.norm();
    if !(length >= width) {
        return None;
    }
    let along = along.mult(1.0 / length);
    let aside = Vector::new(-along.y, along.x);
    let head = if length < 8.0 * width { length / 2.0 } else { 4.0 * width };
    let place = |forth: f64, side: f64| from.add(along.mult(forth)).add(aside.mult(side));
    let (neck, half, wing) = (length - head, width / 2.0, head * 0.45);
    let wing = if wing < half { half } else { wing };
    let points = vec![
        place(0.0, half),
        place(neck, half),
        place(neck, wing),
        to,
        place(neck, -wing),
        place(neck, -half),
        place(0.0, -half),
    ];
    Some(Shape::Polygon { points, ink })
}
