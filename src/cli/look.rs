//! How a picture looks and what it says of itself: flags first, then the scene, then defaults.

use super::arguments::LookOptions;
use super::source::Survey;
use crate::render::{Metadata, Style};
use crate::scene::{ColorBy, FigureOptions, Overlay, Theme};

/// Width and height of a picture nobody gave a size, px.
const DEFAULT_SIZE: [u32; 2] = [1280, 720];

/// The key under which a picture says what it shows.
pub const STEPS: &str = "rebond steps";

/// Width and height, px.
pub fn size(options: &LookOptions, figure: &FigureOptions) -> [u32; 2] {
    options.size.or(figure.size).unwrap_or(DEFAULT_SIZE)
}

/// Theme, overlays and colours.
pub fn style(options: &LookOptions, figure: &FigureOptions, survey: &Survey) -> Style {
    let default = Style::default();
    let flag = options.show.as_ref().map(|show| show.0.clone());
    Style {
        theme: options.theme.or(figure.theme).unwrap_or(default.theme),
        show: flag.or(figure.show.clone()).unwrap_or(default.show),
        color_by: options.color_by.or(figure.color_by).unwrap_or(default.color_by),
        top_speed: survey.top_speed,
        materials: survey.materials.clone(),
    }
}

/// The identity of what is drawn, the steps, and every option that shapes the picture, in one
/// fixed form and order. A picture says neither when nor where nor by how many it was made.
///
/// `more` are options that not every picture has, each with a blank before it.
pub fn metadata(survey: &Survey, steps: String, style: &Style, size: [u32; 2], more: &str) -> Metadata {
    let mut show: Vec<Overlay> = style.show.clone();
    show.sort();
    show.dedup();
    let show: Vec<&str> = show.into_iter().map(Overlay::name).collect();
    let options = format!(
        "size={}x{} theme={} show={} color_by={}{more}",
        size[0],
        size[1],
        Theme::name(style.theme),
        if show.is_empty() { "none".into() } else { show.join(",") },
        ColorBy::name(style.color_by)
    );
    let entry = |key: &str, value: String| (key.to_owned(), value);
    let identity = survey.identity.clone().unwrap_or_else(|| "none, the recording is unfinished".into());
    Metadata {
        entries: vec![
            entry("Software", concat!("rebond ", env!("CARGO_PKG_VERSION")).into()),
            entry("rebond recording", identity),
            entry(STEPS, steps),
            entry("rebond options", options),
        ],
    }
}
