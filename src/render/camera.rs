use super::RenderError;
use crate::physics::{Rect, Vector};

/// Which part of the world is seen, and how large: the only place where metres become pixels.
///
/// World and page both have x to the right and y down, so nothing is flipped. Places are
/// rounded to quarters of a pixel: fine enough for smooth motion, coarse enough that the
/// colours of edges are few.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Camera {
    /// Width and height of the picture, px.
    pub size: [u32; 2],
    /// Height of the strip at the bottom that shows no world, px.
    pub footer: u32,
    /// Pixels per metre, the same along x and y.
    pub scale: f64,
    /// The point of the world seen at the upper-left corner of the picture, m.
    pub origin: Vector,
    /// Width and height of the world, m: where its border is.
    pub world: Vector,
}

/// Pixels along one side that a picture may have at most.
const LARGEST_SIDE: u32 = 16_384;

impl Camera {
    /// The camera that shows a world of `world` metres whole, in the middle of a picture of
    /// `size` pixels, with a small margin for the walls and a footer if asked for.
    ///
    /// # Errors
    /// When the picture has no pixels or more than 16384 along a side, or the world's size is
    /// not finite and positive.
    pub fn fit(world: Vector, size: [u32; 2], footer: bool) -> Result<Camera, RenderError> {
        check(world, size)?;
        let shorter = if size[0] < size[1] { size[0] } else { size[1] };
        let margin = f64::from(shorter / 40);
        let footer = if footer { shorter / 18 } else { 0 };
        let [width, height] = [size[0], size[1] - footer].map(f64::from);
        let across = (width - 2.0 * margin) / world.x;
        let down = (height - 2.0 * margin) / world.y;
        let scale = if across < down { across } else { down };
        let origin = Vector::new((world.x - width / scale) / 2.0, (world.y - height / scale) / 2.0);
        Ok(Camera { size, footer, scale, origin, world })
    }

    /// Where a point of the world is seen, px.
    pub fn point(&self, at: Vector) -> Vector {
        let seen = at.sub(self.origin).mult(self.scale);
        Vector::new(quarter(seen.x), quarter(seen.y))
    }

    /// Where a rectangle of the world is seen, px; rectangles that touch are seen to touch.
    pub fn rect(&self, rect: &Rect) -> Rect {
        let (near, far) = (self.point(rect.origin), self.point(rect.far_corner()));
        Rect::new(near, far.x - near.x, far.y - near.y)
    }

    /// The part of the page where the world is seen, px.
    pub fn window(&self) -> Rect {
        Rect::new(Vector::ZERO, f64::from(self.size[0]), f64::from(self.size[1] - self.footer))
    }
}

/// Farther from the page than that, in px, a place is as good as this far: whole numbers of
/// pixels are exact there.
const FAR: f64 = 1e9;

fn quarter(at: f64) -> f64 {
    (at * 4.0).round().clamp(-FAR, FAR) / 4.0
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
