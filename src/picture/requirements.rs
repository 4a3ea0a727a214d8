use crate::render::AnimationSchedule;
use crate::scene::Overlay;

/// The data that frames need in addition to the recorded states.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Requirements {
    /// Previous positions of the bodies.
    pub trails: bool,
    /// A replay, for collisions or for instants between two recorded states.
    pub replay: bool,
}

impl Requirements {
    /// The requirements of the overlays in `show` and of the instants of `schedule`.
    pub fn new(show: &[Overlay], schedule: &AnimationSchedule) -> Requirements {
        let contacts = [Overlay::Normal, Overlay::Impulse, Overlay::Penetration];
        Requirements {
            trails: show.contains(&Overlay::Trail),
            replay: contacts.iter().any(|overlay| show.contains(overlay)) || !schedule.is_on_grid(),
        }
    }
}

/// The length of a trail: the steps of one second, at `rate` Hz.
pub fn trail_steps(rate: f64) -> u64 {
    rate.ceil() as u64
}
