use crate::physics::{Rect, Vector};
use crate::render::area::{contains, larger, overlap, smaller};
use crate::render::text::Line;
use crate::render::{Color, Ink, Look, Shape};

/// A line of text that has found its place.
pub struct Label {
    /// What it says.
    pub line: Line,
    /// Where its baseline begins, px.
    pub at: Vector,
    /// What it is written with.
    pub color: Color,
}

impl Label {
    /// Adds the label on a halo of the page's colour, so that it reads on anything.
    pub fn draw(self, look: &Look, shapes: &mut Vec<Shape>) {
        let halo = Ink { color: look.palette.background, opacity: 160 };
        let width = (look.line / 2.0).ceil();
        for (x, y) in [(-0.8, -0.8), (0.8, -0.8), (-0.8, 0.8), (0.8, 0.8)] {
            let at = self.at.add(Vector::new(x, y).mult(width));
            shapes.push(Shape::Text { line: self.line.clone(), at, ink: halo });
        }
        shapes.push(Shape::Text { line: self.line, at: self.at, ink: self.color.into() });
    }
}

/// Puts labels where they hide as little as can be.
pub struct Labels {
    /// What they are to stay within, px.
    page: Rect,
    /// What is there already, px, and how much it matters.
    taken: Vec<(Rect, f64)>,
}

/// How much worse it is to leave the page than to hide something.
const LEAVING: f64 = 100.0;

impl Labels {
    /// Labels within `page`.
    pub fn within(page: Rect) -> Labels {
        Labels { page, taken: Vec::new() }
    }

    /// Keeps labels off a rectangle, the more the larger `weight`.
    pub fn avoid(&mut self, rect: Rect, weight: f64) {
        self.taken.push((rect, weight));
    }

    /// Keeps labels off a straight line.
    pub fn avoid_line(&mut self, from: Vector, to: Vector, weight: f64) {
        let pieces = larger(smaller((to.sub(from).norm() / 6.0).ceil(), 400.0), 1.0);
        for piece in 0..=pieces as u32 {
            let at = from.add(to.sub(from).mult(f64::from(piece) / pieces));
            self.avoid(Rect::new(at.sub(Vector::new(3.0, 3.0)), 6.0, 6.0), weight);
        }
    }

    /// Keeps labels off the border of a rectangle.
    pub fn avoid_border(&mut self, rect: &Rect, weight: f64) {
        let (near, far) = (rect.origin, rect.far_corner());
        let corners = [near, Vector::new(far.x, near.y), far, Vector::new(near.x, far.y), near];
        for side in corners.windows(2) {
            self.avoid_line(side[0], side[1], weight);
        }
    }

    /// The label in that of the places around `anchor` where it hides least, `gap` px off.
    ///
    /// Places are tried from `towards` around; of equal ones the first is taken.
    pub fn place(&mut self, line: Line, anchor: Vector, towards: Vector, gap: f64, color: Color) -> Label {
        let places = around(towards).map(|direction| beside(&line, anchor, direction, gap));
        let mut best = places[0];
        for place in places {
            if self.cost(&place) < self.cost(&best) {
                best = place;
            }
        }
        self.avoid(best, 4.0);
        let at = best.origin.add(Vector::new(0.0, line.height()));
        Label { line, at: Vector::new(at.x.round(), at.y.round()), color }
    }

    fn cost(&self, place: &Rect) -> f64 {
        let area = |rect: &Rect| rect.width() * rect.height();
        let hidden = self.taken.iter().filter_map(|(rect, weight)| Some(weight * area(&overlap(place, rect)?)));
        let outside = if contains(&self.page, place) { 0.0 } else { LEAVING * area(place) };
        hidden.sum::<f64>() + outside
    }
}

/// Eight directions, from the given one outwards to both sides.
fn around(towards: Vector) -> [Vector; 8] {
    const HALF: f64 = std::f64::consts::FRAC_1_SQRT_2;
    let length = towards.norm();
    let ahead = if length > 0.0 { towards.mult(1.0 / length) } else { Vector::new(0.0, -1.0) };
    let right = Vector::new(-ahead.y, ahead.x);
    let turned = |forth: f64, side: f64| ahead.mult(forth).add(right.mult(side));
    [
        turned(1.0, 0.0),
        turned(HALF, HALF),
        turned(HALF, -HALF),
        turned(0.0, 1.0),
        turned(0.0, -1.0),
        turned(-HALF, HALF),
        turned(-HALF, -HALF),
        turned(-1.0, 0.0),
    ]
}

/// Where a label stands that touches a circle of radius `gap` around `anchor` in a direction.
fn beside(line: &Line, anchor: Vector, direction: Vector, gap: f64) -> Rect {
    let (width, height) = (line.width, line.height());
    let middle = anchor.add(direction.mult(gap));
    let aside = Vector::new(direction.x * width / 2.0, direction.y * height / 2.0);
    Rect::new(middle.add(aside).sub(Vector::new(width / 2.0, height / 2.0)), width, height)
}

#[cfg(test)]
mod tests {
    use super::*;
    fn place(labels: &mut Labels, anchor: Vector) -> Vector {
        let line = Line::plain("label", 10.0);
        labels.place(line, anchor, Vector::new(1.0, 0.0), 5.0, Color::hex(0)).at
    }

    #[test]
    fn a_label_goes_where_it_is_sent_if_it_may() {
        let mut labels = Labels::within(Rect::new(Vector::ZERO, 200.0, 100.0));
        assert_eq!(place(&mut labels, Vector::new(50.0, 50.0)).x, 55.0);
    }

    #[test]
    fn labels_keep_off_each_other_and_the_border() {
        let mut labels = Labels::within(Rect::new(Vector::ZERO, 60.0, 100.0));
        let first = place(&mut labels, Vector::new(50.0, 50.0));
        let second = place(&mut labels, Vector::new(50.0, 50.0));
        assert!(first.x < 40.0, "{first:?} leaves the page");
        assert_ne!(first, second);
    }
}
