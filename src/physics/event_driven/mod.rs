//! The exact solver: from event to event. See [`EventDriven`].

use super::{Memory, Observer, Settings, SnapshotError, StepError, World};

/// The exact solver's own state.
#[derive(Clone, Debug)]
pub struct EventDriven {}

impl EventDriven {
    /// The solver of an empty world.
    pub fn new(_settings: &Settings) -> EventDriven {
        EventDriven {}
    }

    /// The last body of the world has just been added.
    pub fn spawned(&mut self, _world: &World, _step: u64) {}

    /// The body at `place` is about to be removed.
    pub fn deleting(&mut self, _world: &World, _place: usize, _step: u64) {}

    /// Moves the world on by one step.
    ///
    /// # Errors
    /// When the step cannot be completed.
    pub fn step<O: Observer>(&mut self, _world: &mut World, step: u64, _observer: &mut O) -> Result<(), StepError> {
        Err(StepError::TooManyEvents { step, limit: 0, bodies: Vec::new() })
    }

    /// All that [`EventDriven::restore`] needs.
    pub fn memory(&self) -> Memory {
        Memory::default()
    }

    /// Takes up where [`EventDriven::memory`] was taken.
    ///
    /// # Errors
    /// When the memory is not one of this solver's.
    pub fn restore(&mut self, _world: &World, _step: u64, _memory: &Memory) -> Result<(), SnapshotError> {
        Ok(())
    }
}
