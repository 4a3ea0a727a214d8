use super::{
    Fault,
    refusal::Refusal,
    tree::{Key, Node, Table},
};
use crate::physics::{DEFAULT_EVENTS_PER_STEP, SolverKind};

/// How far, how finely and by which solver: the scene's `[run]`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RunOptions {
    /// Steps per second, Hz; finite and positive.
    pub rate: f64,
    /// Steps from the first state to the last, so that states are 0..=steps.
    pub steps: u64,
    /// Which solver.
    pub solver: SolverKind,
    /// How much may happen within one step before the run is given up.
    pub events_per_step: u64,
}

/// The longest run, s: a recording counts its nanoseconds in 64 bits.
const LONGEST: f64 = 18_446_744_073.0;

const RATE: Key = Key { name: "rate", accepts: "a positive number of steps per second" };
const STEPS: Key = Key { name: "steps", accepts: "a whole number of steps, no more than 584 simulated years" };
const DURATION: Key = Key { name: "duration", accepts: "a number of seconds, 0 or more, and no more than 584 years" };
const SOLVER: Key = Key { name: "solver", accepts: "\"handout\" or \"event-driven\"" };
const EVENTS_PER_STEP: Key = Key { name: "events_per_step", accepts: "a whole number of events, 1 or more" };

pub fn read(node: &Node) -> Result<RunOptions, Refusal> {
    let table = Table::open("run", node, &[RATE, STEPS, DURATION, SOLVER, EVENTS_PER_STEP])?;
    let rate = table.required(RATE, |node| node.number_where(|rate| rate > 0.0 && (1.0 / rate).is_finite()))?;
    Ok(RunOptions {
        rate,
        steps: read_steps(&table, rate)?,
        solver: table.required(SOLVER, |node| SolverKind::named(node.text()?).ok_or(node))?,
        events_per_step: table
            .optional(EVENTS_PER_STEP, |node| node.count_in(1..=u64::MAX))?
            .unwrap_or(DEFAULT_EVENTS_PER_STEP),
    })
}

fn read_steps(table: &Table, rate: f64) -> Result<u64, Refusal> {
    let lasts = |steps: f64| steps / rate <= LONGEST && steps < u64::MAX as f64;
    match (table.get(STEPS), table.get(DURATION)) {
        (Some(steps), None) => {
            steps.read(|node| node.count().and_then(|count| if lasts(count as f64) { Ok(count) } else { Err(node) }))
        }
        (None, Some(duration)) => {
            let steps =
                duration.read(|node| node.number_where(|seconds| seconds >= 0.0 && lasts((seconds * rate).round())))?;
            Ok((steps * rate).round() as u64)
        }
        (Some(_), Some(duration)) => {
            Err(Refusal::new(Fault::EitherOr { keys: ["run.steps", "run.duration"] }, duration.node.span.clone()))
        }
        (None, None) => {
            Err(table.missing(Key { name: "steps", accepts: "a whole number of steps; or say duration, in seconds" }))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::tree::parse_toml;

    fn run(keys: &str) -> RunOptions {
        read(&parse_toml(keys).unwrap()).unwrap()
    }

    #[test]
    fn a_duration_is_rounded_to_the_nearest_step() {
        let steps = |keys: &str| run(&format!("solver = \"handout\"\n{keys}")).steps;
        assert_eq!(steps("rate = 60\nduration = 10.0"), 600);
        assert_eq!(steps("rate = 0.3\nduration = 10"), 3);
        assert_eq!(steps("rate = 7\nduration = 0.5"), 4, "3.5 goes away from 0");
        assert_eq!(steps("rate = 1e-300\nduration = 1"), 0);
    }

    #[test]
    fn the_limit_of_events_has_a_default() {
        let run = run("rate = 100\nsteps = 5\nsolver = \"event-driven\"");
        let expected =
            RunOptions { rate: 100.0, steps: 5, solver: SolverKind::EventDriven, events_per_step: 1_000_000 };
        assert_eq!(run, expected);
    }
}
