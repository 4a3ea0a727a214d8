use crate::physics::{Rect, Vector};
use crate::picture::number::Hundredths;
use crate::picture::{Bitmap, Color, text::Line};
use std::fmt::{Display, Formatter, Result};
use std::sync::Arc;

/// A picture as resolution-independent shapes; every output format is made from it.
///
/// Coordinates are pixels from the upper-left corner of the page, x right, y down.
#[derive(Clone, Debug, PartialEq)]
pub struct DisplayList {
    /// Width and height of the page, px.
    pub size: [u32; 2],
    /// Background colour of the page.
    pub background: Color,
    /// Drawn first, usually the same in consecutive frames.
    pub backdrop: Vec<Shape>,
    /// Drawn in this order, later over earlier.
    pub shapes: Vec<Shape>,
}

/// One shape on a page.
#[derive(Clone, Debug, PartialEq)]
pub enum Shape {
    /// A rectangle, drawn to the nearest quarter of a pixel.
    Rect {
        /// Position and size, px.
        rect: Rect,
        /// Fill.
        ink: Ink,
    },
    /// A polygon.
    Polygon {
        /// Vertices, px; the last is joined to the first.
        points: Vec<Vector>,
        /// Fill.
        ink: Ink,
    },
    /// A line through points, with round caps and joins.
    Polyline {
        /// Points, px.
        points: Vec<Vector>,
        /// Line width, px.
        width: f64,
        /// Stroke.
        ink: Ink,
    },
    /// Shapes clipped to a rectangle.
    Clip {
        /// Clip rectangle, px; its edges are rounded to whole pixels.
        window: Rect,
        /// Shapes, drawn in this order.
        shapes: Vec<Shape>,
    },
    /// A line of text.
    Text {
        /// Text and glyphs.
        line: Line,
        /// Start of the baseline, px.
        at: Vector,
        /// Fill of the glyphs.
        ink: Ink,
    },
    /// A bitmap that fills a rectangle.
    Image {
        /// The pixels.
        bitmap: Arc<Bitmap>,
        /// Position and size, px.
        rect: Rect,
        /// Opacity: 0 is transparent, 255 opaque.
        opacity: u8,
    },
}

/// A colour with opacity.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Ink {
    /// Colour.
    pub color: Color,
    /// Opacity: 0 is transparent, 255 opaque.
    pub opacity: u8,
}

impl Shape {
    /// Cuts off the parts that are out of reach.
    fn cut_to_reach(&mut self) {
        match self {
            Shape::Rect { rect, .. } => {
                let within = |at: Vector| Vector::new(at.x.clamp(-REACH, REACH), at.y.clamp(-REACH, REACH));
                let (near, far) = (within(rect.origin), within(rect.far_corner()));
                if (near, far) != (rect.origin, rect.far_corner()) {
                    *rect = Rect::new(near, far.x - near.x, far.y - near.y);
                }
            }
            Shape::Polygon { points, .. } => cut_points(points, Ends::Joined),
            Shape::Polyline { points, .. } => cut_points(points, Ends::Free),
            Shape::Clip { shapes, .. } => shapes.iter_mut().for_each(Shape::cut_to_reach),
            Shape::Text { .. } | Shape::Image { .. } => {}
        }
    }

    /// The shape itself or, of a clip, the shapes inside it at any depth.
    pub fn leaves(&self) -> Box<dyn Iterator<Item = &Shape> + '_> {
        match self {
            Shape::Clip { shapes, .. } => Box::new(shapes.iter().flat_map(Shape::leaves)),
            Shape::Rect { .. }
            | Shape::Polygon { .. }
            | Shape::Polyline { .. }
            | Shape::Text { .. }
            | Shape::Image { .. } => Box::new(std::iter::once(self)),
        }
    }
}

/// The distance from the corner of the page beyond which shapes are cut off, px. No page is as large, and up to there
/// `f32` is exact to 1/100 px.
const REACH: f64 = 65_536.0;

/// The half-planes within reach: unit normals that point out of them.
const SIDES: [Vector; 4] =
    [Vector::new(1.0, 0.0), Vector::new(-1.0, 0.0), Vector::new(0.0, 1.0), Vector::new(0.0, -1.0)];

