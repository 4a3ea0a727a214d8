//! The exact solver: from event to event. See [`EventDriven`].
//!
//! Boxes neither turn nor rub, so between events each moves on a parabola along each axis
//! (`motion`, `motions`), each pair meets at a root known in closed form (`meeting`), and there is no
//! time step to trade against error: a step only says when the state is sampled.
//!
//! One step: newcomers are admitted (`admission`) and put apart (`separation`); what is due
//! happens in its total order (`schedule`): boxes collide (`collide`, `block`, `impact`), slide
//! off edges and take up or end contacts (`contact`, `settle`, `least_change`), and whoever that
//! concerned looks ahead again among its neighbours (`outlook`, `reach`, `near`, `neighbours`,
//! `grid`); what moved is sampled (`sampling`), and who is about to leave its cell moves on
//! (`calendar`). Where all rests, none of this takes any time. `memory` is what must be kept to
//! go on to the bit, `crush` how a step may fail.
//!
//! Prediction computes with doubles; what happens is computed with twice the digits
//! (`fine_state`, `double_double`, `side_by_side`), so that rounding is no error one could see
//! after thousands of collisions.
//!
//! The rules where mechanics leaves a choice:
//!
//! - **Simultaneous impacts**: of all pairs that approach at an instant the one lowest in
//!   creation order goes first, then again the lowest, until none approaches. So touching
//!   cradles hand a blow on from pair to pair.
//! - **Contacts** take a blow as one: a body that rests, directly or through others, against
//!   an infinite mass answers like that mass, with the e of the impact; a free one together
//!   with all that it pushes. (Handing it on from pair to pair would be the other choice; it
//!   needs endlessly many impacts in a resting stack.) A contact is what presses, or what a
//!   plastic impact joined; bodies that merely touch are not in contact.
//! - **Corners** that meet exactly are hit on both axes. If that leaves them at rest, or if they
//!   are pressed together from rest, they are in contact along both axes until they part along
//!   one. Boxes whose edges only slide along each other's line do not meet.
//! - **Zeno**: where e < 1, impacts slower than `impact::capture_speed`, and those after
//!   `impact::LONGEST_HURRY` impacts without a way between them, are plastic, and all that is
//!   in contact with the two along that axis, or touches them (at less than that speed, if the
//!   blow is so slow), goes on with them as one: the limit of endlessly many blows handed to
//!   and fro.
//! - **Rounding**: after an impact the body ahead is put exactly on the other's face (or the
//!   one behind, if the body ahead cannot move). Coordinates a few units in the last place
//!   apart touch, if nothing else tells them apart; faces that touch at the instant of a sample
//!   in this sense have collided in it.

mod admission;
mod block;
mod calendar;
mod collide;
mod contact;
mod crush;
mod double_double;
mod fine_state;
mod grid;
mod impact;
mod instant;
mod least_change;
mod meeting;
mod memory;
mod motion;
mod motions;
mod mover;
mod near;
mod neighbours;
mod outlook;
mod reach;
mod sampling;
mod schedule;
mod separation;
mod settle;
mod side_by_side;

use super::{Body, BodyId, Observer, Settings, StepError, World};
use block::Block;
use calendar::Calendar;
use contact::Contacts;
use double_double::DoubleDouble;
use fine_state::{Residue, Residues};
use instant::{Clock, Instant};
use meeting::Kind;
use motion::Motion;
use motions::Motions;
use mover::{AXES, Mover, Slot, Traits};
use near::Near;
use neighbours::Neighbours;
use reach::Reach;
use sampling::Moving;
use schedule::Schedule;

/// So often a body may look around in a step beyond the limit of events: far more than any
/// speed makes it, but no scene, however strange, shall hang.
const GLANCES_PER_BODY: u64 = 1000;

/// The exact solver's own state.
///
/// What it *is* are the motions, the contacts and the bodies not yet admitted; that is what
/// [`EventDriven::memory`] keeps. Grids and schedule are derived from it, and
/// nothing of how they were derived shows in any result.
#[derive(Clone, Debug)]
pub struct EventDriven {
    clock: Clock,
    /// m/s², along x and y.
    gravity: [f64; 2],
    /// How much may happen in a step.
    limit: u64,
    /// By slot, in creation order; deleted ones leave a gap.
    movers: Vec<Mover>,
    /// The lower halves of their motions.
    residues: Vec<Residues>,
    traits: Vec<Traits>,
    contacts: Contacts,
    /// How many bodies carry a force of their own along each axis.
    forced: [u32; 2],
    /// Spawned since the last step: they may overlap others yet.
    fresh: Vec<Slot>,
    /// How far the present step has come.
    now: Instant,
    /// The lower half of its offset, s.
    now_residue: f64,
    neighbours: Neighbours,
    schedule: Schedule,
    calendar: Calendar,
    moving: Moving,
    /// Bodies whose motion or contacts changed at the present instant.
    changed: Vec<Slot>,
    /// Bodies whose contacts along each axis changed, so that their accelerations may.
    loosened: [Vec<Slot>; 2],
    /// How many bodies the grids and the schedule were made for.
    made_for: usize,
    blocks: [Block; 2],
    /// Room for those who are to be moved on.
    due: Vec<Slot>,
    /// Room for those who are near a body.
    near: Near,
}

