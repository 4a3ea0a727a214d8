use crate::physics::{Rect, Vector, larger, smaller};
use crate::picture::layers::LayoutContext;
use crate::picture::layers::footer::Footer;
use crate::picture::layers::grid::axis_margin;
use crate::picture::layers::lanes::Lanes;
use crate::picture::number::TimeFormat;
use crate::picture::raster::MAX_COORDINATE;
use crate::picture::raster::color::Palette;
use crate::picture::{CameraTarget, ColorBy, Frame, Language, Look, Overlay, RenderError, Theme, TraceGap};
use crate::picture_options::MAX_SIDE;

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
    /// Returns an error if a side of the picture is 0 or more than 16384 pixels, if the picture is too small for the
    /// text around the world, or if width and height of the visible part are not finite and positive.
    pub fn new(world: Vector, style: Style) -> Result<View, RenderError> {
        let Look { size, camera_target: target, .. } = &style.look.clone();
        validate_size(*size)?;
        let fits = |size: [u32; 2]| viewport(&Style { look: Look { size, ..style.look.clone() }, ..style.clone() });
        let Some(viewport) = fits(*size) else {
            return Err(RenderError::too_small(*size, |size| fits(size).is_some()));
        };
        let camera = Camera::new(world, target, *size, viewport)?;
        let follow = target.followed_body().map(str::to_owned);
        let mut view = View { camera, follow, style };
        if view.style.shows(Overlay::Axes) {
            // Long numbers beside the vertical axis take space from the world, but not most of it.
            let wider = axis_margin(&LayoutContext::new(&view, camera)) - viewport.origin.x;
            if wider > 0.0 && wider < viewport.width() / 2.0 {
                let origin = Vector::new(viewport.origin.x + wider, viewport.origin.y);
                let narrower = Rect::new(origin, viewport.width() - wider, viewport.height());
                view.camera = Camera::new(world, target, *size, narrower)?;
            }
        }
        Ok(view)
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

/// The part of the picture for the world, px: without footer and axes. `None` if these leave too little of it.
fn viewport(style: &Style) -> Option<Rect> {
    let [width, height] = style.look.size.map(f64::from);
    let metrics = DrawingMetrics::new(style.look.theme, style.look.language, style.look.size);
    let footer = Footer::new(style, &metrics);
    let [info, caption] = footer.heights(style);
    let [left, axis] = if style.shows(Overlay::Axes) {
        [(3.2 * metrics.font_size).round(), (1.6 * metrics.font_size).round()]
    } else {
        [0.0, 0.0]
    };
    let viewport = Rect::new(Vector::new(left, 0.0), width - left, height - info - caption - axis);
    let has_text = left > 0.0 || info + caption > 0.0;
    let is_visible = !has_text || viewport.width() >= MIN_WORLD && viewport.height() >= MIN_WORLD;
    (is_visible && footer.is_legible()).then_some(viewport)
}

/// The smallest width and height of the world in a picture with text around it, px.
const MIN_WORLD: f64 = 16.0;

/// The style of a picture, the same for every frame of an animation.
#[derive(Clone, Debug, PartialEq)]
pub struct Style {
    /// The options that do not depend on the run.
    pub look: Look,
    /// The speed, m/s, of the longest velocity arrow, and at the end of the colour scale unless `color_speed` is.
    ///
    /// The maximum of the whole run rather than of the part that is drawn, so that parts drawn separately have the
    /// same scale. Faster bodies, between two states, have the colour of this speed and longer arrows.
    pub top_speed: f64,
    /// The speed, m/s, at the end of the colour scale if few bodies are much faster than all others; these have the
    /// colour of this speed.
    pub color_speed: Option<f64>,
    /// The momentum, kg·m/s, of the longest momentum arrow; also of the whole run.
    pub top_momentum: f64,
    /// The force, N, of the longest force arrow; also of the whole run.
    pub top_force: f64,
    /// The impulse, N·s, of the longest impulse arrow; also of the whole run.
    pub top_impulse: f64,
    /// Number of bodies of the whole run; arrows of bodies are shorter if there are many.
    pub body_count: u32,
    /// The format of simulated times, common to all frames.
    pub time_format: TimeFormat,
    /// The materials of the run in the order of the legend and of the palette colours.
    pub materials: Vec<String>,
    /// The parts between the first and the last instant that the recording lacks.
    pub gaps: Vec<TraceGap>,
    /// The lanes of the arrows of bodies, common to all frames of a clip. Without any, each frame has its own.
    pub lanes: Lanes,
}

impl Style {
    /// Returns true if `overlay` is shown.
    pub fn shows(&self, overlay: Overlay) -> bool {
        self.look.show.contains(overlay)
    }

    /// Returns true if the picture has a strip below the world for the clock, a scale bar or a legend, which
    /// explains colours and arrows.
    pub fn has_footer(&self) -> bool {
        let marks = [Overlay::Velocity, Overlay::Momentum, Overlay::Force, Overlay::Impulse, Overlay::Com];
        let has_strip = |overlay| self.shows(overlay);
        [Overlay::Clock, Overlay::Scale].into_iter().chain(marks).any(has_strip)
            || self.look.color_by != ColorBy::Body
            || !self.gaps.is_empty()
    }
}

impl Default for Style {
    /// The default look with arbitrary scales.
    fn default() -> Style {
        Style {
            look: Look::default(),
            top_speed: 10.0,
            color_speed: None,
            top_momentum: 10.0,
            top_force: 10.0,
            top_impulse: 10.0,
            body_count: 0,
            time_format: TimeFormat::default(),
            materials: Vec::new(),
            gaps: Vec::new(),
            lanes: Lanes::default(),
        }
    }
}

/// The colours of a theme, with a font size and line width that suit the size of the picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DrawingMetrics {
    /// The theme.
    pub theme: Theme,
    /// The language of words and numbers.
    pub language: Language,
    /// The colours of the theme.
    pub palette: Palette,
    /// Font size (height of the em), px.
    pub font_size: f64,
    /// Line width, px; a whole number.
    pub line_width: f64,
    /// Length of the arrow of the largest vector, px, if there are few bodies.
    pub arrow_length: f64,
}

