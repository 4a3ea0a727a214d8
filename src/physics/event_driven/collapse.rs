//! Inelastic collapse: an infinite sequence of impacts in one instant is replaced by its limit. The sequence is
//! recognised in one of two ways:
//!
//! - **Decay**: the next approach is slower than [`DECAYED`] of the greatest of the burst, or than [`UNDECIDED`] times
//!   the rounding of the velocities. The errors of the velocities in a burst are proportional to its greatest approach
//!   speed, so slower approaches are rounding errors. The second condition is for a burst that is slow in a fast frame
//!   of reference: its approach speeds become 0 by rounding before they are below the first bound.
//! - **Cycle** (`impact_history`): three periods hit the same pairs and scale their relative velocities by the same
//!   factor below 1. Impacts are linear, so all further periods are scaled copies.
//!
//! If a body outside is approached in the limit of a cycle, the limit cannot be taken yet. Then a number of periods is
//! skipped: the velocities relative to the limit are multiplied by that power of the factor.

use super::EventDriven;
use super::burst::Cluster;
use super::double_double::DoubleDouble;
use super::exact::VELOCITY_ROUNDING;
use super::impact::Impact;
use super::impact_history::{Cycle, Decay};
use super::patch::{Local, LocalBody, Patch, Touch, TouchKind};
use crate::physics::{Axis, Side, StepError, World, larger, smaller};

/// Approaches below this fraction of the greatest of a burst are rounding errors.
const DECAYED: f64 = 1.0 / (1_u128 << 80) as f64;

/// Approaches below this multiple of the rounding of velocities may be rounding errors.
const UNDECIDED: f64 = 256.0;

/// A bound of the relative rounding of the speeds that are computed for a period: cycles are proven only from speeds
/// that are 2³⁰ times the rounding of velocities.
const PERIOD_ROUNDING: f64 = 1.0 / (1_u64 << 26) as f64;

/// Bodies that take on one velocity, and the touches that become contacts.
#[derive(Clone, Debug, Default)]
struct Collapse {
    /// Bodies of finite mass.
    members: Vec<Local>,
    touches: Vec<u32>,
    /// The velocity of an infinite mass among them.
    wall_velocity: Option<DoubleDouble>,
}

/// A body outside that is approached at the common velocity of a collapse.
struct Outsider {
    touch: u32,
    /// The member that it touches, as an index.
    member: usize,
    /// The side of the member on which it lies.
    side: Side,
    /// The speed at which it is approached, m/s.
    speed: f64,
}

impl Outsider {
    /// The factor by which the velocities relative to the limit have shrunk when it can be hit for the first time; 1 if
    /// that is in the next period.
    ///
    /// A member moves away from it as long as its own speed away from that side, relative to the limit, exceeds the
    /// approach in the limit. `least_speeds` are the least of these speeds in the next period, by member and side.
    fn factor_when_hit(&self, least_speeds: &[[f64; 2]]) -> f64 {
        let away = least_speeds[self.member][self.side];
        if away > self.speed { smaller(self.speed / away * (1.0 + PERIOD_ROUNDING), 1.0) } else { 1.0 }
    }
}

impl EventDriven {
    /// Replaces an approach that has decayed by its limit: the bodies connected with it by faces whose relative
    /// speed is as small move on as one. Returns false if none of these pairs loses energy.
    pub(super) fn take_decayed_limit(
        &mut self,
        patch: &mut Patch,
        index: u32,
        axis: Axis,
        threshold: f64,
        world: &World,
    ) -> bool {
        let touch = patch.touches[index as usize];
        let mut collapse = Collapse { touches: vec![index], ..Collapse::default() };
        touch.bodies.into_iter().for_each(|body| self.join_collapse(patch, body, axis, &mut collapse));
        let mut next = 0;
        while let Some(body) = collapse.members.get(next).copied() {
            next += 1;
            self.explore(patch, body);
            for place in 0..patch.bodies[body as usize].touches.len() {
                let index = patch.bodies[body as usize].touches[place];
                let touch = patch.touches[index as usize];
                let is_slow = patch.approach_speed(&touch, axis).high.abs() <= threshold;
                if touch.kind == TouchKind::Face(axis) && is_slow {
                    collapse.touches.push(index);
                    self.join_collapse(patch, touch.other(body), axis, &mut collapse);
                }
            }
        }
        collapse.touches.sort_unstable();
        collapse.touches.dedup();
        let is_lossy = |touch: &u32| self.restitution(patch, &patch.touches[*touch as usize], world).high < 1.0;
        if !collapse.touches.iter().any(is_lossy) {
            return false;
        }
        self.unify(patch, &collapse, axis);
        true
    }

