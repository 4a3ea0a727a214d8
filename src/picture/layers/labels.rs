use crate::physics::{Rect, Vector, larger, smaller};
use crate::picture::text::Line;
use crate::picture::{Color, DrawingMetrics, Ink, Shape};

/// A placed line of text.
#[derive(Clone, Debug)]
pub struct Label {
    /// Text and glyphs.
    pub line: Line,
    /// Start of the baseline, px.
    pub at: Vector,
    /// Colour of the text.
    pub color: Color,
}

impl Label {
    /// The bounds of its capitals, px.
    pub fn bounds(&self) -> Rect {
        let height = self.line.height();
        Rect::new(self.at.sub(Vector::new(0.0, height)), self.line.width, height)
    }

    /// A label whose capitals fill `bounds` (px), rounded to whole pixels.
    pub fn in_bounds(bounds: &Rect, line: Line, color: Color) -> Label {
        let at = bounds.origin.add(Vector::new(0.0, line.height()));
        Label { line, at: Vector::new(at.x.round(), at.y.round()), color }
    }

    /// Appends the label to `shapes`, on a halo in the background colour that keeps it legible.
    pub fn draw(self, metrics: &DrawingMetrics, shapes: &mut Vec<Shape>) {
        self.draw_on_halo(metrics.palette.background, metrics, shapes);
    }

    /// Appends the label to `shapes` over filled rectangles of the page, in drawing order, in a colour of sufficient
    /// contrast with all that are below it. If there is none, the label is on a plate in the background colour.
    pub fn draw_over(self, fills: &[(Rect, Color)], halo: Halo, metrics: &DrawingMetrics, shapes: &mut Vec<Shape>) {
        let palette = &metrics.palette;
        let bounds = with_overhang(&self.bounds()).inset(-metrics.line_width);
        let grounds = grounds(&bounds, fills, palette.background);
        match (palette.legible(self.color, &grounds), halo) {
            (Some(color), Halo::None) => Label { color, ..self }.draw_bare(shapes),
            (Some(color), Halo::Around) => {
                let lowest = grounds.last().copied().unwrap_or(palette.background);
                Label { color, ..self }.draw_on_halo(lowest, metrics, shapes);
            }
            (None, _) => {
                shapes.push(Shape::Rect { rect: bounds, ink: palette.background.into() });
                Label { color: palette.label(self.color), ..self }.draw_bare(shapes);
            }
        }
    }

    fn draw_on_halo(self, halo: Color, metrics: &DrawingMetrics, shapes: &mut Vec<Shape>) {
        let halo = Ink { color: halo, opacity: 255 };
        let width = metrics.line_width;
        for (x, y) in
            [(-1.0, 0.0), (1.0, 0.0), (0.0, -1.0), (0.0, 1.0), (-0.7, -0.7), (0.7, -0.7), (-0.7, 0.7), (0.7, 0.7)]
        {
            let at = self.at.add(Vector::new(x, y).mult(width));
            shapes.push(Shape::Text { line: self.line.without_text(), at, ink: halo });
        }
        self.draw_bare(shapes);
    }

    /// Appends the label to `shapes` without a halo.
    pub fn draw_bare(self, shapes: &mut Vec<Shape>) {
        shapes.push(Shape::Text { line: self.line, at: self.at, ink: self.color.into() });
    }
}

/// The margin of the glyphs of a label, which separates them from lines.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Halo {
    /// Glyphs alone, for a label that crosses no line.
    None,
    /// A margin in a colour that is below the label.
    Around,
}

/// The colours within `bounds`, from top to bottom: those of `fills`, the last of which is on top, and the page.
fn grounds(bounds: &Rect, fills: &[(Rect, Color)], page: Color) -> Vec<Color> {
    let mut colors = Vec::new();
    for (rect, color) in fills.iter().rev().filter(|(rect, _)| rect.intersection(bounds).is_some()) {
        colors.push(*color);
        if rect.contains(bounds) {
            return colors;
        }
    }
    colors.push(page);
    colors
}

/// Places labels where they cover as little as possible.
///
/// The cost of a position is the weighted area that a label covers there; each label takes the candidate of the least
/// cost. No label covers another one or extends beyond the area for labels.
#[derive(Clone, Debug)]
pub struct LabelPlacer {
    /// The area for labels, px.
    page: Rect,
    /// Rectangles to keep clear, px, with their weights.
    obstacles: Vec<(Rect, f64)>,
    /// Straight lines to keep clear, px, with their weights.
    lines: Vec<([Vector; 2], f64)>,
    /// The bounds of placed labels, px, which no other label may touch.
    labels: Vec<Rect>,
    /// Areas, px, into which no part of a label may extend.
    clear: Vec<Rect>,
}

/// Width attributed to lines to avoid, px; labels keep half of it clear on each side.
const LINE_CLEARANCE: f64 = 6.0;

/// Weight of the area covered by another label.
const LABEL_WEIGHT: f64 = 8.0;

