use std::{
    io::{Read, Seek},
    sync::Arc,
};

use crate::physics::Vector;

use super::{BodyTable, End, Error, Header, Health, Item, KnownBody, RecordedState, Recording};

/// A recording step by step: every state recorded in full, all bodies alive in it.
///
/// Steps thinned away by [`Header::every`] are passed over, and so is what cannot be
/// trusted: see [`Playback::health`].
pub struct Playback<R> {
    recording: Recording<R>,
    from: u64,
}

/// One state of a [`Playback`].
#[derive(Clone, Debug, PartialEq)]
pub struct Frame {
    /// Number of the state.
    pub step: u64,
    /// Seconds since the start of the run: step ÷ rate.
    pub time: f64,
    /// All bodies alive in creation order, walls included.
    pub bodies: Vec<FrameBody>,
}

/// A body in a [`Frame`].
#[derive(Clone, Debug, PartialEq)]
pub struct FrameBody {
    /// What never changes about it.
    pub known: Arc<KnownBody>,
    /// Upper-left corner, m.
    pub position: Vector,
    /// m/s.
    pub velocity: Vector,
}

impl<R: Read + Seek> Playback<R> {
    /// Plays `recording` from where it stands.
    pub fn new(recording: Recording<R>) -> Playback<R> {
        Playback { recording, from: 0 }
    }

    /// Goes to `step`: the next frame is that of it or, if that is not recorded, the first
    /// one after it. What comes before is not read, but for less than about a second.
    ///
    /// # Errors
    /// If the system cannot read.
    pub fn seek(&mut self, step: u64) -> Result<(), Error> {
        self.from = step;
        self.recording.seek(step)
    }

    /// What the recording starts with.
    pub fn header(&self) -> &Header {
        &self.recording.header
    }

    /// In which state the file is; final once the playback has ended.
    pub fn health(&self) -> Health {
        self.recording.health()
    }

    /// How the run ended, once the playback has.
    pub fn end(&self) -> Option<&End> {
        self.recording.end()
    }

    /// The recording, to be read on.
    pub fn into_recording(self) -> Recording<R> {
        self.recording
    }

    fn frame(&self, state: &RecordedState) -> Option<Frame> {
        let Header { every, settings, .. } = &self.recording.header;
        let table = self.recording.table().filter(|_| state.step.is_multiple_of(*every))?;
        Some(Frame { step: state.step, time: state.step as f64 / settings.rate, bodies: bodies(table, state) })
    }
}

impl<R: Read + Seek> Iterator for Playback<R> {
    type Item = Result<Frame, Error>;

    fn next(&mut self) -> Option<Self::Item> {
        loop {
            match self.recording.next()? {
                Err(error) => return Some(Err(error)),
                Ok(Item::State(state)) if state.step >= self.from => {
                    if let Some(frame) = self.frame(&state) {
                        return Some(Ok(frame));
                    }
                }
                Ok(Item::State(_) | Item::Doubtful(_) | Item::Event(_) | Item::Keyframe(_)) => {}
                Ok(Item::View { .. } | Item::Damaged(_) | Item::Gap(_) | Item::End(_)) => {}
            }
        }
    }
}

fn bodies(table: &BodyTable, state: &RecordedState) -> Vec<FrameBody> {
    let body = |(known, moved): (&Arc<KnownBody>, Option<[f64; 4]>)| {
        let [x, y, vx, vy] = moved.unwrap_or_else(|| known.first_numbers());
        FrameBody { known: Arc::clone(known), position: Vector::new(x, y), velocity: Vector::new(vx, vy) }
    };
    table.with_state(state).map(body).collect()
}
