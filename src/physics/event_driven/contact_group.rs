//! Accelerations of bodies in contact along one axis: the least change from free fall.
//!
//! Gauss's principle of least constraint: minimise Σ mᵢ·(aᵢ − fᵢ)² over the accelerations aᵢ, given
//! the free accelerations fᵢ, subject to aⱼ ≥ aᵢ for each contact of i with j on its high side, so
//! that no box penetrates another. This is isotonic regression on a partial order.
//!
//! - Equal free accelerations: a body rests if contacts lead from it to an infinite mass in the direction of
//!   its free fall; a search, O(contacts), without masses.
//! - A chain: pool adjacent violators, O(bodies).
//! - Otherwise recursive partitioning: if c is the best common value of a group, the group is split
//!   along the upper set with the greatest Σ mᵢ·(fᵢ − c), provided that sum is positive beyond rounding, or else
//!   along such a lower set with the least, and both parts are solved separately (Spouge, Wan and Wilbur, "Least
//!   squares isotonic regression in two dimensions", 2003). The set is a maximum closure, found as a minimum cut
//!   (Picard, 1976) by shortest augmenting paths (Edmonds and Karp, 1972), O(bodies × contacts²) for each of at most
//!   4·bodies cuts.
//!
//! A difference is 0 if it is below the rounding of the numbers from which it was computed, those of the set or pool
//! that would separate. The forces on others do not count: a heavy body would otherwise hold a light one back.

use super::double_double::DoubleDouble;
use crate::physics::Side;

/// Bodies connected by contacts along an axis, and the contacts.
#[derive(Clone, Debug, Default)]
pub struct ContactGroup {
    /// The acceleration of bodies without a force of their own, m/s².
    gravity: DoubleDouble,
    /// The free acceleration of each body, m/s².
    free: Vec<DoubleDouble>,
    /// The mass of each body, in any unit.
    mass: Vec<DoubleDouble>,
    /// The force on each body besides gravity, in the unit of mass times m/s².
    force: Vec<DoubleDouble>,
    /// For each body and side, true if it touches an infinite mass there.
    supported: Vec<[bool; 2]>,
    /// Pairs of bodies in contact, the one on the low side first.
    contacts: Vec<[usize; 2]>,
}

/// Differences smaller than this fraction of the numbers involved are rounding: 2¹⁴ times that of an operation, since
/// the errors of all bodies of a group add up.
const ROUNDING: f64 = 1.0 / (1_u128 << 90) as f64;

/// From this ratio of masses on, a mean is computed from that of the heavier body, because the rounding of that of the
/// lighter one would exceed its share in it.
const HEAVIER: f64 = 1024.0;

impl ContactGroup {
    /// Removes all bodies and contacts, and sets the gravitational acceleration, m/s².
    pub fn clear(&mut self, gravity: DoubleDouble) {
        self.gravity = gravity;
        self.free.clear();
        self.mass.clear();
        self.force.clear();
        self.supported.clear();
        self.contacts.clear();
    }

    /// Adds a body: free acceleration (m/s²), mass and force besides gravity, in units whose quotient is m/s²; returns
    /// its index.
    pub fn add(&mut self, free: DoubleDouble, mass: DoubleDouble, force: DoubleDouble) -> usize {
        self.force.push(force);
        self.free.push(free);
        self.mass.push(mass);
        self.supported.push([false; 2]);
        self.free.len() - 1
    }

    /// Adds a contact, the body on the low side first.
    pub fn connect(&mut self, pair: [usize; 2]) {
        self.contacts.push(pair);
    }

    /// Adds the contact of a body with an infinite mass on a side.
    pub fn support(&mut self, body: usize, side: Side) {
        self.supported[body][side] = true;
    }

    /// The acceleration of each body, m/s².
    pub fn accelerations(&self) -> Vec<DoubleDouble> {
        if self.free.iter().all(|free| *free == self.free[0]) {
            return self.solve_equal();
        }
        match self.chain() {
            Some(chain) => self.solve_chain(&chain),
            None => self.solve_partial_order(),
        }
    }

    /// The solution for equal free accelerations.
    fn solve_equal(&self) -> Vec<DoubleDouble> {
        let free = self.free[0];
        let mut accelerations = vec![free; self.free.len()];
        if free.high == 0.0 {
            return accelerations;
        }
        let side = if free.high > 0.0 { Side::High } else { Side::Low };
        let mut behind = vec![Vec::new(); self.free.len()];
        for [low, high] in &self.contacts {
            match side {
                Side::High => behind[*high].push(*low),
                Side::Low => behind[*low].push(*high),
            }
        }
        let mut at_rest: Vec<usize> = (0..self.free.len()).filter(|body| self.supported[*body][side]).collect();
        while let Some(body) = at_rest.pop() {
            if accelerations[body].high != 0.0 {
                accelerations[body] = DoubleDouble::ZERO;
                at_rest.extend(&behind[body]);
            }
        }
        accelerations
    }

