//! Runs a [`Job`] in an engine that Rust can call; `drive.mjs` and `chipmunk.py` do the same.

use crate::{
    clock::cpu_seconds,
    job::{Answer, Job},
};

/// A world of one engine, ready to step.
pub trait PeerWorld {
    /// Advances by one step of 1/rate.
    ///
    /// # Errors
    /// A description, if the engine cannot continue.
    fn step(&mut self) -> Result<(), String>;
    /// The x and y of the upper-left corner of a body, m, and its vx and vy, m/s.
    fn state(&self, body: usize) -> [f64; 4];
    /// The number of collisions so far, if the engine counts them.
    fn collisions(&self) -> Option<u64> {
        None
    }
}

/// Creates the world of a job, or returns the reason why the engine cannot.
pub type Build = fn(&Job) -> Result<Box<dyn PeerWorld>, String>;

/// The least total processor time of the timed passes of a short run, s.
const MIN_TIMED: f64 = 0.3;

/// The total processor time after which no further pass is timed, s.
const MAX_TIMED: f64 = 4.0;

/// Runs a job: one pass whose states are sampled, which also warms up, then passes that only step and are timed.
pub fn drive(job: &Job, version: String, build: Build) -> Answer {
    let mut answer = Answer { version, ..Answer::default() };
    if let Err(reason) = run_sampled(job, build, &mut answer) {
        answer.refused = Some(reason);
        return answer;
    }
    let mut total = 0.0;
    let mut batch = 1;
    loop {
        let seconds = time_phases(job, build, answer.steps, batch);
        let pass: f64 = seconds.iter().sum();
        if batch == 1 && pass < 0.01 {
            batch = (0.02 / pass).ceil().clamp(2.0, 200.0) as u32;
            continue;
        }
        total += pass * f64::from(batch);
        answer.seconds.push(seconds);
        let is_enough = answer.seconds.len() >= 5 && total >= MIN_TIMED;
        if is_enough || total >= MAX_TIMED {
            return answer;
        }
    }
}

/// Runs the job once and writes its samples.
fn run_sampled(job: &Job, build: Build, answer: &mut Answer) -> Result<(), String> {
    let mut world = build(job)?;
    let mut samples = Vec::new();
    let start = cpu_seconds();
    for step in 1..=job.steps() {
        world.step()?;
        answer.steps = step;
        if step % job.sample_every == 0 {
            let states = (0..job.bodies.len()).flat_map(|body| world.state(body));
            samples.extend(states.flat_map(f64::to_le_bytes));
            if cpu_seconds() - start > job.limit {
                break;
            }
        }
    }
    answer.collisions = world.collisions();
    std::fs::write(&job.samples, samples).map_err(|error| error.to_string())
}

/// The processor time of each phase, s: the mean over a batch of runs of the first `steps` steps.
fn time_phases(job: &Job, build: Build, steps: u64, batch: u32) -> Vec<f64> {
    let mut seconds = vec![0.0; job.phases.len()];
    for _ in 0..batch {
        let mut world = build(job).expect("the world was built before");
        let mut remaining = steps;
        for (phase, seconds) in job.phases.iter().zip(&mut seconds) {
            let count = remaining.min(*phase);
            remaining -= count;
            let start = cpu_seconds();
            for _ in 0..count {
                world.step().expect("the step succeeded before");
            }
            *seconds += (cpu_seconds() - start) / f64::from(batch);
        }
    }
    seconds
}
