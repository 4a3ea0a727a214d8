//! How far what an engine made of a scene is from what mechanics says.

use crate::{
    job::{Answer, Body, Job},
    truth::{State, Truth},
};
use serde::Serialize;

/// What is wrong, as far as it can be told for the scene.
#[derive(Clone, Debug, Default, Serialize)]
pub struct Errors {
    /// Furthest from where a body has to be, m.
    pub position_error: Option<f64>,
    /// Furthest from the velocity a body has to have at the end, m/s; of what has to lie, how fast it
    /// still moves from one sample to the next.
    pub velocity_error: Option<f64>,
    /// At e = 1 how far energy was from what it was, else how far it ever rose again, relative to
    /// the kinetic and potential energy of the start.
    pub energy_drift: Option<f64>,
    /// The deepest overlap of two boxes, m: the shorter side of their common rectangle.
    pub worst_overlap: f64,
    /// Collisions: an engine's own count, or how often a velocity changed from step to step.
    pub collisions: Option<u64>,
    /// How many there are.
    pub true_collisions: Option<u64>,
}

/// Judges `samples`, as an engine left them.
pub fn judge(truth: Truth, job: &Job, answer: &Answer, samples: &[u8]) -> Errors {
    let numbers: Vec<f64> =
        samples.chunks_exact(8).map(|bytes| f64::from_le_bytes(bytes.try_into().expect("eight"))).collect();
    let all: Vec<Vec<State>> = numbers
        .chunks_exact(4 * job.bodies.len())
        .map(|sample| sample.chunks_exact(4).map(|state| state.try_into().expect("four")).collect())
        .collect();
    let moves: Vec<usize> = (0..job.bodies.len()).filter(|&place| job.bodies[place].mass.is_some()).collect();
    let course: Vec<Vec<State>> = all.iter().map(|sample| moves.iter().map(|&place| sample[place]).collect()).collect();
    let start: Vec<State> = moves.iter().map(|&place| state(&job.bodies[place])).collect();
    Errors {
        position_error: position(truth, job, &start, &course),
        velocity_error: velocity(truth, job, &start, &course),
        energy_drift: energy(truth, job, &moves, &start, &course),
        worst_overlap: all.iter().map(|sample| overlap(&job.bodies, sample)).fold(0.0, f64::max),
        collisions: answer.collisions.or_else(|| counted(truth, &course)),
        true_collisions: truth.collisions(),
    }
}

fn state(body: &Body) -> State {
    [body.x, body.y, body.vx, body.vy]
}

/// When the sample of that place was taken, s.
fn time(job: &Job, place: usize) -> f64 {
    ((place as u64 + 1) * job.sample_every) as f64 / job.rate
}

fn position(truth: Truth, job: &Job, start: &[State], course: &[Vec<State>]) -> Option<f64> {
    let first = if truth.always() { 0 } else { course.len() - 1 };
    (first..course.len())
        .map(|place| {
            let expected = truth.states(time(job, place), start)?;
            Some(furthest(&course[place], &expected, [0, 1]))
        })
        .try_fold(0.0, |worst: f64, error| Some(worst_of(worst, error?)))
}

fn velocity(truth: Truth, job: &Job, start: &[State], course: &[Vec<State>]) -> Option<f64> {
    let last = course.last()?;
    if let Some(expected) = truth.last_velocities() {
        return Some(last.iter().zip(expected).map(|(state, vx)| (state[2] - vx).abs()).fold(0.0, worst_of));
    }
    if truth == Truth::Fall {
        // Positions tell, since engines leave a velocity to what they put to sleep.
        let before = course.get(course.len().checked_sub(2)?)?;
        return Some(furthest(last, before, [0, 1]) * job.rate / job.sample_every as f64);
    }
    let expected = truth.states(time(job, course.len() - 1), start)?;
    Some(furthest(last, &expected, [2, 3]))
}

