use super::Fixed256;
use crate::physics::{Body, Restitution, World};

/// The reason why a scene cannot be simulated with 77 decimals.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum Unsuitable {
    /// The simulator supports impacts, not resting contacts.
    #[error("some boxes rest on each other or overlap")]
    Resting,
    /// The simulation would take too long.
    #[error("too many collisions for 77 decimals")]
    TooManyCollisions,
}

/// Simulates boxes on exact parabolas that collide one pair at a time; predicts the impacts of all
/// pairs with 77 decimals.
///
/// It has no steps, no resting contacts and practically no rounding. Simultaneous impacts are resolved
/// one pair at a time, always the remaining pair that is lowest in creation order.
pub struct PreciseSimulator {
    boxes: Vec<MovingBox>,
    /// The next impact of each box.
    next: Vec<Option<Impact>>,
    restitution: Restitution,
    now: Fixed256,
    /// End of the simulation, s; later impacts are not predicted.
    until: f64,
    pair_checks: u64,
    /// Number of collisions so far.
    pub collisions: u64,
}

/// Limit of pair predictions; more would take minutes.
const MAX_PAIR_CHECKS: u64 = 20_000_000;

/// Times (s) closer than this are the same instant, and speeds (m/s) below this are zero: far below
/// any visible effect, and far enough above rounding that their squares are still representable.
const TOLERANCE: f64 = 1e-30;

/// A box and its parabola.
struct MovingBox {
    body: Body,
    at: [Fixed256; 2],
    velocity: [Fixed256; 2],
    acceleration: [Fixed256; 2],
    size: [Fixed256; 2],
    inverse_mass: Fixed256,
    since: Fixed256,
    rough: [RoughTrajectory; 2],
}

/// A motion along one axis in double precision.
#[derive(Clone, Copy, Debug)]
struct RoughTrajectory {
    position: f64,
    velocity: f64,
    acceleration: f64,
    since: f64,
}

impl RoughTrajectory {
    /// Position and velocity.
    fn at(&self, time: f64) -> (f64, f64) {
        let t = time - self.since;
        (self.position + t * (self.velocity + 0.5 * self.acceleration * t), self.velocity + self.acceleration * t)
    }
}

#[derive(Clone, Debug, PartialEq)]
struct Impact {
    time: Fixed256,
    pair: [usize; 2],
    axis: usize,
}

/// Motion of one box relative to another along an axis.
struct RelativeMotion {
    position: Fixed256,
    velocity: Fixed256,
    half_acceleration: Fixed256,
}

impl PreciseSimulator {
    /// Creates a simulator of the boxes of `world`, from time 0 until `until` (s).
    ///
    /// # Errors
    /// Returns an error if boxes overlap or rest on each other.
    pub fn new(world: &World, until: f64) -> Result<PreciseSimulator, Unsuitable> {
        let gravity = world.gravity.map_or([0.0; 2], |gravity| [gravity.x, gravity.y]);
        let boxes: Vec<MovingBox> = world.bodies.iter().map(|body| MovingBox::new(body, gravity)).collect();
        let next = vec![None; boxes.len()];
        let restitution = world.restitution.clone();
        let mut simulator =
            PreciseSimulator { boxes, next, restitution, now: Fixed256::zero(), until, pair_checks: 0, collisions: 0 };
        for index in 0..simulator.boxes.len() {
            simulator.predict(index, 0..index)?;
        }
        Ok(simulator)
    }

    /// Advances to a later time, s.
    ///
    /// # Errors
    /// Returns an error if boxes come to rest on each other, or if there are too many collisions.
    pub fn advance(&mut self, time: &Fixed256) -> Result<(), Unsuitable> {
        loop {
            let due = self.next.iter().flatten().filter(|impact| impact.time <= *time);
            let first = due.min_by(|a, b| (&a.time, a.pair).cmp(&(&b.time, b.pair)));
            let Some(Impact { time, pair, axis }) = first.cloned() else { return Ok(()) };
            self.now = time;
            self.collide(pair, axis);
            self.repredict(pair)?;
        }
    }

