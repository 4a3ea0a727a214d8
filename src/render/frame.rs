use super::Color;
use crate::physics::{BodyId, Collision, Rect, Vector};
use std::sync::Arc;

/// One instant to be drawn.
#[derive(Clone, Debug, PartialEq)]
pub struct Frame {
    /// The step whose state this is.
    pub step: u64,
    /// Simulated time, s.
    pub time: f64,
    /// The bodies alive, in creation order: later ones are drawn over earlier ones.
    pub sprites: Vec<Sprite>,
    /// The collisions of the step that led here, for the overlays that show them; may be empty.
    pub collisions: Vec<Collision>,
}

/// The handout's Sprite: a body and how it looks.
#[derive(Clone, Debug, PartialEq)]
pub struct Sprite {
    /// What of its looks never changes.
    pub appearance: Arc<Appearance>,
    /// Where it is, m.
    pub rect: Rect,
    /// m/s.
    pub velocity: Vector,
    /// Where its middle was before, m, oldest first; see [`super::Trails`]. Empty for no trail.
    pub trail: Vec<Vector>,
}

/// The looks of one body, shared by all frames it is in.
#[derive(Clone, Debug, PartialEq)]
pub struct Appearance {
    /// Its number; colours go round the palette by it.
    pub id: BodyId,
    /// What is written on it.
    pub name: String,
    /// What it is made of; empty for nothing in particular.
    pub material: String,
    /// The colour its scene asks for.
    pub color: Option<Color>,
    /// kg; infinity for what is never pushed.
    pub mass: f64,
    /// The constant force on it and its weight together, N; null for an infinite mass.
    pub force: Vector,
    /// Whether it is one of the scene's four walls, drawn as the border of the picture.
    pub is_wall: bool,
}
