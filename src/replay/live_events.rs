use super::RunError;
use crate::scene::{Input, InputLocation, live};
use std::io::BufRead;

/// The reaction to a line of live events that is invalid or impossible.
#[non_exhaustive]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum OnBadEvent {
    /// The run ends with an error that names the line.
    Fail,
    /// The line is skipped and counted.
    Skip,
}

/// Events that arrive during a run: one JSON object per line.
///
/// A line takes effect at the step that it names; without a step it takes effect one step after
/// the line before it (the first line at step 1). The result depends on the lines alone, not on
/// their time of arrival: before a state is recorded, the run waits for a line of a later step or
/// for the end of the input.
pub struct LiveEvents<R> {
    lines: R,
    on_bad_event: OnBadEvent,
    last_step: u64,
    line: u64,
    skipped: u64,
    latest: u64,
    pending: Option<Input>,
    ended: bool,
}

impl<R: BufRead> LiveEvents<R> {
    /// Reads events from `lines` for a run whose last state is `last_step`.
    pub fn new(lines: R, on_bad_event: OnBadEvent, last_step: u64) -> LiveEvents<R> {
        LiveEvents { lines, on_bad_event, last_step, line: 0, skipped: 0, latest: 0, pending: None, ended: false }
    }

    /// The number of skipped lines.
    pub fn skipped(&self) -> u64 {
        self.skipped
    }

    /// Handles the error of a line: counts it as skipped or returns the error.
    ///
    /// # Errors
    /// Returns `error` with [`OnBadEvent::Fail`].
    pub fn refuse(&mut self, error: RunError) -> Result<(), RunError> {
        match self.on_bad_event {
            OnBadEvent::Fail => Err(error),
            OnBadEvent::Skip => {
                self.skipped += 1;
                Ok(())
            }
        }
    }

    /// Returns all inputs for the state `step`; waits for lines as long as there may be more of them.
    ///
    /// # Errors
    /// Returns an error if lines cannot be read, or, with [`OnBadEvent::Fail`], if a line is invalid.
    pub fn due(&mut self, step: u64) -> Result<Vec<Input>, RunError> {
        let mut due = Vec::new();
        while let Some(input) = self.next_until(step)? {
            due.push(input);
        }
        Ok(due)
    }

    /// Returns the next input if it is for `step`; an input for a later step stays pending.
    fn next_until(&mut self, step: u64) -> Result<Option<Input>, RunError> {
        while self.pending.is_none() && !self.ended {
            match self.read_line(step) {
                Ok(input) => self.pending = input,
                Err(error @ (RunError::Events { .. } | RunError::Endless { .. })) => return Err(error),
                Err(error) => self.refuse(error)?,
            }
        }
        Ok(self.pending.take_if(|input| input.step <= step))
    }

    fn read_line(&mut self, current: u64) -> Result<Option<Input>, RunError> {
        let limit = match self.on_bad_event {
            OnBadEvent::Fail => MAX_LINE_BYTES,
            OnBadEvent::Skip => MAX_SKIPPED_BYTES,
        };
        let mut text = Vec::new();
        let read = read_bounded_line(&mut self.lines, &mut text, limit + LINE_END_BYTES);
        let read = read.map_err(|source| RunError::Events { line: self.line, source })?;
        self.ended = read == 0;
        if self.ended {
            return Ok(None);
        }
        self.line += 1;
        let line = self.line;
        if read > MAX_SKIPPED_BYTES {
            return Err(RunError::Endless { line, limit: MAX_SKIPPED_BYTES });
        }
        let ends: [&[u8]; 2] = [b"\n", b"\r"];
        let text = ends.into_iter().fold(text.as_slice(), |text, end| text.strip_suffix(end).unwrap_or(text));
        if text.len() > MAX_LINE_BYTES {
            return Err(RunError::TooLong { line, limit: MAX_LINE_BYTES });
        }
        let text = str::from_utf8(text).map_err(|_| RunError::NotText { line })?;
        // Some programs begin a file with a byte order mark.
        let text = if line == 1 { text.trim_start_matches('\u{feff}') } else { text };
        if text.trim().is_empty() {
            return Ok(None);
        }
        let event = live::parse_line(self.line, text)?;
        let step = event.step.unwrap_or(self.latest + 1);
        self.check_step(step, current)?;
        self.latest = step;
        Ok(Some(Input { step, action: event.action, location: InputLocation::EventLine(self.line) }))
    }

    fn check_step(&self, named: u64, current: u64) -> Result<(), RunError> {
        let (line, last) = (self.line, self.last_step);
        if named < current {
            return Err(RunError::Late { line, named, current });
        }
        if named > last {
            return Err(RunError::AfterLastStep { line, named, last });
        }
        Ok(())
    }
}

/// The largest length of a line without its end, bytes; an event takes a few hundred.
const MAX_LINE_BYTES: usize = 8 * 1024;

/// The largest length of a line that is skipped, with its end, bytes. A device such as `/dev/zero` has no line break.
const MAX_SKIPPED_BYTES: usize = 16 << 20;

/// Bytes of the longest end of a line, `\r\n`.
const LINE_END_BYTES: usize = 2;

/// Reads a line to its end, but at most `limit` bytes, appends as much of it as an event may have to `text`, and
/// returns the number of bytes read.
fn read_bounded_line(lines: &mut impl BufRead, text: &mut Vec<u8>, limit: usize) -> std::io::Result<usize> {
    let mut read = 0;
    loop {
        let buffer = match lines.fill_buf() {
            Ok(buffer) => buffer,
            Err(error) if error.kind() == std::io::ErrorKind::Interrupted => continue,
            Err(error) => return Err(error),
        };
        let buffer = &buffer[..buffer.len().min(limit - read)];
        let end = buffer.iter().position(|byte| *byte == b'\n').map(|index| index + 1);
        let chunk = &buffer[..end.unwrap_or(buffer.len())];
        text.extend(chunk.iter().take(MAX_LINE_BYTES + LINE_END_BYTES - text.len()));
        let count = chunk.len();
        lines.consume(count);
        read += count;
        if end.is_some() || count == 0 || read == limit {
            return Ok(read);
        }
    }
}

/// The argument of [`record`](super::record) for a run without live events.
pub const NO_LIVE_EVENTS: Option<&mut LiveEvents<std::io::Empty>> = None;
