use std::io::{Read, Seek};

use crate::physics::Vector;

use super::{Error, Health, KnownBody, Recording};

/// A recording step by step: every state recorded in full, all bodies alive in it.
///
/// Steps thinned away by [`Header::every`](super::Header::every) are passed over.
pub struct Playback<R> {
    recording: Recording<R>,
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
    pub known: std::rc::Rc<KnownBody>,
    /// Upper-left corner, m.
    pub position: Vector,
    /// m/s.
    pub velocity: Vector,
}

impl<R: Read + Seek> Playback<R> {
    /// Plays `recording` from its start.
    pub fn new(recording: Recording<R>) -> Playback<R> {
        Playback { recording }
    }

    /// What the recording starts with.
    pub fn header(&self) -> &super::Header {
        &self.recording.header
    }

    /// How the recording ended and what state the file is in; meaningful once the
    /// playback has ended.
    pub fn health(&self) -> Health {
        self.recording.health()
    }
}

impl<R: Read + Seek> Iterator for Playback<R> {
    type Item = Result<Frame, Error>;

    fn next(&mut self) -> Option<Self::Item> {
        todo!()
    }
}
