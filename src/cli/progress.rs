use super::output;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};

/// A bar on standard error for long work: shown on a terminal, silent in a pipe.
pub fn bar(what: &'static str, steps: u64) -> ProgressBar {
    let style = ProgressStyle::with_template("{msg} {wide_bar} {pos}/{len} {eta}")
        .expect("the template is a constant that parses");
    let target = if output::is_quiet() { ProgressDrawTarget::hidden() } else { ProgressDrawTarget::stderr_with_hz(10) };
    let bar = ProgressBar::with_draw_target(Some(steps), target);
    bar.set_style(style);
    bar.set_message(what);
    bar
}

/// What moves a bar: how much is done, and of how much.
pub fn listener(bar: &ProgressBar) -> impl FnMut(u64, u64) {
    move |done, of| {
        bar.set_length(of);
        bar.set_position(done);
    }
}
