//! The bodies of the solver.

use super::axis_trajectory::{AxisLowParts, AxisTrajectory, StateDd};
use super::body_state::{BodyDetails, BodyParams, BodyState, Load, MASS_SCALE, NONE, Slot};
use super::decimal::stated;
use super::double_double::DoubleDouble;
use super::exact::Resolution;
use super::instant::Instant;
use super::random_rounding::RandomRounding;
use super::reference::Reference;
use super::trajectory::Trajectory;
use crate::physics::{Axis, Body, BodyId, larger};
use std::ops::Index;

/// The bodies in creation order: trajectories and sizes in double-double arithmetic, masses, free accelerations.
///
/// Invariants: a body keeps its slot, also after it was deleted, until all are cleared. Ids ascend. Until
/// the next deletion after an [update](Self::update_world_indices), the bodies alive have the world indices 0, 1, 2 and
/// so on. The reference of a body is the later of the reference instants of its axes. The high parts of a trajectory,
/// which predictions read, are those of the double-double numbers.
#[derive(Clone, Debug)]
pub struct Bodies {
    /// Acceleration along x and y, m/s².
    gravity: [DoubleDouble; 2],
    /// By slot.
    states: Vec<BodyState>,
    /// By slot.
    details: Vec<BodyDetails>,
    /// The constant forces on bodies of finite mass, alive or deleted, in the order of their slots: newtons times
    /// [`MASS_SCALE`], so that no sum overflows.
    forces: Vec<(Slot, [DoubleDouble; 2])>,
    /// For each axis, the number of bodies alive with a constant force along it.
    force_counts: [u32; 2],
    /// For each axis, the number of bodies alive with a load of [`Load::OwnForces`].
    load_counts: [u32; 2],
    /// The number of moving infinite masses alive.
    moving_walls: u32,
    /// The first of the slots deleted since the last update of the world indices; [`NONE`] if there is none.
    first_deleted: Slot,
    /// Random rounding, by which the accuracy of a run is estimated; usually none.
    rounding: RandomRounding,
    resolution: Resolution,
}

impl Bodies {
    /// No bodies, in a gravitational acceleration, m/s².
    pub fn new(gravity: [f64; 2]) -> Bodies {
        Bodies::with_gravity(gravity.map(stated))
    }

    fn with_gravity(gravity: [DoubleDouble; 2]) -> Bodies {
        Bodies {
            gravity,
            states: Vec::new(),
            details: Vec::new(),
            forces: Vec::new(),
            force_counts: [0; 2],
            load_counts: [0; 2],
            moving_walls: 0,
            first_deleted: NONE,
            rounding: RandomRounding::default(),
            resolution: Resolution::default(),
        }
    }

    /// Removes all bodies and slots.
    pub fn clear(&mut self) {
        *self = Bodies { rounding: self.rounding, resolution: self.resolution, ..Bodies::with_gravity(self.gravity) };
    }

    /// The rounding of computed numbers.
    #[inline]
    pub fn rounding(&self) -> RandomRounding {
        self.rounding
    }

    /// The resolution of positions.
    #[inline]
    pub fn resolution(&self) -> Resolution {
        self.resolution
    }

    /// From now on rounds at random, with numbers that follow from `seed`, and computes with a resolution that is finer
    /// or coarser by a factor.
    pub fn perturb(&mut self, seed: u64, factor: f64) {
        self.rounding = RandomRounding::new(seed);
        self.resolution = self.resolution.times(factor);
    }

    /// The data that predictions read, by slot.
    pub fn states(&self) -> &[BodyState] {
        &self.states
    }

    /// The number of slots.
    pub fn len(&self) -> usize {
        self.states.len()
    }

