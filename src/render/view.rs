use super::{Camera, RenderError, Style};
use crate::physics::Vector;

/// All that shapes a picture beside the frame itself.
#[derive(Clone, Debug, PartialEq)]
pub struct View {
    /// Which part of the world is seen, and how large.
    pub camera: Camera,
    /// How it looks.
    pub style: Style,
}

impl View {
    /// The view of a world of `world` metres, whole, in a picture of `size` pixels.
    ///
    /// # Errors
    /// When the picture has no pixels or too many, or the world's size is not finite and
    /// positive.
    pub fn fit(world: Vector, size: [u32; 2], style: Style) -> Result<View, RenderError> {
        let camera = Camera::fit(world, size, style.has_footer())?;
        Ok(View { camera, style })
    }
}
