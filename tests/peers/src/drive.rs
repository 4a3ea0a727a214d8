//! Runs a [`Job`] in an engine that Rust can call; `drive.mjs` and `chipmunk.py` do the same.

use crate::{
    clock::cpu_seconds,
    job::{Answer, Job},
};

/// A world of one engine, ready to step.
pub trait Peer {
    /// One step of 1/rate.
    ///
    /// # Errors
    /// In words, when the engine cannot go on.
    fn step(&mut self) -> Result<(), String>;
    /// x, y of the upper-left corner in m, vx, vy in m/s.
    fn state(&self, body: usize) -> [f64; 4];
    /// Collisions so far, where the engine counts them.
    fn collisions(&self) -> Option<u64> {
        None
    }
}

/// Makes the world of a job, or says why the engine cannot.
pub type Build = fn(&Job) -> Result<Box<dyn Peer>, String>;

/// Processor time that the repeats of a short run fill, s, and of a long run do not exceed by much.
const REPEATS: [f64; 2] = [0.3, 4.0];

/// First a pass that is looked at, which also warms up; then passes that only step.
pub fn drive(job: &Job, version: String, build: Build) -> Answer {
    let mut answer = Answer { version, ..Answer::default() };
    if let Err(reason) = look(job, build, &mut answer) {
        answer.refused = Some(reason);
        return answer;
    }
    let mut total = 0.0;
    let mut batch = 1;
    loop {
        let seconds = time(job, build, answer.steps, batch);
        let pass: f64 = seconds.iter().sum();
        if batch == 1 && pass < 0.01 {
            batch = (0.02 / pass).ceil().clamp(2.0, 200.0) as u32;
            continue;
        }
        total += pass * f64::from(batch);
        answer.seconds.push(seconds);
        let enough = answer.seconds.len() >= 5 && total >= REPEATS[0];
        if enough || total >= REPEATS[1] {
            return answer;
        }
    }
}

fn look(job: &Job, build: Build, answer: &mut Answer) -> Result<(), String> {
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

/// Processor time of each phase of one world, s, the mean of a batch of them.
fn time(job: &Job, build: Build, mut steps: u64, batch: u32) -> Vec<f64> {
    let mut seconds = vec![0.0; job.phases.len()];
    let whole = steps;
    for _ in 0..batch {
        let mut world = build(job).expect("it was built before");
        steps = whole;
        for (phase, seconds) in job.phases.iter().zip(&mut seconds) {
            let part = steps.min(*phase);
            steps -= part;
            let start = cpu_seconds();
            for _ in 0..part {
                world.step().expect("it did before");
            }
            *seconds += (cpu_seconds() - start) / f64::from(batch);
        }
    }
    seconds
}
