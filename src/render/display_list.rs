use super::{Color, text::Line};
use crate::physics::{Rect, Vector};

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
    /// A line through points.
    Polyline {
        /// px.
        points: Vec<Vector>,
        /// px.
        width: f64,
        /// What it is drawn with.
        ink: Ink,
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

impl From<Color> for Ink {
    fn from(color: Color) -> Ink {
        Ink { color, opacity: 255 }
    }
}
