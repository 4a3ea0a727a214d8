//! Clusters of bodies that take an impact as one.

use super::EventDriven;
use super::body_state::Slot;
use super::double_double::DoubleDouble;
use super::impact::is_negligible;
use super::pair_event::Sample;
use super::state_dd::StateDd;
use super::swept_aabb::SweptAabb;
use crate::physics::{Axis, Side, World};

/// Bodies that take an impact as one.
#[derive(Clone, Debug, Default)]
pub struct ContactCluster {
    /// The struck body first, then the others; empty if the impact moves none.
    members: Vec<Member>,
    /// Mass, kg; infinite if the cluster cannot move.
    pub mass: f64,
    /// Velocity before the impact, m/s.
    pub velocity: DoubleDouble,
}

/// One body of a cluster.
#[derive(Clone, Copy, Debug)]
struct Member {
    slot: Slot,
    /// The body on whose face it is placed, and on which side of it; none for the struck body and for
    /// bodies that keep their positions.
    placed_on: Option<(Slot, Side)>,
}

/// One of the two bodies of an impact.
#[derive(Clone, Copy, Debug)]
pub struct StruckBody {
    /// The body that is struck.
    pub slot: Slot,
    /// The axis of the impact.
    pub axis: Axis,
    /// The direction in which the impact pushes it.
    pub side: Side,
    /// Its velocity before the impact, m/s.
    pub velocity: DoubleDouble,
}

impl EventDriven {
    /// Collects the struck body and all bodies that it pushes, directly or through others. If that
    /// body is supported on the side to which it is pushed, the cluster is empty and its mass infinite.
    pub(super) fn impact_cluster(&self, struck: StruckBody, cluster: &mut ContactCluster) {
        cluster.members.clear();
        cluster.velocity = struck.velocity;
        cluster.mass = f64::INFINITY;
        if self.states[struck.slot as usize].is_immovable(struck.axis, struck.side) {
            return;
        }
        cluster.members.push(Member { slot: struck.slot, placed_on: None });
        let mut next = 0;
        while let Some(Member { slot: by, .. }) = cluster.members.get(next).copied() {
            next += 1;
            for contact in self.contacts.of(by) {
                let slot = contact.other;
                let along = contact.axis == struck.axis && contact.side == struck.side;
                if along && !self.states[slot as usize].infinite && !cluster.contains(slot) {
                    cluster.members.push(Member { slot, placed_on: Some((by, struck.side)) });
                }
            }
        }
        cluster.mass = self.total_mass(cluster);
    }

    /// Collects the bodies that end an inelastic collapse together with the struck body: all connected
    /// to it by contacts along the axis, on either side, and all that touch these with a relative speed
    /// of at most `max_speed`, m/s. The mass is infinite if one of them is supported.
    ///
    /// `excluded` bodies belong to the other cluster.
    pub(super) fn collapse_cluster(
        &mut self,
        world: &World,
        struck: StruckBody,
        max_speed: f64,
        excluded: impl Fn(Slot) -> bool,
        cluster: &mut ContactCluster,
    ) {
        cluster.members.clear();
        cluster.members.push(Member { slot: struck.slot, placed_on: None });
        let mut support_velocity = None;
        let mut next = 0;
        while let Some(Member { slot: by, .. }) = cluster.members.get(next).copied() {
            next += 1;
            if self.is_supported(by, struck.axis) {
                support_velocity = support_velocity.or(Some(self.velocity_dd(by, struck.axis)));
                continue;
            }
            let in_contact = self.contacts.of(by).iter().filter(|contact| contact.axis == struck.axis);
            let in_contact = in_contact.map(|contact| (contact.other, contact.side));
            for (slot, side) in in_contact.chain(self.touching_bodies(world, by, struck.axis, max_speed)) {
                if !cluster.contains(slot) && !excluded(slot) {
                    cluster.members.push(Member { slot, placed_on: Some((by, side)) });
                }
            }
        }
        match support_velocity {
            Some(velocity) => self.attach_to_support(cluster, struck, velocity),
            None => self.merge(cluster, struck),
        }
    }

    /// Gives a cluster the velocity of its support; its members keep their positions.
    fn attach_to_support(&self, cluster: &mut ContactCluster, struck: StruckBody, velocity: DoubleDouble) {
        cluster.members.retain(|member| !self.is_supported(member.slot, struck.axis));
        cluster.members.iter_mut().for_each(|member| member.placed_on = None);
        cluster.mass = f64::INFINITY;
        cluster.velocity = velocity;
    }

    /// Gives a free cluster its common velocity, and adds contacts between members that only touched.
    fn merge(&mut self, cluster: &mut ContactCluster, struck: StruckBody) {
        cluster.mass = self.total_mass(cluster);
        cluster.velocity = self.common_velocity(cluster, struck);
        for member in &cluster.members {
            if let Some((other, side)) = member.placed_on
                && self.contacts.axis_between(member.slot, other).is_none()
            {
                let pair = match side {
                    Side::High => [other, member.slot],
                    Side::Low => [member.slot, other],
                };
                self.add_contact(pair, struck.axis);
            }
        }
    }

    /// True if a body has infinite mass or rests, directly or through others, against an infinite mass.
    fn is_supported(&self, slot: Slot, axis: Axis) -> bool {
        let body = &self.states[slot as usize];
        body.infinite || body.supported[axis] != [false; 2]
    }

