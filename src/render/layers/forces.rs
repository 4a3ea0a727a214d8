use super::super::{Arrow, Frame, Sprite};
use super::bodies::seen;
use super::velocities::{length, width};
use super::{NamedArrow, Page};
use crate::scene::Overlay;

/// An arrow for weight and constant force together, from the middle of each box. What contacts
/// do to it is not known to any recording.
pub fn arrows(frame: &Frame, page: &Page) -> Vec<NamedArrow> {
    if !page.view.style.shows(Overlay::Force) {
        return Vec::new();
    }
    let sprites = frame.sprites.iter().filter(|sprite| !sprite.appearance.is_wall);
    sprites.filter_map(|sprite| arrow(sprite, page)).map(NamedArrow::from).collect()
}

fn arrow(sprite: &Sprite, page: &Page) -> Option<Arrow> {
    let from = seen(sprite, page)?.center();
    let to = from.add(length(sprite.appearance.force, page.view.style.top_force, page));
    Some(Arrow { from, to, width: width(page), color: page.look.palette.force })
}
