//! JSON output: one object per line.

use crate::replay::{Difference, Verdict, ulps};
use serde_json::{Value, json};

/// A verdict as JSON, including its line of text.
pub fn verdict(verdict: &Verdict) -> Value {
    let (word, steps) = match verdict {
        Verdict::Same { steps, .. } => ("same", Some(steps)),
        Verdict::Diverged(_) => ("diverged", None),
        Verdict::Truncated { steps, .. } => ("truncated", Some(steps)),
        Verdict::Corrupt { steps, .. } => ("corrupt", Some(steps)),
    };
    let divergence = match verdict {
        Verdict::Diverged(divergence) => Some(difference(divergence.step, &divergence.difference)),
        Verdict::Same { .. } | Verdict::Truncated { .. } | Verdict::Corrupt { .. } => None,
    };
    json!({ "verdict": word, "same_steps": steps, "divergence": divergence, "what": verdict.to_string() })
}

/// A difference as JSON, with the step where it was found.
pub fn difference(step: u64, difference: &Difference) -> Value {
    match difference {
        Difference::Value { body, field, recorded, replayed } => json!({
            "step": step, "body": body, "field": field, "recorded": recorded, "replayed": replayed,
            "ulps": ulps(*recorded, *replayed),
        }),
        Difference::Digest { .. } | Difference::Mismatch { .. } => {
            json!({ "step": step, "what": difference.to_string() })
        }
    }
}
