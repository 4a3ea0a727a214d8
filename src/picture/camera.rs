use crate::physics::{Rect, Vector, smaller};
use crate::picture::{CameraTarget, RenderError};
use crate::picture_options::MAX_SIDE;

/// Maps world coordinates (m) to page coordinates (px). Metres become pixels only here.
///
/// World and page both have x to the right and y down, so no axis is flipped. Positions are rounded to quarter pixels:
/// fine enough for smooth motion, coarse enough to keep the number of edge colours small.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Camera {
    /// Width and height of the picture, px.
    pub size: [u32; 2],
    /// The part of the picture that shows the world, px.
    pub viewport: Rect,
    /// Pixels per metre, the same along x and y.
    pub scale: f64,
    /// The world point at the upper-left corner of the picture, m.
    pub origin: Vector,
    /// Width and height of the world, m.
    pub world: Vector,
}

impl Camera {
    /// Returns the camera that shows `target`, in a world of `world` metres, in the `viewport` of a picture of `size`
    /// pixels. The whole world is shown with a small margin for its walls.
    ///
    /// # Errors
    /// Returns an error if a side of the picture is 0 or more than 16384 pixels, or if width and height of the target
    /// are not finite and positive.
    pub fn new(world: Vector, target: &CameraTarget, size: [u32; 2], viewport: Rect) -> Result<Camera, RenderError> {
        let shorter = size[0].min(size[1]);
        let whole = Rect::new(Vector::ZERO, world.x, world.y);
        let (area, margin) = match target {
            CameraTarget::World => (whole, f64::from(shorter / 40)),
            CameraTarget::Window(area) => (*area, 0.0),
            CameraTarget::Follow { size, .. } => (Rect::new(whole.center().sub(size.mult(0.5)), size.x, size.y), 0.0),
        };
        validate(&area, size)?;
        Ok(Camera { world, ..Camera::fit(&area, size, viewport, margin) })
    }

    /// Returns the camera that shows `area` (m) in the middle of `viewport` (px), as large as possible with a margin
    /// of at least `margin` px.
    pub fn fit(area: &Rect, size: [u32; 2], viewport: Rect, margin: f64) -> Camera {
        let scale_x = (viewport.width() - 2.0 * margin) / area.width();
        let scale_y = (viewport.height() - 2.0 * margin) / area.height();
        let scale = smaller(scale_x, scale_y);
        let origin = area.center().sub(viewport.center().mult(1.0 / scale));
        Camera { size, viewport, scale, origin, world: area.far_corner() }
    }

    /// Returns the camera moved so that the world point `middle` is in the middle of its viewport. The shift is a
    /// whole number of pixels.
    pub fn centered_on(&self, middle: Vector) -> Camera {
        let shift = middle.sub(self.viewport.center().mult(1.0 / self.scale)).sub(self.origin).mult(self.scale);
        let pixels = Vector::new(shift.x.round(), shift.y.round());
        Camera { origin: self.origin.add(pixels.mult(1.0 / self.scale)), ..*self }
    }

    /// The part of the plane shown in the viewport, m.
    pub fn visible_area(&self) -> Rect {
        let per_pixel = 1.0 / self.scale;
        let near = self.origin.add(self.viewport.origin.mult(per_pixel));
        Rect::new(near, self.viewport.width() * per_pixel, self.viewport.height() * per_pixel)
    }

    /// The page position of a world point, px.
    pub fn point(&self, at: Vector) -> Vector {
        let page = at.sub(self.origin).mult(self.scale);
        Vector::new(round_to_quarter(page.x), round_to_quarter(page.y))
    }

    /// The page rectangle of a world rectangle, px. Rectangles that touch in the world touch on the page.
    pub fn rect(&self, rect: &Rect) -> Rect {
        let (near, far) = (self.point(rect.origin), self.point(rect.far_corner()));
        Rect::new(near, far.x - near.x, far.y - near.y)
    }
}

/// Page coordinates are clamped to this magnitude, px: quarter pixels are exact there, and everything beyond is
/// outside any page.
const MAX_COORDINATE: f64 = 1e9;

fn round_to_quarter(at: f64) -> f64 {
    (at * 4.0).round().clamp(-MAX_COORDINATE, MAX_COORDINATE) / 4.0
}

fn validate(area: &Rect, size: [u32; 2]) -> Result<(), RenderError> {
    if size.iter().any(|&side| side == 0 || side > MAX_SIDE) {
        return Err(RenderError::PictureSize { width: size[0], height: size[1], max_side: MAX_SIDE });
    }
    let (width, height) = (area.width(), area.height());
    if !(area.origin.is_finite() && width.is_finite() && height.is_finite()) || width <= 0.0 || height <= 0.0 {
        return Err(RenderError::WorldSize { width, height });
    }
    Ok(())
}
