//! The command line: one file per command. Errors are printed here and nowhere else.

mod against;
mod arguments;
mod body_topics;
mod check;
mod error;
mod error_report;
mod export;
mod figure;
mod github;
mod info;
mod manifest;
mod output;
mod output_file;
mod picture_arguments;
mod record;
mod render;
mod replay;
mod report;
mod review;
mod shell;
mod source;
mod states_table;
mod supervisor;
mod video;

pub use error_report::ErrorReport;
pub(crate) use manifest::read as read_manifest;

use crate::temporary;
use arguments::{
    CheckOptions, CompletionsOptions, ExportOptions, InfoOptions, ManOptions, RecordOptions, RecoverOptions,
    ReplayOptions, ReportOptions,
};
use clap::{Parser, Subcommand};
use error::CommandError;
use picture_arguments::{FigureCommandOptions, RenderOptions};
use std::io::{self, Write};
use std::path::Path;
use std::process::ExitCode;

/// Deterministic 2-D physics of boxes: record, replay bit for bit, draw
#[derive(Debug, Parser)]
#[command(version, arg_required_else_help = true, max_term_width = 100, next_line_help = false)]
pub struct Arguments {
    /// The command.
    #[command(subcommand)]
    pub command: Command,
    /// Print only results and errors
    #[arg(short, long, global = true, display_order = 900)]
    pub quiet: bool,
}

/// The commands.
#[derive(Debug, Subcommand)]
pub enum Command {
    /// Run a scene and record its events and states
    Record(RecordOptions),
    /// Replay a recording and compare every state bit for bit
    Replay(ReplayOptions),
    /// Draw scenes or recordings as an animation or as pictures
    Render(RenderOptions),
    /// Draw a lecture figure of scenes or recordings as PNG, SVG or PDF
    Figure(FigureCommandOptions),
    /// Export states, collisions, energies or bodies as CSV or JSON Lines
    Export(ExportOptions),
    /// Show the contents of a recording, or the provenance of a picture
    Info(InfoOptions),
    /// Check that recordings and pictures are unchanged
    Check(CheckOptions),
    /// Recover the readable part of a damaged or unfinished recording
    Recover(RecoverOptions),
    /// Measure error and cost of both solvers on hard scenes
    Report(ReportOptions),
    /// Print shell completions
    Completions(CompletionsOptions),
    /// Write the manual pages
    Man(ManOptions),
}

/// Runs one command, prints its error if it fails, and returns the exit code.
pub fn run(arguments: Arguments) -> Exit {
    output::set_quiet(arguments.quiet);
    temporary::remove_all_on_interruption();
    let result = match &arguments.command {
        Command::Record(options) => record::run(options),
        Command::Replay(options) => replay::run(options),
        Command::Render(options) => render::run(options),
        Command::Figure(options) => figure::run(options),
        Command::Export(options) => export::run(options),
        Command::Info(options) => info::run(options),
        Command::Check(options) => check::run(options),
        Command::Recover(options) => record::recover(options),
        Command::Report(options) => report::run(options),
        Command::Completions(options) => shell::completions(options),
        Command::Man(options) => shell::man(options),
    };
    result.unwrap_or_else(error::report)
}

/// Prints help, the version or an error of the arguments, and returns the exit code.
pub fn print_usage(message: &clap::Error) -> Exit {
    let printed = message.print().and_then(|()| io::stdout().flush());
    match printed.map_err(CommandError::unwritable(Path::new("-"))) {
        Ok(()) | Err(_) if message.use_stderr() => Exit::Usage,
        Ok(()) => Exit::Done,
        Err(error) => error::report(error),
    }
}

/// The exit code of a command. The argument parser returns 2, too.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Exit {
    /// Success; everything that was compared is the same.
    Done = 0,
    /// Invalid input, an unreadable or missing file, or a result that cannot be written.
    Error = 1,
    /// Options that the command cannot carry out, whatever its inputs contain.
    Usage = 2,
    /// A replay diverged, or something differs from its reference or is missing.
    Diverged = 3,
    /// A recording is incomplete or corrupt: its readable part was used, or it lacks the chosen steps.
    Damaged = 4,
}

impl Exit {
    /// The exit code for two files: an error goes before damage, and damage before a difference, as in `check`.
    fn worse(self, other: Exit) -> Exit {
        let order = [Exit::Usage, Exit::Error, Exit::Damaged, Exit::Diverged];
        order.into_iter().find(|exit| [self, other].contains(exit)).unwrap_or(Exit::Done)
    }

    /// The exit code of a process of this program; another code is none of its own.
    fn of_code(code: i32) -> Option<Exit> {
        [Exit::Done, Exit::Error, Exit::Diverged, Exit::Damaged].into_iter().find(|exit| *exit as i32 == code)
    }
}

impl From<Exit> for ExitCode {
    fn from(exit: Exit) -> ExitCode {
        ExitCode::from(exit as u8)
    }
}