impl LabelPlacer {
    /// Creates a placer for labels within `page` (px), without obstacles.
    pub fn within(page: Rect) -> LabelPlacer {
        LabelPlacer { page, obstacles: Vec::new(), lines: Vec::new(), labels: Vec::new(), clear: Vec::new() }
    }

    /// Adds a rectangle for labels to avoid, with a weight per covered area.
    pub fn avoid(&mut self, rect: Rect, weight: f64) {
        self.obstacles.push((rect, weight));
    }

    /// Adds an area into which no label may extend.
    pub fn keep_clear(&mut self, area: Rect) {
        self.clear.push(area);
    }

    /// Adds a straight line for labels to avoid.
    pub fn avoid_line(&mut self, from: Vector, to: Vector, weight: f64) {
        self.lines.push(([from, to], weight));
    }

    /// Adds the border of a rectangle for labels to avoid.
    pub fn avoid_border(&mut self, rect: &Rect, weight: f64) {
        let (near, far) = (rect.origin, rect.far_corner());
        let corners = [near, Vector::new(far.x, near.y), far, Vector::new(near.x, far.y), near];
        for side in corners.windows(2) {
            self.avoid_line(side[0], side[1], weight);
        }
    }

    /// Places `line` around `anchor` where its cost is least, at a distance of one to four times `gap` px, and reserves
    /// the position. `None` if every position touches another label or an area to keep clear.
    ///
    /// The eight directions are tried from `towards` outwards; of equal costs the first is taken.
    pub fn place(&mut self, line: Line, anchor: Vector, towards: Vector, gap: f64, color: Color) -> Option<Label> {
        self.place_along(line, &[anchor], towards, gap, color)
    }

    /// As [`LabelPlacer::place`], around the best of several anchors.
    pub fn place_along(
        &mut self,
        line: Line,
        anchors: &[Vector],
        towards: Vector,
        gap: f64,
        color: Color,
    ) -> Option<Label> {
        self.place_where(line, anchors, (towards, gap), color, |_| true)
    }

    /// As [`LabelPlacer::place_along`], only with bounds that `is_allowed` accepts.
    pub fn place_where(
        &mut self,
        line: Line,
        anchors: &[Vector],
        (towards, gap): (Vector, f64),
        color: Color,
        is_allowed: impl Fn(&Rect) -> bool,
    ) -> Option<Label> {
        let directions = directions_from(towards);
        let around = |gap: f64| {
            let line = &line;
            anchors
                .iter()
                .flat_map(move |anchor| directions.map(|direction| label_bounds(line, *anchor, direction, gap)))
                .filter(&is_allowed)
        };
        let near = self.best([gap, 2.0 * gap].into_iter().flat_map(around));
        let (bounds, _) = near.or_else(|| self.best([3.0 * gap, 4.0 * gap].into_iter().flat_map(around)))?;
        self.reserve(bounds);
        Some(Label::in_bounds(&bounds, line, color))
    }

    /// The first candidate of the least cost, and that cost. `None` without candidates of finite cost.
    pub fn best(&self, candidates: impl IntoIterator<Item = Rect>) -> Option<(Rect, f64)> {
        let mut best: Option<(Rect, f64)> = None;
        for bounds in candidates.into_iter().map(rounded) {
            let least = best.map_or(f64::INFINITY, |(_, cost)| cost);
            let cost = self.cost(&bounds);
            if cost < least {
                best = Some((bounds, cost));
            }
            if cost == 0.0 {
                break;
            }
        }
        best
    }

    /// The first candidate that covers nothing, if any.
    pub fn first_free(&self, candidates: impl IntoIterator<Item = Rect>) -> Option<Rect> {
        candidates.into_iter().map(rounded).find(|bounds| self.cost(bounds) <= 0.0)
    }

    /// Reserves the bounds of a label and a margin around it, which later labels avoid.
    pub fn reserve(&mut self, bounds: Rect) {
        self.avoid(bounds.inset(-bounds.height() / 3.0), LABEL_WEIGHT);
        self.labels.push(bounds);
    }

    /// The cost of a label with these bounds; infinite if it touches another label or an area to keep clear, or extends
    /// beyond the area for labels.
    pub fn cost(&self, bounds: &Rect) -> f64 {
        let all = with_overhang(bounds);
        if !self.page.contains(&all)
            || self.clear.iter().any(|area| area.intersection(&all).is_some())
            || self.labels.iter().any(|label| label.intersection(bounds).is_some())
        {
            return f64::INFINITY;
        }
        let area = |rect: &Rect| rect.width() * rect.height();
        let covered =
            self.obstacles.iter().filter_map(|(rect, weight)| Some(weight * area(&bounds.intersection(rect)?)));
        let expanded = bounds.inset(-LINE_CLEARANCE / 2.0);
        let crossed = self.lines.iter().map(|(line, weight)| weight * LINE_CLEARANCE * length_within(line, &expanded));
        covered.sum::<f64>() + crossed.sum::<f64>()
    }
}

