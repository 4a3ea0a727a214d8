use crate::scene::{ColorBy, Overlay, Theme};

/// The style of a picture, the same for every frame of an animation.
#[derive(Clone, Debug, PartialEq)]
pub struct Style {
    /// Light or dark.
    pub theme: Theme,
    /// The overlays drawn in addition to the boxes; order and repetition have no effect.
    pub show: Vec<Overlay>,
    /// The quantity that the colour of a box shows.
    pub color_by: ColorBy,
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
    /// Caption below the picture; none if empty.
    pub caption: String,
    /// The materials of the run in the order of the legend and of the palette colours.
    pub materials: Vec<String>,
}

impl Style {
    /// Returns true if `overlay` is shown.
    pub fn shows(&self, overlay: Overlay) -> bool {
        self.show.contains(&overlay)
    }

    /// Returns true if the picture has a strip below the world for the clock, a scale bar or a legend.
    pub fn has_footer(&self) -> bool {
        self.shows(Overlay::Clock) || self.shows(Overlay::Scale) || self.color_by != ColorBy::Body
    }
}

impl Default for Style {
    /// The light theme with names and clock, coloured by body.
    fn default() -> Style {
        Style {
            theme: Theme::Light,
            show: vec![Overlay::Name, Overlay::Clock],
            color_by: ColorBy::Body,
            top_speed: 10.0,
            top_force: 10.0,
            top_impulse: 10.0,
            body_count: 0,
            caption: String::new(),
            materials: Vec::new(),
        }
    }
}
