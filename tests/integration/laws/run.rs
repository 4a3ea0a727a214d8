//! The result of a run of a scene, and how two results differ.

use super::scene::Scene;
use rebond::internals::physics::{Axis, Collision};

/// The state of a body at a step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct State {
    /// The id of the body: its place in the scene.
    pub id: usize,
    pub at: [f64; 2],
    pub velocity: [f64; 2],
}

#[derive(Clone, Debug, Default)]
pub struct Run {
    /// For each step, the states in the order of creation.
    pub states: Vec<Vec<State>>,
    pub collisions: Vec<Collision>,
    /// The error that ended the run.
    pub error: Option<String>,
}

/// A collision in numbers that transformations of a scene change in a known way.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Impact {
    pub instant: f64,
    pub bodies: [usize; 2],
    pub axis: usize,
    pub before: f64,
    pub after: f64,
    pub impulse: f64,
}

/// A run in a form that can be compared: bodies have the labels of the scene.
#[derive(Clone, Debug, PartialEq)]
pub struct Outcome {
    pub states: Vec<Vec<State>>,
    pub impacts: Vec<Impact>,
    /// The kind of the error that ended the run: its words without step and numbers.
    pub error: Option<String>,
}

impl Outcome {
    pub fn of(scene: &Scene, run: Run) -> Outcome {
        let label = |id: usize| scene.bodies[id].label;
        let impact = |collision: &Collision| Impact {
            instant: collision.instant,
            bodies: collision.bodies.map(|id| label(id as usize)),
            axis: usize::from(collision.axis == Axis::Y),
            before: collision.normal_velocity[0],
            after: collision.normal_velocity[1],
            impulse: collision.impulse,
        };
        let states = run
            .states
            .into_iter()
            .map(|states| states.into_iter().map(|state| State { id: label(state.id), ..state }).collect());
        let error = run.error.map(|error| error.chars().filter(|c| c.is_alphabetic() || *c == ' ').collect());
        Outcome { states: states.collect(), impacts: run.collisions.iter().map(impact).collect(), error }
    }

    /// Changes all states, given their step, and all impacts.
    pub fn map(mut self, state: impl Fn(u64, &mut State), impact: impl Fn(&mut Impact)) -> Outcome {
        for (step, states) in (0..).zip(&mut self.states) {
            states.iter_mut().for_each(|found| state(step, found));
        }
        self.impacts.iter_mut().for_each(impact);
        self
    }

    /// Keeps every `factor`-th state.
    pub fn every(mut self, factor: usize) -> Outcome {
        self.states = self.states.into_iter().step_by(factor).collect();
        self
    }

    /// Puts the two impacts of a corner that blocks both axes into the order of the axes.
    pub fn with_sorted_corners(mut self) -> Outcome {
        for index in 1..self.impacts.len() {
            let [a, b] = [self.impacts[index - 1], self.impacts[index]];
            if a.instant == b.instant && a.bodies == b.bodies && a.axis == 1 && b.axis == 0 {
                self.impacts.swap(index - 1, index);
            }
        }
        self
    }

    /// The first difference from another run that should be the same to the bit.
    pub fn difference_to_the_bit(&self, other: &Outcome) -> Option<String> {
        for (step, (one, two)) in self.states.iter().zip(&other.states).enumerate() {
            if one.len() != two.len() {
                return Some(format!("step {step}: {} bodies and {}", one.len(), two.len()));
            }
            if let Some((a, b)) = one.iter().zip(two).find(|(a, b)| a != b) {
                return Some(format!("step {step}: {a:?} and {b:?}"));
            }
        }
        for (a, b) in self.impacts.iter().zip(&other.impacts) {
            if a != b {
                return Some(format!("{a:?} and {b:?}"));
            }
        }
        let counts = [self, other].map(|run| run.impacts.len());
        if counts[0] != counts[1] {
            return Some(format!("{} collisions and {}", counts[0], counts[1]));
        }
        (self.error != other.error).then(|| format!("{:?} and {:?}", self.error, other.error))
    }

