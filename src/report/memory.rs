//! Memory of the process, as Linux tells it; elsewhere it is not known.

use std::fs;

/// Bytes in use now. What was the most until now is forgotten, so that [`most`] counts from here.
pub fn begin() -> Option<u64> {
    // Fails where the system has no such file: then the most until now stays what it was.
    let _ = fs::write("/proc/self/clear_refs", "5");
    status("VmRSS:")
}

/// The most bytes in use since [`begin`].
pub fn most() -> Option<u64> {
    status("VmHWM:")
}

fn status(key: &str) -> Option<u64> {
    let status = fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find_map(|line| line.strip_prefix(key))?;
    let kilobytes: u64 = line.trim().strip_suffix("kB")?.trim().parse().ok()?;
    Some(kilobytes * 1024)
}

#[cfg(test)]
mod tests {
    #[test]
    #[cfg(target_os = "linux")]
    fn what_is_taken_is_seen() {
        let before = super::begin().unwrap();
        // More by far than other tests give back meanwhile.
        let taken = std::hint::black_box(vec![1_u8; 256 << 20]);
        let most = super::most().unwrap();
        assert!(most >= before + (128 << 20), "{most} bytes of {before} and {}", taken.len());
    }
}
