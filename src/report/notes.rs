//! Describes notable errors of a run as text.

use super::Errors;
use crate::counted::counted;
use crate::scene::{Action, Scene, SpawnRequest};

/// Errors below this fraction of the smallest side, or of the energy, are not mentioned.
const NEGLIGIBLE: f64 = 0.01;

/// Describes the visible errors of a run, or returns `None` if there are none. `side` is the smallest
/// side of all boxes, m.
pub fn describe(errors: &Errors, must_fail: bool, collisions: Option<u64>, side: f64) -> Option<String> {
    let mut notes = Vec::new();
    match (&errors.end, must_fail) {
        (Some(error), true) => return Some(format!("ends in an error, as it must: {error}")),
        (Some(error), false) => return Some(format!("ends in an error: {error}")),
        (None, true) => notes.push("does not detect that the body is crushed".to_owned()),
        (None, false) => {}
    }
    match collisions {
        Some(expected) if expected > 0 && errors.collisions == 0 => {
            notes.push(format!("passes through: found 0 of {}", counted(expected, "collision")));
        }
        Some(_) | None => {}
    }
    if errors.overlap > NEGLIGIBLE * side {
        notes.push(format!("boxes overlap by up to {} m", rounded(errors.overlap)));
    }
    if let Some(position) = errors.position.filter(|&position| position > NEGLIGIBLE * side) {
        notes.push(format!("positions are wrong by up to {} m", rounded(position)));
    }
    if let Some(energy) = errors.energy.filter(|&energy| energy > NEGLIGIBLE) {
        notes.push(format!("energy is wrong by {} %", rounded(100.0 * energy)));
    }
    (!notes.is_empty()).then(|| notes.join(", "))
}

fn rounded(value: f64) -> String {
    if (0.001..10_000.0).contains(&value) {
        let decimals = if value >= 10.0 {
            0
        } else if value >= 0.1 {
            2
        } else {
            4
        };
        format!("{value:.decimals$}")
    } else {
        format!("{value:.1e}")
    }
}

/// The bodies of finite mass spawned at step 0.
pub fn finite(scene: &Scene) -> impl Iterator<Item = &SpawnRequest> {
    scene.inputs.iter().filter(|input| input.step == 0).filter_map(|input| match &input.action {
        Action::Spawn(request) if request.mass < f64::INFINITY => Some(request),
        Action::Spawn(_) | Action::Wall(_) | Action::Delete { .. } | Action::Click { .. } => None,
    })
}

/// The smallest side of the bodies of finite mass spawned at step 0, m; infinite if there are none.
pub fn smallest_side(scene: &Scene) -> f64 {
    let sides = finite(scene).flat_map(|request| [request.rect.width(), request.rect.height()]);
    sides.fold(f64::INFINITY, |least, side| if side < least { side } else { least })
}