    /// Returns the positions of the bodies of finite mass at a time already reached, in creation order, m.
    pub fn positions(&self, time: &Fixed256) -> Vec<[Fixed256; 2]> {
        let finite = self.boxes.iter().filter(|each| !each.body.is_infinite());
        finite.map(|each| [0, 1].map(|axis| each.state(axis, time).0)).collect()
    }

    fn collide(&mut self, pair: [usize; 2], axis: usize) {
        let now = self.now.clone();
        let [a, b] = pair.map(|index| &self.boxes[index]);
        let e = Fixed256::stated(self.restitution.between(a.body.material, b.body.material));
        let approach = &b.state(axis, &now).1 - &a.state(axis, &now).1;
        let impulse = &(&(&e + &Fixed256::from(1.0)) * &approach) / &(&a.inverse_mass + &b.inverse_mass);
        for (index, impulse) in pair.into_iter().zip([impulse.clone(), -&impulse]) {
            let moving = &mut self.boxes[index];
            moving.advance(&now);
            moving.velocity[axis] = &moving.velocity[axis] + &(&impulse * &moving.inverse_mass);
            moving.update_rough();
        }
        self.collisions += 1;
    }

    /// Re-predicts the impacts of two boxes whose motion has changed, and of the boxes whose next impact
    /// was with one of them.
    fn repredict(&mut self, pair: [usize; 2]) -> Result<(), Unsuitable> {
        let all = 0..self.boxes.len();
        let is_invalid = |impact: &Option<Impact>| {
            impact.as_ref().is_some_and(|impact| pair.iter().any(|index| impact.pair.contains(index)))
        };
        let mut affected: Vec<usize> = all.clone().filter(|&index| is_invalid(&self.next[index])).collect();
        affected.extend(pair);
        affected.sort_unstable();
        affected.dedup();
        affected.iter().for_each(|&index| self.next[index] = None);
        affected.into_iter().try_for_each(|index| self.predict(index, all.clone()))
    }

    /// Predicts the impacts of a box with `others` and updates the next impact of both boxes of each pair.
    fn predict(&mut self, index: usize, others: std::ops::Range<usize>) -> Result<(), Unsuitable> {
        for other in others {
            let pair = if index < other { [index, other] } else { [other, index] };
            let infinite = pair.iter().all(|&index| self.boxes[index].body.is_infinite());
            if index == other || infinite || !self.may_collide(pair) {
                continue;
            }
            self.pair_checks += 1;
            let Some(impact) = self.first_impact(pair)? else { continue };
            for index in pair {
                let earlier = |next: &Impact| (&impact.time, impact.pair) < (&next.time, next.pair);
                if self.next[index].as_ref().is_none_or(earlier) {
                    self.next[index] = Some(impact.clone());
                }
            }
        }
        if self.pair_checks > MAX_PAIR_CHECKS { Err(Unsuitable::TooManyCollisions) } else { Ok(()) }
    }

    /// Returns true if two boxes may collide before the end. A conservative test in double precision, which
    /// saves predictions with 77 decimals.
    fn may_collide(&self, pair: [usize; 2]) -> bool {
        let now = self.now.to_f64();
        let left = self.until - now;
        let [a, b] = pair.map(|index| &self.boxes[index]);
        [0, 1].into_iter().all(|axis| {
            let [(here, v_a), (there, v_b)] = [a, b].map(|moving| moving.rough[axis].at(now));
            let size = if here < there { &a.body.rect } else { &b.body.rect };
            let size = if axis == 0 { size.width() } else { size.height() };
            let acceleration = (a.rough[axis].acceleration - b.rough[axis].acceleration).abs();
            let distance = left * ((v_b - v_a).abs() + 0.5 * acceleration * left);
            let margin = 1e-6 * (1.0 + here.abs() + there.abs() + distance);
            (there - here).abs() - size <= distance + margin
        })
    }