impl EventDriven {
    /// The solver of an empty world.
    pub fn new(settings: &Settings) -> EventDriven {
        let clock = Clock::new(settings.rate);
        let gravity = settings.gravity.map_or([0.0; 2], |gravity| [gravity.x, gravity.y]);
        EventDriven {
            clock,
            gravity,
            limit: settings.events_per_step,
            movers: Vec::new(),
            residues: Vec::new(),
            traits: Vec::new(),
            contacts: Contacts::default(),
            forced: [0; 2],
            fresh: Vec::new(),
            now: Instant::start_of(0),
            now_residue: 0.0,
            neighbours: Neighbours::new(1.0),
            schedule: Schedule::new(clock, 0, 0),
            calendar: Calendar::new(0),
            moving: Moving::default(),
            changed: Vec::new(),
            loosened: [Vec::new(), Vec::new()],
            made_for: 0,
            blocks: [Block::default(), Block::default()],
            due: Vec::new(),
            near: Near::default(),
        }
    }

    /// The last body of the world has just been added.
    pub fn spawned(&mut self, world: &World, step: u64) {
        let place = world.bodies.len() - 1;
        let slot = self.add(&world.bodies[place], place, Instant::start_of(step));
        self.fresh.push(slot);
    }

    fn add(&mut self, body: &Body, place: usize, since: Instant) -> Slot {
        let slot = self.movers.len() as Slot;
        let force = [body.constant_force.x, body.constant_force.y];
        let infinite = body.is_infinite();
        let free_fall = AXES.map(|axis| match infinite {
            true => DoubleDouble::ZERO,
            false if force[axis] == 0.0 => self.gravity[axis].into(),
            false => DoubleDouble::from(force[axis]) / body.mass.into() + self.gravity[axis].into(),
        });
        let state = [(body.rect.origin.x, body.velocity.x), (body.rect.origin.y, body.velocity.y)];
        let motion = Motions::new(AXES.map(|axis| {
            let (position, velocity) = state[axis];
            Motion { position, velocity, acceleration: free_fall[axis].high, since }
        }));
        let residues = AXES.map(|axis| Residue { acceleration: free_fall[axis].low, ..Residue::default() });
        self.residues.push(Residues(residues));
        let size = [body.rect.width(), body.rect.height()];
        self.movers.push(Mover {
            motion,
            size,
            since,
            generation: 0,
            place: place as u32,
            infinite,
            held: [[false; 2]; 2],
            hurry: [0; 2],
        });
        let forced = AXES.map(|axis| !infinite && force[axis] != 0.0);
        AXES.into_iter().for_each(|axis| self.forced[axis] += u32::from(forced[axis]));
        let (mass, material) = (body.mass, body.material);
        self.traits.push(Traits { id: body.id, mass, material, free_fall, forced, alive: true });
        self.contacts.add_body();
        self.moving.add_body();
        self.calendar.add_body();
        slot
    }

    /// The body at `place` is about to be removed.
    pub fn deleting(&mut self, world: &World, place: usize, step: u64) {
        let Some(slot) = self.slot(world.bodies[place].id) else { return };
        self.advance_to(Instant::start_of(step));
        self.traits[slot as usize].alive = false;
        AXES.into_iter().for_each(|axis| self.forced[axis] -= u32::from(self.traits[slot as usize].forced[axis]));
        for later in &mut self.movers[slot as usize + 1..] {
            later.place = later.place.saturating_sub(1);
        }
        if let Some(fresh) = self.fresh.iter().position(|fresh| *fresh == slot) {
            self.fresh.remove(fresh);
            return;
        }
        self.movers[slot as usize].generation += 1;
        self.neighbours.remove(slot);
        self.schedule.set(slot, None);
        self.calendar.forget(slot);
        self.moving.forget(slot);
        self.release(slot);
    }

