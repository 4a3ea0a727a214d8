//! Everything that commands print: lines on standard output and standard error, and progress bars.

use super::Exit;
use super::error::CommandError;
use super::error_report::printable;
use super::output_file::goes_to_standard_output;
use crate::picture::ReadStatus;
use crate::recording::Health;
use crate::text::Printable;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use std::{
    io::{self, IsTerminal, Write},
    path::Path,
    sync::OnceLock,
    time::{Duration, Instant},
};

/// Writes text to standard output, with its control characters escaped except line breaks and tabs.
///
/// If the reader has closed the pipe, the text is dropped: the reader does not need it, and the work goes on to its
/// exit code.
pub fn print(text: &str) -> Result<(), CommandError> {
    let mut output = io::stdout().lock();
    match write!(output, "{}", Printable(text)).and_then(|()| output.flush()) {
        Err(error) if error.kind() != io::ErrorKind::BrokenPipe => Err(CommandError::StandardOutput(error)),
        Err(_) | Ok(()) => Ok(()),
    }
}

/// Set once, before any command runs.
static QUIET: OnceLock<bool> = OnceLock::new();

/// Suppresses everything but results and errors if `quiet` is true. Only the first call has an effect.
pub fn set_quiet(quiet: bool) {
    let _ = QUIET.set(quiet);
}

/// Returns true if only results and errors are printed.
pub fn is_quiet() -> bool {
    QUIET.get().copied().unwrap_or(false)
}

/// Prints a line on standard error, unless `--quiet` is given.
pub fn info(text: std::fmt::Arguments) {
    if !is_quiet() {
        print_line_to_stderr(text);
    }
}

/// Prints a line on standard error, also with `--quiet`.
pub fn print_line_to_stderr(text: std::fmt::Arguments) {
    let _ = writeln!(io::stderr(), "{}", printable(&text.to_string()));
}

/// Prints text on standard error, also with `--quiet`.
pub fn print_to_stderr(text: &str) {
    let _ = write!(io::stderr(), "{}", Printable(text));
}

/// Prints a line about the result at `path`: on standard output, or on standard error if the result itself goes to
/// standard output.
pub fn print_result(path: &Path, text: &str) -> Result<(), CommandError> {
    if is_quiet() {
        return Ok(());
    }
    print_beside(path, text)
}

/// Prints a text about the result at `path` where [`print_result`] prints it, also with `--quiet`.
pub fn print_beside(path: &Path, text: &str) -> Result<(), CommandError> {
    if goes_to_standard_output(path) {
        print_to_stderr(&format!("{text}\n"));
        return Ok(());
    }
    print(&format!("{text}\n"))
}

/// Warns about each recording that is incomplete or corrupt. Returns the exit code.
pub fn warn_of_damage(statuses: &[ReadStatus]) -> Exit {
    let mut exit = Exit::Done;
    for ReadStatus { path, health, .. } in statuses {
        if *health != Health::Whole {
            print_line_to_stderr(format_args!("{} is {health}", path.display()));
            exit = Exit::Damaged;
        }
    }
    exit
}

/// Creates a progress bar on standard error, which is hidden if standard error is not a terminal.
pub fn progress_bar(label: &'static str, total: u64) -> ProgressBar {
    let style = ProgressStyle::with_template("{msg} {wide_bar} {pos}/{len}, {eta} left")
        .expect("the template is a constant that parses");
    let target = if is_quiet() { ProgressDrawTarget::hidden() } else { ProgressDrawTarget::stderr_with_hz(10) };
    let bar = ProgressBar::with_draw_target(Some(total), target);
    bar.set_style(style);
    bar.set_message(label);
    bar
}

/// Returns a callback that sets the position and length of a bar. Without a terminal, a line is printed now and then.
pub fn progress_updater(bar: &ProgressBar) -> impl FnMut(u64, u64) {
    const INTERVAL: Duration = Duration::from_secs(10);
    let (is_terminal, mut reported) = (io::stderr().is_terminal(), Instant::now());
    move |done, total| {
        bar.set_length(total);
        bar.set_position(done);
        if !is_terminal && reported.elapsed() >= INTERVAL {
            reported = Instant::now();
            info(format_args!("{}: {done} of {total}, {} s left", bar.message(), bar.eta().as_secs()));
        }
    }
}
