//! The accelerations of least change from free fall under which no contact is pressed through.
//!
//! Gauss's principle of least constraint: minimise Σ mᵢ·(aᵢ − fᵢ)² subject to aⱼ ≥ aᵢ for
//! each contact of i with j ahead of it. That is isotonic regression on a partial order. Its
//! exact solution by repeated halving: a group whose best common value is c is split along
//! the set, closed ahead, of greatest Σ mᵢ·(fᵢ − c), if that is positive; the two parts are
//! then solved on their own (Spouge, Wan and Wilbur, "Least squares isotonic regression in
//! two dimensions", 2003). The set is a maximum closure, found as a minimum cut (Picard, 1976).

/// Bodies joined by contacts along an axis.
#[derive(Clone, Debug, Default)]
pub struct Group {
    /// Free acceleration of each, m/s².
    free: Vec<f64>,
    /// kg.
    mass: Vec<f64>,
    /// Whether contacts hold it at 0 from behind, from ahead.
    held: Vec<[bool; 2]>,
    /// Pairs in contact: behind, ahead.
    pub order: Vec<[usize; 2]>,
}

impl Group {
    /// One more body.
    pub fn add(&mut self, free: f64, mass: f64, held: [bool; 2]) {
        self.free.push(free);
        self.mass.push(mass);
        self.held.push(held);
    }
}

/// Gains smaller than this part of the forces involved are rounding.
const ROUNDING: f64 = 64.0 * f64::EPSILON;

/// The acceleration of each body of a group, m/s².
pub fn least_change(group: &Group) -> Vec<f64> {
    let mut accelerations = vec![0.0; group.free.len()];
    let all: Vec<usize> = (0..group.free.len()).collect();
    if group.held.iter().any(|held| held[0] || held[1]) {
        let (pulled_ahead, rest) = cut(group, &all, 0.0, true, true);
        let (pulled_behind, _) = cut(group, &rest, 0.0, false, true);
        solve(group, &pulled_ahead, &mut accelerations);
        solve(group, &pulled_behind, &mut accelerations);
    } else {
        solve(group, &all, &mut accelerations);
    }
    accelerations
}

/// Solves a group that nothing holds.
fn solve(group: &Group, members: &[usize], accelerations: &mut [f64]) {
    let mut open = vec![members.to_vec()];
    while let Some(members) = open.pop() {
        if members.is_empty() {
            continue;
        }
        let common = common(group, &members);
        let (faster, slower) = cut(group, &members, common, true, false);
        if faster.is_empty() || slower.is_empty() {
            members.iter().for_each(|member| accelerations[*member] = common);
        } else {
            open.push(faster);
            open.push(slower);
        }
    }
}

/// The acceleration of members that move as one: total force by total mass, m/s².
fn common(group: &Group, members: &[usize]) -> f64 {
    let first = group.free[members[0]];
    if members.iter().all(|member| group.free[*member] == first) {
        return first;
    }
    let force: f64 = members.iter().map(|member| group.mass[*member] * group.free[*member]).sum();
    force / members.iter().map(|member| group.mass[*member]).sum::<f64>()
}

/// Splits off the set, closed ahead (or behind), that gains most by leaving `level` that way;
/// without those that are `held` back, if that is asked for.
fn cut(group: &Group, members: &[usize], level: f64, ahead: bool, held: bool) -> (Vec<usize>, Vec<usize>) {
    let sign = if ahead { 1.0 } else { -1.0 };
    let mut network = Network::new(members.len());
    let mut forces = 0.0;
    for (place, member) in members.iter().enumerate() {
        let (mass, free) = (group.mass[*member], group.free[*member]);
        forces += mass * (free.abs() + level.abs());
        network.supply[place] = sign * mass * (free - level);
        network.held[place] = held && group.held[*member][usize::from(ahead)];
    }
    for [behind, in_front] in &group.order {
        if let (Ok(behind), Ok(in_front)) = (members.binary_search(behind), members.binary_search(in_front)) {
            network.needs[if ahead { behind } else { in_front }].push(if ahead { in_front } else { behind });
        }
    }
    let leaves = network.closure(forces * ROUNDING);
    let (leaving, staying): (Vec<usize>, Vec<usize>) = (0..members.len()).partition(|place| leaves[*place]);
    let named = |places: Vec<usize>| places.into_iter().map(|place| members[place]).collect();
    (named(leaving), named(staying))
}

