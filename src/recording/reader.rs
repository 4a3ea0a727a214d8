use std::{
    fs::File,
    io::{BufReader, Read, Seek},
    path::Path,
};

use super::{Damage, End, Error, Header, Health, Keyframe, RecordedEvent, RecordedState};

/// A recording being read from its start: an iterator of [`Item`]s in file order.
///
/// Memory is that of one chunk. After the last item [`Recording::health`] is final.
pub struct Recording<R> {
    /// What the recording starts with.
    pub header: Header,
    read: R,
}

/// One thing in a recording.
#[derive(Clone, Debug, PartialEq)]
pub enum Item {
    /// Something was done to the world.
    Event(RecordedEvent),
    /// Everything about a step.
    Keyframe(Keyframe),
    /// The state of a step.
    State(RecordedState),
    /// Something could not be read here; events may be missing until the next keyframe.
    Damaged(Damage),
    /// How the run ended.
    End(End),
}

/// Opens the recording at `path`.
///
/// # Errors
/// If it cannot be opened, is no recording, or is newer than this program.
pub fn open(path: &Path) -> Result<Recording<BufReader<File>>, Error> {
    let file = File::open(path).map_err(|source| Error::Open { path: path.into(), source })?;
    Recording::read(BufReader::new(file))
}

impl<R: Read + Seek> Recording<R> {
    /// Reads the head of a recording.
    ///
    /// # Errors
    /// If it is no recording or newer than this program.
    pub fn read(_read: R) -> Result<Recording<R>, Error> {
        todo!()
    }

    /// What reading has shown so far; final once the iterator has ended.
    pub fn health(&self) -> Health {
        todo!()
    }
}

impl<R: Read + Seek> Iterator for Recording<R> {
    type Item = Result<Item, Error>;

    fn next(&mut self) -> Option<Self::Item> {
        let _ = &mut self.read;
        todo!()
    }
}