    /// Adds a body to a collapse. An infinite mass, or a body that rests on one, only gives its velocity.
    fn join_collapse(&self, patch: &Patch, body: Local, axis: Axis, collapse: &mut Collapse) {
        let slot = patch.bodies[body as usize].slot;
        if Side::BOTH.into_iter().any(|side| self.contacts.is_immovable(slot, axis, side)) {
            collapse.wall_velocity = collapse.wall_velocity.or(Some(patch.axis(body, axis).state.velocity));
        } else if !collapse.members.contains(&body) {
            collapse.members.push(body);
        }
    }

    /// Gives the members of a collapse one velocity, that of its infinite mass or of its total momentum, and makes
    /// its touches contacts.
    fn unify(&mut self, patch: &mut Patch, collapse: &Collapse, axis: Axis) {
        let velocity = collapse.wall_velocity.unwrap_or_else(|| self.common_velocity(patch, &collapse.members, axis));
        self.change_velocities(patch, &collapse.members, axis, |_| velocity);
        for index in &collapse.touches {
            let touch = patch.touches[*index as usize];
            if !self.is_contact(patch, &touch, axis) {
                self.add_contact(patch, &touch, axis);
            }
        }
    }

    /// Replaces the velocity (m/s) of each member along an axis by a function of it.
    fn change_velocities(
        &mut self,
        patch: &mut Patch,
        members: &[Local],
        axis: Axis,
        velocity_after: impl Fn(DoubleDouble) -> DoubleDouble,
    ) {
        for body in members {
            let state = patch.axis_mut(*body, axis);
            state.state.velocity = velocity_after(state.state.velocity);
            state.magnitudes.velocity = larger(state.state.velocity.high.abs(), state.magnitudes.velocity);
            patch.mark_changed(*body, axis);
        }
        self.velocities_changed(patch, members, axis);
    }

    /// Total momentum divided by total mass, m/s; computed as the velocity of the first member plus the mean
    /// difference from it, in creation order.
    fn common_velocity(&self, patch: &Patch, members: &[Local], axis: Axis) -> DoubleDouble {
        let mut members = members.to_vec();
        members.sort_unstable_by_key(|body| patch.bodies[*body as usize].slot);
        let first = patch.axis(members[0], axis).state.velocity;
        let mut excess = DoubleDouble::ZERO;
        for body in &members {
            let difference = patch.axis(*body, axis).state.velocity - first;
            let mass = self.bodies.params(patch.bodies[*body as usize].slot).mass;
            excess = excess + difference * mass;
        }
        first + excess / self.total_mass(patch, &members)
    }

