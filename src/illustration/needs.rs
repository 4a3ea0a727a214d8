use crate::render::Timeline;
use crate::scene::Overlay;

/// What frames need beside the recorded states.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Needs {
    /// Where bodies were.
    pub trails: bool,
    /// What a replay tells: collisions, or what is between two states.
    pub replay: bool,
}

impl Needs {
    /// What these overlays need on a timeline.
    pub fn of(show: &[Overlay], timeline: &Timeline) -> Needs {
        let contacts = [Overlay::Normal, Overlay::Impulse, Overlay::Penetration];
        Needs {
            trails: show.contains(&Overlay::Trail),
            replay: contacts.iter().any(|overlay| show.contains(overlay)) || !timeline.is_plain(),
        }
    }
}

/// A trail shows the last second: so many steps.
pub fn trail_steps(rate: f64) -> u64 {
    rate.ceil() as u64
}
