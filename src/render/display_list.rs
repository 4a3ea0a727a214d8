use super::Color;

/// A picture as shapes in page units, before any pixel: what every output format is made of.
#[derive(Clone, Debug, PartialEq)]
pub struct DisplayList {
    /// Width and height of the page, px.
    pub size: [u32; 2],
    /// What the page is filled with.
    pub background: Color,
    /// Drawn in this order, later over earlier.
    pub shapes: Vec<Shape>,
}

/// One shape; coordinates are pixels from the upper-left corner of the page, x right, y down.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Shape {}