    /// Records an impact and its approach speed (m/s) in the history of its component; takes the limit of a cycle that
    /// decays, and fails on one that does not.
    pub(super) fn follow_cycle(
        &mut self,
        patch: &mut Patch,
        index: u32,
        speed: f64,
        axis: Axis,
        world: &World,
    ) -> Result<(), StepError> {
        let root = patch.root_of_touch(&patch.touches[index as usize]) as usize;
        let greatest = patch.bursts[root].greatest;
        let mut bursts = std::mem::take(&mut patch.bursts);
        let approach_speed = |touch: u32| patch.approach_speed(&patch.touches[touch as usize], axis);
        let rounding = |touch: u32| {
            let [first, second] =
                patch.touches[touch as usize].bodies.map(|body| patch.axis(body, axis).magnitudes.velocity);
            (first + second) * VELOCITY_ROUNDING
        };
        let cycle = bursts[root].histories[axis].push(index, speed, greatest, approach_speed, rounding);
        patch.bursts = bursts;
        match cycle {
            None => Ok(()),
            Some((Cycle::Decays(decay), touches)) => {
                self.take_cycle_limit(patch, touches, &decay, axis, world);
                Ok(())
            }
            Some((Cycle::Persists, _)) => {
                // Infinite masses that approach each other make up for the losses. One of them can act through
                // contacts.
                let mut body = 0;
                while body < patch.present().len() {
                    self.explore(patch, body as Local);
                    body += 1;
                }
                self.check_squeezed(patch, world)?;
                let pair = patch.touches[index as usize].bodies.map(|body| patch.bodies[body as usize].slot);
                Err(self.endless_error(world, pair))
            }
        }
    }

    /// Takes the limit of a decaying cycle. If a body outside is approached in the limit, the burst goes on, without
    /// the periods in which that body cannot be hit.
    fn take_cycle_limit(&mut self, patch: &mut Patch, touches: Vec<u32>, decay: &Decay, axis: Axis, world: &World) {
        let Some(collapse) = self.collapse_of_cycle(patch, touches, axis) else { return };
        let velocity = collapse.wall_velocity.unwrap_or_else(|| self.common_velocity(patch, &collapse.members, axis));
        let root = patch.root(collapse.members[0]) as usize;
        let outsiders = approached_outsiders(patch, &collapse, axis, velocity);
        if outsiders.is_empty() {
            self.unify(patch, &collapse, axis);
        } else {
            let greatest = patch.bursts[root].greatest;
            let threshold = |index: &u32| decay_threshold(patch, &patch.touches[*index as usize], axis, greatest);
            let decayed = collapse.touches.iter().map(threshold).fold(0.0, larger) / decay.least_speed;
            let last = collapse.touches.iter().map(|index| patch.order_of(*index)).max();
            // While the cycle lasts, one of its touches always approaches, so that those after them in the order must
            // wait.
            let is_early = |outsider: &Outsider| Some(patch.order_of(outsider.touch)) < last;
            let early: Vec<Outsider> = outsiders.into_iter().filter(is_early).collect();
            let hit = if early.is_empty() {
                0.0
            } else {
                let Some(speeds) = self.least_speeds_away(patch, &collapse, decay, axis, velocity, world) else {
                    return;
                };
                early.iter().map(|outsider| outsider.factor_when_hit(&speeds)).fold(0.0, larger)
            };
            let least = larger(decayed, hit);
            let factor = decay.factor_above(least);
            if factor == 1.0.into() {
                return;
            }
            let later = |now: DoubleDouble| velocity + (now - velocity) * factor;
            self.change_velocities(patch, &collapse.members, axis, later);
        }
        patch.bursts[root].histories[axis].restart();
    }

    /// For each member of the collapse of a cycle and each side, the least speed in the next period by which it moves
    /// away from that side, relative to the common velocity, m/s. `None` if bodies are joined and parted again.
    fn least_speeds_away(
        &self,
        patch: &mut Patch,
        collapse: &Collapse,
        decay: &Decay,
        axis: Axis,
        common: DoubleDouble,
        world: &World,
    ) -> Option<Vec<[f64; 2]>> {
        let place_of = |body: Local| collapse.members.iter().position(|member| *member == body);
        let mut velocities: Vec<DoubleDouble> =
            collapse.members.iter().map(|body| patch.axis(*body, axis).state.velocity).collect();
        // Away from the low side means towards higher coordinates.
        let speeds_away = |velocity: DoubleDouble| [(velocity - common).high, (common - velocity).high];
        let mut least: Vec<[f64; 2]> = velocities.iter().map(|velocity| speeds_away(*velocity)).collect();
        let mut clusters = [Cluster::default(), Cluster::default()];
        for index in &decay.sequence {
            let touch = patch.touches[*index as usize];
            let restitution = self.restitution(patch, &touch, world);
            if restitution.high == 0.0 {
                return None;
            }
            let impact = self.impact_of_clusters(patch, &touch, axis, restitution, &mut clusters);
            let velocity_of = |body: Local| match place_of(body) {
                Some(place) => velocities[place],
                None => patch.axis(body, axis).state.velocity,
            };
            let velocity = touch.ordered(axis).map(velocity_of);
            let after = Impact { velocity, ..impact }.velocities_after();
            for (cluster, velocity) in clusters.iter().zip(after) {
                for place in cluster.members.iter().filter_map(|body| place_of(*body)) {
                    velocities[place] = velocity;
                    let now = speeds_away(velocity);
                    least[place] = [smaller(now[0], least[place][0]), smaller(now[1], least[place][1])];
                }
            }
        }
        Some(least)
    }

