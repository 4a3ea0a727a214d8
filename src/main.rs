//! The `rebond` command.

use clap::Parser;
use rebond::internals::cli::{self, Arguments};
use std::process::ExitCode;

fn main() -> ExitCode {
    cli::run(Arguments::parse()).into()
}
