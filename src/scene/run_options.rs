use super::{
    Diagnostic, DiagnosticKind,
    diagnostics::Reported,
    tree::{Key, Node, Table},
};
use crate::physics::{DEFAULT_EVENTS_PER_STEP, SolverKind};

/// The `[run]` table of a scene: duration, sampling and solver.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RunOptions {
    /// Steps per second, Hz; finite and positive.
    pub rate: f64,
    /// The number of steps; the run has the states 0..=steps.
    pub steps: u64,
    /// The solver.
    pub solver: SolverKind,
    /// The largest number of events within one step; the run ends with an error beyond it.
    pub events_per_step: u64,
}

/// The rate of a scene that gives none, Hz.
pub const DEFAULT_RATE: f64 = 60.0;

/// The solver of a scene that gives none.
pub const DEFAULT_SOLVER: SolverKind = SolverKind::EventDriven;

/// The longest run, s: a recording stores its nanoseconds in 64 bits.
const MAX_SECONDS: f64 = 18_446_744_073.0;

const RATE: Key = Key { name: "rate", accepts: "a positive number of steps per second" };
const STEPS: Key = Key { name: "steps", accepts: "a whole number of steps, at most 584 simulated years" };
const DURATION: Key = Key { name: "duration", accepts: "a number of seconds, 0 or more and at most 584 years" };
const SOLVER: Key = Key { name: "solver", accepts: "\"handout\" or \"event-driven\"" };
const EVENTS_PER_STEP: Key = Key { name: "events_per_step", accepts: "a whole number of events, 1 or more" };

/// The keys of `[run]`.
pub const KEYS: &[Key] = &[RATE, STEPS, DURATION, SOLVER, EVENTS_PER_STEP];

/// Reads `[run]`. The number of steps is returned on its own because it may be known even if other options
/// are not.
pub fn read(table: &Table) -> (Result<RunOptions, Reported>, Result<u64, Reported>) {
    let rate = table
        .optional(RATE, |node| node.number_where(|rate| rate > 0.0 && (1.0 / rate).is_finite()))
        .map(|rate| rate.unwrap_or(DEFAULT_RATE));
    let steps = read_steps(table, rate);
    let solver = table.optional(SOLVER, |node| SolverKind::from_name(node.text()?).ok_or(node));
    let events_per_step = table.optional(EVENTS_PER_STEP, |node| node.count_in(1..=u64::MAX));
    let options = || {
        Ok(RunOptions {
            rate: rate?,
            steps: steps?,
            solver: solver?.unwrap_or(DEFAULT_SOLVER),
            events_per_step: events_per_step?.unwrap_or(DEFAULT_EVENTS_PER_STEP),
        })
    };
    (options(), steps)
}

fn read_steps(table: &Table, rate: Result<f64, Reported>) -> Result<u64, Reported> {
    let fits = |steps: f64, rate: f64| steps / rate <= MAX_SECONDS && steps < u64::MAX as f64;
    match (table.get(STEPS)?, table.get(DURATION)?) {
        (Some(steps), None) => steps.read(|node| {
            let count = node.count()?;
            let is_accepted = rate.map_or(true, |rate| fits(count as f64, rate));
            if is_accepted { Ok(count) } else { Err(node) }
        }),
        (None, Some(duration)) => {
            let seconds = |rate: f64, node| {
                Node::number_where(node, |seconds| seconds >= 0.0 && fits((seconds * rate).round(), rate))
            };
            match rate {
                Ok(rate) => Ok((duration.read(|node| seconds(rate, node))? * rate).round() as u64),
                Err(reported) => {
                    duration.read(|node| node.number_where(|seconds| seconds >= 0.0))?;
                    Err(reported)
                }
            }
        }
        (Some(_), Some(duration)) => {
            let kind = DiagnosticKind::ExclusiveKeys { keys: ["run.steps", "run.duration"] };
            Err(duration.report(Diagnostic::new(kind, duration.node.span.clone())))
        }
        (None, None) => {
            let accepts = "a whole number of steps; or give duration, in seconds";
            Err(table.report_missing(Key { name: "steps", accepts }))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{diagnostics::Reporter, tree::parse_toml};

    fn run(keys: &str) -> RunOptions {
        read(&Table::open("run", &parse_toml(keys).unwrap(), KEYS, &Reporter::default()).unwrap()).0.unwrap()
    }

    #[test]
    fn a_duration_is_rounded_to_the_nearest_step() {
        let steps = |keys: &str| run(&format!("solver = \"handout\"\n{keys}")).steps;
        assert_eq!(steps("rate = 60\nduration = 10.0"), 600);
        assert_eq!(steps("rate = 0.3\nduration = 10"), 3);
        assert_eq!(steps("rate = 7\nduration = 0.5"), 4, "3.5 is rounded away from 0");
        assert_eq!(steps("rate = 1e-300\nduration = 1"), 0);
    }

    #[test]
    fn all_keys_but_the_steps_have_defaults() {
        let expected = RunOptions { rate: 60.0, steps: 5, solver: SolverKind::EventDriven, events_per_step: 1_000_000 };
        assert_eq!(run("steps = 5"), expected);
        assert_eq!(run("duration = 0.25").steps, 15);
    }
}
