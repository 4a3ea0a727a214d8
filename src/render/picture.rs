/// Pixels: what shapes are drawn to, what encoders write and what tests compare.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Picture {
    /// Width and height, px.
    pub size: [u32; 2],
    /// Row by row from the top: red, green, blue and 255.
    pub pixels: Vec<[u8; 4]>,
}

impl Picture {
    /// The rows, from the top.
    pub fn rows(&self) -> std::slice::ChunksExact<'_, [u8; 4]> {
        self.pixels.chunks_exact(self.size[0] as usize)
    }
}
