use super::super::{Arrow, Frame, Shape, Sprite};
use super::Page;
use super::bodies::seen;
use crate::physics::Vector;
use crate::scene::Overlay;

/// An arrow for each velocity, from the middle of its box.
pub fn draw(frame: &Frame, page: &Page, shapes: &mut Vec<Shape>) {
    if !page.view.style.shows(Overlay::Velocity) {
        return;
    }
    for sprite in frame.sprites.iter().filter(|sprite| !sprite.appearance.is_wall) {
        let Some(rect) = seen(sprite, page) else { continue };
        let from = rect.center();
        let to = from.add(length(sprite, page));
        Arrow { from, to, width: page.look.line, color: page.look.palette.ink }.draw(&page.look, shapes);
    }
}

/// The longest arrow, for the style's top speed, in texts' heights.
const LONGEST: f64 = 5.0;

fn length(sprite: &Sprite, page: &Page) -> Vector {
    let speed = sprite.velocity.norm();
    let top = page.view.style.top_speed;
    let slowed = if speed > top { sprite.velocity.mult(top / speed) } else { sprite.velocity };
    slowed.mult(LONGEST * page.look.text / top)
}
