use super::arguments::{Arguments, CompletionsOptions};
use super::{Exit, error::CommandError, output};
use clap::CommandFactory;

/// Writes the completions for a shell to standard output.
pub fn run(options: &CompletionsOptions) -> Result<Exit, CommandError> {
    let mut script = Vec::new();
    clap_complete::generate(options.shell, &mut Arguments::command(), "rebond", &mut script);
    output::print(&script)?;
    Ok(Exit::Done)
}
