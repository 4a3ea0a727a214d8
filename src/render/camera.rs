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
    /// The part of the picture where the world is seen, px.
    pub window: Rect,
    /// Pixels per metre, the same along x and y.
    pub scale: f64,
    /// The point of the world that would be seen at the upper-left corner of the picture, m.
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
        let footer = if footer { shorter / 18 } else { 0 };
        let window = Rect::new(Vector::ZERO, f64::from(size[0]), f64::from(size[1] - footer));
        let area = Rect::new(Vector::ZERO, world.x, world.y);
        Ok(Camera::over(&area, size, window, f64::from(shorter / 40)).with_world(world))
    }

    /// The camera that shows a part of the world, in m, in the middle of a part of the picture,
    /// in px, with at least a margin around it, in px.
    pub fn over(area: &Rect, size: [u32; 2], window: Rect, margin: f64) -> Camera {
        let across = (window.width() - 2.0 * margin) / area.width();
        let down = (window.height() - 2.0 * margin) / area.height();
        let scale = if across < down { across } else { down };
        let origin = area.center().sub(window.center().mult(1.0 / scale));
        Camera { size, window, scale, origin, world: area.far_corner() }
    }

    fn with_world(self, world: Vector) -> Camera {
        Camera { world, ..self }
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
