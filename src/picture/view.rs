use crate::physics::{Rect, Vector, larger, smaller};
use crate::picture::layers::footer::strip_heights;
use crate::picture::number::TimeFormat;
use crate::picture::raster::color::Palette;
use crate::picture::{Camera, ColorBy, Frame, Look, Overlay, RenderError, Theme};

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
    /// A view of the part of a world of `world` metres that the style selects. Space for footer and axes is reserved.
    ///
    /// # Errors
    /// Returns an error if a side of the picture is 0 or more than 16384 pixels, or if width and height of the visible
    /// part are not finite and positive.
    pub fn new(world: Vector, style: Style) -> Result<View, RenderError> {
        let Look { theme, size, camera_target: target, .. } = &style.look;
        let [width, height] = size.map(f64::from);
        let metrics = DrawingMetrics::new(*theme, *size);
        let [left, below] = margins(&style, &metrics);
        let viewport = Rect::new(Vector::new(left, 0.0), larger(width - left, 1.0), larger(height - below, 1.0));
        let camera = Camera::new(world, target, *size, viewport)?;
        let follow = target.followed_body().map(str::to_owned);
        Ok(View { camera, follow, style })
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
fn margins(style: &Style, metrics: &DrawingMetrics) -> [f64; 2] {
    let [info, caption] = strip_heights(style, metrics);
    let [left, axis] = match style.shows(Overlay::Axes) {
        true => [(3.2 * metrics.font_size).round(), (1.6 * metrics.font_size).round()],
        false => [0.0, 0.0],
    };
    [left, info + caption + axis]
}

/// The style of a picture, the same for every frame of an animation.
#[derive(Clone, Debug, PartialEq)]
pub struct Style {
    /// The options that do not depend on the run.
    pub look: Look,
    /// The speed, m/s, at the end of the colour scale and of the longest velocity arrow.
    ///
    /// The maximum of the whole run rather than of the part that is drawn, so that parts drawn separately have the
    /// same scale. Faster bodies are drawn as if they had this speed.
    pub top_speed: f64,
    /// The force, N, of the longest force arrow; also of the whole run.
    pub top_force: f64,
    /// The impulse, N·s, of the longest impulse arrow; also of the whole run.
    pub top_impulse: f64,
    /// Number of bodies of the whole run; velocity and force arrows are shorter if there are many.
    pub body_count: u32,
    /// The format of simulated times, common to all frames.
    pub time_format: TimeFormat,
    /// The materials of the run in the order of the legend and of the palette colours.
    pub materials: Vec<String>,
}

impl Style {
    /// Returns true if `overlay` is shown.
    pub fn shows(&self, overlay: Overlay) -> bool {
        self.look.show.contains(overlay)
    }

    /// Returns true if the picture has a strip below the world for the clock, a scale bar or a legend.
    pub fn has_footer(&self) -> bool {
        self.shows(Overlay::Clock) || self.shows(Overlay::Scale) || self.look.color_by != ColorBy::Body
    }
}

impl Default for Style {
    /// The default look with arbitrary scales.
    fn default() -> Style {
        Style {
            look: Look::default(),
            top_speed: 10.0,
            top_force: 10.0,
            top_impulse: 10.0,
            body_count: 0,
            time_format: TimeFormat::default(),
            materials: Vec::new(),
        }
    }
}

/// The colours of a theme, with a font size and line width that suit the size of the picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DrawingMetrics {
    /// The colours of the theme.
    pub palette: Palette,
    /// Font size (height of the em), px.
    pub font_size: f64,
    /// Line width, px; a whole number.
    pub line_width: f64,
}

impl DrawingMetrics {
    /// The metrics of a picture of `size` pixels, in proportion to its shorter side; small pictures keep a legible
    /// font.
    pub fn new(theme: Theme, size: [u32; 2]) -> DrawingMetrics {
        let [width, height] = size.map(f64::from);
        let unit = smaller(width, height) / 720.0;
        DrawingMetrics {
            palette: Palette::of(theme),
            font_size: if unit < 0.6 { 12.0 } else { (21.0 * unit).round() },
            line_width: larger((2.0 * unit).round(), 1.0),
        }
    }
}
