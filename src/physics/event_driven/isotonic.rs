//! Accelerations of bodies in contact along one axis, by isotonic regression.
//!
//! Gauss's principle of least constraint: minimise Σ mᵢ·(aᵢ − fᵢ)² over the accelerations aᵢ, given
//! the free accelerations fᵢ, subject to aⱼ ≥ aᵢ for each contact of i with j on its high side, so
//! that no box penetrates another. This is isotonic regression on a partial order. It is solved
//! exactly by recursive partitioning: if c is the best common value of a group, the group is split
//! along the upper set with the greatest Σ mᵢ·(fᵢ − c), provided that sum is positive, and both parts are
//! solved separately (Spouge, Wan and Wilbur, "Least squares isotonic regression in
//! two dimensions", 2003). The set is a maximum closure, found as a minimum cut (Picard, 1976) by
//! augmenting paths (Ford and Fulkerson).

use crate::physics::Side;

/// Bodies connected by contacts along an axis, and the contacts.
#[derive(Clone, Debug, Default)]
pub struct ContactGroup {
    /// The free acceleration of each body, m/s².
    free: Vec<f64>,
    /// The mass of each body, kg.
    mass: Vec<f64>,
    /// For each body and side, true if contacts on that side lead to an infinite mass at acceleration 0.
    supported: Vec<[bool; 2]>,
    /// Pairs of bodies in contact, the one on the low side first.
    pub contacts: Vec<[usize; 2]>,
}

impl ContactGroup {
    /// Adds a body: free acceleration (m/s²), mass (kg), support on each side.
    pub fn add(&mut self, free: f64, mass: f64, supported: [bool; 2]) {
        self.free.push(free);
        self.mass.push(mass);
        self.supported.push(supported);
    }
}

/// Gains smaller than this fraction of the forces involved are rounding.
const ROUNDING: f64 = 64.0 * f64::EPSILON;

/// The acceleration of each body of a group, m/s².
pub fn solve(group: &ContactGroup) -> Vec<f64> {
    let mut accelerations = vec![0.0; group.free.len()];
    let all: Vec<usize> = (0..group.free.len()).collect();
    if group.supported.iter().any(|supported| supported[0] || supported[1]) {
        let (pulled_high, rest) = split(group, &all, 0.0, Side::High, SupportedMembers::Stay);
        let (pulled_low, _) = split(group, &rest, 0.0, Side::Low, SupportedMembers::Stay);
        solve_free(group, &pulled_high, &mut accelerations);
        solve_free(group, &pulled_low, &mut accelerations);
    } else {
        solve_free(group, &all, &mut accelerations);
    }
    accelerations
}

/// Solves `members` without any support.
fn solve_free(group: &ContactGroup, members: &[usize], accelerations: &mut [f64]) {
    let mut unsolved = vec![members.to_vec()];
    while let Some(members) = unsolved.pop() {
        if members.is_empty() {
            continue;
        }
        let common = mean_acceleration(group, &members);
        let (faster, slower) = split(group, &members, common, Side::High, SupportedMembers::MayLeave);
        if faster.is_empty() || slower.is_empty() {
            members.iter().for_each(|member| accelerations[*member] = common);
        } else {
            unsolved.push(faster);
            unsolved.push(slower);
        }
    }
}

/// The common acceleration of members that move as one: total force divided by total mass, m/s².
fn mean_acceleration(group: &ContactGroup, members: &[usize]) -> f64 {
    let first = group.free[members[0]];
    if members.iter().all(|member| group.free[*member] == first) {
        return first;
    }
    let force: f64 = members.iter().map(|member| group.mass[*member] * group.free[*member]).sum();
    force / members.iter().map(|member| group.mass[*member]).sum::<f64>()
}

/// Treatment of the members that are supported on the side towards which a set is split off.
#[derive(Clone, Copy, PartialEq)]
enum SupportedMembers {
    /// They cannot belong to the set.
    Stay,
    /// They are treated like all others.
    MayLeave,
}