/// A network in which supplies flow to demands: from each member to those that must go with it.
struct Network {
    /// What each member gains by going; negative for a loss.
    supply: Vec<f64>,
    /// Members that must not go.
    held: Vec<bool>,
    /// Who must go if this one goes.
    needs: Vec<Vec<usize>>,
    /// What has flowed along each need, and the way back.
    flow: Vec<Vec<f64>>,
    back: Vec<Vec<(usize, usize)>>,
}

impl Network {
    fn new(members: usize) -> Network {
        Network {
            supply: vec![0.0; members],
            held: vec![false; members],
            needs: vec![Vec::new(); members],
            flow: Vec::new(),
            back: vec![Vec::new(); members],
        }
    }

    /// Who goes: those that can still be reached from a supply when all that can flow has flowed.
    fn closure(mut self, rounding: f64) -> Vec<bool> {
        self.flow = self.needs.iter().map(|needs| vec![0.0; needs.len()]).collect();
        for member in 0..self.needs.len() {
            for (index, needed) in self.needs[member].iter().enumerate() {
                self.back[*needed].push((member, index));
            }
        }
        loop {
            let reached = self.reach(rounding);
            let sink = (0..self.supply.len())
                .find(|member| reached[*member].is_some() && (self.held[*member] || self.supply[*member] < -rounding));
            match sink {
                Some(sink) => self.send(&reached, sink),
                None => return reached.iter().map(Option::is_some).collect(),
            }
        }
    }

    /// For each member reachable from a supply, by which step: breadth first.
    fn reach(&self, rounding: f64) -> Vec<Option<Step>> {
        let mut reached = vec![None; self.supply.len()];
        let mut queue = Vec::new();
        for (member, _) in self.supply.iter().enumerate().filter(|(_, supply)| **supply > rounding) {
            reached[member] = Some(Step::Source);
            queue.push(member);
        }
        let mut next = 0;
        while let Some(member) = queue.get(next).copied() {
            next += 1;
            for (index, needed) in self.needs[member].iter().enumerate() {
                if reached[*needed].is_none() {
                    reached[*needed] = Some(Step::Along(member, index));
                    queue.push(*needed);
                }
            }
            for (from, index) in &self.back[member] {
                if reached[*from].is_none() && self.flow[*from][*index] > rounding {
                    reached[*from] = Some(Step::Back(member, *index));
                    queue.push(*from);
                }
            }
        }
        reached
    }

    /// Sends what can flow along the path found to `sink`.
    fn send(&mut self, reached: &[Option<Step>], sink: usize) {
        let mut amount = if self.held[sink] { f64::INFINITY } else { -self.supply[sink] };
        let mut member = sink;
        let source = loop {
            match reached[member] {
                Some(Step::Along(from, _)) => member = from,
                Some(Step::Back(from, index)) => {
                    amount = if self.flow[member][index] < amount { self.flow[member][index] } else { amount };
                    member = from;
                }
                Some(Step::Source) | None => break member,
            }
        };
        amount = if self.supply[source] < amount { self.supply[source] } else { amount };
        self.supply[source] -= amount;
        if !self.held[sink] {
            self.supply[sink] += amount;
        }
        member = sink;
        loop {
            match reached[member] {
                Some(Step::Along(from, index)) => {
                    self.flow[from][index] += amount;
                    member = from;
                }
                Some(Step::Back(from, index)) => {
                    self.flow[member][index] -= amount;
                    member = from;
                }
                Some(Step::Source) | None => break,
            }
        }
    }
}

/// How a member was reached.
#[derive(Clone, Copy, Debug)]
enum Step {
    /// It has supply left.
    Source,
    /// From that member along its need of that index.
    Along(usize, usize),
    /// From that member against the flow of its own need of that index.
    Back(usize, usize),
}