    /// The bodies that a cycle hits, with those in contact with them; `None` if its touches and these contacts do not
    /// connect them all.
    ///
    /// The contacts last as long as the cycle: those that an impact ends are ended in its first period, and it hits the
    /// touches at which an impact joins bodies.
    fn collapse_of_cycle(&mut self, patch: &mut Patch, touches: Vec<u32>, axis: Axis) -> Option<Collapse> {
        let mut collapse = Collapse { touches, ..Collapse::default() };
        for body in patch.touches[collapse.touches[0] as usize].bodies {
            self.join_collapse(patch, body, axis, &mut collapse);
        }
        let mut next = 0;
        while let Some(body) = collapse.members.get(next).copied() {
            next += 1;
            self.explore(patch, body);
            let hit = collapse.touches.iter().map(|index| &patch.touches[*index as usize]);
            let mut others: Vec<Local> =
                hit.filter(|touch| touch.bodies.contains(&body)).map(|touch| touch.other(body)).collect();
            let LocalBody { slot, at, .. } = patch.bodies[body as usize];
            for contact in self.contacts.of(slot).iter().filter(|contact| contact.axis == axis) {
                others.push(self.local_of(patch, contact.other, at));
            }
            others.into_iter().for_each(|other| self.join_collapse(patch, other, axis, &mut collapse));
        }
        let connected = collapse.members.len();
        for index in collapse.touches.clone() {
            for body in patch.touches[index as usize].bodies {
                self.join_collapse(patch, body, axis, &mut collapse);
            }
        }
        (connected > 0 && collapse.members.len() == connected).then_some(collapse)
    }
}

/// The bodies outside that touch a member of a collapse and would be approached at the common velocity.
fn approached_outsiders(patch: &Patch, collapse: &Collapse, axis: Axis, velocity: DoubleDouble) -> Vec<Outsider> {
    let mut outsiders = Vec::new();
    for (member, body) in collapse.members.iter().enumerate() {
        for index in &patch.bodies[*body as usize].touches {
            let touch = &patch.touches[*index as usize];
            let other = touch.other(*body);
            let is_inside = collapse.members.contains(&other) || collapse.touches.contains(index);
            if touch.kind != TouchKind::Face(axis) || is_inside {
                continue;
            }
            let outside = patch.axis(other, axis);
            let magnitude = outside.magnitudes.velocity + patch.axis(*body, axis).magnitudes.velocity;
            let side = touch.side_of(*body, axis);
            let speed = match side {
                Side::High => velocity - outside.state.velocity,
                Side::Low => outside.state.velocity - velocity,
            };
            if speed.high > magnitude * VELOCITY_ROUNDING {
                outsiders.push(Outsider { touch: *index, member, side, speed: speed.high });
            }
        }
    }
    outsiders
}

/// Approach speeds up to this one are rounding in a burst whose greatest was `greatest`, m/s.
pub fn decay_threshold(patch: &Patch, touch: &Touch, axis: Axis, greatest: f64) -> f64 {
    let [first, second] = touch.bodies.map(|body| patch.axis(body, axis).magnitudes.velocity);
    larger(greatest * DECAYED, (first + second) * VELOCITY_ROUNDING * UNDECIDED)
}
