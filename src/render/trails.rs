use super::Sprite;
use crate::physics::{BodyId, Vector};
use std::collections::{BTreeMap, VecDeque};

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
