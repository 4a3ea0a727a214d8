//! The accelerations of resting bodies, compared with the formula for the optimum of the quadratic program.

use super::{Law, check, kinds::random_touching_scene, random::Random, run::larger, scene::Scene};
use crate::world_builder::{BodySpec, Conditions, INFINITE, run, spec, world};
use rebond::internals::physics::Vector;

/// Two bodies that touch, the one behind first, and the axis.
type Pair = (usize, usize, usize);

/// The most lower sets of a component that the formula is evaluated for.
const MOST_SETS: usize = 200;

#[test]
fn contact_accelerations_minimise_the_change_from_free_fall() {
    check("contact accelerations", random_touching_scene, is_least_change);
}

fn is_least_change(scene: &Scene) -> Result<Law, String> {
    let mut scene = scene.clone();
    scene.bodies.retain(|body| body.step == 0);
    scene.deletes.clear();
    scene.bodies.iter_mut().for_each(|body| body.spec.velocity = [0.0; 2]);
    (scene.rate, scene.steps) = (1024.0 * 1024.0, 1);
    let Some(expected) = accelerations(&scene) else { return Ok(Law::DoesNotApply) };
    let run = scene.run();
    if let Some(error) = run.error {
        return Err(error);
    }
    let scale = scene.acceleration();
    for (state, expected) in run.states[1].iter().zip(expected) {
        let found = state.velocity.map(|v| v * scene.rate);
        if (0..2).any(|k| (found[k] - expected[k]).abs() > 1e-9 * scale) {
            return Err(format!("body {}: {found:?} m/s², expected {expected:?}", state.id));
        }
    }
    if !run.collisions.is_empty() {
        return Err(format!("{} collisions of bodies at rest", run.collisions.len()));
    }
    Ok(Law::Holds)
}

/// The accelerations of the bodies of a scene at rest, m/s²; `None` if a component is too large.
///
/// Faces that touch must not approach. A corner that would then be entered on both axes is blocked along the axis of
/// the gentler approach, along both if they are equal. A corner that is not entered any more, because others block too, is
/// released, once.
fn accelerations(scene: &Scene) -> Option<Vec<[f64; 2]>> {
    let bodies: Vec<&BodySpec> = scene.bodies.iter().map(|body| &body.spec).collect();
    let tiny = 1e-12 * scene.extent();
    let (mut faces, mut corners) = (Vec::new(), Vec::new());
    for (i, a) in bodies.iter().enumerate() {
        for (j, b) in bodies.iter().enumerate().filter(|(j, b)| *j != i && (a.mass != INFINITE || b.mass != INFINITE)) {
            // The gap along each axis with `a` behind, and the larger one of both orders.
            let gaps = [0, 1].map(|k| b.at[k] - a.at[k] - a.size[k]);
            let distance = [0, 1].map(|k| larger(gaps[k], a.at[k] - b.at[k] - b.size[k]));
            let touches = |k: &usize| gaps[*k].abs() <= tiny && distance[1 - k] < -tiny;
            faces.extend((0..2).filter(touches).map(|k| (i, j, k)));
            if i < j && distance.iter().all(|gap| gap.abs() <= tiny) {
                let pair = |k: usize| if gaps[k].abs() <= tiny { (i, j, k) } else { (j, i, k) };
                corners.push([pair(0), pair(1)]);
            }
        }
    }
    let rounding = 1e-12 * scene.acceleration();
    let mut blocks = vec![[false; 2]; corners.len()];
    let mut was_released = vec![false; corners.len()];
    loop {
        let blocked =
            corners.iter().zip(&blocks).flat_map(|(pairs, blocks)| (0..2).filter(|k| blocks[*k]).map(|k| pairs[k]));
        let pairs: Vec<Pair> = faces.iter().copied().chain(blocked).collect();
        let found = least_change(scene, &bodies, &pairs)?;
        let approaches = |corner: usize| corners[corner].map(|(behind, ahead, k)| found[behind][k] - found[ahead][k]);
        let mut has_changed = false;
        for corner in (0..corners.len()).filter(|corner| blocks[*corner] == [false; 2]).collect::<Vec<usize>>() {
            let [x, y] = approaches(corner);
            if x > rounding && y > rounding {
                let is_equal = (x - y).abs() <= rounding;
                blocks[corner] = [x < y || is_equal, y < x || is_equal];
                has_changed = true;
            }
        }
        if has_changed {
            continue;
        }
        for corner in 0..corners.len() {
            let is_left = (0..2).any(|k| {
                if blocks[corner][k] {
                    approaches(corner)[k].abs() > rounding
                } else {
                    approaches(corner)[k] <= rounding
                }
            });
            if blocks[corner] != [false; 2] && !was_released[corner] && is_left {
                (blocks[corner], was_released[corner], has_changed) = ([false; 2], true, true);
            }
        }
        if !has_changed {
            return Some(found);
        }
    }
}

/// Accelerations of least change from free fall, Σ m·(a − f)², with a(behind) ≤ a(ahead) for each pair.
fn least_change(scene: &Scene, bodies: &[&BodySpec], pairs: &[Pair]) -> Option<Vec<[f64; 2]>> {
    let mut found = vec![[0.0; 2]; bodies.len()];
    for (k, gravity) in scene.gravity.into_iter().enumerate() {
        let pairs: Vec<Pair> = pairs.iter().filter(|pair| pair.2 == k).copied().collect();
        let mut is_done: Vec<bool> = bodies.iter().map(|body| body.mass == INFINITE).collect();
        for first in 0..bodies.len() {
            if is_done[first] {
                continue;
            }
            let component = component(first, bodies, &pairs);
            let free_fall = |id: usize| gravity + bodies[id].force[k] / bodies[id].mass;
            let terms: Vec<[f64; 2]> = component.iter().map(|&id| [bodies[id].mass, free_fall(id)]).collect();
            let accelerations = Order::new(&component, bodies, &pairs).optimum(&terms)?;
            for (&id, a) in component.iter().zip(accelerations) {
                (found[id][k], is_done[id]) = (a, true);
            }
        }
    }
    Some(found)
}

