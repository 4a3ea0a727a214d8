use super::case::{Case, RunSpec, SceneRunner};
use crate::physics::CollisionCount;
use crate::replay::RunError;
use crate::scene::Scene;
use serde::{Deserialize, Serialize};
use std::fs;

/// The cost of one run, measured without recording or reading states.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Cost {
    /// Processor time per body of finite mass and step, ns; the median of several runs.
    pub ns_per_body_step: f64,
    /// Minimum and maximum of these runs, ns.
    pub ns_spread: [f64; 2],
    /// Collisions per second of processor time.
    pub events_per_second: f64,
    /// Peak memory of the run above that of the process before it, bytes; `None` where the system
    /// does not report it.
    pub peak_bytes: Option<u64>,
}

/// A run is repeated at least `MIN_RUNS` times and for at least `MIN_SECONDS` of processor time; no
/// run is started after `MAX_SECONDS`.
const MIN_RUNS: usize = 5;
const MIN_SECONDS: f64 = 0.1;
const MAX_SECONDS: f64 = 1.5;

impl Cost {
    /// Measures a run. If it ends in an error, the part up to the error is measured. `None` if no body of finite mass
    /// takes a step.
    ///
    /// # Errors
    /// Returns an error if an input of the scene is invalid.
    pub fn measure(case: &Case, scene: &Scene, spec: RunSpec) -> Result<Option<Cost>, RunError> {
        let before = reset_peak_memory();
        let mut start = SceneRunner::start(scene)?;
        let _ = start.advance_to(case.from * spec.factor, &mut CollisionCount::default())?;
        // The first run warms the caches and determines the peak memory.
        let first = TimedRun::measure(start.clone(), scene.run.steps)?;
        if first.body_steps == 0 {
            return Ok(None);
        }
        let peak_bytes = before.zip(peak_memory()).map(|(before, peak)| peak.saturating_sub(before));
        let mut runs = if first.seconds > MAX_SECONDS { vec![first] } else { Vec::new() };
        while !is_enough(&runs) {
            runs.push(TimedRun::measure(start.clone(), scene.run.steps)?);
        }
        runs.sort_by(|a, b| a.nanoseconds().total_cmp(&b.nanoseconds()));
        let median = runs[runs.len() / 2];
        Ok(Some(Cost {
            ns_per_body_step: median.nanoseconds(),
            ns_spread: [runs[0], runs[runs.len() - 1]].map(TimedRun::nanoseconds),
            events_per_second: median.events as f64 / median.seconds,
            peak_bytes,
        }))
    }
}

fn is_enough(runs: &[TimedRun]) -> bool {
    let seconds: f64 = runs.iter().map(|run| run.seconds).sum();
    (runs.len() >= MIN_RUNS && seconds >= MIN_SECONDS) || seconds > MAX_SECONDS
}

/// One timed run.
#[derive(Clone, Copy)]
struct TimedRun {
    seconds: f64,
    events: u64,
    body_steps: u64,
}

impl TimedRun {
    fn measure(mut runner: SceneRunner, steps: u64) -> Result<TimedRun, RunError> {
        let mut collisions = CollisionCount::default();
        let (mut body_steps, start) = (0, processor_seconds());
        let mut is_over = false;
        while !is_over {
            // The bodies change only where the scene has inputs.
            let bodies = runner.world().bodies.iter().filter(|body| !body.is_infinite()).count() as u64;
            let (first, next) = (runner.current_step(), runner.next_input_step().unwrap_or(steps).min(steps));
            // If the run ends in an error, the time up to the error counts.
            let result = runner.advance_to(next, &mut collisions)?;
            body_steps += bodies * (runner.current_step() - first).max(1);
            is_over = result.is_err() || next == steps;
        }
        Ok(TimedRun { seconds: processor_seconds() - start, events: collisions.0, body_steps })
    }

    fn nanoseconds(self) -> f64 {
        self.seconds * 1e9 / self.body_steps as f64
    }
}

/// Returns the processor time of this thread, s; on systems that do not report it, wall-clock time.
fn processor_seconds() -> f64 {
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

/// Resets the peak and returns the memory in use, bytes. [`peak_memory`] then counts from here.
fn reset_peak_memory() -> Option<u64> {
    // Where the system has no such file the peak is not reset.
    let _ = fs::write("/proc/self/clear_refs", "5");
    memory_status("VmRSS:")
}

/// Returns the peak memory since [`reset_peak_memory`], bytes.
fn peak_memory() -> Option<u64> {
    memory_status("VmHWM:")
}

/// Memory of the process as reported by Linux, bytes; unknown on other systems.
fn memory_status(key: &str) -> Option<u64> {
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
        let before = super::reset_peak_memory().unwrap();
        // Far more than other tests free at the same time.
        let allocated = std::hint::black_box(vec![1_u8; 256 << 20]);
        let peak = super::peak_memory().unwrap();
        assert!(peak >= before + (128 << 20), "peak {peak} bytes, before {before}, allocated {}", allocated.len());
    }
}
