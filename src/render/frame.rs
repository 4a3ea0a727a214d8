use super::Color;
use crate::physics::{BodyId, Collision, Rect, Vector};
use std::sync::Arc;

/// The state of the world at one instant, as drawn.
#[derive(Clone, Debug, PartialEq)]
pub struct Frame {
    /// The step of the state.
    pub step: u64,
    /// Simulated time, s.
    pub time: f64,
    /// The living bodies in creation order; later ones are drawn over earlier ones.
    pub sprites: Vec<Sprite>,
    /// The collisions of the step that led to this state, for the overlays that show them; may be empty.
    pub collisions: Vec<Collision>,
}

/// A body as drawn in one frame (the handout's class `Sprite`).
#[derive(Clone, Debug, PartialEq)]
pub struct Sprite {
    /// The constant part of its appearance.
    pub appearance: Arc<Appearance>,
    /// Position and size, m.
    pub rect: Rect,
    /// Velocity, m/s.
    pub velocity: Vector,
    /// Earlier positions of its center, m, oldest first; see [`super::Trails`]. Empty for no trail.
    pub trail: Vec<Vector>,
}

/// The constant attributes of a body, shared by all its frames.
#[derive(Clone, Debug, PartialEq)]
pub struct Appearance {
    /// Its number, which also selects its colour in the palette.
    pub id: BodyId,
    /// Its name, shown as a label.
    pub name: String,
    /// Its material; empty for the default material.
    pub material: String,
    /// The colour that its scene assigns, if any.
    pub color: Option<Color>,
    /// Mass, kg; infinite for a static body.
    pub mass: f64,
    /// Sum of its weight and the constant force on it, N; zero for a static body.
    pub force: Vector,
    /// True for the scene's four walls, which are drawn as the border of the picture.
    pub is_wall: bool,
}
