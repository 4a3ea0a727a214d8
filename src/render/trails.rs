use super::Sprite;
use crate::physics::{BodyId, Vector};
use std::collections::{BTreeMap, VecDeque};

/// Remembers where bodies were, so that a frame can show it.
///
/// It forgets what is older than its length: memory does not grow with the run, and a frame
/// is the same wherever a clip begins, as long as that many states before it were seen.
#[derive(Clone, Debug)]
pub struct Trails {
    steps: u64,
    places: BTreeMap<BodyId, VecDeque<(u64, Vector)>>,
}

impl Trails {
    /// Trails of the last `steps` steps.
    pub fn new(steps: u64) -> Trails {
        Trails { steps, places: BTreeMap::new() }
    }

    /// Gives each sprite the trail it has at `step`, and remembers where it is now.
    ///
    /// States are to be shown in order; bodies that are not among them are forgotten.
    pub fn follow(&mut self, step: u64, sprites: &mut [Sprite]) {
        let mut places = BTreeMap::new();
        for sprite in sprites {
            let id = sprite.appearance.id;
            let mut trail = self.places.remove(&id).unwrap_or_default();
            trail.push_back((step, sprite.rect.center()));
            while trail.front().is_some_and(|&(seen, _)| seen + self.steps < step) {
                trail.pop_front();
            }
            sprite.trail = trail.iter().map(|&(_, place)| place).collect();
            places.insert(id, trail);
        }
        self.places = places;
    }
}
