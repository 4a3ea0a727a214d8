use super::LayoutContext;
use super::footer::{Entry, KeyArrow};
use super::lanes::ArrowKey;
use crate::physics::{Rect, Vector, larger};
use crate::picture::number::{Unit, format_significant, nice_below};
use crate::picture::{Color, DrawingMetrics, Frame, Ink, Language, Overlay, Shape, Sprite, Style};

/// An arrow between two points of the page, drawn with a halo that separates it from the background.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Arrow {
    /// Start of the shaft, px.
    pub from: Vector,
    /// The tip, px.
    pub to: Vector,
    /// Width of the shaft, px.
    pub width: f64,
    /// Colour of shaft and head.
    pub color: Color,
    /// The meaning of its length.
    pub length: ArrowLength,
}

/// The meaning of the length of an arrow.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ArrowLength {
    /// The length is to scale.
    ToScale,
    /// The vector is shorter than an arrow head: an open head shows its direction alone.
    Short,
}

impl Arrow {
    /// An arrow whose length is to scale.
    pub fn new(from: Vector, to: Vector, width: f64, color: Color) -> Arrow {
        Arrow { from, to, width, color, length: ArrowLength::ToScale }
    }

    /// The arrow for a vector on the page, px: an open head if it is shorter than a head. `None` for a vector that is
    /// negligible beside the longest one of the picture, `longest` px, or not finite.
    pub fn of_vector(from: Vector, vector: Vector, width: f64, color: Color, longest: f64) -> Option<Arrow> {
        let length = vector.norm();
        if !(length.is_finite() && length > NEGLIGIBLE * longest) {
            return None;
        }
        let head = HEAD_LENGTH * width;
        if length >= head {
            return Some(Arrow::new(from, from.add(vector), width, color));
        }
        let to = from.add(vector.mult(head / length));
        Some(Arrow { length: ArrowLength::Short, ..Arrow::new(from, to, width, color) })
    }

    /// Appends the arrow to `shapes`, on a halo in the background colour. Appends nothing if the arrow is shorter
    /// than its shaft is wide.
    pub fn draw(&self, metrics: &DrawingMetrics, shapes: &mut Vec<Shape>) {
        self.aligned().draw_at_place(metrics, shapes);
    }

    /// The arrow moved sideways by half a pixel at most, if it is horizontal or vertical, so that its edges are those
    /// of pixels: a thin shaft between two rows of pixels would be pale.
    fn aligned(&self) -> Arrow {
        let place = |at: f64| if self.width.round() % 2.0 == 1.0 { at.floor() + 0.5 } else { at.round() };
        let [from, to] = [self.from, self.to];
        let [from, to] = match (from.x == to.x, from.y == to.y) {
            (false, true) => [from, to].map(|at| Vector::new(at.x, place(at.y))),
            (true, false) => [from, to].map(|at| Vector::new(place(at.x), at.y)),
            _ => [from, to],
        };
        Arrow { from, to, ..*self }
    }

    /// The bounds of the arrow with its halo, px.
    pub fn bounds(&self, metrics: &DrawingMetrics) -> Rect {
        let half = (HEAD_SLOPE * HEAD_LENGTH + 0.25) * self.width + metrics.line_width;
        let between = Rect::new(self.from, 0.0, 0.0).union(&Rect::new(self.to, 0.0, 0.0));
        between.inset(-half)
    }

    fn draw_at_place(&self, metrics: &DrawingMetrics, shapes: &mut Vec<Shape>) {
        let direction = self.to.sub(self.from);
        let length = direction.norm();
        // A zero vector has no direction, and an arrow of infinite length cannot be drawn.
        if !(length >= self.width && length.is_finite()) {
            return;
        }
        let direction = direction.mult(1.0 / length);
        let (margin, background) = (metrics.line_width / 2.0, metrics.palette.background);
        match self.length {
            ArrowLength::ToScale => {
                shapes.extend(self.shaft_and_head(direction, length, margin, background));
                shapes.extend(self.shaft_and_head(direction, length, 0.0, self.color));
            }
            ArrowLength::Short => {
                let normal = Vector::new(-direction.y, direction.x).mult(HEAD_SLOPE * length + self.width / 4.0);
                let corners = vec![self.from.add(normal), self.to, self.from.sub(normal), self.from.add(normal)];
                for (width, color) in
                    [(self.width + 2.0 * margin, background), (larger(self.width / 2.0, 1.0), self.color)]
                {
                    shapes.push(Shape::Polyline { points: corners.clone(), width, ink: color.into() });
                }
            }
        }
    }

