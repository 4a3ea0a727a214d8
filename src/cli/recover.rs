use super::arguments::RecoverOptions;
use super::error::CommandError;
use super::{Exit, output};
use crate::recording;

/// Writes the readable part of a damaged recording to a new one, and prints what was lost.
pub fn run(options: &RecoverOptions) -> Result<Exit, CommandError> {
    let path = &options.recording;
    let mut recording = recording::open(path).map_err(CommandError::in_recording(path))?;
    let recovery = output::write_file(&options.output.output, options.output.force, |output| {
        let (recovery, _) = recording::recover(&mut recording, output).map_err(CommandError::in_recording(path))?;
        Ok(recovery)
    })?;
    output::print_result(&options.output.output, &recovery.to_string())?;
    Ok(Exit::Done)
}
