use super::arguments::RecoverOptions;
use super::error::CommandError;
use super::{Exit, output};
use crate::recording;

/// Saves all that can be read of a damaged recording, and says what could not.
pub fn run(options: &RecoverOptions) -> Result<Exit, CommandError> {
    let failed = |error| CommandError::recording(&options.recording, error);
    let mut recording = recording::open(&options.recording).map_err(failed)?;
    let mut recovery = None;
    output::write_file(&options.output.output, options.output.force, |output| {
        recovery = Some(recording::recover(&mut recording, output).map_err(failed)?.0);
        Ok(())
    })?;
    let told = recovery.map_or(String::new(), |recovery| recovery.to_string());
    output::tell(&options.output.output, &told)?;
    Ok(Exit::Done)
}