/// The bounds of a label with its accents and subscripts, which extend beyond its capitals.
fn with_overhang(bounds: &Rect) -> Rect {
    let (above, below) = (0.3 * bounds.height(), 0.5 * bounds.height());
    Rect::new(bounds.origin.sub(Vector::new(0.0, above)), bounds.width(), bounds.height() + above + below)
}

/// The bounds of a label whose baseline begins at a whole pixel.
fn rounded(bounds: Rect) -> Rect {
    let (x, bottom) = (bounds.origin.x.round(), bounds.far_corner().y.round());
    Rect::new(Vector::new(x, bottom - bounds.height()), bounds.width(), bounds.height())
}

/// The length of a straight line within a rectangle (after Liang and Barsky, "A new concept and method for line
/// clipping", 1984).
fn length_within([from, to]: &[Vector; 2], rect: &Rect) -> f64 {
    let direction = to.sub(*from);
    let (near, far) = (rect.origin, rect.far_corner());
    let sides = [(direction.x, near.x - from.x, far.x - from.x), (direction.y, near.y - from.y, far.y - from.y)];
    let (mut enter, mut leave) = (0.0, 1.0);
    for (delta, low, high) in sides {
        if delta == 0.0 {
            if low > 0.0 || high < 0.0 {
                return 0.0;
            }
            continue;
        }
        let (first, second) = (low / delta, high / delta);
        enter = larger(enter, smaller(first, second));
        leave = smaller(leave, larger(first, second));
    }
    if leave > enter { (leave - enter) * direction.norm() } else { 0.0 }
}

/// Eight unit vectors, from the direction of `towards` outwards to both sides.
fn directions_from(towards: Vector) -> [Vector; 8] {
    const HALF: f64 = std::f64::consts::FRAC_1_SQRT_2;
    let length = towards.norm();
    let forward = if length > 0.0 { towards.mult(1.0 / length) } else { Vector::new(0.0, -1.0) };
    let right = Vector::new(-forward.y, forward.x);
    let turned = |along: f64, sideways: f64| forward.mult(along).add(right.mult(sideways));
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

/// The bounds of a label that touches the circle of radius `gap` around `anchor` in a direction.
fn label_bounds(line: &Line, anchor: Vector, direction: Vector, gap: f64) -> Rect {
    let (width, height) = (line.width, line.height());
    let middle = anchor.add(direction.mult(gap));
    let offset = Vector::new(direction.x * width / 2.0, direction.y * height / 2.0);
    Rect::new(middle.add(offset).sub(Vector::new(width / 2.0, height / 2.0)), width, height)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn place(placer: &mut LabelPlacer, anchor: Vector) -> Vector {
        let line = Line::plain("label", 10.0);
        placer.place(line, anchor, Vector::new(1.0, 0.0), 5.0, Color::hex(0)).unwrap().at
    }

    #[test]
    fn a_label_without_obstacles_takes_the_preferred_direction() {
        let mut placer = LabelPlacer::within(Rect::new(Vector::ZERO, 200.0, 100.0));
        assert_eq!(place(&mut placer, Vector::new(50.0, 50.0)).x, 55.0);
    }

    #[test]
    fn labels_avoid_each_other_and_stay_on_the_page() {
        let mut placer = LabelPlacer::within(Rect::new(Vector::ZERO, 60.0, 100.0));
        let first = place(&mut placer, Vector::new(50.0, 50.0));
        let second = place(&mut placer, Vector::new(50.0, 50.0));
        assert!(first.x < 40.0, "{first:?} is off the page");
        assert_ne!(first, second);
    }

    #[test]
    fn labels_avoid_lines() {
        let mut placer = LabelPlacer::within(Rect::new(Vector::ZERO, 200.0, 100.0));
        placer.avoid_line(Vector::new(50.0, 50.0), Vector::new(200.0, 50.0), 1.0);
        let at = place(&mut placer, Vector::new(50.0, 50.0));
        assert!(at.y < 47.0 || at.y - Line::plain("label", 10.0).height() > 53.0, "{at:?} is on the line");
    }

    #[test]
    fn no_part_of_a_label_extends_into_an_area_to_keep_clear() {
        let mut placer = LabelPlacer::within(Rect::new(Vector::ZERO, 200.0, 100.0));
        let area = Rect::new(Vector::new(52.0, 20.0), 30.0, 60.0);
        placer.keep_clear(area);
        let line = Line::plain("label", 10.0);
        let label = placer.place(line, Vector::new(50.0, 50.0), Vector::new(1.0, 0.0), 5.0, Color::hex(0)).unwrap();
        assert_eq!(area.intersection(&with_overhang(&label.bounds())), None, "{label:?}");
        placer.keep_clear(Rect::new(Vector::ZERO, 200.0, 100.0));
        let line = Line::plain("label", 10.0);
        assert!(placer.place(line, Vector::new(50.0, 50.0), Vector::ZERO, 5.0, Color::hex(0)).is_none());
    }

    #[test]
    fn only_the_part_of_a_line_within_the_rectangle_counts() {
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
