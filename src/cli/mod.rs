//! The command line: one file per command. Errors are printed here and nowhere else.

mod arguments;
mod check;
mod completions;
mod error;
mod exit;
mod export;
mod figure;
mod info;
mod jobs;
mod json;
mod man;
mod output;
mod output_kind;
mod picture_arguments;
mod picture_options;
mod progress;
mod record;
mod recover;
mod render;
mod replay;
mod report;
mod shard;
mod source;
mod values;
mod video;
mod warnings;

pub use arguments::{Arguments, Command};
pub use exit::Exit;

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
        Command::Completions(options) => completions::run(options),
        Command::Man(options) => man::run(options),
    };
    result.unwrap_or_else(error::report)
}
