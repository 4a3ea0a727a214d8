//! Memory of the process as reported by Linux; unknown on other systems.

use std::fs;

/// Resets the peak and returns the memory in use, bytes. [`peak`] then counts from here.
pub fn reset_peak() -> Option<u64> {
    // Where the system has no such file the peak is not reset.
    let _ = fs::write("/proc/self/clear_refs", "5");
    status("VmRSS:")
}

/// Returns the peak memory since [`reset_peak`], bytes.
pub fn peak() -> Option<u64> {
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
    fn allocated_memory_raises_the_peak() {
        let before = super::reset_peak().unwrap();
        // Far more than other tests free at the same time.
        let allocated = std::hint::black_box(vec![1_u8; 256 << 20]);
        let peak = super::peak().unwrap();
        assert!(peak >= before + (128 << 20), "peak {peak} bytes, before {before}, allocated {}", allocated.len());
    }
}
