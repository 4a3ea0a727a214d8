//! The `rebond` command.

use clap::Parser;
use rebond::internals::cli::{self, Arguments};
use std::process::ExitCode;

fn main() -> ExitCode {
    Arguments::try_parse().map_or_else(|error| cli::print_usage(&error), cli::run).into()
}
