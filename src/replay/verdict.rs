use std::fmt::{self, Display, Formatter};

use crate::recording::{Damage, Health, Missing};
use crate::text::counted;

/// The result of a replay.
#[non_exhaustive]
#[derive(Clone, Debug, PartialEq)]
pub enum Verdict {
    /// All compared states are the same.
    Same {
        /// The number of steps that are the same.
        steps: u64,
        /// The number of bodies ever spawned, walls included.
        bodies: u64,
        /// The error that ended the recorded run, reproduced by the replay.
        error: Option<String>,
    },
    /// A state differs.
    Diverged(Box<Divergence>),
    /// Parts of the recording are missing; all its states are the same.
    Incomplete {
        /// The missing parts.
        missing: Missing,
        /// The number of steps that are the same.
        steps: u64,
    },
    /// Part of the recording is damaged; all readable states are the same.
    Corrupt {
        /// The first damage.
        damage: Damage,
        /// The missing parts.
        missing: Missing,
        /// The number of steps that are the same.
        steps: u64,
    },
}

impl Verdict {
    /// Returns the condition of the recording; `None` for a divergence.
    pub fn health(&self) -> Option<Health> {
        match self {
            Verdict::Same { .. } => Some(Health::Whole),
            Verdict::Diverged(_) => None,
            Verdict::Incomplete { missing, .. } => Some(Health::Incomplete(missing.clone())),
            Verdict::Corrupt { damage, missing, .. } => {
                Some(Health::Corrupt { damage: damage.clone(), missing: missing.clone() })
            }
        }
    }

    /// Returns the first word of the line of text: `same`, `diverged`, `incomplete` or `corrupt`.
    pub const fn word(&self) -> &'static str {
        match self {
            Verdict::Same { .. } => "same",
            Verdict::Diverged(_) => "diverged",
            Verdict::Incomplete { .. } => "incomplete",
            Verdict::Corrupt { .. } => "corrupt",
        }
    }
}

/// The first difference between a recording and its replay.
#[derive(Clone, Debug, PartialEq)]
pub struct Divergence {
    /// The step whose state differs.
    pub step: u64,
    /// The difference.
    pub difference: Difference,
    /// A description of the last event before the state, such as `spawn "b" at step 30`.
    pub last_event: Option<String>,
}

/// A difference between a recorded and a replayed state.
#[non_exhaustive]
#[derive(Clone, Debug, PartialEq)]
pub enum Difference {
    /// A value of a body differs. This is the first differing body in creation order, and its first
    /// differing field in the order x, y, vx, vy.
    Value {
        /// The name of the body.
        body: String,
        /// `x`, `y`, `vx` or `vy`.
        field: &'static str,
        /// The recorded value, m or m/s.
        recorded: f64,
        /// The replayed value, m or m/s.
        replayed: f64,
    },
    /// The digests differ, and no other values can be compared.
    Digest {
        /// The digest of the recorded state.
        recorded: u64,
        /// The digest of the replayed state.
        replayed: u64,
    },
    /// The runs have different bodies, events, errors or solver states.
    Mismatch {
        /// A description of the difference.
        description: String,
    },
}

/// Formats the verdict as one line, documented for scripts.
impl Display for Verdict {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        match self {
            Verdict::Same { steps, bodies, error: None } => {
                write!(f, "same: {}, {}", counted(*steps, "step"), counted(*bodies, "body"))
            }
            Verdict::Same { steps, error: Some(error), .. } => {
                write!(f, "same: {}, then the recorded error: {error}", counted(*steps, "step"))
            }
            Verdict::Diverged(divergence) => divergence.fmt(f),
            Verdict::Incomplete { missing, steps } => {
                write!(f, "incomplete: {missing}; {} same", counted(*steps, "step"))
            }
            Verdict::Corrupt { damage, missing, steps } if missing.is_empty() => {
                write!(f, "corrupt {damage}; {} same", counted(*steps, "step"))
            }
            Verdict::Corrupt { damage, missing, steps } => {
                write!(f, "corrupt {damage}; {missing}; {} same", counted(*steps, "step"))
            }
        }
    }
}