    /// The bodies from low to high if each touches at most one on either side.
    fn chain(&self) -> Option<Vec<usize>> {
        let mut next = vec![None; self.free.len()];
        let mut previous = vec![None; self.free.len()];
        for [low, high] in &self.contacts {
            if next[*low].is_some() || previous[*high].is_some() {
                return None;
            }
            next[*low] = Some(*high);
            previous[*high] = Some(*low);
        }
        let blocked = |body: usize| {
            (self.supported[body][Side::Low] && previous[body].is_some())
                || (self.supported[body][Side::High] && next[body].is_some())
        };
        if (0..self.free.len()).any(blocked) {
            return None;
        }
        let first = (0..self.free.len()).find(|body| previous[*body].is_none())?;
        let chain: Vec<usize> = std::iter::successors(Some(first), |body| next[*body]).collect();
        (chain.len() == self.free.len()).then_some(chain)
    }

    /// Pool adjacent violators; an infinite mass at an end is a pool with acceleration 0.
    fn solve_chain(&self, chain: &[usize]) -> Vec<DoubleDouble> {
        let mut pools: Vec<Pool> = Vec::new();
        if self.supported[chain[0]][Side::Low] {
            pools.push(Pool::WALL);
        }
        for body in chain {
            push_pool(&mut pools, self.pool(*body));
        }
        if self.supported[chain[chain.len() - 1]][Side::High] {
            push_pool(&mut pools, Pool::WALL);
        }
        let mut accelerations = vec![DoubleDouble::ZERO; self.free.len()];
        let mut bodies = chain.iter();
        for pool in pools {
            for body in bodies.by_ref().take(pool.count) {
                accelerations[*body] = pool.mean;
            }
        }
        accelerations
    }

    /// The solution for any contacts.
    fn solve_partial_order(&self) -> Vec<DoubleDouble> {
        let mut accelerations = vec![DoubleDouble::ZERO; self.free.len()];
        let all: Vec<usize> = (0..self.free.len()).collect();
        if self.supported.iter().any(|supported| supported[0] || supported[1]) {
            let (pulled_high, rest) = self.split(&all, &Pool::WALL, Side::High, SupportedMembers::Stay);
            let (pulled_low, _) = self.split(&rest, &Pool::WALL, Side::Low, SupportedMembers::Stay);
            self.solve_free(&pulled_high, &mut accelerations);
            self.solve_free(&pulled_low, &mut accelerations);
        } else {
            self.solve_free(&all, &mut accelerations);
        }
        accelerations
    }

    /// Solves `members` without any support.
    fn solve_free(&self, members: &[usize], accelerations: &mut [DoubleDouble]) {
        let mut unsolved = vec![members.to_vec()];
        while let Some(members) = unsolved.pop() {
            if members.is_empty() {
                continue;
            }
            let common = self.as_one(&members);
            match self.parts(&members, &common) {
                Some(parts) => unsolved.extend(parts),
                None => members.iter().for_each(|member| accelerations[*member] = common.mean),
            }
        }
    }

    /// Members that move as one: their mean is total force divided by total mass.
    fn as_one(&self, members: &[usize]) -> Pool {
        let pools = members.iter().map(|member| self.pool(*member));
        pools.reduce(Pool::merged).unwrap_or(Pool::WALL)
    }

    /// A body alone.
    fn pool(&self, body: usize) -> Pool {
        let (mass, mean, force) = (self.mass[body], self.free[body], self.force[body]);
        let [magnitude, force_magnitude] = [mean, force].map(|number| number.high.abs());
        Pool { count: 1, mass, mean, magnitude, force, force_magnitude, gravity: self.gravity }
    }

    /// The two parts into which members without any support separate; `None` if they move as one.
    ///
    /// In exact arithmetic, both sides give the same parts or ones that separate later. A part that is light by
    /// comparison with the other is found only from its own side.
    fn parts(&self, members: &[usize], common: &Pool) -> Option<[Vec<usize>; 2]> {
        [Side::High, Side::Low].into_iter().find_map(|side| {
            let (leaving, staying) = self.split(members, common, side, SupportedMembers::MayLeave);
            (!leaving.is_empty() && !staying.is_empty()).then_some([leaving, staying])
        })
    }