    /// The slots of the bodies alive, in creation order.
    pub fn alive(&self) -> impl Iterator<Item = Slot> + '_ {
        (0..self.states.len() as Slot).filter(|slot| self.params(*slot).alive)
    }

    /// The slot of a body, alive or deleted.
    pub fn slot_of(&self, id: BodyId) -> Option<Slot> {
        self.details.binary_search_by_key(&id, |details| details.params.id).ok().map(|slot| slot as Slot)
    }

    /// The data of a body that predictions do not read.
    pub fn params(&self, slot: Slot) -> &BodyParams {
        &self.details[slot as usize].params
    }

    /// The constant force on a body along an axis, N, times [`MASS_SCALE`]; 0 for an infinite mass.
    pub fn force(&self, slot: Slot, axis: Axis) -> DoubleDouble {
        let index = self.forces.binary_search_by_key(&slot, |(slot, _)| *slot);
        index.map_or(DoubleDouble::ZERO, |index| self.forces[index].1[axis])
    }

    /// Appends the body with the given index in the world, whose trajectory starts at `since` in free fall.
    pub fn push(&mut self, body: &Body, world_index: usize, since: Instant) -> Slot {
        let slot = self.states.len() as Slot;
        let (force, infinite) = (body.constant_force, body.is_infinite());
        let free_acceleration = self.free_acceleration(body);
        let trajectory = Trajectory::new(Axis::BOTH.map(|axis| {
            // Not −0, which some formulas for the state at an instant keep, and others do not.
            let (position, velocity) = (body.rect.origin[axis] + 0.0, body.velocity[axis] + 0.0);
            AxisTrajectory { position, velocity, acceleration: free_acceleration[axis].high, since }
        }));
        let size = [body.rect.width(), body.rect.height()];
        let low_parts = Axis::BOTH.map(|axis| AxisLowParts {
            position: stated(trajectory.position[axis]).low,
            velocity: stated(trajectory.velocity[axis]).low,
            acceleration: free_acceleration[axis].low,
            size: stated(size[axis]).low,
        });
        let has_force = Axis::BOTH.map(|axis| !infinite && force[axis] != 0.0);
        if has_force != [false; 2] {
            self.forces.push((slot, Axis::BOTH.map(|axis| stated(force[axis]).scaled(MASS_SCALE))));
        }
        self.states.push(BodyState {
            trajectory,
            size,
            since,
            generation: 0,
            world_index: world_index as u32,
            infinite,
            load: [Load::GravityOnly; 2],
        });
        for axis in Axis::BOTH {
            self.force_counts[axis] += u32::from(has_force[axis]);
        }
        self.moving_walls += u32::from(infinite && !trajectory.is_at_rest());
        let params = BodyParams {
            id: body.id,
            mass: stated(body.mass).scaled(MASS_SCALE),
            material: body.material,
            free_acceleration,
            has_force,
            alive: true,
        };
        self.details.push(BodyDetails { low_parts, params });
        slot
    }

    /// The acceleration of a body without contacts, m/s².
    fn free_acceleration(&self, body: &Body) -> [DoubleDouble; 2] {
        let force = body.constant_force;
        Axis::BOTH.map(|axis| {
            if body.is_infinite() {
                DoubleDouble::ZERO
            } else if force[axis] == 0.0 {
                self.gravity[axis]
            } else {
                quotient(stated(force[axis]), stated(body.mass)) + self.gravity[axis]
            }
        })
    }

    /// Deletes a body alive; its slot stays. The world indices of later bodies must be
    /// [updated](Self::update_world_indices).
    pub fn delete(&mut self, slot: Slot) {
        let state = &self.states[slot as usize];
        self.moving_walls -= u32::from(state.infinite && !state.is_static());
        let params = &mut self.details[slot as usize].params;
        params.alive = false;
        for axis in Axis::BOTH {
            self.load_counts[axis] -= u32::from(self.states[slot as usize].load[axis] == Load::OwnForces);
            self.force_counts[axis] -= u32::from(params.has_force[axis]);
        }
        self.first_deleted = self.first_deleted.min(slot);
        self.invalidate(slot);
    }

    /// Updates the world indices after deletions: once for all of a step, since this visits all later bodies.
    pub fn update_world_indices(&mut self) {
        let first = std::mem::replace(&mut self.first_deleted, NONE);
        let Some(deleted) = self.states.get(first as usize) else { return };
        let mut next = deleted.world_index;
        for (state, details) in self.states.iter_mut().zip(&self.details).skip(first as usize) {
            if details.params.alive {
                state.world_index = next;
                next += 1;
            }
        }
    }

    /// Invalidates the predictions that involve a body.
    pub fn invalidate(&mut self, slot: Slot) {
        let generation = &mut self.states[slot as usize].generation;
        *generation = generation.wrapping_add(1);
    }

    /// The gravitational acceleration along an axis, m/s².
    pub fn gravity(&self, axis: Axis) -> DoubleDouble {
        self.gravity[axis]
    }

    /// Returns true if a component may carry forces of its own along an axis: if a constant force acts on a body alive,
    /// or did when the component of one was last solved.
    pub fn carry_forces(&self, axis: Axis) -> bool {
        self.force_counts[axis] > 0 || self.load_counts[axis] > 0
    }

    /// Returns true if neither gravity nor a constant force acts on any body.
    pub fn are_free(&self) -> bool {
        self.gravity == [DoubleDouble::ZERO; 2] && self.force_counts == [0; 2]
    }

    /// Returns true if a body of finite mass that others support certainly keeps its contacts and hits no infinite
    /// mass: it is at rest, and so are all infinite masses.
    pub fn is_at_rest(&self, slot: Slot) -> bool {
        self.moving_walls == 0 && self.states[slot as usize].trajectory.is_at_rest()
    }

    /// Sets the load of the component of a body along an axis.
    pub fn set_load(&mut self, slot: Slot, axis: Axis, load: Load) {
        let previous = std::mem::replace(&mut self.states[slot as usize].load[axis], load);
        self.load_counts[axis] -= u32::from(previous == Load::OwnForces);
        self.load_counts[axis] += u32::from(load == Load::OwnForces);
    }

    /// A body along an axis at its reference instant.
    #[inline]
    pub fn reference(&self, slot: Slot, axis: Axis) -> Reference {
        let body = &self.states[slot as usize];
        let low = &self.details[slot as usize].low_parts[axis];
        let trajectory = &body.trajectory;
        let state = StateDd {
            position: DoubleDouble { high: trajectory.position[axis], low: low.position },
            velocity: DoubleDouble { high: trajectory.velocity[axis], low: low.velocity },
            acceleration: DoubleDouble { high: trajectory.acceleration[axis], low: low.acceleration },
        };
        Reference {
            state,
            since: trajectory.since(axis),
            size: DoubleDouble { high: body.size[axis], low: low.size },
            free_acceleration: self.details[slot as usize].params.free_acceleration[axis].high.abs(),
        }
    }

    /// The state of a body along an axis at an instant.
    #[inline]
    pub fn state_at(&self, slot: Slot, axis: Axis, at: Instant) -> StateDd {
        self.reference(slot, axis).state_at(at, self.rounding)
    }

    /// Sets the trajectory of a body along one axis from an instant on, which becomes its reference.
    #[inline(always)]
    pub fn set_trajectory(&mut self, slot: Slot, axis: Axis, state: StateDd, since: Instant) {
        let StateDd { position, velocity, acceleration } = state;
        let body = &mut self.states[slot as usize];
        let [position_high, velocity_high, acceleration_high] =
            [position, velocity, acceleration].map(|number| number.high);
        let trajectory =
            AxisTrajectory { position: position_high, velocity: velocity_high, acceleration: acceleration_high, since };
        body.trajectory.set(axis, trajectory);
        body.since = body.trajectory.later_since();
        let low = &mut self.details[slot as usize].low_parts[axis];
        (low.position, low.velocity, low.acceleration) = (position.low, velocity.low, acceleration.low);
    }

    /// Reads all that is stored of a body; returns a number that depends on it.
    #[inline]
    pub fn read_ahead(&self, slot: Slot) -> f64 {
        let low_size = self.details[slot as usize].low_parts[Axis::X].size;
        self.states[slot as usize].read_ahead() + low_size + self.details[slot as usize].params.mass.high
    }

    /// The size of a body along an axis, m.
    #[inline]
    pub fn size(&self, slot: Slot, axis: Axis) -> DoubleDouble {
        DoubleDouble {
            high: self.states[slot as usize].size[axis],
            low: self.details[slot as usize].low_parts[axis].size,
        }
    }

    /// Changes the size of a body along an axis by less than the rounding of its coordinates.
    pub fn adjust_size(&mut self, slot: Slot, axis: Axis, size: DoubleDouble) {
        let high = self.states[slot as usize].size[axis];
        self.details[slot as usize].low_parts[axis].size = (size - high.into()).high;
    }

    /// The low parts of a body along an axis, for a snapshot.
    pub fn low_parts(&self, slot: Slot, axis: Axis) -> &AxisLowParts {
        &self.details[slot as usize].low_parts[axis]
    }

    /// Restores the state of a body along an axis from a snapshot.
    pub fn restore(&mut self, slot: Slot, axis: Axis, trajectory: AxisTrajectory, low_parts: AxisLowParts, load: Load) {
        let body = &mut self.states[slot as usize];
        self.moving_walls -= u32::from(body.infinite && !body.is_static());
        body.trajectory.set(axis, trajectory);
        body.since = body.trajectory.later_since();
        self.moving_walls += u32::from(body.infinite && !body.is_static());
        self.set_load(slot, axis, load);
        self.details[slot as usize].low_parts[axis] = low_parts;
    }

    /// The longest side among the bodies of finite mass, without the outliers; m.
    ///
    /// A side of more than twice the 90th percentile is an outlier.
    pub fn largest_usual_size(&self) -> f64 {
        let moving = self.alive().filter(|slot| !self[*slot].infinite);
        let longer = |[width, height]: [f64; 2]| larger(width, height);
        let mut sizes: Vec<f64> = moving.map(|slot| longer(self[slot].size)).collect();
        sizes.sort_unstable_by(f64::total_cmp);
        let Some(large) = sizes.get(sizes.len() * 9 / 10) else { return 1.0 };
        sizes[sizes.partition_point(|size| *size <= 2.0 * large) - 1]
    }
}