    /// Returns the next impact of two boxes: the first time at which faces touch while approaching.
    fn first_impact(&self, pair: [usize; 2]) -> Result<Option<Impact>, Unsuitable> {
        let [a, b] = pair.map(|index| &self.boxes[index]);
        let relative = [0, 1].map(|axis| a.motion_of(b, axis, &self.now));
        refuse_resting(a, b, &relative)?;
        let mut first: Option<Impact> = None;
        for axis in [0, 1] {
            let other = &relative[1 - axis];
            for (face, ahead) in [(a.size[axis].clone(), true), (-&b.size[axis], false)] {
                for t in relative[axis].times_at(&face) {
                    let closing = relative[axis].velocity_after(&t);
                    let approaching = if ahead { closing < Fixed256::zero() } else { closing > Fixed256::zero() };
                    let beside = other.position_after(&t);
                    let facing = -&b.size[1 - axis] < beside && beside < a.size[1 - axis];
                    if t >= Fixed256::from(-TOLERANCE) && approaching && facing {
                        let time = &self.now + &(if t < Fixed256::zero() { Fixed256::zero() } else { t });
                        if first.as_ref().is_none_or(|first| time < first.time) {
                            first = Some(Impact { time, pair, axis });
                        }
                    }
                }
            }
        }
        Ok(first)
    }
}

impl MovingBox {
    fn new(body: &Body, gravity: [f64; 2]) -> MovingBox {
        let force = [body.constant_force.x, body.constant_force.y];
        let (inverse_mass, acceleration) = if body.is_infinite() {
            (Fixed256::zero(), [Fixed256::zero(), Fixed256::zero()])
        } else {
            let inverse_mass = &Fixed256::from(1.0) / &Fixed256::stated(body.mass);
            let pushed = force.map(|force| &Fixed256::stated(force) * &inverse_mass);
            let acceleration = [0, 1].map(|axis| &Fixed256::stated(gravity[axis]) + &pushed[axis]);
            (inverse_mass, acceleration)
        };
        let mut moving = MovingBox {
            at: [body.rect.origin.x, body.rect.origin.y].map(Fixed256::stated),
            velocity: [body.velocity.x, body.velocity.y].map(Fixed256::stated),
            acceleration,
            size: [body.rect.width(), body.rect.height()].map(Fixed256::stated),
            inverse_mass,
            since: Fixed256::zero(),
            body: body.clone(),
            rough: [RoughTrajectory { position: 0.0, velocity: 0.0, acceleration: 0.0, since: 0.0 }; 2],
        };
        moving.update_rough();
        moving
    }

    fn update_rough(&mut self) {
        self.rough = [0, 1].map(|axis| RoughTrajectory {
            position: self.at[axis].to_f64(),
            velocity: self.velocity[axis].to_f64(),
            acceleration: self.acceleration[axis].to_f64(),
            since: self.since.to_f64(),
        });
    }

    /// Position and velocity along an axis.
    fn state(&self, axis: usize, time: &Fixed256) -> (Fixed256, Fixed256) {
        let t = time - &self.since;
        let gained = &self.acceleration[axis] * &t;
        let mean = &self.velocity[axis] + &(&gained * &Fixed256::from(0.5));
        (&self.at[axis] + &(&mean * &t), &self.velocity[axis] + &gained)
    }

    fn advance(&mut self, time: &Fixed256) {
        for axis in [0, 1] {
            (self.at[axis], self.velocity[axis]) = self.state(axis, time);
        }
        self.since = time.clone();
    }

    /// Motion of `other` relative to this box.
    fn motion_of(&self, other: &MovingBox, axis: usize, time: &Fixed256) -> RelativeMotion {
        let ((x_a, v_a), (x_b, v_b)) = (self.state(axis, time), other.state(axis, time));
        let acceleration = &other.acceleration[axis] - &self.acceleration[axis];
        let half_acceleration = &acceleration * &Fixed256::from(0.5);
        RelativeMotion { position: &x_b - &x_a, velocity: &v_b - &v_a, half_acceleration }
    }
}