    /// Splits off the set of members with the greatest total force towards `side`, relative to the mean acceleration
    /// of `common`; with each member it contains all members in contact with it on that side. Returns the set and the
    /// rest.
    ///
    /// Each force is less by its rounding, so the total force of the set exceeds its rounding.
    fn split(
        &self,
        members: &[usize],
        common: &Pool,
        side: Side,
        supported_members: SupportedMembers,
    ) -> (Vec<usize>, Vec<usize>) {
        let mut network = FlowNetwork::new(members.len());
        for (index, member) in members.iter().enumerate() {
            let (mass, free) = (self.mass[*member], self.free[*member]);
            let rounding = mass.high * ((free.high.abs() + common.magnitude) * ROUNDING);
            let force = mass * (free - common.mean);
            let force = if side == Side::High { force } else { -force };
            network.supply[index] = force - rounding.into();
            network.blocked[index] = supported_members == SupportedMembers::Stay && self.supported[*member][side];
        }
        for [low, high] in &self.contacts {
            if let (Ok(low), Ok(high)) = (members.binary_search(low), members.binary_search(high)) {
                let (member, successor) = match side {
                    Side::High => (low, high),
                    Side::Low => (high, low),
                };
                network.successors[member].push(successor);
            }
        }
        let leaves = network.max_closure();
        let (leaving, staying): (Vec<usize>, Vec<usize>) = (0..members.len()).partition(|index| leaves[*index]);
        let to_bodies = |indices: Vec<usize>| indices.into_iter().map(|index| members[index]).collect();
        (to_bodies(leaving), to_bodies(staying))
    }
}

/// Adjacent bodies of a chain that move as one.
#[derive(Clone, Copy, Debug)]
struct Pool {
    count: usize,
    /// Infinite for a pool that contains an infinite mass.
    mass: DoubleDouble,
    mean: DoubleDouble,
    /// The mean of the magnitudes of the free accelerations in it, m/s²; 0 for an infinite mass.
    magnitude: f64,
    /// The sum of the forces besides gravity, in the unit of mass times m/s².
    force: DoubleDouble,
    /// The sum of their magnitudes, likewise.
    force_magnitude: f64,
    /// The acceleration without these forces, m/s².
    gravity: DoubleDouble,
}

impl Pool {
    /// An infinite mass, which is no body of the chain.
    const WALL: Pool = Pool {
        count: 0,
        mass: DoubleDouble { high: f64::INFINITY, low: 0.0 },
        mean: DoubleDouble::ZERO,
        magnitude: 0.0,
        force: DoubleDouble::ZERO,
        force_magnitude: 0.0,
        gravity: DoubleDouble::ZERO,
    };

    /// The two pools as one. If the forces on it cancel, it falls like a body without forces, to the last digit.
    fn merged(self, other: Pool) -> Pool {
        let count = self.count + other.count;
        if self.mass.high == f64::INFINITY || other.mass.high == f64::INFINITY {
            return Pool { count, ..Pool::WALL };
        }
        let mass = self.mass + other.mass;
        let [base, added] = if other.mass.high > self.mass.high * HEAVIER { [other, self] } else { [self, other] };
        let share = added.mass / mass;
        let force = self.force + other.force;
        let force_magnitude = self.force_magnitude + other.force_magnitude;
        let mean = if force.high.abs() <= force_magnitude * ROUNDING {
            self.gravity
        } else {
            base.mean + (added.mean - base.mean) * share
        };
        let magnitude = base.magnitude + (added.magnitude - base.magnitude) * share.high;
        Pool { count, mass, mean, magnitude, force, force_magnitude, gravity: self.gravity }
    }

    /// True if the second of two adjacent pools does not outrun the first.
    fn presses(&self, next: &Pool) -> bool {
        let magnitude = if self.magnitude > next.magnitude { self.magnitude } else { next.magnitude };
        (self.mean - next.mean).high >= -magnitude * ROUNDING
    }
}

/// Appends a pool and merges it with those that press on it.
fn push_pool(pools: &mut Vec<Pool>, mut pool: Pool) {
    while let Some(last) = pools.last().copied()
        && last.presses(&pool)
    {
        pool = last.merged(pool);
        pools.pop();
    }
    pools.push(pool);
}

/// Treatment of the members that are supported on the side towards which a set is split off.
#[derive(Clone, Copy, PartialEq)]
enum SupportedMembers {
    /// They cannot belong to the set.
    Stay,
    /// They are treated like all others.
    MayLeave,
}

