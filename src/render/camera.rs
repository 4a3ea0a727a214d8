use super::{Aim, RenderError};
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
    /// The camera that shows what is aimed at, of a world of `world` metres, in a part of a
    /// picture of `size` pixels; the world is shown whole, with a small margin for its walls.
    ///
    /// # Errors
    /// When the picture has no pixels or more than 16384 along a side, or what is aimed at is
    /// not finite and positive.
    pub fn aimed(world: Vector, aim: &Aim, size: [u32; 2], window: Rect) -> Result<Camera, RenderError> {
        let shorter = if size[0] < size[1] { size[0] } else { size[1] };
        let whole = Rect::new(Vector::ZERO, world.x, world.y);
        let (area, margin) = match aim {
            Aim::World => (whole, f64::from(shorter / 40)),
            Aim::Window(area) => (*area, 0.0),
            Aim::Follow { size, .. } => (Rect::new(whole.center().sub(size.mult(0.5)), size.x, size.y), 0.0),
        };
        check(&area, size)?;
        Ok(Camera { world, ..Camera::over(&area, size, window, margin) })
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

    /// The same camera with a point of the world in the middle of its window, moved by whole
    /// pixels.
    pub fn moved_to(&self, middle: Vector) -> Camera {
        let by = middle.sub(self.window.center().mult(1.0 / self.scale)).sub(self.origin).mult(self.scale);
        let whole = Vector::new(by.x.round(), by.y.round());
        Camera { origin: self.origin.add(whole.mult(1.0 / self.scale)), ..*self }
    }

    /// The part of the plane that is seen in the window, m.
    pub fn seen(&self) -> Rect {
        let per_pixel = 1.0 / self.scale;
        let near = self.origin.add(self.window.origin.mult(per_pixel));
        Rect::new(near, self.window.width() * per_pixel, self.window.height() * per_pixel)
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

fn check(area: &Rect, size: [u32; 2]) -> Result<(), RenderError> {
    if size.iter().any(|&side| side == 0 || side > LARGEST_SIDE) {
        return Err(RenderError::PictureSize { width: size[0], height: size[1], largest: LARGEST_SIDE });
    }
    let (width, height) = (area.width(), area.height());
    if !(area.origin.is_finite() && width.is_finite() && height.is_finite()) || width <= 0.0 || height <= 0.0 {
        return Err(RenderError::WorldSize { width, height });
    }
    Ok(())
}