    fn slot(&self, id: BodyId) -> Option<Slot> {
        self.traits.binary_search_by_key(&id, |traits| traits.id).ok().map(|slot| slot as Slot)
    }

    /// Moves the world on by one step: admits the newcomers, lets happen what happens, samples.
    ///
    /// # Errors
    /// [`StepError::Crushed`] if a body is pressed between infinite masses,
    /// [`StepError::TooManyEvents`] beyond the limit, [`StepError::NotFinite`] if a number
    /// overflows. In the first two cases the world still shows the state before the step.
    pub fn step<O: Observer>(&mut self, world: &mut World, step: u64, observer: &mut O) -> Result<(), StepError> {
        if self.rests(step) {
            self.pass(step);
            return Ok(());
        }
        self.advance_to(Instant::start_of(step));
        self.admit(world, step);
        self.run(world, step, Instant::NEVER, observer)?;
        self.sample(world, step)?;
        self.move_on(step + 1);
        Ok(())
    }

    /// The world so many seconds after a step began, without going there.
    ///
    /// # Errors
    /// As for [`EventDriven::step`].
    pub fn between<O: Observer>(
        &self,
        world: &World,
        step: u64,
        offset: f64,
        observer: &mut O,
    ) -> Result<World, StepError> {
        let instant = Instant { step: step as f64, offset };
        let mut ahead = self.clone();
        ahead.now = Instant::start_of(step);
        ahead.admit(world, step);
        ahead.run(world, step, instant, observer)?;
        Ok(ahead.seen_at(world, instant))
    }

    /// Whether nobody moves in the step, and nobody is to be looked at.
    fn rests(&self, step: u64) -> bool {
        self.fresh.is_empty() && self.moving.is_empty() && self.schedule.is_free(step) && self.calendar.is_free()
    }

    /// Passes over a step in which all rests.
    fn pass(&mut self, step: u64) {
        self.schedule.pass(step);
        self.calendar.pass();
        self.advance_to(Instant::start_of(step + 1));
    }

    /// Lets happen what is due in the step, up to an instant.
    fn run<O: Observer>(&mut self, world: &World, step: u64, last: Instant, observer: &mut O) -> Result<(), StepError> {
        self.schedule.begin(step);
        let (mut events, mut glances) = (0, 0);
        let most_glances = self.limit.saturating_add(GLANCES_PER_BODY * self.movers.len() as u64);
        while let Some((slot, turn)) = self.schedule.next(step) {
            if last.is_before(turn.at) {
                break;
            }
            glances += 1;
            if glances - events > most_glances {
                return Err(self.too_many(world, step, turn.pair));
            }
            self.advance_to(turn.at);
            let Some(kind) = turn.meeting else {
                self.cross(slot);
                continue;
            };
            let partner = if turn.pair[0] == slot { turn.pair[1] } else { turn.pair[0] };
            if self.movers[partner as usize].generation != turn.generation {
                self.predict(slot);
                continue;
            }
            events += 1;
            if events > self.limit {
                return Err(self.too_many(world, step, turn.pair));
            }
            self.changed.push(slot);
            self.happen(world, turn.pair, kind, observer)?;
        }
        Ok(())
    }

    /// Lets two bodies meet, and looks ahead again for all whom it concerned.
    fn happen<O: Observer>(
        &mut self,
        world: &World,
        pair: [Slot; 2],
        kind: Kind,
        observer: &mut O,
    ) -> Result<(), StepError> {
        match kind {
            Kind::Touch(axis) => self.collide(world, pair, usize::from(axis), observer)?,
            Kind::Corner | Kind::Press => self.collide_corners(world, pair, observer)?,
            Kind::Part(_) => self.part(pair),
        }
        self.predict_changed();
        Ok(())
    }

    /// Notes that what was foretold of this body does not hold any more.
    fn mark(&mut self, slot: Slot) {
        let mover = &mut self.movers[slot as usize];
        if !mover.infinite {
            mover.generation = mover.generation.wrapping_add(1);
            self.neighbours.extend(slot, Reach::ANYWHERE);
            self.changed.push(slot);
        }
    }

    fn predict_changed(&mut self) {
        let mut changed = std::mem::take(&mut self.changed);
        if changed.len() > 2 {
            changed.sort_unstable();
        }
        changed.dedup();
        for slot in &changed {
            self.predict(*slot);
            self.moving.update(*slot, &self.movers[*slot as usize]);
        }
        changed.clear();
        self.changed = changed;
    }

    fn name(&self, world: &World, slot: Slot) -> String {
        world.bodies[self.movers[slot as usize].place as usize].name.clone()
    }
}