/// Splits off the set of members with the greatest total force towards `side`, relative to the acceleration
/// `level`; with each member it contains all members in contact with it on that side. Returns
/// the set and the rest.
fn split(
    group: &ContactGroup,
    members: &[usize],
    level: f64,
    side: Side,
    supported_members: SupportedMembers,
) -> (Vec<usize>, Vec<usize>) {
    let sign = side.sign();
    let mut network = FlowNetwork::new(members.len());
    let mut forces = 0.0;
    for (index, member) in members.iter().enumerate() {
        let (mass, free) = (group.mass[*member], group.free[*member]);
        forces += mass * (free.abs() + level.abs());
        network.supply[index] = sign * mass * (free - level);
        network.blocked[index] = supported_members == SupportedMembers::Stay && group.supported[*member][side];
    }
    for [low, high] in &group.contacts {
        if let (Ok(low), Ok(high)) = (members.binary_search(low), members.binary_search(high)) {
            let (member, successor) = match side {
                Side::High => (low, high),
                Side::Low => (high, low),
            };
            network.successors[member].push(successor);
        }
    }
    let leaves = network.max_closure(forces * ROUNDING);
    let (leaving, staying): (Vec<usize>, Vec<usize>) = (0..members.len()).partition(|index| leaves[*index]);
    let to_bodies = |indices: Vec<usize>| indices.into_iter().map(|index| members[index]).collect();
    (to_bodies(leaving), to_bodies(staying))
}

/// The flow network of a maximum closure: flow leads from members of positive supply to members of
/// negative supply, along successor edges of unlimited capacity.
struct FlowNetwork {
    /// The gain of including each member in the closure; negative for a loss.
    supply: Vec<f64>,
    /// Members that must not be included.
    blocked: Vec<bool>,
    /// The members that must be included with each member.
    successors: Vec<Vec<usize>>,
    /// The flow along each successor edge.
    flow: Vec<Vec<f64>>,
    /// For each member, its predecessors and the indices of their edges to it.
    predecessors: Vec<Vec<(usize, usize)>>,
}

impl FlowNetwork {
    fn new(members: usize) -> FlowNetwork {
        FlowNetwork {
            supply: vec![0.0; members],
            blocked: vec![false; members],
            successors: vec![Vec::new(); members],
            flow: Vec::new(),
            predecessors: vec![Vec::new(); members],
        }
    }

    /// The maximum closure: the members reachable from a remaining supply once the flow is maximal.
    fn max_closure(mut self, rounding: f64) -> Vec<bool> {
        self.flow = self.successors.iter().map(|successors| vec![0.0; successors.len()]).collect();
        for member in 0..self.successors.len() {
            for (index, successor) in self.successors[member].iter().enumerate() {
                self.predecessors[*successor].push((member, index));
            }
        }
        loop {
            let reached = self.search(rounding);
            let sink = (0..self.supply.len()).find(|member| {
                reached[*member].is_some() && (self.blocked[*member] || self.supply[*member] < -rounding)
            });
            match sink {
                Some(sink) => self.augment(&reached, sink),
                None => return reached.iter().map(Option::is_some).collect(),
            }
        }
    }

    /// Breadth-first search of the residual network: for each member reachable from a remaining supply, its
    /// predecessor on the path.
    fn search(&self, rounding: f64) -> Vec<Option<Predecessor>> {
        let mut reached = vec![None; self.supply.len()];
        let mut queue = Vec::new();
        for (member, _) in self.supply.iter().enumerate().filter(|(_, supply)| **supply > rounding) {
            reached[member] = Some(Predecessor::Source);
            queue.push(member);
        }
        let mut next = 0;
        while let Some(member) = queue.get(next).copied() {
            next += 1;
            for (index, successor) in self.successors[member].iter().enumerate() {
                if reached[*successor].is_none() {
                    reached[*successor] = Some(Predecessor::Forward(member, index));
                    queue.push(*successor);
                }
            }
            for (from, index) in &self.predecessors[member] {
                if reached[*from].is_none() && self.flow[*from][*index] > rounding {
                    reached[*from] = Some(Predecessor::Backward(member, *index));
                    queue.push(*from);
                }
            }
        }
        reached
    }

    /// Augments the flow along the path found to `sink` by as much as possible.
    fn augment(&mut self, reached: &[Option<Predecessor>], sink: usize) {
        let mut amount = if self.blocked[sink] { f64::INFINITY } else { -self.supply[sink] };
        let mut member = sink;
        let source = loop {
            match reached[member] {
                Some(Predecessor::Forward(from, _)) => member = from,
                Some(Predecessor::Backward(from, index)) => {
                    amount = if self.flow[member][index] < amount { self.flow[member][index] } else { amount };
                    member = from;
                }
                Some(Predecessor::Source) | None => break member,
            }
        };
        amount = if self.supply[source] < amount { self.supply[source] } else { amount };
        self.supply[source] -= amount;
        if !self.blocked[sink] {
            self.supply[sink] += amount;
        }
        member = sink;
        loop {
            match reached[member] {
                Some(Predecessor::Forward(from, index)) => {
                    self.flow[from][index] += amount;
                    member = from;
                }
                Some(Predecessor::Backward(from, index)) => {
                    self.flow[member][index] -= amount;
                    member = from;
                }
                Some(Predecessor::Source) | None => break,
            }
        }
    }
}