    /// The total mass, summed in creation order, kg.
    fn total_mass(&self, cluster: &ContactCluster) -> f64 {
        let mass = |member: &Member| self.params[member.slot as usize].mass;
        match cluster.members.as_slice() {
            [single] => mass(single),
            several => {
                let mut in_creation_order: Vec<&Member> = several.iter().collect();
                in_creation_order.sort_unstable_by_key(|member| member.slot);
                in_creation_order.into_iter().map(mass).sum()
            }
        }
    }

    /// Total momentum divided by total mass, m/s; computed as the velocity of the struck body plus the
    /// mean difference from it.
    fn common_velocity(&self, cluster: &ContactCluster, struck: StruckBody) -> DoubleDouble {
        let mut excess = DoubleDouble::ZERO;
        for member in &cluster.members {
            let difference = self.velocity_dd(member.slot, struck.axis) - struck.velocity;
            excess = excess + difference * DoubleDouble::from(self.params[member.slot as usize].mass);
        }
        struck.velocity + excess / cluster.mass.into()
    }

    /// The momentum that the members lose by moving on at the velocity of the cluster, N·s.
    pub(super) fn momentum_lost(&self, cluster: &ContactCluster, axis: Axis) -> f64 {
        let lost = |member: &Member| {
            let excess = self.velocity_dd(member.slot, axis) - cluster.velocity;
            excess.high * self.params[member.slot as usize].mass
        };
        cluster.members.iter().map(lost).sum()
    }

    /// The bodies that touch a body along an axis, on which side, at a relative speed of at most
    /// `max_speed` and without being in contact with it; only where e < 1.
    fn touching_bodies(&self, world: &World, slot: Slot, axis: Axis, max_speed: f64) -> Vec<(Slot, Side)> {
        let body = &self.states[slot as usize];
        let reach = SweptAabb::new(&Sample::new(&self.clock, body, self.now), 0.0);
        let mut near = self.cell_lists.neighbours_of(slot, body, &reach);
        near.retain(|other| {
            let [own, others] = [slot, *other].map(|slot| self.params[slot as usize].material);
            let is_known = *other == slot || self.contacts.axis_between(slot, *other).is_some();
            !is_known && world.restitution.between(own, others) < 1.0
        });
        near.into_iter().filter_map(|other| Some((other, self.touching_side(slot, other, axis, max_speed)?))).collect()
    }

    /// The side of a body on which another touches it at a relative speed of at most `max_speed`, if any.
    fn touching_side(&self, slot: Slot, other: Slot, axis: Axis, max_speed: f64) -> Option<Side> {
        let [own, others] = [slot, other].map(|slot| self.state_dd(slot, axis));
        let [own_size, others_size] = [slot, other].map(|slot| self.states[slot as usize].size[axis]);
        let scale = own.position.high.abs() + others.position.high.abs() + (own_size + others_size);
        let offset = (others.position - own.position).high;
        let [high_gap, low_gap] = [offset - own_size, -offset - others_size];
        let (gap, side) = if high_gap > low_gap { (high_gap, Side::High) } else { (low_gap, Side::Low) };
        let relative_speed = (others.velocity - own.velocity).high.abs();
        let touches = is_negligible(gap.abs(), scale) && relative_speed <= max_speed;
        (touches && self.overlaps_along(axis.other(), slot, other)).then_some(side)
    }

    /// True if two boxes overlap along an axis by more than rounding.
    pub(super) fn overlaps_along(&self, axis: Axis, slot: Slot, other: Slot) -> bool {
        let [own, others] = [slot, other].map(|slot| self.state_dd(slot, axis).position);
        let [own_size, others_size] = [slot, other].map(|slot| self.states[slot as usize].size[axis]);
        let offset = (others - own).high;
        let scale = own.high.abs() + others.high.abs() + (own_size + others_size);
        let overlap = if offset > 0.0 { own_size - offset } else { others_size + offset };
        !is_negligible(overlap, scale)
    }

    /// Gives a cluster its new velocity and ends its contacts with bodies of another velocity.
    ///
    /// The struck body is placed at `start` and the others on each other's faces, so that these coincide.
    pub(super) fn apply_to_cluster(
        &mut self,
        cluster: &ContactCluster,
        struck: StruckBody,
        start: DoubleDouble,
        velocity: DoubleDouble,
    ) {
        for (index, member) in cluster.members.iter().enumerate() {
            let acceleration = self.acceleration(member.slot, struck.axis);
            let size = |slot: Slot| self.states[slot as usize].size[struck.axis].into();
            let position = match member.placed_on {
                None if index == 0 => start,
                None => self.state_dd(member.slot, struck.axis).position,
                Some((other, Side::High)) => self.state_dd(other, struck.axis).position + size(other),
                Some((other, Side::Low)) => self.state_dd(other, struck.axis).position - size(member.slot),
            };
            self.set_trajectory(member.slot, struck.axis, StateDd { position, velocity, acceleration });
        }
        for member in &cluster.members {
            let mut next = 0;
            while let Some(contact) = self.contacts.of(member.slot).get(next).copied() {
                if contact.axis != struck.axis || self.velocity_dd(contact.other, struck.axis).high == velocity.high {
                    next += 1;
                } else {
                    self.remove_contact(member.slot, contact.other);
                }
            }
        }
    }
}

impl ContactCluster {
    /// True if a body is one of its members.
    pub fn contains(&self, slot: Slot) -> bool {
        self.members.iter().any(|member| member.slot == slot)
    }
}
