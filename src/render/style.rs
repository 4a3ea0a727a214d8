use crate::scene::{ColorBy, Overlay, Theme};

/// How pictures look; the same for every frame of a clip.
#[derive(Clone, Debug, PartialEq)]
pub struct Style {
    /// Light or dark.
    pub theme: Theme,
    /// What is drawn beside the boxes; order and repetition mean nothing.
    pub show: Vec<Overlay>,
    /// What the colour of a box tells.
    pub color_by: ColorBy,
    /// The speed, m/s, at the end of the colour scale and of the longest velocity arrow.
    ///
    /// Taken from the whole run, not from the part that is drawn, so that parts drawn apart
    /// fit together. Faster bodies are drawn as if they had this speed.
    pub top_speed: f64,
    /// The force, N, of the longest force arrow; of the whole run, too.
    pub top_force: f64,
    /// The impulse, N·s, of the longest impulse arrow; of the whole run, too.
    pub top_impulse: f64,
    /// How many bodies the run ever has: of many, velocities and forces are drawn shorter.
    pub crowd: u32,
    /// What is written below the picture; nothing if empty.
    pub caption: String,
    /// The materials of the run in the order of the legend; the palette is gone round by it.
    pub materials: Vec<String>,
}

impl Style {
    /// Whether that overlay is asked for.
    pub fn shows(&self, overlay: Overlay) -> bool {
        self.show.contains(&overlay)
    }

    /// Whether a strip below the world is kept free for the clock, a scale bar or a legend.
    pub fn has_footer(&self) -> bool {
        self.shows(Overlay::Clock) || self.shows(Overlay::Scale) || self.color_by != ColorBy::Body
    }
}

impl Default for Style {
    /// Light, names and clock, coloured by body.
    fn default() -> Style {
        Style {
            theme: Theme::Light,
            show: vec![Overlay::Name, Overlay::Clock],
            color_by: ColorBy::Body,
            top_speed: 10.0,
            top_force: 10.0,
            top_impulse: 10.0,
            crowd: 0,
            caption: String::new(),
            materials: Vec::new(),
        }
    }
}
