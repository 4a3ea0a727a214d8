use rebond::internals::replay::RecordingRun;
use rebond::{LiveEvents, OnBadEvent, RecordOptions, Scene};
use std::io::{self, Cursor, Write};
use std::sync::{Arc, Mutex, PoisonError};

/// The recording of a session: a run from its scene and lines, in slices. Its bytes are those of
/// `rebond record SCENE --events LINES`.
pub struct Save {
    recording: Option<RecordingRun<Sink>>,
    lines: LiveEvents<Cursor<Vec<u8>>>,
    sink: Sink,
    /// The last step that is recorded.
    pub step: u64,
}

impl Save {
    /// Starts the recording of `scene` with `lines`.
    ///
    /// # Errors
    /// The message of a recording that cannot be started.
    pub fn new(scene: &Scene, lines: String) -> Result<Save, String> {
        let sink = Sink::default();
        let options = RecordOptions::complete(scene);
        let options = if lines.is_empty() { options } else { options.live_events() };
        let recording = RecordingRun::new(scene, options, sink.clone()).map_err(|error| error.to_string())?;
        let lines = LiveEvents::new(Cursor::new(lines.into_bytes()), OnBadEvent::Fail, options.steps);
        Ok(Save { recording: Some(recording), lines, sink, step: 0 })
    }

    /// Records up to `states` states and returns the file if it is complete.
    ///
    /// # Errors
    /// The message of a line that is refused.
    pub fn advance(&mut self, states: u64) -> Result<Option<Vec<u8>>, String> {
        for _ in 0..states {
            let recording = self.recording.as_mut().ok_or("the recording is finished")?;
            match recording.record_state(Some(&mut self.lines)).map_err(|error| error.to_string())? {
                Some(step) => self.step = step,
                None => {
                    let finished = self.recording.take().map(RecordingRun::finish);
                    finished.transpose().map_err(|error| error.to_string())?;
                    return Ok(Some(self.sink.take()));
                }
            }
        }
        Ok(None)
    }
}

/// Bytes that the recording and the page share.
#[derive(Clone, Default)]
struct Sink(Arc<Mutex<Vec<u8>>>);

impl Sink {
    fn take(&self) -> Vec<u8> {
        std::mem::take(&mut self.0.lock().unwrap_or_else(PoisonError::into_inner))
    }
}

impl Write for Sink {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).extend_from_slice(bytes);
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}