    /// The first difference from another run whose last digits may differ: positions to 1e-9 of `extent`, and the
    /// sequence of impacts, up to a step. `reach` is the largest coordinate of either run and limits the resolution of
    /// bounces.
    pub fn difference(&self, other: &Outcome, scene: &Scene, reach: f64, last_step: u64) -> Option<String> {
        let extent = scene.extent();
        for (step, (one, two)) in (0..=last_step).zip(self.states.iter().zip(&other.states)) {
            if one.len() != two.len() {
                return Some(format!("step {step}: {} bodies and {}", one.len(), two.len()));
            }
            for (a, b) in one.iter().zip(two) {
                let off = (0..2).any(|k| (a.at[k] - b.at[k]).abs() > 1e-9 * larger(extent, a.at[k].abs()));
                if off || a.id != b.id {
                    return Some(format!("step {step}: {a:?} and {b:?}"));
                }
            }
        }
        if last_step == scene.steps && self.error != other.error {
            return Some(format!("{:?} and {:?}", self.error, other.error));
        }
        let top = self.top_speed();
        // Slower impacts are the tail of an infinite sequence of impacts or bounces. Its end is a matter of rounding.
        let resolution = 64.0 * (scene.acceleration() * larger(extent, reach) * f64::EPSILON).sqrt();
        let slow = larger(1e-6 * top, resolution);
        let [one, two] = [self, other].map(|run| run.instants(slow, 1e-10 * scene.steps as f64 / scene.rate));
        let end = last_step as f64 / scene.rate * (1.0 - 1e-10);
        for index in 0..if one.len() > two.len() { one.len() } else { two.len() } {
            let [a, b] = [&one, &two].map(|instants| instants.get(index).map_or(&[][..], Vec::as_slice));
            if [a, b].iter().any(|impacts| impacts.first().is_some_and(|impact| impact.instant >= end)) {
                return None;
            }
            let same = a.iter().zip(b).take_while(|(a, b)| a.bodies == b.bodies && a.axis == b.axis).count();
            // Three periods of two pairs are the shortest repetition that can be taken for an infinite burst.
            let is_infinite_burst = same >= 6 && scene.restitutions().any(|e| e < 1.0);
            if (same < a.len() || same < b.len()) && !is_infinite_burst {
                return Some(format!("impact {same} of an instant: {:?} and {:?}", a.get(same), b.get(same)));
            }
            let off = |a: &Impact, b: &Impact| {
                (a.before - b.before).abs() > 1e-8 * top || (a.after - b.after).abs() > 1e-8 * top
            };
            if let Some((a, b)) = a.iter().zip(b).take(same).find(|(a, b)| off(a, b)) {
                return Some(format!("{a:?} and {b:?}"));
            }
        }
        None
    }

    /// The greatest speed of any body or approach, m/s.
    pub fn top_speed(&self) -> f64 {
        let speeds = self.states.iter().flatten().flat_map(|state| state.velocity);
        let speeds = speeds.chain(self.impacts.iter().map(|impact| impact.before));
        speeds.fold(0.0, |most, speed| larger(most, speed.abs()))
    }

    /// The impacts faster than `slow`, grouped by instants that are more than `apart` seconds apart.
    fn instants(&self, slow: f64, apart: f64) -> Vec<Vec<Impact>> {
        let mut instants: Vec<Vec<Impact>> = Vec::new();
        for impact in self.impacts.iter().filter(|impact| -impact.before > slow) {
            match instants.last_mut() {
                Some(last) if impact.instant - last[0].instant <= apart => last.push(*impact),
                _ => instants.push(vec![*impact]),
            }
        }
        instants
    }
}

pub fn larger(a: f64, b: f64) -> f64 {
    if a > b { a } else { b }
}
