use super::RenderError;
use crate::physics::Vector;

/// Which part of the world is seen, and how large: the only place where metres become pixels.
///
/// World and picture both have x to the right and y down, so nothing is flipped.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Camera {
    /// Width and height of the picture, px.
    pub size: [u32; 2],
    /// Pixels per metre, the same along x and y.
    pub scale: f64,
    /// The point of the world seen at the upper-left corner of the picture, m.
    pub origin: Vector,
}

/// Pixels along one side that a picture may have at most.
const LARGEST_SIDE: u32 = 16_384;

/// Pixels left around the world at least, where the walls are seen.
const MARGIN: f64 = 1.0 / 40.0;

impl Camera {
    /// The camera that shows a world of `world` metres whole, in the middle of a picture of
    /// `size` pixels, with a small margin for the walls.
    ///
    /// # Errors
    /// When the picture has no pixels or more than 16384 along a side, or the world's size is
    /// not finite and positive.
    pub fn fit(world: Vector, size: [u32; 2]) -> Result<Camera, RenderError> {
        check(world, size)?;
        let [width, height] = size.map(f64::from);
        let margin = (if width < height { width } else { height } * MARGIN).round();
        let across = (width - 2.0 * margin) / world.x;
        let down = (height - 2.0 * margin) / world.y;
        let scale = if across < down { across } else { down };
        let origin = Vector::new((world.x - width / scale) / 2.0, (world.y - height / scale) / 2.0);
        Ok(Camera { size, scale, origin })
    }
}

fn check(world: Vector, size: [u32; 2]) -> Result<(), RenderError> {
    if size.iter().any(|&side| side == 0 || side > LARGEST_SIDE) {
        return Err(RenderError::PictureSize { width: size[0], height: size[1], largest: LARGEST_SIDE });
    }
    if !world.is_finite() || world.x <= 0.0 || world.y <= 0.0 {
        return Err(RenderError::WorldSize { width: world.x, height: world.y });
    }
    Ok(())
}