    /// Shaft and head, expanded by `margin` px on all sides. A short arrow has a smaller head.
    fn shaft_and_head(&self, direction: Vector, length: f64, margin: f64, color: Color) -> [Shape; 2] {
        let normal = Vector::new(-direction.y, direction.x);
        let point = |ahead: f64, side: f64| self.from.add(direction.mult(ahead)).add(normal.mult(side));
        let full = HEAD_LENGTH * self.width;
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

/// Length of an arrow head, in widths of the shaft.
const HEAD_LENGTH: f64 = 5.0;

/// Vectors shorter than this part of the longest one are rounding errors of zero.
const NEGLIGIBLE: f64 = 1e-9;

/// The distance at which two arrows are beside each other, px: the width of a head with its halo.
pub fn lane_width(width: f64) -> f64 {
    (2.0 * HEAD_SLOPE * HEAD_LENGTH + 1.5) * width
}

/// An arrow with a label at its tip.
pub struct LabeledArrow {
    /// The arrow.
    pub arrow: Arrow,
    /// Its body and quantity, if it is in all frames of the body.
    pub key: Option<ArrowKey>,
    /// The label as markup for [`crate::picture::text::Line::math`]; none if empty.
    pub label: String,
}

impl From<Arrow> for LabeledArrow {
    fn from(arrow: Arrow) -> LabeledArrow {
        LabeledArrow { arrow, key: None, label: String::new() }
    }
}

/// The velocity arrows, those of momenta, then those for the sum of weight and constant force, each from the middle of
/// a box. Contact forces are not part of a recording.
pub fn of_bodies(frame: &Frame, context: &LayoutContext) -> Vec<LabeledArrow> {
    let shows = |quantity: &Quantity| context.view.style.shows(quantity.overlay);
    let mut arrows = Vec::new();
    if shows(&VELOCITY) {
        arrows.extend(from_centers(frame, |sprite| sprite.velocity, &VELOCITY, context));
    }
    if shows(&MOMENTUM) {
        let momentum = |sprite: &Sprite| sprite.appearance.momentum(sprite.velocity);
        arrows.extend(from_centers(frame, momentum, &MOMENTUM, context));
    }
    if shows(&FORCE) {
        arrows.extend(from_centers(frame, |sprite| sprite.appearance.force, &FORCE, context));
    }
    arrows
}

/// Arrows from the middle of the visible part of each box.
fn from_centers(
    frame: &Frame,
    vector: impl Fn(&Sprite) -> Vector,
    quantity: &Quantity,
    context: &LayoutContext,
) -> Vec<LabeledArrow> {
    let (style, metrics) = (&context.view.style, &context.metrics);
    let (scale, width, color) = (quantity.scale(style, metrics), width(style, metrics), (quantity.color)(metrics));
    let boxes = frame.sprites.iter().filter(|sprite| !sprite.appearance.is_wall);
    let arrow = |sprite: &Sprite| {
        let from = context.visible_rect(sprite)?.intersection(&context.camera.viewport)?.center();
        let vector = vector(sprite).mult(scale);
        let arrow = Arrow::of_vector(from, vector, width, color, longest(style, metrics))?;
        Some(LabeledArrow { key: Some((quantity.overlay, sprite.appearance.id)), ..arrow.into() })
    };
    boxes.filter_map(arrow).collect()
}

/// A quantity that arrows show.
pub struct Quantity {
    overlay: Overlay,
    unit: Unit,
    /// The largest value of the run.
    top: fn(&Style) -> f64,
    color: fn(&DrawingMetrics) -> Color,
    /// The width of the shafts, px.
    width: fn(&Style, &DrawingMetrics) -> f64,
}

/// Velocity, m/s.
pub const VELOCITY: Quantity = Quantity {
    overlay: Overlay::Velocity,
    unit: Unit::METRE_PER_SECOND,
    top: |style| style.top_speed,
    color: |metrics| metrics.palette.ink,
    width,
};

/// Momentum, kg·m/s.
pub const MOMENTUM: Quantity = Quantity {
    overlay: Overlay::Momentum,
    unit: Unit::MOMENTUM,
    top: |style| style.top_momentum,
    color: |metrics| metrics.palette.momentum,
    width,
};

/// Force, N.
pub const FORCE: Quantity = Quantity {
    overlay: Overlay::Force,
    unit: Unit::NEWTON,
    top: |style| style.top_force,
    color: |metrics| metrics.palette.force,
    width,
};

/// Impulse, N·s.
pub const IMPULSE: Quantity = Quantity {
    overlay: Overlay::Impulse,
    unit: Unit::NEWTON_SECOND,
    top: |style| style.top_impulse,
    color: |metrics| metrics.palette.impulse,
    width: |_, metrics| 1.5 * metrics.line_width,
};

impl Quantity {
    /// Pixels per unit of the quantity: one scale for all arrows of a picture.
    pub fn scale(&self, style: &Style, metrics: &DrawingMetrics) -> f64 {
        longest(style, metrics) / (self.top)(style)
    }

    /// The width of the shafts, px, on which the smallest arrow that has its length depends.
    pub fn width(&self, style: &Style, metrics: &DrawingMetrics) -> f64 {
        (self.width)(style, metrics)
    }

    /// The entries of the legend that explain the lengths of the arrows.
    fn keys(&self, style: &Style, metrics: &DrawingMetrics) -> Vec<Entry> {
        let (top, scale) = ((self.top)(style), self.scale(style, metrics));
        if !(style.shows(self.overlay) && top > 0.0 && top.is_finite() && scale.is_finite()) {
            return Vec::new();
        }
        let (width, color) = (self.width(style, metrics), (self.color)(metrics));
        key_entries(scale, top, self.unit, width, color, metrics.language).into()
    }
}

/// The entries of a legend for arrows of `scale` px per unit and values up to `top`: an arrow of a round length, and
/// the open head of shorter ones.
pub fn key_entries(scale: f64, top: f64, unit: Unit, width: f64, color: Color, language: Language) -> [Entry; 2] {
    let (value, shortest) = (nice_below(top), HEAD_LENGTH * width / scale);
    let key = |length: f64, kind: ArrowLength, name: String| Entry {
        arrow: Some(KeyArrow { length, width, kind }),
        name,
        ..Entry::new(color, "")
    };
    let head = HEAD_LENGTH * width;
    let limit = unit.for_size(shortest);
    let shortest = format_significant(limit.scaled(shortest), 2);
    [
        key(larger(value * scale, head), ArrowLength::ToScale, language.decimal(unit.format(value, 1))),
        key(head, ArrowLength::Short, language.decimal(format!("< {shortest} \"{limit}\""))),
    ]
}

/// The entries of the legend for all arrows of frames.
pub fn keys(style: &Style, metrics: &DrawingMetrics) -> Vec<Entry> {
    [&VELOCITY, &MOMENTUM, &FORCE, &IMPULSE].into_iter().flat_map(|quantity| quantity.keys(style, metrics)).collect()
}

/// With more bodies than this, arrows are shorter and thinner, so that their density stays about the same.
const MANY_BODIES: f64 = 40.0;

/// The length of the longest arrow of a picture, px.
fn longest(style: &Style, metrics: &DrawingMetrics) -> f64 {
    let body_count = f64::from(style.body_count);
    let shrink = if body_count > MANY_BODIES { (MANY_BODIES / body_count).sqrt() } else { 1.0 };
    larger(shrink * metrics.arrow_length, 3.0 * HEAD_LENGTH * width(style, metrics))
}

/// The width of the shafts of arrows at bodies, px.
fn width(style: &Style, metrics: &DrawingMetrics) -> f64 {
    if f64::from(style.body_count) > MANY_BODIES { (metrics.line_width / 2.0).ceil() } else { metrics.line_width }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::picture::Look;

    const INK: Color = Color::hex(0);

    #[test]
    fn the_shaft_of_a_horizontal_arrow_fills_whole_rows_of_pixels() {
        for (y, width) in [(10.0, 1.0), (10.3, 1.0), (10.5, 2.0), (10.8, 2.0), (10.2, 3.0)] {
            let aligned = Arrow::new(Vector::new(3.2, y), Vector::new(40.7, y), width, INK).aligned();
            let edges = [aligned.from.y - width / 2.0, aligned.to.y + width / 2.0];
            assert!(edges.iter().all(|edge| edge.fract() == 0.0) && (aligned.from.y - y).abs() <= 0.5, "{aligned:?}");
            assert_eq!([aligned.from.x, aligned.to.x], [3.2, 40.7]);
        }
        let oblique = Arrow::new(Vector::new(3.2, 10.3), Vector::new(40.7, 11.0), 1.0, INK);
        assert_eq!(oblique.aligned(), oblique);
    }

    #[test]
    fn a_vector_shorter_than_a_head_has_an_open_head_of_full_length() {
        let of = |length: f64| Arrow::of_vector(Vector::ZERO, Vector::new(length, 0.0), 2.0, INK, 100.0);
        assert_eq!(of(0.0), None);
        assert_eq!(of(1e-8), None);
        assert_eq!(of(f64::NAN), None);
        for length in [1e-6, 0.5, 9.9] {
            let arrow = of(length).unwrap();
            assert!(arrow.length == ArrowLength::Short && (arrow.to.x - 10.0).abs() < 1e-9, "{arrow:?}");
        }
        assert_eq!(of(10.0).map(|arrow| (arrow.length, arrow.to.x)), Some((ArrowLength::ToScale, 10.0)));
    }

    /// Just below the limit in the legend, an arrow is short, and just above it has its length.
    #[test]
    fn the_legend_states_the_smallest_value_of_an_arrow_to_scale() {
        for body_count in [2, 1000] {
            for quantity in [VELOCITY, MOMENTUM, FORCE, IMPULSE] {
                let look = Look { show: [quantity.overlay].into(), size: [1280, 720], ..Look::default() };
                let style = Style { look, body_count, ..Style::default() };
                let metrics = DrawingMetrics::new(style.look.theme, style.look.language, style.look.size);
                let (scale, width) = (quantity.scale(&style, &metrics), quantity.width(&style, &metrics));
                let keys = quantity.keys(&style, &metrics);
                let limit: f64 = keys[1].name.split(' ').nth(1).unwrap().parse().unwrap();
                let length = |value: f64| {
                    let along = Vector::new(value * scale, 0.0);
                    Arrow::of_vector(Vector::ZERO, along, width, INK, 10.0 * scale).unwrap().length
                };
                // The limit has two digits.
                assert_eq!(length(0.9 * limit), ArrowLength::Short, "{body_count} {}", keys[1].name);
                assert_eq!(length(1.1 * limit), ArrowLength::ToScale, "{body_count} {}", keys[1].name);
            }
        }
    }
}
