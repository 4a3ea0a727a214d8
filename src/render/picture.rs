/// A raster image: the output of the painter, the input of the encoders.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Picture {
    /// Width and height, px.
    pub size: [u32; 2],
    /// Rows from the top, as red, green, blue and alpha; alpha is always 255.
    pub pixels: Vec<[u8; 4]>,
}

impl Picture {
    /// The rows of pixels, from the top.
    pub fn rows(&self) -> std::slice::ChunksExact<'_, [u8; 4]> {
        self.pixels.chunks_exact(self.size[0] as usize)
    }
}