impl RelativeMotion {
    fn position_after(&self, t: &Fixed256) -> Fixed256 {
        &(&self.position + &(&self.velocity * t)) + &(&self.half_acceleration * &(t * t))
    }

    fn velocity_after(&self, t: &Fixed256) -> Fixed256 {
        &self.velocity + &(&(&self.half_acceleration * t) + &(&self.half_acceleration * t))
    }

    /// Returns the times (s) at which the position is `face`, computed without cancellation.
    fn times_at(&self, face: &Fixed256) -> Vec<Fixed256> {
        let RelativeMotion { position, velocity, half_acceleration: half } = self;
        let offset = position - face;
        if half.is_zero() {
            return if velocity.is_zero() { Vec::new() } else { vec![&-&offset / velocity] };
        }
        let discriminant = &(velocity * velocity) - &(&(half * &offset) * &Fixed256::from(4.0));
        let Some(root) = discriminant.square_root() else { return Vec::new() };
        let sum = if *velocity < Fixed256::zero() { velocity - &root } else { velocity + &root };
        let q = &sum * &Fixed256::from(-0.5);
        let first = (!half.is_zero()).then(|| &q / half);
        let second = (!q.is_zero()).then(|| &offset / &q);
        first.into_iter().chain(second).collect()
    }
}