#[cfg(test)]
mod tests {
    use super::*;

    fn solved(bodies: &[(f64, f64, [bool; 2])], order: &[[usize; 2]]) -> Vec<f64> {
        let mut group = Group { order: order.to_vec(), ..Group::default() };
        bodies.iter().for_each(|(free, mass, held)| group.add(*free, *mass, *held));
        least_change(&group)
    }

    const FREE: [bool; 2] = [false; 2];

    #[test]
    fn pressed_together_they_move_as_one() {
        assert_eq!(solved(&[(3.0, 1.0, FREE), (-1.0, 3.0, FREE)], &[[0, 1]]), [0.0, 0.0]);
        assert_eq!(solved(&[(5.0, 1.0, FREE), (1.0, 3.0, FREE)], &[[0, 1]]), [2.0, 2.0]);
    }

    #[test]
    fn pulled_apart_they_move_apart() {
        assert_eq!(solved(&[(-1.0, 1.0, FREE), (2.0, 3.0, FREE)], &[[0, 1]]), [-1.0, 2.0]);
    }

    #[test]
    fn a_block_transmits_no_tension() {
        let bodies = [(4.0, 1.0, FREE), (0.0, 1.0, FREE), (9.0, 1.0, FREE)];
        assert_eq!(solved(&bodies, &[[0, 1], [1, 2]]), [2.0, 2.0, 9.0]);
    }

    #[test]
    fn one_box_on_two_is_pressed_by_both() {
        let bodies = [(6.0, 1.0, FREE), (3.0, 1.0, FREE), (0.0, 1.0, FREE)];
        assert_eq!(solved(&bodies, &[[0, 2], [1, 2]]), [3.0, 3.0, 3.0]);
        assert_eq!(solved(&[(6.0, 1.0, FREE), (1.0, 1.0, FREE), (0.0, 1.0, FREE)], &[[0, 2], [1, 2]]), [3.0, 1.0, 3.0]);
    }

    #[test]
    fn what_is_held_stays_unless_it_is_pulled_away() {
        let held_ahead = [false, true];
        assert_eq!(solved(&[(5.0, 1.0, held_ahead), (5.0, 1.0, held_ahead)], &[[0, 1]]), [0.0, 0.0]);
        assert_eq!(solved(&[(-5.0, 1.0, held_ahead), (5.0, 1.0, held_ahead)], &[[0, 1]]), [-5.0, 0.0]);
        assert_eq!(
            solved(&[(-5.0, 3.0, held_ahead), (1.0, 1.0, FREE), (-7.0, 1.0, held_ahead)], &[[1, 2]])[1..],
            [-3.0, -3.0][..]
        );
    }

    #[test]
    fn minimises_the_change_on_random_orders() {
        let mut state = 12345_u64;
        let mut random = move || {
            state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
            (state >> 33) as f64 / (1u64 << 31) as f64
        };
        for _ in 0..200 {
            let bodies: Vec<_> = (0..6).map(|_| (random() * 10.0 - 5.0, 0.5 + random(), FREE)).collect();
            let order: Vec<[usize; 2]> =
                (0..6).flat_map(|j| (0..j).map(move |i| [i, j])).filter(|_| random() < 0.4).collect();
            let a = solved(&bodies, &order);
            let slack = 1e-12;
            assert!(order.iter().all(|[i, j]| a[*j] >= a[*i] - slack), "no contact is pressed through");
            let force = |i: usize| bodies[i].1 * (a[i] - bodies[i].0);
            assert!((0..6).map(force).sum::<f64>().abs() < 1e-9, "inner forces cancel");
            assert!(
                (0..6).map(|i| force(i) * a[i]).sum::<f64>().abs() < 1e-9,
                "forces act only where they stay together"
            );
            for from in 0..64_u32 {
                let closed = order.iter().all(|[i, j]| from >> i & 1 == 0 || from >> j & 1 == 1);
                let pushed: f64 = (0..6).filter(|i| from >> i & 1 == 1).map(force).sum();
                assert!(!closed || pushed > -1e-9, "contact forces only push");
            }
        }
    }
}
