use super::area::{contains, larger, overlap, smaller};
use super::text::Line;
use super::{Color, Ink, Look, Shape};
use crate::physics::{Rect, Vector};

/// A line of text that has found its place.
#[derive(Clone, Debug)]
pub struct Label {
    /// What it says.
    pub line: Line,
    /// Where its baseline begins, px.
    pub at: Vector,
    /// What it is written with.
    pub color: Color,
}

impl Label {
    /// What its letters cover, px.
    pub fn place(&self) -> Rect {
        let height = self.line.height();
        Rect::new(self.at.sub(Vector::new(0.0, height)), self.line.width, height)
    }

    /// A line whose capitals fill a place, px, as far as whole pixels allow.
    pub fn at(place: &Rect, line: Line, color: Color) -> Label {
        let at = place.origin.add(Vector::new(0.0, line.height()));
        Label { line, at: Vector::new(at.x.round(), at.y.round()), color }
    }

    /// Adds the label on a halo of the page's colour, so that it reads on anything.
    pub fn draw(self, look: &Look, shapes: &mut Vec<Shape>) {
        let halo = Ink { color: look.palette.background, opacity: 255 };
        let width = look.line;
        for (x, y) in
            [(-1.0, 0.0), (1.0, 0.0), (0.0, -1.0), (0.0, 1.0), (-0.7, -0.7), (0.7, -0.7), (-0.7, 0.7), (0.7, 0.7)]
        {
            let at = self.at.add(Vector::new(x, y).mult(width));
            shapes.push(Shape::Text { line: self.line.clone(), at, ink: halo });
        }
        self.draw_bare(shapes);
    }

    /// Adds the label where nothing is beneath.
    pub fn draw_bare(self, shapes: &mut Vec<Shape>) {
        shapes.push(Shape::Text { line: self.line, at: self.at, ink: self.color.into() });
    }
}

/// Puts labels where they hide as little as can be.
#[derive(Clone, Debug)]
pub struct Labels {
    /// What they are to stay within, px.
    page: Rect,
    /// What is there already, px, and how much it matters.
    taken: Vec<(Rect, f64)>,
    /// Straight lines that are there already, px, and how much they matter.
    lines: Vec<([Vector; 2], f64)>,
}

/// How much worse it is to leave the page than to hide something.
const LEAVING: f64 = 100.0;

/// How wide a line counts, px: labels keep half of it off.
const LINE: f64 = 6.0;

/// How much it matters that labels do not hide each other.
const OTHER_LABEL: f64 = 8.0;

impl Labels {
    /// Labels within `page`.
    pub fn within(page: Rect) -> Labels {
        Labels { page, taken: Vec::new(), lines: Vec::new() }
    }

    /// Keeps labels off a rectangle, the more the larger `weight`.
    pub fn avoid(&mut self, rect: Rect, weight: f64) {
        self.taken.push((rect, weight));
    }

    /// Keeps labels off a straight line.
    pub fn avoid_line(&mut self, from: Vector, to: Vector, weight: f64) {
        self.lines.push(([from, to], weight));
    }

    /// Keeps labels off the border of a rectangle.
    pub fn avoid_border(&mut self, rect: &Rect, weight: f64) {
        let (near, far) = (rect.origin, rect.far_corner());
        let corners = [near, Vector::new(far.x, near.y), far, Vector::new(near.x, far.y), near];
        for side in corners.windows(2) {
            self.avoid_line(side[0], side[1], weight);
        }
    }

    /// The label in that of the places around `anchor` where it hides least, `gap` px off or
    /// twice that.
    ///
    /// Places are tried from `towards` around; of equal ones the first is taken.
    pub fn place(&mut self, line: Line, anchor: Vector, towards: Vector, gap: f64, color: Color) -> Label {
        self.place_along(line, &[anchor], towards, gap, color)
    }

