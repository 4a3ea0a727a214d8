use std::{
    io::{Read, Seek},
    sync::Arc,
};

use crate::physics::Vector;

use super::{BodyInfo, BodyTable, Error, Header, Health, Item, RecordedState, Recording, Trailer};

/// Iterates over the states of a recording that are recorded in full, with all living bodies.
///
/// States thinned out by [`Header::every`] are skipped, and so are damaged ones; see
/// [`Playback::health`].
pub struct Playback<R> {
    recording: Recording<R>,
    from: u64,
}

/// One state of a [`Playback`].
#[non_exhaustive]
#[derive(Clone, Debug, PartialEq)]
pub struct SampledState {
    /// The step of the state.
    pub step: u64,
    /// The simulated time, s: step ÷ rate.
    pub time: f64,
    /// All living bodies in creation order, walls included.
    pub bodies: Vec<SampledBody>,
}

/// A body in a [`SampledState`].
#[non_exhaustive]
#[derive(Clone, Debug, PartialEq)]
pub struct SampledBody {
    /// The constants and the initial state.
    pub info: Arc<BodyInfo>,
    /// The upper-left corner, m.
    pub position: Vector,
    /// The velocity, m/s.
    pub velocity: Vector,
}

impl<R: Read + Seek> Playback<R> {
    /// Plays `recording` from its current position.
    pub fn new(recording: Recording<R>) -> Playback<R> {
        Playback { recording, from: 0 }
    }

    /// Moves to `step`: the next state is that of `step` or, if it is not recorded in full, the first full
    /// one after it. Reads the data from the last keyframe on: about one simulated second at most.
    ///
    /// # Errors
    /// Returns an error if the file cannot be read.
    pub fn seek(&mut self, step: u64) -> Result<(), Error> {
        self.from = step;
        self.recording.seek(step)
    }

    /// The header of the recording.
    pub fn header(&self) -> &Header {
        &self.recording.header
    }

    /// Returns the condition of the file; final once the playback has ended.
    pub fn health(&self) -> Health {
        self.recording.health()
    }

    /// The end record, once the playback has ended.
    pub fn trailer(&self) -> Option<&Trailer> {
        self.recording.trailer()
    }

    /// Returns the recording, for further reading.
    pub fn into_recording(self) -> Recording<R> {
        self.recording
    }

    fn sample(&self, state: &RecordedState) -> Option<SampledState> {
        let Header { every, config, .. } = &self.recording.header;
        let table = self.recording.table().filter(|_| state.step.is_multiple_of(*every))?;
        Some(SampledState { step: state.step, time: state.step as f64 / config.rate, bodies: bodies(table, state) })
    }
}

impl<R: Read + Seek> Iterator for Playback<R> {
    type Item = Result<SampledState, Error>;

    fn next(&mut self) -> Option<Self::Item> {
        loop {
            match self.recording.next()? {
                Err(error) => return Some(Err(error)),
                Ok(Item::State(state)) if state.step >= self.from => {
                    if let Some(sample) = self.sample(&state) {
                        return Some(Ok(sample));
                    }
                }
                Ok(Item::State(_) | Item::SuspectState(_) | Item::Event(_) | Item::Keyframe(_)) => {}
                Ok(Item::SceneUpdate { .. } | Item::Damaged(_) | Item::Gap(_) | Item::Trailer(_)) => {}
            }
        }
    }
}

fn bodies(table: &BodyTable, state: &RecordedState) -> Vec<SampledBody> {
    let body = |(info, recorded): (&Arc<BodyInfo>, Option<[f64; 4]>)| {
        let [x, y, vx, vy] = recorded.unwrap_or_else(|| info.initial_state());
        SampledBody { info: Arc::clone(info), position: Vector::new(x, y), velocity: Vector::new(vx, vy) }
    };
    table.join_state(state).map(body).collect()
}