impl Display for Divergence {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        write!(f, "diverged at step {}: {}", self.step, self.difference)?;
        match &self.last_event {
            Some(event) => write!(f, ", after event {event}"),
            None => Ok(()),
        }
    }
}

impl Display for Difference {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        match self {
            Difference::Value { body, field, recorded, replayed } => {
                let distance = distance(*recorded, *replayed);
                write!(f, "body {body:?} {field} recorded {recorded:?} replayed {replayed:?}{distance}")
            }
            Difference::Digest { recorded, replayed } => {
                write!(f, "the digest of all bodies recorded {recorded:016x} replayed {replayed:016x}")
            }
            Difference::Mismatch { description } => f.write_str(description),
        }
    }
}

/// Returns the distance from `a` to `b` in units in the last place; −0 and 0 are neighbours. NaN has no distance.
pub fn ulps(a: f64, b: f64) -> Option<u64> {
    (!a.is_nan() && !b.is_nan()).then(|| ordered(a).abs_diff(ordered(b)))
}

/// Returns the distance from `a` to `b` in words and brackets, if they have one.
pub fn distance(a: f64, b: f64) -> String {
    ulps(a, b).map_or(String::new(), |ulps| format!(" ({})", counted(ulps, "ulp")))
}

/// Maps floats to integers, preserving order and mapping neighbours to neighbours.
fn ordered(number: f64) -> u64 {
    const SIGN: u64 = 1 << 63;
    let bits = number.to_bits();
    if bits & SIGN == 0 { bits | SIGN } else { !bits }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::recording::MissingEnd;

    #[test]
    fn the_distance_in_ulps_counts_representable_values() {
        assert_eq!(ulps(1.25, 1.25), Some(0));
        assert_eq!(ulps(1.25, 1.2500000000000002), Some(1));
        assert_eq!(ulps(1.0, 2.0), Some(1 << 52));
        assert_eq!(ulps(-0.0, 0.0), Some(1));
        assert_eq!(ulps(-f64::from_bits(1), f64::from_bits(1)), Some(3));
        assert_eq!((ulps(f64::NAN, 1.0), distance(f64::NAN, 1.0)), (None, String::new()));
        assert_eq!(ulps(f64::MAX, f64::INFINITY), Some(1));
    }

    #[test]
    fn verdicts_have_the_documented_format() {
        let same = Verdict::Same { steps: 600, bodies: 12, error: None };
        assert_eq!(same.to_string(), "same: 600 steps, 12 bodies");
        let error = Verdict::Same { steps: 200, bodies: 12, error: Some("step 200: crushed".into()) };
        assert_eq!(error.to_string(), "same: 200 steps, then the recorded error: step 200: crushed");
        let difference =
            Difference::Value { body: "c".into(), field: "vx", recorded: 1.25, replayed: 1.2500000000000002 };
        let last_event = Some("spawn \"b\" at step 30".into());
        let diverged = Verdict::Diverged(Box::new(Divergence { step: 301, difference, last_event }));
        assert_eq!(
            diverged.to_string(),
            "diverged at step 301: body \"c\" vx recorded 1.25 replayed 1.2500000000000002 (1 ulp), \
             after event spawn \"b\" at step 30"
        );
        let end = Some(MissingEnd { after: Some(400), last: 600, is_cut: true });
        let truncated = Verdict::Incomplete { missing: Missing { end, ..Missing::default() }, steps: 400 };
        assert_eq!(truncated.to_string(), "incomplete: truncated after step 400 of 600; 400 steps same");
        let damage = Damage { chunk: Some(3), offset: 9000, reason: "it is broken".into(), after: Some(1) };
        let corrupt = Verdict::Corrupt { damage, missing: Missing::default(), steps: 1 };
        assert_eq!(corrupt.to_string(), "corrupt chunk 3 at byte 9000 after step 1: it is broken; 1 step same");
    }
}
