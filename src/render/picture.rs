/// Pixels: what shapes are drawn to, what encoders write and what tests compare.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Picture {
    /// Width and height, px.
    pub size: [u32; 2],
    /// Row by row from the top, red, green, blue and 255 for each pixel.
    pub pixels: Vec<u8>,
}
