use std::fmt::{self, Display, Formatter};

use crate::recording::Damage;

/// What a replay found.
#[derive(Clone, Debug, PartialEq)]
pub enum Verdict {
    /// Every recorded state came out again.
    Same {
        /// Steps compared.
        steps: u64,
        /// Bodies that ever lived, walls included.
        bodies: u64,
        /// The error the recorded run ended in, which came out again too.
        then_error: Option<String>,
    },
    /// A state came out differently.
    Diverged(Box<Divergence>),
    /// The recording ends before its run does; what is there came out again.
    Truncated {
        /// The last step recorded; none if there was none.
        after: Option<u64>,
        /// Steps compared.
        steps: u64,
    },
    /// Part of the recording cannot be read; what can came out again.
    Corrupt {
        /// The first damage.
        damage: Damage,
        /// Steps compared.
        steps: u64,
    },
}

/// The first difference between a recording and its replay.
#[derive(Clone, Debug, PartialEq)]
pub struct Divergence {
    /// The step whose state differs.
    pub step: u64,
    /// How it differs.
    pub difference: Difference,
    /// The last event before it, in words: `spawn "b" at step 30`.
    pub last_event: Option<String>,
}

/// How a state differs from the recorded one.
#[derive(Clone, Debug, PartialEq)]
pub enum Difference {
    /// In a number of a body: the first differing body in creation order, and of that the
    /// first field in the order x, y, vx, vy.
    Number {
        /// Name of the body.
        body: String,
        /// `x`, `y`, `vx` or `vy`.
        field: &'static str,
        /// m or m/s.
        recorded: f64,
        /// m or m/s.
        replayed: f64,
    },
    /// Only the digests can be compared and they differ.
    Digest {
        /// Of the recorded state.
        recorded: u64,
        /// Of the replayed state.
        replayed: u64,
    },
    /// The runs do not go on alike: one has a body, a step or an error the other has not.
    Course {
        /// In words.
        what: String,
    },
}

/// The line a script reads: its words stay in the plural, so that one pattern finds them.
impl Display for Verdict {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        match self {
            Verdict::Same { steps, bodies, then_error: None } => {
                write!(f, "same: {steps} steps, {bodies} bodies")
            }
            Verdict::Same { steps, then_error: Some(error), .. } => {
                write!(f, "same: {steps} steps, then the recorded error: {error}")
            }
            Verdict::Diverged(divergence) => divergence.fmt(f),
            Verdict::Truncated { after: Some(step), steps } => {
                write!(f, "truncated after step {step}: {steps} steps same")
            }
            Verdict::Truncated { after: None, .. } => write!(f, "truncated before the first state"),
            Verdict::Corrupt { damage, steps } => {
                write!(f, "corrupt {damage}; {steps} steps same")
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
            Difference::Number { body, field, recorded, replayed } => {
                let distance = ulps(*recorded, *replayed);
                let unit = if distance == 1 { "ulp" } else { "ulps" };
                write!(f, "body {body:?} {field} recorded {recorded:?} replayed {replayed:?} ({distance} {unit})")
            }
            Difference::Digest { recorded, replayed } => {
                write!(f, "the digest of all bodies recorded {recorded:016x} replayed {replayed:016x}")
            }
            Difference::Course { what } => f.write_str(what),
        }
    }
}

/// How many representable numbers lie from `a` to `b`; −0 and 0 are neighbours.
pub fn ulps(a: f64, b: f64) -> u64 {
    ordered(a).abs_diff(ordered(b))
}

/// Maps doubles to integers in the same order, neighbours to neighbours.
fn ordered(number: f64) -> u64 {
    const SIGN: u64 = 1 << 63;
    let bits = number.to_bits();
    if bits & SIGN == 0 { bits | SIGN } else { !bits }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ulps_count_representable_numbers() {
        assert_eq!(ulps(1.25, 1.25), 0);
        assert_eq!(ulps(1.25, 1.2500000000000002), 1);
        assert_eq!(ulps(1.0, 2.0), 1 << 52);
        assert_eq!(ulps(-0.0, 0.0), 1);
        assert_eq!(ulps(-f64::from_bits(1), f64::from_bits(1)), 3);
        assert_eq!(ulps(f64::MAX, f64::INFINITY), 1);
    }

    #[test]
    fn verdicts_read_as_documented() {
        let same = Verdict::Same { steps: 600, bodies: 12, then_error: None };
        assert_eq!(same.to_string(), "same: 600 steps, 12 bodies");
        let error = Verdict::Same { steps: 200, bodies: 12, then_error: Some("step 200: crushed".into()) };
        assert_eq!(error.to_string(), "same: 200 steps, then the recorded error: step 200: crushed");
        let difference =
            Difference::Number { body: "c".into(), field: "vx", recorded: 1.25, replayed: 1.2500000000000002 };
        let last_event = Some("spawn \"b\" at step 30".into());
        let diverged = Verdict::Diverged(Box::new(Divergence { step: 301, difference, last_event }));
        assert_eq!(
            diverged.to_string(),
            "diverged at step 301: body \"c\" vx recorded 1.25 replayed 1.2500000000000002 (1 ulp), \
             after event spawn \"b\" at step 30"
        );
        let truncated = Verdict::Truncated { after: Some(400), steps: 400 };
        assert_eq!(truncated.to_string(), "truncated after step 400: 400 steps same");
        let damage = Damage { chunk: Some(3), offset: 9000, what: "it is broken".into(), after: Some(1) };
        let corrupt = Verdict::Corrupt { damage, steps: 1 };
        assert_eq!(corrupt.to_string(), "corrupt chunk 3 at byte 9000 after step 1: it is broken; 1 steps same");
    }
}