    /// The same around the best of several anchors.
    pub fn place_along(&mut self, line: Line, anchors: &[Vector], towards: Vector, gap: f64, color: Color) -> Label {
        let directions = around(towards);
        let places = [gap, 2.0 * gap].into_iter().flat_map(|gap| {
            let line = &line;
            anchors.iter().flat_map(move |anchor| directions.map(|direction| beside(line, *anchor, direction, gap)))
        });
        let (best, _) = self.best(places).unwrap_or((beside(&line, Vector::ZERO, towards, gap), 0.0));
        self.take(best);
        Label::at(&best, line, color)
    }

    /// The first of the places that hide least, and how much it hides.
    pub fn best(&self, places: impl Iterator<Item = Rect>) -> Option<(Rect, f64)> {
        let mut best: Option<(Rect, f64)> = None;
        for place in places {
            let least = best.map_or(f64::INFINITY, |(_, cost)| cost);
            let cost = self.cost(&place);
            if cost < least {
                best = Some((place, cost));
            }
            if cost == 0.0 {
                break;
            }
        }
        best
    }

    /// Keeps later labels off a place that is taken, and a little around it.
    pub fn take(&mut self, place: Rect) {
        let apart = place.height() / 3.0;
        let wide = Vector::new(place.width() + 2.0 * apart, place.height() + 2.0 * apart);
        self.avoid(Rect::new(place.origin.sub(Vector::new(apart, apart)), wide.x, wide.y), OTHER_LABEL);
    }

    /// What a label there would hide.
    pub fn cost(&self, place: &Rect) -> f64 {
        let area = |rect: &Rect| rect.width() * rect.height();
        let hidden = self.taken.iter().filter_map(|(rect, weight)| Some(weight * area(&overlap(place, rect)?)));
        let wide = Rect::new(
            place.origin.sub(Vector::new(LINE / 2.0, LINE / 2.0)),
            place.width() + LINE,
            place.height() + LINE,
        );
        let crossed = self.lines.iter().map(|(line, weight)| weight * LINE * length_within(line, &wide));
        let outside = if contains(&self.page, place) { 0.0 } else { LEAVING * area(place) };
        hidden.sum::<f64>() + crossed.sum::<f64>() + outside
    }
}

/// How much of a straight line lies in a rectangle (after Liang and Barsky, "A new concept and
/// method for line clipping", 1984).
fn length_within([from, to]: &[Vector; 2], rect: &Rect) -> f64 {
    let along = to.sub(*from);
    let (near, far) = (rect.origin, rect.far_corner());
    let sides = [(along.x, near.x - from.x, far.x - from.x), (along.y, near.y - from.y, far.y - from.y)];
    let (mut enters, mut leaves) = (0.0, 1.0);
    for (speed, low, high) in sides {
        if speed == 0.0 {
            if low > 0.0 || high < 0.0 {
                return 0.0;
            }
            continue;
        }
        let (first, second) = (low / speed, high / speed);
        enters = larger(enters, smaller(first, second));
        leaves = smaller(leaves, larger(first, second));
    }
    if leaves > enters { (leaves - enters) * along.norm() } else { 0.0 }
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

    #[test]
    fn a_label_keeps_off_lines() {
        let mut labels = Labels::within(Rect::new(Vector::ZERO, 200.0, 100.0));
        labels.avoid_line(Vector::new(50.0, 50.0), Vector::new(200.0, 50.0), 1.0);
        let at = place(&mut labels, Vector::new(50.0, 50.0));
        assert!(at.y < 47.0 || at.y - Line::plain("label", 10.0).height() > 53.0, "{at:?} is on the line");
    }

    #[test]
    fn the_length_of_a_line_within_a_rectangle() {
        let rect = Rect::new(Vector::new(1.0, 1.0), 2.0, 2.0);
        let length = |from: [f64; 2], to: [f64; 2]| {
            length_within(&[Vector::new(from[0], from[1]), Vector::new(to[0], to[1])], &rect)
        };
        assert_eq!(length([0.0, 2.0], [4.0, 2.0]), 2.0);
        assert_eq!(length([2.0, 2.0], [2.0, 2.5]), 0.5);
        assert_eq!(length([0.0, 0.0], [5.0, 0.0]), 0.0);
        assert_eq!(length([2.0, 2.0], [2.0, 2.0]), 0.0);
    }
}
