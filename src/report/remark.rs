//! What a solver cannot do, in words.

use super::Errors;
use crate::scene::{Action, Scene, SpawnRequest};

/// Errors below this part of the smallest side, or of the energy, are not worth a word.
const NEGLIGIBLE: f64 = 0.01;

/// What went wrong in a run, if anything one could see; `side` is the smallest of all boxes, m.
pub fn of(errors: &Errors, must_end: bool, collisions: Option<u64>, side: f64) -> Option<String> {
    let mut remarks = Vec::new();
    match (&errors.end, must_end) {
        (Some(error), true) => return Some(format!("ends, as it must: {error}")),
        (Some(error), false) => return Some(format!("ends: {error}")),
        (None, true) => remarks.push("does not see that there is no room".to_owned()),
        (None, false) => {}
    }
    match collisions {
        Some(expected) if expected > 0 && errors.collisions == 0 => {
            remarks.push(format!("passes through: none of {expected} collisions"));
        }
        Some(_) | None => {}
    }
    if errors.overlap > NEGLIGIBLE * side {
        remarks.push(format!("boxes are up to {} m inside each other", rounded(errors.overlap)));
    }
    if let Some(position) = errors.position.filter(|&position| position > NEGLIGIBLE * side) {
        remarks.push(format!("up to {} m from where they should be", rounded(position)));
    }
    if let Some(energy) = errors.energy.filter(|&energy| energy > NEGLIGIBLE) {
        remarks.push(format!("energy wrong by {} %", rounded(100.0 * energy)));
    }
    (!remarks.is_empty()).then(|| remarks.join(", "))
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

/// The bodies of finite mass that a scene begins with.
pub fn finite(scene: &Scene) -> impl Iterator<Item = &SpawnRequest> {
    scene.inputs.iter().filter(|input| input.step == 0).filter_map(|input| match &input.action {
        Action::Spawn(request) if request.mass < f64::INFINITY => Some(request),
        Action::Spawn(_) | Action::Wall(_) | Action::Delete { .. } | Action::Click { .. } => None,
    })
}

/// The smallest side of any of them, m; infinite if there are none.
pub fn smallest_side(scene: &Scene) -> f64 {
    let sides = finite(scene).flat_map(|request| [request.rect.width(), request.rect.height()]);
    sides.fold(f64::INFINITY, |least, side| if side < least { side } else { least })
}