impl DrawingMetrics {
    /// The metrics of a picture of `size` pixels, in proportion to its shorter side; small pictures keep a legible
    /// font.
    pub fn new(theme: Theme, language: Language, size: [u32; 2]) -> DrawingMetrics {
        let [width, height] = size.map(f64::from);
        let shorter = smaller(width, height);
        let unit = shorter / 720.0;
        // Thumbnails have the smallest legible font.
        let small = (shorter / 16.0).floor().clamp(MIN_TEXT, 12.0);
        let font_size = if unit < 0.6 { small } else { (21.0 * unit).round() };
        DrawingMetrics {
            theme,
            language,
            palette: Palette::of(theme),
            font_size,
            line_width: larger((2.0 * unit).round(), 1.0),
            arrow_length: 5.0 * font_size,
        }
    }

    /// The metrics with another font size, px, and lines and arrows in proportion.
    pub fn with_font_size(self, font_size: f64) -> DrawingMetrics {
        let part = font_size / self.font_size;
        let (line_width, arrow_length) = (larger((self.line_width * part).round(), 1.0), self.arrow_length * part);
        DrawingMetrics { font_size, line_width, arrow_length, ..self }
    }

    /// A font size relative to that of the picture, px, but never one that is illegible.
    pub fn text(&self, part: f64) -> f64 {
        larger(part * self.font_size, MIN_TEXT)
    }
}

/// The smallest font size of a label, px. Sub- and superscripts are smaller.
pub const MIN_TEXT: f64 = 8.0;

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

fn round_to_quarter(at: f64) -> f64 {
    (at * 4.0).round().clamp(-MAX_COORDINATE, MAX_COORDINATE) / 4.0
}

/// Returns an error for a page without pixels or with a side longer than any picture's.
pub fn validate_size(size: [u32; 2]) -> Result<(), RenderError> {
    if size.iter().any(|&side| side == 0 || side > MAX_SIDE) {
        Err(RenderError::PictureSize { width: size[0], height: size[1], max_side: MAX_SIDE })
    } else {
        Ok(())
    }
}

/// Returns an error for an area that is not finite and positive, or for a page of an invalid size.
pub fn validate(area: &Rect, size: [u32; 2]) -> Result<(), RenderError> {
    validate_size(size)?;
    let (width, height) = (area.width(), area.height());
    if !(area.origin.is_finite() && width.is_finite() && height.is_finite()) || width <= 0.0 || height <= 0.0 {
        return Err(RenderError::WorldSize { width, height });
    }
    Ok(())
}