/// The finite masses connected with one by pairs. Infinite masses do not connect.
fn component(first: usize, bodies: &[&BodySpec], pairs: &[Pair]) -> Vec<usize> {
    let mut members = vec![first];
    let mut next = 0;
    while next < members.len() {
        let neighbours = pairs.iter().filter_map(|&(a, b, _)| match members[next] {
            id if id == a => Some(b),
            id if id == b => Some(a),
            _ => None,
        });
        let new: Vec<usize> = neighbours.filter(|&id| bodies[id].mass != INFINITE && !members.contains(&id)).collect();
        new.into_iter().for_each(|id| {
            if !members.contains(&id) {
                members.push(id)
            }
        });
        next += 1;
    }
    members
}

/// The partial order of a component: for each element, the mask of those directly behind it. The last two elements are
/// all infinite masses behind, and all of them ahead.
struct Order(Vec<u32>);

impl Order {
    fn new(component: &[usize], bodies: &[&BodySpec], pairs: &[Pair]) -> Order {
        let place = |id: usize| component.iter().position(|&member| member == id);
        let mut behind = vec![0; component.len() + 2];
        for &(a, b, _) in pairs {
            match (place(a), place(b)) {
                (Some(a), Some(b)) => behind[b] |= 1 << a,
                (None, Some(b)) if bodies[a].mass == INFINITE => behind[b] |= 1 << component.len(),
                (Some(a), None) if bodies[b].mass == INFINITE => behind[component.len() + 1] |= 1 << a,
                _ => {}
            }
        }
        Order(behind)
    }

    /// The values of least weighted squared change, by the max–min formula (Robertson, Wright, Dykstra, "Order
    /// restricted statistical inference", 1988, theorem 1.4.4): the maximum over the upper sets with the element of
    /// the minimum over the lower sets with it of the average over their intersection.
    fn optimum(&self, terms: &[[f64; 2]]) -> Option<Vec<f64>> {
        let sets = self.lower_sets()?;
        let everything = (1_u32 << self.0.len()) - 1;
        let average = |set: u32| {
            if set >> terms.len() != 0 {
                return 0.0;
            }
            let members = || terms.iter().enumerate().filter(move |(n, _)| set >> n & 1 == 1).map(|(_, term)| term);
            members().map(|[mass, value]| mass * value).sum::<f64>() / members().map(|[mass, _]| mass).sum::<f64>()
        };
        let value = |element: usize| {
            let has = |set: &u32| set >> element & 1 == 1;
            let minima = sets.iter().map(|lower| everything & !lower).filter(has).map(|upper| {
                let averages = sets.iter().filter(|lower| has(lower)).map(|lower| average(lower & upper));
                averages.fold(f64::INFINITY, |least, average| if average < least { average } else { least })
            });
            minima.fold(f64::NEG_INFINITY, larger)
        };
        Some((0..terms.len()).map(value).collect())
    }

    /// All sets that contain, with an element, everything behind it; `None` if there are too many.
    fn lower_sets(&self) -> Option<Vec<u32>> {
        let mut sets = vec![0];
        let mut next = 0;
        while next < sets.len() {
            let set: u32 = sets[next];
            for (element, behind) in self.0.iter().enumerate() {
                let larger = set | 1 << element;
                if larger != set && behind & !set == 0 && !sets.contains(&larger) {
                    sets.push(larger);
                }
            }
            if sets.len() > MOST_SETS || self.0.len() > 31 {
                return None;
            }
            next += 1;
        }
        Some(sets)
    }
}

/// Boxes of any masses in a row or a column are pressed together by forces that cancel: those on the outer ones, or all.
fn press(seed: u64) {
    let mut random = Random::new(seed);
    let (count, force) = (random.whole(2, 6) as usize, random.between(0.1, 9.0));
    let axis = random.below(2) as usize;
    let vector = |along: f64| if axis == 0 { [along, 0.0] } else { [0.0, along] };
    let mut bodies: Vec<BodySpec> = (0..count)
        .map(|n| {
            let at = vector(n as f64);
            spec(at, [1.0, 1.0], random.magnitude(1e-3, 40))
        })
        .collect();
    let inner = if random.chance(50) { random.between(-0.05, 0.05) } else { 0.0 };
    bodies[0].force = vector(force);
    bodies[count - 1].force = vector(-force);
    if count > 3 {
        (bodies[1].force, bodies[2].force) = (vector(inner), vector(-inner));
    }
    let gravity = random.chance(50).then(|| vector(random.between(-9.0, 9.0)));
    // Far away, a body without a force falls freely.
    bodies.push(spec([20.0, 20.0], [1.0, 1.0], 1.0));
    let is_reversed = random.chance(50);
    if is_reversed {
        bodies.reverse();
    }
    let about = format!("seed {seed}: gravity {gravity:?}, {bodies:?}");
    let mut engine = world(Conditions { gravity, ..Conditions::default() }, &bodies);
    let collisions = run(&mut engine, 60);
    assert!(collisions.is_empty(), "{about}");
    let bodies = &engine.world().bodies;
    let free = bodies[if is_reversed { 0 } else { count }].velocity;
    assert_eq!(gravity.is_none(), free == Vector::ZERO, "{about}");
    for body in bodies {
        assert_eq!(body.velocity, free, "{about}");
    }
}

#[test]
fn forces_that_cancel_move_nothing() {
    super::seeds().for_each(press);
}