impl Index<Slot> for Bodies {
    type Output = BodyState;

    #[inline]
    fn index(&self, slot: Slot) -> &BodyState {
        &self.states[slot as usize]
    }
}

/// The quotient of a force and a mass, m/s²; in a smaller unit where the product of huge numbers would overflow.
fn quotient(force: DoubleDouble, mass: DoubleDouble) -> DoubleDouble {
    const HUGE: f64 = 1e280;
    const UNIT: f64 = 1.0 / (1_u128 << 100) as f64;
    if mass.high > HUGE || force.high.abs() > HUGE {
        return force.scaled(UNIT) / mass.scaled(UNIT);
    }
    force / mass
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::physics::{Engine, EngineConfig, Event, Rect, SolverKind, Spawn, Vector};

    /// Boxes of 1, 2, 3 and so on kilograms in a gravity of 10 m/s² along y, the last with a force of 6 N along x.
    fn bodies(count: u32) -> Bodies {
        let mut engine = Engine::new(EngineConfig::new(SolverKind::Handout, 1.0));
        for number in 0..count {
            engine.apply(&Event::Spawn(Spawn {
                name: number.to_string(),
                rect: Rect::new(Vector::new(f64::from(number), 0.0), 1.0, 2.0),
                mass: f64::from(number + 1),
                velocity: Vector::new(0.0, -4.0),
                force: Vector::new(if number + 1 == count { 6.0 } else { 0.0 }, 0.0),
                material: String::new(),
            }));
        }
        let mut bodies = Bodies::new([0.0, 10.0]);
        for (index, body) in engine.world().bodies.iter().enumerate() {
            bodies.push(body, index, Instant::START);
        }
        bodies
    }

    #[test]
    fn the_bodies_alive_have_dense_world_indices() {
        let mut bodies = bodies(5);
        bodies.delete(1);
        bodies.delete(3);
        bodies.update_world_indices();
        let alive: Vec<(Slot, u32)> = bodies.alive().map(|slot| (slot, bodies[slot].world_index)).collect();
        assert_eq!(alive, [(0, 0), (2, 1), (4, 2)]);
        assert_eq!((bodies.len(), bodies.slot_of(4), bodies.slot_of(5)), (5, Some(4), None));
    }

    #[test]
    fn no_velocity_is_minus_zero() {
        let mut engine = Engine::new(EngineConfig::new(SolverKind::Handout, 1.0));
        let spawn = Spawn::new("", Rect::new(Vector::new(-0.0, 0.0), 1.0, 1.0), 1.0);
        engine.apply(&Event::Spawn(spawn.with_velocity(Vector::new(-0.0, 1.0))));
        let mut bodies = Bodies::new([0.0; 2]);
        bodies.push(&engine.world().bodies[0], 0, Instant::START);
        let at = Instant { high: 1.0, low: 0.0 };
        for state in [bodies[0].trajectory.at(at), bodies[0].trajectory.drifted(at)] {
            assert_eq!(
                state.map(|vector| vector.map(f64::to_bits)),
                [[0.0, 1.0_f64], [0.0, 1.0]].map(|v| v.map(f64::to_bits))
            );
        }
    }

    #[test]
    fn a_force_acts_until_its_body_is_deleted() {
        let mut bodies = bodies(3);
        assert_eq!(bodies.params(2).free_acceleration, [2.0.into(), 10.0.into()]);
        assert!(bodies.carry_forces(Axis::X) && !bodies.carry_forces(Axis::Y) && !bodies.are_free());
        bodies.set_load(0, Axis::X, Load::OwnForces);
        bodies.delete(2);
        assert!(bodies.carry_forces(Axis::X), "the body that was pushed has not been examined since");
        bodies.set_load(0, Axis::X, Load::GravityOnly);
        assert!(!bodies.carry_forces(Axis::X));
    }

    #[test]
    fn a_deleted_body_carries_no_forces() {
        let mut bodies = bodies(2);
        bodies.set_load(0, Axis::Y, Load::OwnForces);
        bodies.set_load(0, Axis::Y, Load::OwnForces);
        assert!(bodies.carry_forces(Axis::Y));
        bodies.delete(0);
        assert!(!bodies.carry_forces(Axis::Y));
    }

    #[test]
    fn a_body_falls_freely_from_its_reference_on() {
        let bodies = bodies(1);
        let state = bodies.state_at(0, Axis::Y, Instant { high: 0.5, low: 0.0 });
        assert_eq!((state.position.high, state.velocity.high), (-0.75, 1.0));
    }

    #[test]
    fn a_new_trajectory_has_its_own_reference_and_keeps_all_digits() {
        let mut bodies = bodies(1);
        let (at, third) = (Instant { high: 2.0, low: 0.0 }, DoubleDouble::from(1.0) / 3.0.into());
        let state = StateDd { position: third, velocity: third, acceleration: DoubleDouble::ZERO };
        bodies.set_trajectory(0, Axis::X, state, at);
        assert_eq!((bodies[0].since, bodies[0].trajectory.since(Axis::Y)), (at, Instant::START));
        assert_eq!(bodies.state_at(0, Axis::X, at).position, third);
        assert_eq!(bodies[0].trajectory.position[0], third.high);
    }

    #[test]
    fn an_adjusted_size_keeps_its_high_part() {
        let mut bodies = bodies(1);
        let size = DoubleDouble::from(1.0) + 1e-17.into();
        bodies.adjust_size(0, Axis::X, size);
        assert_eq!((bodies.size(0, Axis::X), bodies[0].size), (size, [1.0, 2.0]));
    }
}
