use super::arguments::RecoverOptions;
use super::error::CommandError;
use super::output_file::{OutputFile, Overwrite};
use super::{Exit, output};
use crate::recording::{self, Error};

/// Writes the readable part of a damaged recording to a new one, and prints what was lost. The exit code says whether
/// anything was.
pub fn run(options: &RecoverOptions) -> Result<Exit, CommandError> {
    let path = &options.recording;
    let overwrite = Overwrite::from_force(options.output.force);
    let output = OutputFile::create(&options.output.output, overwrite, &[path])?;
    let mut recording = recording::open(path).map_err(CommandError::in_recording(path))?;
    let recovery = output.write(|output| match recording::recover(&mut recording, output) {
        Ok((recovery, _)) => Ok(recovery),
        Err(Error::Write(error)) => Err(CommandError::unwritable(&options.output.output)(error)),
        Err(error) => Err(CommandError::in_recording(path)(error)),
    })?;
    output::print_result(&options.output.output, &recovery.to_string())?;
    Ok(if recovery.is_everything() { Exit::Done } else { Exit::Damaged })
}