/// The flow network of a maximum closure: flow leads from members of positive supply to members of
/// negative supply, along successor edges of unlimited capacity.
struct FlowNetwork {
    /// The gain of including each member in the closure; negative for a loss.
    supply: Vec<DoubleDouble>,
    /// Members that must not be included.
    blocked: Vec<bool>,
    /// The members that must be included with each member.
    successors: Vec<Vec<usize>>,
    /// The flow along each successor edge.
    flow: Vec<Vec<DoubleDouble>>,
    /// For each member, its predecessors and the indices of their edges to it.
    predecessors: Vec<Vec<(usize, usize)>>,
}

impl FlowNetwork {
    fn new(members: usize) -> FlowNetwork {
        FlowNetwork {
            supply: vec![DoubleDouble::ZERO; members],
            blocked: vec![false; members],
            successors: vec![Vec::new(); members],
            flow: Vec::new(),
            predecessors: vec![Vec::new(); members],
        }
    }

    /// The maximum closure: the members reachable from a remaining supply once the flow is maximal.
    fn max_closure(mut self) -> Vec<bool> {
        self.flow = self.successors.iter().map(|successors| vec![DoubleDouble::ZERO; successors.len()]).collect();
        for member in 0..self.successors.len() {
            for (index, successor) in self.successors[member].iter().enumerate() {
                self.predecessors[*successor].push((member, index));
            }
        }
        loop {
            let reached = self.search();
            let sink = (0..self.supply.len()).find(|member| {
                reached[*member].is_some() && (self.blocked[*member] || self.supply[*member].high < 0.0)
            });
            match sink {
                Some(sink) => self.augment(&reached, sink),
                None => return reached.iter().map(Option::is_some).collect(),
            }
        }
    }

