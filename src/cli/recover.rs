use super::arguments::RecoverOptions;
use super::error::CommandError;
use super::{Exit, output};
use crate::recording;

/// Writes the readable part of a damaged recording to a new one, and prints what was lost.
pub fn run(options: &RecoverOptions) -> Result<Exit, CommandError> {
    let failed = |error| CommandError::recording(&options.recording, error);
    let mut recording = recording::open(&options.recording).map_err(failed)?;
    let mut recovery = None;
    output::write_file(&options.output.output, options.output.force, |output| {
        recovery = Some(recording::recover(&mut recording, output).map_err(failed)?.0);
        Ok(())
    })?;
    let summary = recovery.map_or(String::new(), |recovery| recovery.to_string());
    output::print_result(&options.output.output, &summary)?;
    Ok(Exit::Done)
}
