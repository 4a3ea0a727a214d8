use super::RunError;
use crate::scene::{Input, Place, live};
use std::io::BufRead;

/// What is done with an event line that cannot be obeyed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Manners {
    /// It ends the run with an error that names the line.
    Strict,
    /// It is skipped and counted.
    Lenient,
}

/// Events that come in while a run goes on: one JSON object a line.
///
/// A line takes effect at the step it names; one without a step takes effect one step after
/// the line before it (the first at step 1). So what happens depends on the lines alone, never
/// on when they arrive: before a state is recorded, the run waits until a line for a later
/// step, or the end of input, shows that no more is to come for this one.
pub struct LiveEvents<R> {
    lines: R,
    manners: Manners,
    last_step: u64,
    line: u64,
    skipped: u64,
    latest: u64,
    pending: Option<Input>,
    ended: bool,
}

impl<R: BufRead> LiveEvents<R> {
    /// The events of `lines` for a run whose last state is `last_step`.
    pub fn new(lines: R, manners: Manners, last_step: u64) -> LiveEvents<R> {
        LiveEvents { lines, manners, last_step, line: 0, skipped: 0, latest: 0, pending: None, ended: false }
    }

    /// How many lines were skipped.
    pub fn skipped(&self) -> u64 {
        self.skipped
    }

    /// What is done about an input that cannot be obeyed: it is skipped, or it ends the run.
    ///
    /// # Errors
    /// `error`, when manners are strict.
    pub fn refuse(&mut self, error: RunError) -> Result<(), RunError> {
        match self.manners {
            Manners::Strict => Err(error),
            Manners::Lenient => {
                self.skipped += 1;
                Ok(())
            }
        }
    }

    /// All inputs for the state `step`; waits for lines as long as there may be more.
    ///
    /// # Errors
    /// When lines cannot be read, or one cannot be obeyed and manners are strict.
    pub fn due(&mut self, step: u64) -> Result<Vec<Input>, RunError> {
        let mut due = Vec::new();
        while let Some(input) = self.next_until(step)? {
            due.push(input);
        }
        Ok(due)
    }

    /// The next input if it is for `step`; an input for a later step waits.
    fn next_until(&mut self, step: u64) -> Result<Option<Input>, RunError> {
        while self.pending.is_none() && !self.ended {
            match self.read_line(step) {
                Ok(input) => self.pending = input,
                Err(error @ RunError::Events { .. }) => return Err(error),
                Err(error) => self.refuse(error)?,
            }
        }
        Ok(self.pending.take_if(|input| input.step <= step))
    }

    fn read_line(&mut self, present: u64) -> Result<Option<Input>, RunError> {
        let mut text = Vec::new();
        let read = read_bounded_line(&mut self.lines, &mut text);
        self.ended = read.map_err(|source| RunError::Events { line: self.line, source })? == 0;
        if self.ended {
            return Ok(None);
        }
        self.line += 1;
        let line = self.line;
        if text.len() > LONGEST_LINE {
            return Err(RunError::TooLong { line, limit: LONGEST_LINE });
        }
        let text = str::from_utf8(&text).map_err(|_| RunError::NotText { line })?;
        // Some programs begin a file with a byte order mark.
        let text = if line == 1 { text.trim_start_matches('\u{feff}') } else { text };
        if text.trim().is_empty() {
            return Ok(None);
        }
        let event = live::parse_line(self.line, text.trim_end_matches(['\n', '\r']))?;
        let step = event.step.unwrap_or(self.latest + 1);
        self.check(step, present)?;
        self.latest = step;
        Ok(Some(Input { step, action: event.action, place: Place::Line(self.line) }))
    }

    fn check(&self, named: u64, present: u64) -> Result<(), RunError> {
        let (line, last) = (self.line, self.last_step);
        if named < present {
            return Err(RunError::Late { line, named, present });
        }
        if named > last {
            return Err(RunError::AfterLastStep { line, named, last });
        }
        Ok(())
    }
}

/// Bytes of a line: an event takes a few hundred.
const LONGEST_LINE: usize = 8 * 1024;

/// Reads a line, of which it keeps a little more than it may have; how many bytes were read.
fn read_bounded_line(lines: &mut impl BufRead, text: &mut Vec<u8>) -> std::io::Result<usize> {
    let mut read = 0;
    loop {
        let buffer = match lines.fill_buf() {
            Ok(buffer) => buffer,
            Err(error) if error.kind() == std::io::ErrorKind::Interrupted => continue,
            Err(error) => return Err(error),
        };
        let end = buffer.iter().position(|byte| *byte == b'\n').map(|place| place + 1);
        let part = &buffer[..end.unwrap_or(buffer.len())];
        text.extend(part.iter().take(LONGEST_LINE + 1 - text.len()));
        let count = part.len();
        lines.consume(count);
        read += count;
        if end.is_some() || count == 0 {
            return Ok(read);
        }
    }
}

/// For runs that take no events but the scene's.
pub const NO_LIVE_EVENTS: Option<&mut LiveEvents<std::io::Empty>> = None;