/// Reduces points to the part of their polygon or line within reach. A line that leaves and returns runs along the
/// border in between (after Sutherland and Hodgman, "Reentrant polygon clipping", 1974).
fn cut_points(points: &mut Vec<Vector>, ends: Ends) {
    let is_within = |at: &Vector| at.x.abs() <= REACH && at.y.abs() <= REACH;
    if points.iter().all(is_within) || !points.iter().all(|at| at.is_finite()) {
        return;
    }
    for side in SIDES {
        let beyond = |at: Vector| at.dot(side) - REACH;
        let mut cut = Vec::with_capacity(points.len() + 2);
        let mut last = points.last().copied().filter(|_| ends == Ends::Joined);
        for &at in &*points {
            if let Some(last) = last
                && (beyond(last) > 0.0) != (beyond(at) > 0.0)
            {
                let part = beyond(last) / (beyond(last) - beyond(at));
                cut.push(last.add(at.sub(last).mult(part)));
            }
            if beyond(at) <= 0.0 {
                cut.push(at);
            }
            last = Some(at);
        }
        *points = cut;
    }
}

/// The ends of a sequence of points.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Ends {
    /// The ends of a line.
    Free,
    /// The first and the last corner of a polygon.
    Joined,
}

impl DisplayList {
    /// The same picture without the parts of shapes that are far outside of the page: renderers calculate with `f32`,
    /// in which an edge inside the page is displaced if another point of its shape is far away.
    pub fn within_reach(mut self) -> DisplayList {
        self.backdrop.iter_mut().chain(&mut self.shapes).for_each(Shape::cut_to_reach);
        self
    }

    /// All shapes in drawing order, with clips replaced by the shapes inside them.
    pub fn leaves(&self) -> impl Iterator<Item = &Shape> {
        self.backdrop.iter().chain(&self.shapes).flat_map(Shape::leaves)
    }
}

/// The different bitmaps of a page, in the order in which they are first drawn.
pub fn distinct_bitmaps(list: &DisplayList) -> Vec<Arc<Bitmap>> {
    let mut distinct: Vec<Arc<Bitmap>> = Vec::new();
    for shape in list.leaves() {
        if let Shape::Image { bitmap, .. } = shape
            && !distinct.contains(bitmap)
        {
            distinct.push(bitmap.clone());
        }
    }
    distinct
}

impl From<Color> for Ink {
    fn from(color: Color) -> Ink {
        Ink { color, opacity: 255 }
    }
}

impl Display for DisplayList {
    /// One line per shape, for debugging and for snapshot tests.
    fn fmt(&self, out: &mut Formatter) -> Result {
        writeln!(out, "page {}×{} {}", self.size[0], self.size[1], self.background)?;
        self.backdrop.iter().try_for_each(|shape| writeln!(out, "backdrop {shape}"))?;
        self.shapes.iter().try_for_each(|shape| writeln!(out, "{shape}"))
    }
}

impl Display for Shape {
    fn fmt(&self, out: &mut Formatter) -> Result {
        match self {
            Shape::Rect { rect, ink } => {
                write!(
                    out,
                    "rect {} {}×{} {ink}",
                    Position(rect.origin),
                    Hundredths(rect.width()),
                    Hundredths(rect.height())
                )
            }
            Shape::Polygon { points, ink } => {
                write!(out, "polygon {ink}")?;
                points.iter().try_for_each(|&point| write!(out, " {}", Position(point)))
            }
            Shape::Polyline { points, width, ink } => {
                write!(out, "line of {} {ink}", Hundredths(*width))?;
                points.iter().try_for_each(|&point| write!(out, " {}", Position(point)))
            }
            Shape::Clip { window, shapes } => {
                let size = [window.width(), window.height()].map(Hundredths);
                write!(out, "window {} {}×{}", Position(window.origin), size[0], size[1])?;
                shapes.iter().try_for_each(|shape| write!(out, "\n  {shape}"))
            }
            Shape::Text { line, at, ink } => {
                write!(out, "text {:?} {} size {} {ink}", line.text, Position(*at), Hundredths(line.size))
            }
            Shape::Image { bitmap, rect, opacity } => {
                let [width, height] = [rect.width(), rect.height()].map(Hundredths);
                let [columns, rows] = bitmap.size;
                write!(out, "image of {columns}×{rows} {} {width}×{height}/{opacity}", Position(rect.origin))
            }
        }
    }
}

