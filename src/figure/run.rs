use super::FigureOptions;
use crate::physics::{BodyId, Collision, Vector};
use crate::render::area::overlap;
use crate::render::layers::legend::{Entry, Legend};
use crate::render::{Aim, Appearance, Frame, Sprite, palette};
use crate::scene::ColorBy;
use std::collections::BTreeMap;
use std::sync::Arc;

/// What of one recording a figure shows; figures of several show them side by side.
#[derive(Clone, Debug, PartialEq)]
pub struct Run {
    /// What is written above it, if there are several.
    pub title: String,
    /// Width and height of its world, m.
    pub world: Vector,
    /// The instants shown, in order.
    pub frames: Vec<Frame>,
}

/// A collision and what its two bodies look like.
#[derive(Clone, Debug, PartialEq)]
pub struct Meeting {
    /// What is written above it, if there are several.
    pub title: String,
    /// As an observer saw it.
    pub collision: Collision,
    /// Its bodies c and b.
    pub bodies: [Arc<Appearance>; 2],
}

/// More bodies than that are not told by a legend.
const MOST_IN_LEGEND: usize = 12;

/// The one legend of all panels: what colours mean or, where each body has its own and there are
/// several panels, whose they are that are seen.
pub fn legend(runs: &[Run], FigureOptions { aim, style, .. }: &FigureOptions) -> Legend {
    if style.color_by != ColorBy::Body || runs.len() < 2 {
        return Legend::of(style);
    }
    let mut bodies: BTreeMap<(BodyId, &str), Entry> = BTreeMap::new();
    for sprite in runs.iter().flat_map(|run| &run.frames).flat_map(|frame| &frame.sprites) {
        let body = &*sprite.appearance;
        if !body.is_wall && is_seen(sprite, aim) {
            let entry = || Entry::new(palette::body_color(sprite, style), &body.name);
            bodies.entry((body.id, &body.name)).or_insert_with(entry);
        }
    }
    let entries: Vec<Entry> = if bodies.len() > MOST_IN_LEGEND { Vec::new() } else { bodies.into_values().collect() };
    Legend { entries }
}

/// Whether a body is in the part of the plane that a camera is aimed at.
fn is_seen(sprite: &Sprite, aim: &Aim) -> bool {
    match aim {
        Aim::World | Aim::Follow { .. } => true,
        Aim::Window(area) => overlap(&sprite.rect, area).is_some(),
    }
}
