//! Compares the results of an engine with the correct ones.

use crate::{
    job::{Answer, Body, Job},
    oracle::{Oracle, State},
};
use serde::Serialize;

/// The errors of a run, as far as they are known for the scene.
#[derive(Clone, Debug, Default, Serialize)]
pub struct Errors {
    /// The greatest distance of a body from its correct position, m.
    pub position_error: Option<f64>,
    /// The greatest difference of a final velocity from the correct one, m/s. If all bodies should rest, the
    /// greatest speed between the last two samples.
    pub velocity_error: Option<f64>,
    /// At e = 1 the greatest deviation of the energy from its initial value, otherwise its greatest increase
    /// between samples, relative to the initial kinetic and potential energy.
    pub energy_drift: Option<f64>,
    /// The deepest overlap of two boxes, m: the shorter side of their common rectangle.
    pub worst_overlap: f64,
    /// The number of collisions: counted by the engine, or else the number of steps in which a velocity changed.
    pub collisions: Option<u64>,
    /// The correct number of collisions.
    pub true_collisions: Option<u64>,
}

/// Returns the errors of the samples that an engine wrote.
pub fn judge(oracle: Oracle, job: &Job, answer: &Answer, samples: &[u8]) -> Errors {
    let numbers: Vec<f64> =
        samples.chunks_exact(8).map(|bytes| f64::from_le_bytes(bytes.try_into().expect("eight bytes"))).collect();
    let all: Vec<Vec<State>> = numbers
        .chunks_exact(4 * job.bodies.len())
        .map(|sample| sample.chunks_exact(4).map(|state| state.try_into().expect("four numbers")).collect())
        .collect();
    let movable: Vec<usize> = (0..job.bodies.len()).filter(|&index| job.bodies[index].mass.is_some()).collect();
    let history: Vec<Vec<State>> =
        all.iter().map(|sample| movable.iter().map(|&index| sample[index]).collect()).collect();
    let start: Vec<State> = movable.iter().map(|&index| state(&job.bodies[index])).collect();
    Errors {
        position_error: position(oracle, job, &start, &history),
        velocity_error: velocity(oracle, job, &start, &history),
        energy_drift: energy(oracle, job, &movable, &start, &history),
        worst_overlap: all.iter().map(|sample| overlap(&job.bodies, sample)).fold(0.0, f64::max),
        collisions: answer.collisions.or_else(|| count_velocity_changes(oracle, &history)),
        true_collisions: oracle.collisions(),
    }
}

fn state(body: &Body) -> State {
    [body.x, body.y, body.vx, body.vy]
}

/// The time of a sample, s.
fn time(job: &Job, sample: usize) -> f64 {
    ((sample as u64 + 1) * job.sample_every) as f64 / job.rate
}

fn position(oracle: Oracle, job: &Job, start: &[State], history: &[Vec<State>]) -> Option<f64> {
    let first = if oracle.compares_all_samples() { 0 } else { history.len() - 1 };
    (first..history.len())
        .map(|sample| {
            let expected = oracle.states(time(job, sample), start)?;
            Some(max_distance(&history[sample], &expected, [0, 1]))
        })
        .try_fold(0.0, |worst: f64, error| Some(nan_max(worst, error?)))
}

fn velocity(oracle: Oracle, job: &Job, start: &[State], history: &[Vec<State>]) -> Option<f64> {
    let last = history.last()?;
    if let Some(expected) = oracle.final_velocities() {
        return Some(last.iter().zip(expected).map(|(state, vx)| (state[2] - vx).abs()).fold(0.0, nan_max));
    }
    if oracle == Oracle::Fall {
        // Sleeping bodies can keep a velocity, so the speed is computed from positions.
        let before = history.get(history.len().checked_sub(2)?)?;
        return Some(max_distance(last, before, [0, 1]) * job.rate / job.sample_every as f64);
    }
    let expected = oracle.states(time(job, history.len() - 1), start)?;
    Some(max_distance(last, &expected, [2, 3]))
}

/// The maximum, or NaN if one of the two is NaN.
fn nan_max(a: f64, b: f64) -> f64 {
    if a.is_nan() || b.is_nan() { f64::NAN } else { a.max(b) }
}

