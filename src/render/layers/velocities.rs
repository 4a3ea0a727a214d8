use super::super::{Arrow, Frame, Sprite};
use super::bodies::seen;
use super::{NamedArrow, Page};
use crate::physics::Vector;
use crate::scene::Overlay;

/// An arrow for each velocity, from the middle of its box.
pub fn arrows(frame: &Frame, page: &Page) -> Vec<NamedArrow> {
    if !page.view.style.shows(Overlay::Velocity) {
        return Vec::new();
    }
    let sprites = frame.sprites.iter().filter(|sprite| !sprite.appearance.is_wall);
    sprites.filter_map(|sprite| arrow(sprite, page)).map(NamedArrow::from).collect()
}

fn arrow(sprite: &Sprite, page: &Page) -> Option<Arrow> {
    let from = seen(sprite, page)?.center();
    let to = from.add(length(sprite.velocity, page.view.style.top_speed, page));
    Some(Arrow { from, to, width: width(page), color: page.look.palette.ink })
}

/// The thickness of arrows, px, thinner in a crowd.
pub fn width(page: &Page) -> f64 {
    let is_crowd = f64::from(page.view.style.crowd) > CROWD;
    if is_crowd { (page.look.line / 2.0).ceil() } else { page.look.line }
}

/// The longest arrow in texts' heights.
const LONGEST: f64 = 5.0;

/// From so many bodies on arrows are shorter, so that each has about the same room.
const CROWD: f64 = 40.0;

/// A vector as an arrow, px: one of length `top` is as long as any is drawn.
pub fn length(vector: Vector, top: f64, page: &Page) -> Vector {
    let size = vector.norm();
    let shortened = if size > top { vector.mult(top / size) } else { vector };
    let crowd = f64::from(page.view.style.crowd);
    let part = if crowd > CROWD { (CROWD / crowd).sqrt() } else { 1.0 };
    shortened.mult(part * LONGEST * page.look.text / top)
}
