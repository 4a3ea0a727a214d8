use super::{
    diagnostics::Reported,
    tree::{Key, Node, Table},
};
use crate::picture_options::{ColorBy, Overlay, Overlays, PictureOptions, Theme};

/// The largest width and height of a picture, px.
const MAX_PIXELS: u64 = 8192;

const SIZE: Key = Key { name: "size", accepts: "width and height, px: two whole numbers from 1 to 8192" };
const THEME: Key = Key { name: "theme", accepts: "\"light\" or \"dark\"" };
const FPS: Key = Key { name: "fps", accepts: "a positive number of frames per second, at most 1000" };
const SHOW: Key = Key {
    name: "show",
    accepts: "a list of \"velocity\", \"force\", \"normal\", \"impulse\", \"penetration\", \"trail\", \"name\", \"mass\", \"grid\", \"axes\", \"scale\" and \"clock\", each at most once",
};
const COLOR_BY: Key = Key { name: "color_by", accepts: "\"body\", \"material\" or \"speed\"" };

/// The keys of `[figure]`.
pub(super) const KEYS: &[Key] = &[SIZE, THEME, FPS, SHOW, COLOR_BY];

/// Reads `[figure]`.
pub(super) fn read(table: &Table) -> Result<PictureOptions, Reported> {
    let size = table.optional(SIZE, |node| node.each(pixels));
    let theme = table.optional(THEME, |node| Theme::named(node.text()?).ok_or(node));
    let fps = table.optional(FPS, |node| node.number_where(|fps| 0.0 < fps && fps <= 1000.0));
    let show = table.optional(SHOW, overlays);
    let color_by = table.optional(COLOR_BY, |node| ColorBy::named(node.text()?).ok_or(node));
    Ok(PictureOptions {
        size: size?,
        theme: theme?,
        fps: fps?,
        show: show?,
        color_by: color_by?,
        ..PictureOptions::default()
    })
}

fn pixels(node: &Node) -> Result<u32, &Node> {
    node.count_in(1..=MAX_PIXELS).map(|count| count as u32)
}

fn overlays(node: &Node) -> Result<Overlays, &Node> {
    let mut overlays = Overlays::default();
    for node in node.nodes()? {
        let overlay = Overlay::named(node.text()?).ok_or(node)?;
        if !overlays.insert(overlay) {
            return Err(node);
        }
    }
    Ok(overlays)
}