/// Not-a-number is worst of all.
fn worst_of(one: f64, other: f64) -> f64 {
    if one.is_nan() || other.is_nan() { f64::NAN } else { one.max(other) }
}

fn furthest(states: &[State], expected: &[State], [x, y]: [usize; 2]) -> f64 {
    let distance = |(state, expected): (&State, &State)| (state[x] - expected[x]).hypot(state[y] - expected[y]);
    states.iter().zip(expected).map(distance).fold(0.0, worst_of)
}

fn energy(truth: Truth, job: &Job, moves: &[usize], start: &[State], course: &[Vec<State>]) -> Option<f64> {
    // Nothing to give: a stack that has to rest is judged by where it is.
    if truth == Truth::Rest {
        return None;
    }
    let floor = job.bodies.iter().filter(|body| body.mass.is_none()).map(|body| body.y).fold(0.0, f64::max);
    let total = |states: &[State]| -> f64 {
        let each = moves.iter().zip(states).map(|(&place, [_, y, vx, vy])| {
            let Body { height, mass, .. } = job.bodies[place];
            let mass = mass.expect("it can move");
            mass * (0.5 * (vx * vx + vy * vy) + job.gravity[1] * (floor - y - height))
        });
        each.sum()
    };
    let begin = total(start);
    let energies = std::iter::once(begin).chain(course.iter().map(|states| total(states)));
    if truth.restitution() == 1.0 {
        return Some(energies.map(|energy| (energy - begin).abs() / begin).fold(0.0, worst_of));
    }
    let energies: Vec<f64> = energies.collect();
    Some(energies.windows(2).map(|pair| (pair[1] - pair[0]) / begin).fold(0.0, worst_of))
}

/// The deepest overlap in one sample, found by a sweep along x; what cannot move may overlap itself.
fn overlap(bodies: &[Body], sample: &[State]) -> f64 {
    let mut order: Vec<usize> = (0..bodies.len()).collect();
    order.sort_by(|&one, &other| sample[one][0].total_cmp(&sample[other][0]));
    let mut worst: f64 = 0.0;
    for (place, &one) in order.iter().enumerate() {
        let right = sample[one][0] + bodies[one].width;
        for &other in order[place + 1..].iter().take_while(|&&other| sample[other][0] < right) {
            if bodies[one].mass.is_none() && bodies[other].mass.is_none() {
                continue;
            }
            let low = |axis: usize| sample[one][axis].max(sample[other][axis]);
            let wide = right.min(sample[other][0] + bodies[other].width) - low(0);
            let high = (sample[one][1] + bodies[one].height).min(sample[other][1] + bodies[other].height) - low(1);
            worst = worst.max(wide.min(high));
        }
    }
    worst
}

/// How often the small box of Galperin's billiard changed its velocity from one step to the next:
/// at most one collision is seen in a step.
fn counted(truth: Truth, course: &[Vec<State>]) -> Option<u64> {
    let Truth::Galperin { .. } = truth else { return None };
    let speeds: Vec<f64> = std::iter::once(0.0).chain(course.iter().map(|states| states[0][2])).collect();
    let changed = |pair: &&[f64]| (pair[1] - pair[0]).abs() > 1e-3 * pair[0].abs() + 1e-6;
    Some(speeds.windows(2).filter(changed).count() as u64)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn overlap_is_the_shorter_side_of_the_common_rectangle() {
        let body = |mass| Body { x: 0.0, y: 0.0, width: 2.0, height: 1.0, mass, vx: 0.0, vy: 0.0, bullet: false };
        let bodies = [body(Some(1.0)), body(Some(1.0)), body(None), body(None)];
        let apart = [9.0, 0.0, 0.0, 0.0];
        assert_eq!(overlap(&bodies, &[[0.0; 4], [1.5, 0.75, 0.0, 0.0], apart, apart]), 0.25);
        assert_eq!(overlap(&bodies, &[[0.0; 4], [2.0, 0.0, 0.0, 0.0], apart, apart]), 0.0);
    }
}
