//! Interruption of the process: temporary files are removed before it ends.

use crate::temporary;

/// Removes temporary files on SIGINT, SIGTERM and SIGHUP, and then ends the process by the same signal, so that shells
/// and parent processes see the interruption. Signals that the parent process ignores stay ignored, as under `nohup`.
#[cfg(unix)]
pub fn remove_temporary_files_on_interruption() {
    use signal_hook::consts::{SIGHUP, SIGINT, SIGTERM};
    use signal_hook::{iterator::Signals, low_level};

    let ignored = ignored_signals();
    let handled = [SIGINT, SIGTERM, SIGHUP].into_iter().filter(|signal| ignored >> (signal - 1) & 1 == 0);
    let Ok(mut signals) = Signals::new(handled) else { return };
    std::thread::spawn(move || {
        if let Some(signal) = signals.forever().next() {
            temporary::remove_all();
            let _ = low_level::emulate_default_handler(signal);
        }
    });
}

/// The signals that are ignored from the start, bit n − 1 for signal n. Known only on Linux, 0 elsewhere.
#[cfg(unix)]
fn ignored_signals() -> u64 {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let mask = status.lines().find_map(|line| line.strip_prefix("SigIgn:"));
    mask.and_then(|mask| u64::from_str_radix(mask.trim(), 16).ok()).unwrap_or(0)
}

/// Removes temporary files on Ctrl-C, on Ctrl-Break and when the window is closed, and then ends the process.
#[cfg(windows)]
pub fn remove_temporary_files_on_interruption() {
    /// STATUS_CONTROL_C_EXIT, the exit code of a process that does not handle Ctrl-C.
    const INTERRUPTED: i32 = 0xC000_013A_u32 as i32;
    // Without a handler the process ends as well, and leaves its temporary files behind.
    let _ = ctrlc::set_handler(|| {
        temporary::remove_all();
        std::process::exit(INTERRUPTED);
    });
}

/// Other systems have no signals that could be handled.
#[cfg(not(any(unix, windows)))]
pub fn remove_temporary_files_on_interruption() {}