impl Display for Ink {
    fn fmt(&self, out: &mut Formatter) -> Result {
        match self.opacity {
            255 => write!(out, "{}", self.color),
            opacity => write!(out, "{}/{opacity}", self.color),
        }
    }
}

struct Position(Vector);

impl Display for Position {
    fn fmt(&self, out: &mut Formatter) -> Result {
        write!(out, "({},{})", Hundredths(self.0.x), Hundredths(self.0.y))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::picture::Painter;

    fn list(shape: Shape) -> DisplayList {
        DisplayList { size: [96, 64], background: Color::hex(0xffffff), backdrop: Vec::new(), shapes: vec![shape] }
    }

    /// A number from -1 to 1.
    fn random(state: &mut u64) -> f64 {
        *state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (*state >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    }

    #[test]
    fn shapes_of_every_extent_are_drawn_and_stay_within_reach() {
        let (mut state, ink) = (1, Color::hex(0).into());
        let extents: Vec<f64> = std::iter::successors(Some(1.0), |extent| Some(10.0 * extent)).take(13).collect();
        for round in 0..2000 {
            let extent = extents[round % extents.len()];
            let mut point = || Vector::new(48.0 + extent * random(&mut state), 32.0 + extent * random(&mut state));
            let points: Vec<Vector> = (0..3 + round % 4).map(|_| point()).collect();
            let rect = Rect::new(points[0].min(points[1]), (points[0].x - points[1].x).abs(), extent);
            for shape in [
                Shape::Polygon { points: points.clone(), ink },
                Shape::Polyline { points: points.clone(), width: 2.0, ink },
                Shape::Rect { rect, ink },
            ] {
                let whole = list(shape);
                let cut = whole.clone().within_reach();
                if extent < REACH / 2.0 {
                    assert_eq!(cut, whole);
                }
                let within = |at: &Vector| at.x.abs() <= 1.0001 * REACH && at.y.abs() <= 1.0001 * REACH;
                assert!(cut.leaves().all(|shape| match shape {
                    Shape::Rect { rect, .. } => within(&rect.origin) && within(&rect.far_corner()),
                    Shape::Polygon { points, .. } | Shape::Polyline { points, .. } => points.iter().all(within),
                    Shape::Clip { .. } | Shape::Text { .. } | Shape::Image { .. } => false,
                }));
                assert_eq!(Painter::new().draw(&cut).pixels.len(), 96 * 64);
            }
        }
    }

    #[test]
    fn the_parts_within_the_page_do_not_move() {
        let far = 1.6e10;
        // A band that reaches from row 20 down, and the same as a rectangle, as far as any renderer draws it.
        let points = [[0.0, far], [96.0, far], [96.0, 20.0], [0.0, 20.0]].map(|[x, y]| Vector::new(x, y)).to_vec();
        let ink: Ink = Color::hex(0).into();
        let near = Rect::new(Vector::new(0.0, 20.0), 96.0, 44.0);
        let expected = Painter::new().draw(&list(Shape::Rect { rect: near, ink }));
        let rect = Rect::new(near.origin, 96.0, far);
        for shape in [Shape::Polygon { points, ink }, Shape::Rect { rect, ink }] {
            assert_eq!(Painter::new().draw(&list(shape).within_reach()), expected);
        }
        // A line that passes through the page and returns outside of it.
        let line = |points: &[[f64; 2]]| Shape::Polyline {
            points: points.iter().map(|&[x, y]| Vector::new(x, y)).collect(),
            width: 2.0,
            ink,
        };
        let [through, whole] =
            [line(&[[48.0, -10.0], [48.0, 80.0]]), line(&[[48.0, -far], [48.0, far], [far, far], [far, -far]])];
        assert_eq!(Painter::new().draw(&list(whole).within_reach()), Painter::new().draw(&list(through)));
    }
}