/// Returns an error if two boxes overlap, or touch and are pressed together from rest.
fn refuse_resting(a: &MovingBox, b: &MovingBox, relative: &[RelativeMotion; 2]) -> Result<(), Unsuitable> {
    let tiny = Fixed256::from(TOLERANCE);
    let zero = Fixed256::zero();
    // The gap along each axis, and true if b lies ahead of a.
    let gaps = [0, 1].map(|axis| {
        let (ahead, behind) = (&relative[axis].position - &a.size[axis], -&(&relative[axis].position + &b.size[axis]));
        if ahead > behind { (ahead, true) } else { (behind, false) }
    });
    if gaps.iter().all(|(gap, _)| *gap < -&tiny) {
        return Err(Unsuitable::Resting);
    }
    for axis in [0, 1] {
        let (gap, ahead) = &gaps[axis];
        let RelativeMotion { velocity, half_acceleration: half, .. } = &relative[axis];
        let pressed = if *ahead { *half < zero } else { *half > zero };
        if gap.abs() <= tiny && velocity.abs() <= tiny && pressed && gaps[1 - axis].0 < zero {
            return Err(Unsuitable::Resting);
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::super::closed_form::{Bounce, galperin_collisions};
    use super::*;
    use crate::{replay::Run, scene};

    /// Corner, size, mass and velocity.
    type Sketch = ([f64; 2], [f64; 2], f64, [f64; 2]);

    fn world(text: &str, spawns: &[Sketch]) -> World {
        let mut text = format!("[world]\nsize = [9.0, 9.0]\n{text}\n");
        for (at, size, mass, velocity) in spawns {
            text += &format!("[[spawn]]\nat = {at:?}\nsize = {size:?}\nmass = {mass:?}\nvelocity = {velocity:?}\n");
        }
        let mut run = Run::new(&scene::parse("test.toml", &text).unwrap_or_else(|error| panic!("{error}")));
        run.apply_inputs(Vec::new(), |error| Err(error.into())).unwrap();
        run.engine().world().clone()
    }

    const RUN: &str = "[run]\nrate = 60\nsteps = 1\nsolver = \"handout\"\n";
    const FLOOR: Sketch = ([0.0, 8.0], [9.0, 1.0], f64::INFINITY, [0.0; 2]);

    fn close(a: &Fixed256, b: &Fixed256) -> bool {
        (a - b).abs() < Fixed256::from(1e-60)
    }

    #[test]
    fn a_bounce_agrees_with_the_closed_form() {
        for restitution in [1.0, 0.5, 0.9] {
            let text = format!("gravity = [0.0, 9.81]\n{RUN}[restitution]\ndefault = {restitution:?}");
            let mut simulator =
                PreciseSimulator::new(&world(&text, &[FLOOR, ([1.0, 3.0], [1.0, 1.0], 2.0, [0.0; 2])]), 5.0).unwrap();
            let bounce = Bounce { height: 4.0, gravity: 9.81, restitution };
            for time in [0.5, 1.0, 1.5, 2.0, 2.6].map(Fixed256::from) {
                simulator.advance(&time).unwrap();
                let (fallen, collisions) = bounce.state_at(&time);
                let [[x, y]] = simulator.positions(&time).try_into().unwrap();
                assert!(x == Fixed256::from(1.0) && close(&y, &(&Fixed256::from(3.0) + &fallen)), "e = {restitution}");
                assert_eq!(collisions, Some(simulator.collisions), "e = {restitution}");
            }
        }
    }

    #[test]
    fn galperins_billiard_counts_the_digits_of_pi() {
        for digits in 0..4 {
            let mass = 10.0_f64 * 10.0;
            let mass = (0..digits).fold(1.0, |product, _| product * mass);
            let spawns = [
                ([0.0, 0.0], [1.0, 9.0], f64::INFINITY, [0.0; 2]),
                ([4.0, 8.0], [1.0, 1.0], 1.0, [0.0; 2]),
                ([8.0, 7.0], [2.0, 2.0], mass, [-1.0, 0.0]),
            ];
            let mut simulator = PreciseSimulator::new(&world(RUN, &spawns), 1e6).unwrap();
            simulator.advance(&Fixed256::from(1e6)).unwrap();
            assert_eq!(simulator.collisions, galperin_collisions(digits));
        }
    }

    #[test]
    fn an_impulse_travels_through_a_touching_row() {
        let unit = |x: f64, velocity: f64| ([x, 1.0], [1.0, 1.0], 1.0, [velocity, 0.0]);
        let mut simulator =
            PreciseSimulator::new(&world(RUN, &[unit(0.0, 2.0), unit(2.0, 0.0), unit(3.0, 0.0), unit(4.0, 0.0)]), 2.0)
                .unwrap();
        let time = Fixed256::from(2.0);
        simulator.advance(&time).unwrap();
        let xs: Vec<f64> = simulator.positions(&time).iter().map(|[x, _]| x.to_f64()).collect();
        assert_eq!((xs, simulator.collisions), (vec![1.0, 2.0, 3.0, 7.0], 3));
    }

    #[test]
    fn resting_contacts_are_refused() {
        let gravity = format!("gravity = [0.0, 10.0]\n{RUN}");
        let on_floor = ([1.0, 7.0], [1.0, 1.0], 1.0, [0.0; 2]);
        assert_eq!(PreciseSimulator::new(&world(&gravity, &[FLOOR, on_floor]), 1.0).err(), Some(Unsuitable::Resting));
        assert!(PreciseSimulator::new(&world(RUN, &[FLOOR, on_floor]), 1.0).is_ok(), "nothing presses");
        let inside = ([1.0, 7.5], [1.0, 1.0], 1.0, [0.0; 2]);
        assert_eq!(PreciseSimulator::new(&world(RUN, &[FLOOR, inside]), 1.0).err(), Some(Unsuitable::Resting));
    }

    #[test]
    fn an_infinite_sequence_of_bounces_is_refused() {
        let text = format!("gravity = [0.0, 9.81]\n{RUN}[restitution]\ndefault = 0.5");
        let mut simulator =
            PreciseSimulator::new(&world(&text, &[FLOOR, ([1.0, 3.0], [1.0, 1.0], 2.0, [0.0; 2])]), 5.0).unwrap();
        assert_eq!(simulator.advance(&Fixed256::from(5.0)), Err(Unsuitable::Resting));
    }
}
