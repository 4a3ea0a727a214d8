//! The command line: one file per command, and the edge where errors become reports.

mod arguments;
mod check;
mod completions;
mod damage;
mod error;
mod exit;
mod export;
mod figure;
mod info;
mod jobs;
mod json;
mod kind;
mod man;
mod output;
mod picture_arguments;
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
mod wish;

pub use arguments::{Arguments, Command};
pub use exit::Exit;

/// Runs one command to its end and says how it ended; errors are reported on the way.
pub fn run(arguments: Arguments) -> Exit {
    output::be_quiet(arguments.quiet);
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
