use crate::physics::{Rect, Vector};
use crate::picture::number::Hundredths;
use crate::picture::{Color, text::Line};
use std::fmt::{Display, Formatter, Result};

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
    /// The shape itself or, of a clip, the shapes inside it at any depth.
    pub fn leaves(&self) -> Box<dyn Iterator<Item = &Shape> + '_> {
        match self {
            Shape::Clip { shapes, .. } => Box::new(shapes.iter().flat_map(Shape::leaves)),
            Shape::Rect { .. } | Shape::Polygon { .. } | Shape::Polyline { .. } | Shape::Text { .. } => {
                Box::new(std::iter::once(self))
            }
        }
    }
}

impl DisplayList {
    /// All shapes in drawing order, with clips replaced by the shapes inside them.
    pub fn leaves(&self) -> impl Iterator<Item = &Shape> {
        self.backdrop.iter().chain(&self.shapes).flat_map(Shape::leaves)
    }
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
