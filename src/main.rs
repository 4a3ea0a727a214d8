//! The `rebond` command.

use clap::Parser;
use rebond::cli::{self, Arguments};
use std::process::ExitCode;

fn main() -> ExitCode {
    cli::run(Arguments::parse()).into()
}
