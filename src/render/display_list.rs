use super::{Color, text::Line};
use crate::physics::{Rect, Vector};
use std::fmt::{Display, Formatter, Result};

/// A picture as shapes in page units, before any pixel: what every output format is made of.
///
/// Coordinates are pixels from the upper-left corner of the page, x right, y down.
#[derive(Clone, Debug, PartialEq)]
pub struct DisplayList {
    /// Width and height of the page, px.
    pub size: [u32; 2],
    /// What the page is filled with.
    pub background: Color,
    /// Drawn first, and likely the same in the next frame.
    pub backdrop: Vec<Shape>,
    /// Drawn in this order, later over earlier.
    pub shapes: Vec<Shape>,
}

/// One shape on a page.
#[derive(Clone, Debug, PartialEq)]
pub enum Shape {
    /// A rectangle, drawn to the nearest quarter of a pixel.
    Rect {
        /// px.
        rect: Rect,
        /// What fills it.
        ink: Ink,
    },
    /// A polygon.
    Polygon {
        /// Its corners, px; the last one joins the first.
        points: Vec<Vector>,
        /// What fills it.
        ink: Ink,
    },
    /// A line through points, with round ends and corners.
    Polyline {
        /// px.
        points: Vec<Vector>,
        /// px.
        width: f64,
        /// What it is drawn with.
        ink: Ink,
    },
    /// Shapes of which only what lies in a window is seen.
    Clip {
        /// px; its edges are rounded to whole pixels.
        window: Rect,
        /// Drawn in this order.
        shapes: Vec<Shape>,
    },
    /// A line of text.
    Text {
        /// Its glyphs.
        line: Line,
        /// Where its baseline begins, px.
        at: Vector,
        /// What it is drawn with.
        ink: Ink,
    },
}

/// A colour and how much of it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Ink {
    /// Its colour.
    pub color: Color,
    /// 255 hides what is beneath, 0 leaves it.
    pub opacity: u8,
}

impl Shape {
    /// This shape, or those within it: everything that is really drawn.
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
    /// Everything that is really drawn, in order.
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
    /// One shape a line, for people and for tests that hold a layout as text.
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
                write!(out, "rect {} {}×{} {ink}", Place(rect.origin), Length(rect.width()), Length(rect.height()))
            }
            Shape::Polygon { points, ink } => {
                write!(out, "polygon {ink}")?;
                points.iter().try_for_each(|&point| write!(out, " {}", Place(point)))
            }
            Shape::Polyline { points, width, ink } => {
                write!(out, "line of {} {ink}", Length(*width))?;
                points.iter().try_for_each(|&point| write!(out, " {}", Place(point)))
            }
            Shape::Clip { window, shapes } => {
                let size = [window.width(), window.height()].map(Length);
                write!(out, "window {} {}×{}", Place(window.origin), size[0], size[1])?;
                shapes.iter().try_for_each(|shape| write!(out, "\n  {shape}"))
            }
            Shape::Text { line, at, ink } => {
                write!(out, "text {:?} {} size {} {ink}", line.text, Place(*at), Length(line.size))
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

/// A length to the hundredth of a pixel, without needless zeros.
struct Length(f64);

impl Display for Length {
    fn fmt(&self, out: &mut Formatter) -> Result {
        // Adding 0 turns −0 into 0.
        write!(out, "{}", (self.0 * 100.0).round() / 100.0 + 0.0)
    }
}

struct Place(Vector);

impl Display for Place {
    fn fmt(&self, out: &mut Formatter) -> Result {
        write!(out, "({},{})", Length(self.0.x), Length(self.0.y))
    }
}