/// The edge by which the search reached a member.
#[derive(Clone, Copy, Debug)]
enum Predecessor {
    /// None: the member has supply left.
    Source,
    /// From the given member along its successor edge of the given index.
    Forward(usize, usize),
    /// From the given successor, against the flow along the member's own edge of the given index.
    Backward(usize, usize),
}

#[cfg(test)]
mod tests {
    use super::*;

    fn solved(bodies: &[(f64, f64, [bool; 2])], contacts: &[[usize; 2]]) -> Vec<f64> {
        let mut group = ContactGroup { contacts: contacts.to_vec(), ..ContactGroup::default() };
        bodies.iter().for_each(|(free, mass, supported)| group.add(*free, *mass, *supported));
        solve(&group)
    }

    const FREE: [bool; 2] = [false; 2];

    #[test]
    fn bodies_pressed_together_move_as_one() {
        assert_eq!(solved(&[(3.0, 1.0, FREE), (-1.0, 3.0, FREE)], &[[0, 1]]), [0.0, 0.0]);
        assert_eq!(solved(&[(5.0, 1.0, FREE), (1.0, 3.0, FREE)], &[[0, 1]]), [2.0, 2.0]);
    }

    #[test]
    fn bodies_pulled_apart_separate() {
        assert_eq!(solved(&[(-1.0, 1.0, FREE), (2.0, 3.0, FREE)], &[[0, 1]]), [-1.0, 2.0]);
    }

    #[test]
    fn contacts_transmit_no_tension() {
        let bodies = [(4.0, 1.0, FREE), (0.0, 1.0, FREE), (9.0, 1.0, FREE)];
        assert_eq!(solved(&bodies, &[[0, 1], [1, 2]]), [2.0, 2.0, 9.0]);
    }

    #[test]
    fn a_box_on_two_is_pressed_by_both() {
        let bodies = [(6.0, 1.0, FREE), (3.0, 1.0, FREE), (0.0, 1.0, FREE)];
        assert_eq!(solved(&bodies, &[[0, 2], [1, 2]]), [3.0, 3.0, 3.0]);
        assert_eq!(solved(&[(6.0, 1.0, FREE), (1.0, 1.0, FREE), (0.0, 1.0, FREE)], &[[0, 2], [1, 2]]), [3.0, 1.0, 3.0]);
    }

    #[test]
    fn a_supported_body_rests_unless_it_is_pulled_away() {
        let supported = [false, true];
        assert_eq!(solved(&[(5.0, 1.0, supported), (5.0, 1.0, supported)], &[[0, 1]]), [0.0, 0.0]);
        assert_eq!(solved(&[(-5.0, 1.0, supported), (5.0, 1.0, supported)], &[[0, 1]]), [-5.0, 0.0]);
        assert_eq!(
            solved(&[(-5.0, 3.0, supported), (1.0, 1.0, FREE), (-7.0, 1.0, supported)], &[[1, 2]])[1..],
            [-3.0, -3.0][..]
        );
    }

    #[test]
    fn random_groups_satisfy_the_optimality_conditions() {
        let mut state = 12345_u64;
        let mut random = move || {
            state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
            (state >> 33) as f64 / (1u64 << 31) as f64
        };
        for _ in 0..200 {
            let bodies: Vec<_> = (0..6).map(|_| (random() * 10.0 - 5.0, 0.5 + random(), FREE)).collect();
            let contacts: Vec<[usize; 2]> =
                (0..6).flat_map(|j| (0..j).map(move |i| [i, j])).filter(|_| random() < 0.4).collect();
            let a = solved(&bodies, &contacts);
            let slack = 1e-12;
            assert!(contacts.iter().all(|[i, j]| a[*j] >= a[*i] - slack), "no contact is penetrated");
            let force = |i: usize| bodies[i].1 * (a[i] - bodies[i].0);
            assert!((0..6).map(force).sum::<f64>().abs() < 1e-9, "contact forces cancel");
            assert!(
                (0..6).map(|i| force(i) * a[i]).sum::<f64>().abs() < 1e-9,
                "contact forces act only between bodies that stay together"
            );
            for from in 0..64_u32 {
                let closed = contacts.iter().all(|[i, j]| from >> i & 1 == 0 || from >> j & 1 == 1);
                let pushed: f64 = (0..6).filter(|i| from >> i & 1 == 1).map(force).sum();
                assert!(!closed || pushed > -1e-9, "contact forces only push");
            }
        }
    }
}
