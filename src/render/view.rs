use super::area::{larger, smaller};
use super::{Aim, Camera, Frame, Look, RenderError, Style};
use crate::physics::{Rect, Vector};
use crate::scene::Overlay;

/// All that shapes a picture beside the frame itself.
#[derive(Clone, Debug, PartialEq)]
pub struct View {
    /// Which part of the world is seen, and how large.
    pub camera: Camera,
    /// The body that the camera follows, if any: see [`View::camera_at`].
    pub follow: Option<String>,
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
        View::new(world, size, &Aim::World, style)
    }

    /// The view of that of a world of `world` metres which the camera aims at, in a picture of
    /// `size` pixels. What the style writes beside it has its room.
    ///
    /// # Errors
    /// As for [`View::fit`], and when what is aimed at is not finite and positive.
    pub fn new(world: Vector, size: [u32; 2], aim: &Aim, style: Style) -> Result<View, RenderError> {
        let [width, height] = size.map(f64::from);
        let look = Look::new(style.theme, size);
        let [left, below] = margins(&style, &look, smaller(width, height));
        let window = Rect::new(Vector::new(left, 0.0), larger(width - left, 1.0), larger(height - below, 1.0));
        let camera = Camera::aimed(world, aim, size, window)?;
        Ok(View { camera, follow: aim.follows().map(str::to_owned), style })
    }

    /// The camera that shows `frame`: where it follows a body, in the middle of the picture as
    /// long as that is alive, in whole pixels so that nothing else shimmers.
    pub fn camera_at(&self, frame: &Frame) -> Camera {
        let followed = self.follow.as_ref().and_then(|name| {
            let sprite = frame.sprites.iter().find(|sprite| sprite.appearance.name == *name)?;
            Some(sprite.rect.center()).filter(|middle| middle.is_finite())
        });
        followed.map_or(self.camera, |middle| self.camera.moved_to(middle))
    }
}

/// What stays free on the left, and below, px.
fn margins(style: &Style, look: &Look, shorter: f64) -> [f64; 2] {
    let strip = (shorter / 18.0).floor();
    let footer = if style.has_footer() { strip } else { 0.0 };
    let caption = if style.caption.is_empty() { 0.0 } else { strip };
    let [left, axis] = match style.shows(Overlay::Axes) {
        true => [(3.2 * look.text).round(), (1.6 * look.text).round()],
        false => [0.0, 0.0],
    };
    [left, footer + caption + axis]
}
