use super::EventDriven;
use super::body_state::Slot;
use super::double_double::DoubleDouble;
use super::instant::Instant;
use crate::physics::{Axis, Collision, Rect, Side, Vector};

/// An impact as it is reported: the same numbers, whichever way it was computed.
///
/// The bodies are in creation order, the velocities along the axis begin with that of the body on the low side.
pub struct ImpactRecord {
    pub slots: [Slot; 2],
    pub axis: Axis,
    /// The side of the first body on which the second lies.
    pub side: Side,
    pub at: Instant,
    /// Positions and sizes, m.
    pub rects: [Rect; 2],
    /// Velocities before and after, m/s.
    pub velocities: [[Vector; 2]; 2],
    /// Velocities along the axis before and after, m/s.
    pub along: [[DoubleDouble; 2]; 2],
    /// N·s.
    pub impulse: f64,
    pub restitution: f64,
}

impl EventDriven {
    /// The collision for the observer.
    pub(super) fn collision(&self, impact: ImpactRecord) -> Collision {
        let ImpactRecord { slots, axis, side, at, rects, velocities, along, impulse, restitution } = impact;
        let [before, after] = velocities;
        Collision {
            step: self.timeline.step(),
            time: self.timeline.step_start().seconds_until(at).clamp(0.0, self.timeline.clock().period),
            instant: at.high,
            axis,
            bodies: slots.map(|slot| self.bodies.params(slot).id),
            rects,
            // The impulse pushes the first away from the second.
            normal: Vector::along(axis, -side.sign()),
            penetration: Vector::ZERO,
            shares: [0.0; 2],
            impulse,
            restitution,
            normal_velocity: along.map(|[low, high]| (high - low).high),
            before,
            after,
        }
    }
}
