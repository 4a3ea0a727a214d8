//! The command line: one file per command. Errors are printed here and nowhere else.

mod arguments;
mod check;
mod error;
mod export;
mod figure;
mod info;
mod manifest;
mod output;
mod picture_arguments;
mod record;
mod recover;
mod render;
mod replay;
mod report;
mod scene_report;
mod shell;
mod source;
mod video;

pub use arguments::{Arguments, Command};
pub use scene_report::SceneReport;

use std::process::ExitCode;

/// Runs one command, prints its error if it fails, and returns the exit code.
pub fn run(arguments: Arguments) -> Exit {
    output::set_quiet(arguments.quiet);
    let result = match &arguments.command {
        Command::Record(options) => record::run(options),
        Command::Replay(options) => replay::run(options),
        Command::Render(options) => render::run(options),
        Command::Figure(options) => figure::run(options),
        Command::Export(options) => export::run(options),
        Command::Info(options) => info::run(options),
        Command::Check(options) => check::run(options),
        Command::Recover(options) => recover::run(options),
        Command::Report(options) => report::run(options),
        Command::Completions(options) => shell::completions(options),
        Command::Man(options) => shell::man(options),
    };
    result.unwrap_or_else(error::report)
}

/// The exit code of a command. (2, wrong usage, is returned by the argument parser.)
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Exit {
    /// Success; everything that was compared is the same.
    Done = 0,
    /// Invalid input, an unreadable or missing file, or a result that cannot be written.
    Error = 1,
    /// A replay diverged or a picture differs.
    Diverged = 3,
    /// A recording is truncated or corrupt; the part that could be read is the same.
    Damaged = 4,
}

impl From<Exit> for ExitCode {
    fn from(exit: Exit) -> ExitCode {
        ExitCode::from(exit as u8)
    }
}
