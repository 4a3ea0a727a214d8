use super::super::{Arrow, Frame, Sprite};
use super::bodies::visible_rect;
use super::velocities::{arrow_width, to_arrow};
use super::{LabeledArrow, LayoutContext};
use crate::scene::Overlay;

/// An arrow for the sum of weight and constant force, from the middle of each box. Contact forces are not part of a
/// recording.
pub fn arrows(frame: &Frame, context: &LayoutContext) -> Vec<LabeledArrow> {
    if !context.view.style.shows(Overlay::Force) {
        return Vec::new();
    }
    let sprites = frame.sprites.iter().filter(|sprite| !sprite.appearance.is_wall);
    sprites.filter_map(|sprite| arrow(sprite, context)).map(LabeledArrow::from).collect()
}

fn arrow(sprite: &Sprite, context: &LayoutContext) -> Option<Arrow> {
    let from = visible_rect(sprite, context)?.center();
    let to = from.add(to_arrow(sprite.appearance.force, context.view.style.top_force, context));
    Some(Arrow { from, to, width: arrow_width(context), color: context.metrics.palette.force })
}
