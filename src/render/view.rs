use super::area::{larger, smaller};
use super::{Camera, CameraTarget, Frame, Metrics, RenderError, Style};
use crate::physics::{Rect, Vector};
use crate::scene::Overlay;

/// Camera and style: everything that determines a picture except the frame.
#[derive(Clone, Debug, PartialEq)]
pub struct View {
    /// The part of the world shown, and its scale.
    pub camera: Camera,
    /// Name of the body that the camera follows, if any; see [`View::camera_for`].
    pub follow: Option<String>,
    /// Theme, overlays and colours.
    pub style: Style,
}

impl View {
    /// A view of a whole world of `world` metres in a picture of `size` pixels.
    ///
    /// # Errors
    /// Returns an error if a side of the picture is 0 or more than 16384 pixels, or if the size of the world is not
    /// finite and positive.
    pub fn fit(world: Vector, size: [u32; 2], style: Style) -> Result<View, RenderError> {
        View::new(world, size, &CameraTarget::World, style)
    }

    /// A view of the part of a world of `world` metres selected by `target`, in a picture of `size` pixels. Space for
    /// the footer and axes of `style` is reserved.
    ///
    /// # Errors
    /// As [`View::fit`]; also if the size of the target is not finite and positive.
    pub fn new(world: Vector, size: [u32; 2], target: &CameraTarget, style: Style) -> Result<View, RenderError> {
        let [width, height] = size.map(f64::from);
        let metrics = Metrics::new(style.theme, size);
        let [left, below] = margins(&style, &metrics, smaller(width, height));
        let viewport = Rect::new(Vector::new(left, 0.0), larger(width - left, 1.0), larger(height - below, 1.0));
        let camera = Camera::new(world, target, size, viewport)?;
        Ok(View { camera, follow: target.followed_body().map(str::to_owned), style })
    }

    /// The camera for `frame`. If the view follows a body that is alive, the camera is centred on it, moved by whole
    /// pixels so that resting bodies do not shimmer.
    pub fn camera_for(&self, frame: &Frame) -> Camera {
        let followed = self.follow.as_ref().and_then(|name| {
            let sprite = frame.sprites.iter().find(|sprite| sprite.appearance.name == *name)?;
            Some(sprite.rect.center()).filter(|middle| middle.is_finite())
        });
        followed.map_or(self.camera, |middle| self.camera.centered_on(middle))
    }
}

/// Space reserved on the left and below, px.
fn margins(style: &Style, metrics: &Metrics, shorter: f64) -> [f64; 2] {
    let strip = (shorter / 18.0).floor();
    let footer = if style.has_footer() { strip } else { 0.0 };
    let caption = if style.caption.is_empty() { 0.0 } else { strip };
    let [left, axis] = match style.shows(Overlay::Axes) {
        true => [(3.2 * metrics.font_size).round(), (1.6 * metrics.font_size).round()],
        false => [0.0, 0.0],
    };
    [left, footer + caption + axis]
}
