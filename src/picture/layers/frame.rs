use crate::physics::{BodyId, Collision, Rect, Spawn, Vector};
use crate::picture::{Bitmap, Color};
use crate::recording::BodyInfo;
use crate::scene::Walls;
use std::collections::{BTreeMap, VecDeque};
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
    /// The collisions since the previous frame, for the overlays that show them; may be empty.
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
    /// Earlier positions of its centre, m, oldest first; see [`crate::picture::Trails`]. Empty for no trail.
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
    /// The image that is drawn into its box, if any.
    pub image: Option<Arc<Bitmap>>,
    /// Mass, kg; infinite for a static body.
    pub mass: f64,
    /// Sum of its weight and the constant force on it, N; zero for a static body.
    pub force: Vector,
    /// True for the scene's four walls, which are drawn as the border of the picture.
    pub is_wall: bool,
}

impl Appearance {
    /// Returns the appearance of a body, without its image.
    pub fn new(info: &BodyInfo, gravity: Option<Vector>) -> Appearance {
        let BodyInfo { id, spawn, paint } = info;
        Appearance {
            id: *id,
            name: spawn.name.clone(),
            material: spawn.material.clone(),
            color: paint.color(),
            image: None,
            mass: spawn.mass,
            force: force(spawn, gravity),
            is_wall: paint.is_empty() && Walls::is_wall(*id, spawn),
        }
    }

    /// The momentum at a velocity, kg·m/s; zero for an infinite mass, which has none.
    pub fn momentum(&self, velocity: Vector) -> Vector {
        if self.mass == f64::INFINITY { Vector::ZERO } else { velocity.mult(self.mass) }
    }
}

/// The sum of weight and constant force, N; zero for an infinite mass.
pub fn force(spawn: &Spawn, gravity: Option<Vector>) -> Vector {
    if spawn.mass == f64::INFINITY {
        return Vector::ZERO;
    }
    gravity.map_or(Vector::ZERO, |gravity| gravity.mult(spawn.mass)).add(spawn.force)
}

/// The recent positions of bodies, from which frames take their trails.
///
/// Positions older than the trail length are dropped. Memory therefore does not grow with the run, and a frame does not
/// depend on where an animation begins if the states of one trail length before it have been added.
#[derive(Clone, Debug)]
pub struct Trails {
    steps: u64,
    positions: BTreeMap<BodyId, VecDeque<(u64, Vector)>>,
}

impl Trails {
    /// Creates trails that cover the last `steps` steps.
    pub fn new(steps: u64) -> Trails {
        Trails { steps, positions: BTreeMap::new() }
    }

    /// Creates trails that cover the steps of one second, at `rate` Hz.
    pub fn of_one_second(rate: f64) -> Trails {
        Trails::new(rate.ceil() as u64)
    }

    /// The number of steps that a trail covers.
    pub fn steps(&self) -> u64 {
        self.steps
    }

    /// Forgets all positions, because states are missing: no trail leads across a gap.
    pub fn interrupt(&mut self) {
        self.positions.clear();
    }

    /// Adds the positions of `sprites` at `step` and sets the trail of each sprite.
    ///
    /// Steps must not decrease from call to call. Bodies missing from `sprites` lose their trail.
    pub fn update(&mut self, step: u64, sprites: &mut [Sprite]) {
        let mut positions = BTreeMap::new();
        for sprite in sprites {
            let id = sprite.appearance.id;
            let mut trail = self.positions.remove(&id).unwrap_or_default();
            trail.push_back((step, sprite.rect.center()));
            while trail.front().is_some_and(|&(recorded, _)| recorded + self.steps < step) {
                trail.pop_front();
            }
            sprite.trail = trail.iter().map(|&(_, position)| position).collect();
            positions.insert(id, trail);
        }
        self.positions = positions;
    }
}
