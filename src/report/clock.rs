/// Returns the processor time of this thread, s; on systems that do not report it, wall-clock time.
pub fn processor_seconds() -> f64 {
    #[cfg(unix)]
    {
        let now = rustix::time::clock_gettime(rustix::time::ClockId::ThreadCPUTime);
        now.tv_sec as f64 + now.tv_nsec as f64 * 1e-9
    }
    #[cfg(not(unix))]
    {
        static START: std::sync::LazyLock<std::time::Instant> = std::sync::LazyLock::new(std::time::Instant::now);
        START.elapsed().as_secs_f64()
    }
}

/// A description of what `processor_seconds` measures.
pub const CLOCK: &str = if cfg!(unix) { "processor time of one thread" } else { "wall-clock time" };