fn max_distance(states: &[State], expected: &[State], [x, y]: [usize; 2]) -> f64 {
    let distance = |(state, expected): (&State, &State)| (state[x] - expected[x]).hypot(state[y] - expected[y]);
    states.iter().zip(expected).map(distance).fold(0.0, nan_max)
}

fn energy(oracle: Oracle, job: &Job, movable: &[usize], start: &[State], history: &[Vec<State>]) -> Option<f64> {
    // A stack that should rest and boxes with forces are judged by their positions.
    if matches!(oracle, Oracle::Rest | Oracle::Corners) {
        return None;
    }
    let floor = job.bodies.iter().filter(|body| body.mass.is_none()).map(|body| body.y).fold(0.0, f64::max);
    let total = |states: &[State]| -> f64 {
        let each = movable.iter().zip(states).map(|(&index, [_, y, vx, vy])| {
            let Body { height, mass, .. } = job.bodies[index];
            let mass = mass.expect("movable bodies have a mass");
            mass * (0.5 * (vx * vx + vy * vy) + job.gravity[1] * (floor - y - height))
        });
        each.sum()
    };
    let initial = total(start);
    let energies = std::iter::once(initial).chain(history.iter().map(|states| total(states)));
    if oracle.restitution() == 1.0 {
        return Some(energies.map(|energy| (energy - initial).abs() / initial).fold(0.0, nan_max));
    }
    let energies: Vec<f64> = energies.collect();
    Some(energies.windows(2).map(|pair| (pair[1] - pair[0]) / initial).fold(0.0, nan_max))
}

/// The deepest overlap in one sample, found by a sweep along x. Overlaps of static bodies do not count.
fn overlap(bodies: &[Body], sample: &[State]) -> f64 {
    let mut order: Vec<usize> = (0..bodies.len()).collect();
    order.sort_by(|&a, &b| sample[a][0].total_cmp(&sample[b][0]));
    let mut worst: f64 = 0.0;
    for (position, &a) in order.iter().enumerate() {
        let right = sample[a][0] + bodies[a].width;
        for &b in order[position + 1..].iter().take_while(|&&b| sample[b][0] < right) {
            if bodies[a].mass.is_none() && bodies[b].mass.is_none() {
                continue;
            }
            let low = |axis: usize| sample[a][axis].max(sample[b][axis]);
            let width = right.min(sample[b][0] + bodies[b].width) - low(0);
            let height = (sample[a][1] + bodies[a].height).min(sample[b][1] + bodies[b].height) - low(1);
            worst = worst.max(width.min(height));
        }
    }
    worst
}

/// The number of steps in which the small box of Galperin's billiard changed its velocity: at most one
/// collision is counted per step.
fn count_velocity_changes(oracle: Oracle, history: &[Vec<State>]) -> Option<u64> {
    let Oracle::Galperin { .. } = oracle else { return None };
    let speeds: Vec<f64> = std::iter::once(0.0).chain(history.iter().map(|states| states[0][2])).collect();
    let changed = |pair: &&[f64]| (pair[1] - pair[0]).abs() > 1e-3 * pair[0].abs() + 1e-6;
    Some(speeds.windows(2).filter(changed).count() as u64)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn overlap_is_the_shorter_side_of_the_common_rectangle() {
        let body = |mass| Body {
            x: 0.0,
            y: 0.0,
            width: 2.0,
            height: 1.0,
            mass,
            vx: 0.0,
            vy: 0.0,
            fx: 0.0,
            fy: 0.0,
            bullet: false,
        };
        let bodies = [body(Some(1.0)), body(Some(1.0)), body(None), body(None)];
        let apart = [9.0, 0.0, 0.0, 0.0];
        assert_eq!(overlap(&bodies, &[[0.0; 4], [1.5, 0.75, 0.0, 0.0], apart, apart]), 0.25);
        assert_eq!(overlap(&bodies, &[[0.0; 4], [2.0, 0.0, 0.0, 0.0], apart, apart]), 0.0);
    }
}