    /// Breadth-first search of the residual network: for each member reachable from a remaining supply, its
    /// predecessor on the path.
    fn search(&self) -> Vec<Option<Predecessor>> {
        let mut reached = vec![None; self.supply.len()];
        let mut queue = Vec::new();
        for (member, _) in self.supply.iter().enumerate().filter(|(_, supply)| supply.high > 0.0) {
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
                if reached[*from].is_none() && self.flow[*from][*index].high > 0.0 {
                    reached[*from] = Some(Predecessor::Backward(member, *index));
                    queue.push(*from);
                }
            }
        }
        reached
    }

    /// Augments the flow along the path found to `sink` by as much as possible.
    fn augment(&mut self, reached: &[Option<Predecessor>], sink: usize) {
        let least = |a: DoubleDouble, b: DoubleDouble| if b.is_less(a) { b } else { a };
        let mut amount = if self.blocked[sink] { f64::INFINITY.into() } else { -self.supply[sink] };
        let mut member = sink;
        let source = loop {
            match reached[member] {
                Some(Predecessor::Forward(from, _)) => member = from,
                Some(Predecessor::Backward(from, index)) => {
                    amount = least(amount, self.flow[member][index]);
                    member = from;
                }
                Some(Predecessor::Source) | None => break member,
            }
        };
        amount = least(amount, self.supply[source]);
        self.supply[source] = self.supply[source] - amount;
        if !self.blocked[sink] {
            self.supply[sink] = self.supply[sink] + amount;
        }
        member = sink;
        loop {
            match reached[member] {
                Some(Predecessor::Forward(from, index)) => {
                    self.flow[from][index] = self.flow[from][index] + amount;
                    member = from;
                }
                Some(Predecessor::Backward(from, index)) => {
                    self.flow[member][index] = self.flow[member][index] - amount;
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
    use crate::physics::event_driven::pseudo_random::PseudoRandom;

    fn solved(bodies: &[(f64, f64, [bool; 2])], contacts: &[[usize; 2]]) -> Vec<f64> {
        let mut group = ContactGroup::default();
        for (free, mass, supported) in bodies {
            let body = group.add((*free).into(), (*mass).into(), (*free * *mass).into());
            Side::BOTH.into_iter().filter(|side| supported[*side]).for_each(|side| group.support(body, side));
        }
        contacts.iter().for_each(|pair| group.connect(*pair));
        group.accelerations().iter().map(|acceleration| acceleration.high).collect()
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
        assert_eq!(solved(&[(5.0, 1.0, FREE), (5.0, 1.0, supported)], &[[0, 1]]), [0.0, 0.0]);
        assert_eq!(solved(&[(-5.0, 1.0, FREE), (5.0, 1.0, supported)], &[[0, 1]]), [-5.0, 0.0]);
        assert_eq!(solved(&[(1.0, 1.0, FREE), (-7.0, 1.0, supported)], &[[0, 1]]), [-3.0, -3.0]);
    }

    #[test]
    fn a_stack_is_solved_like_a_partial_order() {
        let bodies: Vec<(f64, f64, [bool; 2])> =
            (0..9_u32).map(|index| (f64::from(index * 7 % 5) - 2.0, f64::from(index % 3 + 1), FREE)).collect();
        let contacts: Vec<[usize; 2]> = (0..8).map(|index| [index, index + 1]).collect();
        let mut group = ContactGroup::default();
        bodies.iter().for_each(|(free, mass, _)| _ = group.add((*free).into(), (*mass).into(), (*free * *mass).into()));
        contacts.iter().for_each(|pair| group.connect(*pair));
        let general = group.solve_partial_order();
        for (chain, general) in group.accelerations().iter().zip(general) {
            assert!((*chain - general).high.abs() < 1e-28);
        }
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

    /// Bodies of masses from 10⁻²⁰ to 10²⁰ kg: free acceleration, mass, supports.
    type Group = Vec<(f64, f64, [bool; 2])>;

    /// A random group, and its contacts: a chain in half of the cases.
    fn random_group(random: &mut PseudoRandom) -> (Group, Vec<[usize; 2]>) {
        let magnitude = |random: &mut PseudoRandom, most: f64| {
            let exponent = random.between(-most, most).floor();
            let factor = if exponent < 0.0 { 0.1 } else { 10.0 };
            (0..exponent.abs() as u32).fold(random.between(1.0, 2.0), |value, _| value * factor)
        };
        let (is_chain, has_walls) = (random.next() < 0.5, random.next() < 0.5);
        let bodies = (0..6).map(|n| {
            let free = magnitude(random, 15.0) * [1.0, -1.0, 0.0][random.between(0.0, 2.3).floor() as usize];
            let supported = [0, 5].map(|end| has_walls && random.next() < 0.2 && (!is_chain || n == end));
            (free, magnitude(random, 20.0), supported)
        });
        let bodies = bodies.collect();
        let contacts = (0..6).flat_map(|j| (0..j).map(move |i| [i, j]));
        let contacts = contacts.filter(|[i, j]| if is_chain { i + 1 == *j } else { random.next() < 0.4 }).collect();
        (bodies, contacts)
    }

    #[test]
    fn no_contact_pulls_whatever_the_ratio_of_masses() {
        let mut random = PseudoRandom(3);
        for number in 0..3000 {
            let (bodies, contacts) = random_group(&mut random);
            let mut group = ContactGroup::default();
            for (free, mass, supported) in &bodies {
                let body = group.add((*free).into(), (*mass).into(), (*free * *mass).into());
                Side::BOTH.into_iter().filter(|side| supported[*side]).for_each(|side| group.support(body, side));
            }
            contacts.iter().for_each(|pair| group.connect(*pair));
            let a = group.accelerations();
            // The magnitude of the numbers from which an acceleration is computed: those of the bodies that move as
            // one.
            let magnitude = |i: usize| {
                let together = (0..6).filter(|j| a[*j] == a[i]);
                let sums = together.fold([0.0; 2], |[m, f], j| [m + bodies[j].1, f + bodies[j].1 * bodies[j].0.abs()]);
                if a[i].high == 0.0 { 0.0 } else { sums[1] / sums[0] }
            };
            let slack = 1e-24;
            let about = format!("group {number}: {a:?} of {bodies:?}, {contacts:?}");
            for [i, j] in &contacts {
                let rounding = slack * (magnitude(*i) + magnitude(*j));
                assert!((a[*i] - a[*j]).high <= rounding, "{i} is pressed through {j}, {about}");
            }
            let force = |i: usize| (a[i] - bodies[i].0.into()) * bodies[i].1.into();
            let rounding = |i: usize| slack * bodies[i].1 * (bodies[i].0.abs() + magnitude(i));
            for (set, side) in (0..64_u32).flat_map(|set| [(set, Side::High), (set, Side::Low)]) {
                let has = |i: usize| set >> i & 1 == 1;
                let is_closed = contacts.iter().all(|&[i, j]| match side {
                    Side::High => !has(i) || has(j),
                    Side::Low => !has(j) || has(i),
                });
                let members = || (0..6).filter(|i| has(*i));
                if !is_closed || members().any(|i| bodies[i].2[side]) {
                    continue;
                }
                let sum = members().fold(DoubleDouble::ZERO, |sum, i| sum + force(i)).high;
                let pushed = if side == Side::High { sum } else { -sum };
                assert!(pushed >= -members().map(rounding).sum::<f64>(), "{set:b} is pulled by {pushed:e} N, {about}");
            }
        }
    }
}
