use super::Number;
use crate::physics::{Body, Restitution, World};

/// Why there is no reference for a scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum Unsuitable {
    /// The reference knows impacts, not contacts.
    #[error("boxes rest on each other or overlap")]
    Resting,
    /// It would take hours.
    #[error("too many collisions for 77 decimals")]
    TooMany,
}

/// Boxes on exact parabolas that collide one pair at a time, all pairs watched, to 77 decimals.
///
/// It knows nothing of steps, of contacts at rest or of rounding. Of simultaneous impacts the
/// pair lowest in creation order goes first, then again the lowest.
pub struct Reference {
    points: Vec<Point>,
    /// For each, when and with whom it meets next.
    next: Vec<Option<Meeting>>,
    restitution: Restitution,
    now: Number,
    /// Nobody asks what is later than that, s.
    until: f64,
    looks: u64,
    /// Impulses exchanged so far.
    pub collisions: u64,
}

/// More looks at pairs than that take minutes.
const MOST_LOOKS: u64 = 20_000_000;

/// Times this close are the same instant, s, and speeds this low are none, m/s: far below all
/// that can be seen, and far enough above rounding that their squares are still known.
const SAME: f64 = 1e-30;

/// A box and its parabola.
struct Point {
    body: Body,
    at: [Number; 2],
    velocity: [Number; 2],
    acceleration: [Number; 2],
    size: [Number; 2],
    inverse_mass: Number,
    since: Number,
    rough: [Rough; 2],
}

/// A motion along one axis to sixteen digits.
#[derive(Clone, Copy, Debug)]
struct Rough {
    position: f64,
    velocity: f64,
    acceleration: f64,
    since: f64,
}

impl Rough {
    /// Position and velocity.
    fn at(&self, time: f64) -> (f64, f64) {
        let t = time - self.since;
        (self.position + t * (self.velocity + 0.5 * self.acceleration * t), self.velocity + self.acceleration * t)
    }
}

#[derive(Clone, Debug, PartialEq)]
struct Meeting {
    time: Number,
    pair: [usize; 2],
    axis: usize,
}

/// How b moves as seen from a: position, velocity, half the acceleration.
struct Relative {
    position: Number,
    velocity: Number,
    half: Number,
}

impl Reference {
    /// The boxes of a world at time 0, for so many seconds.
    ///
    /// # Errors
    /// When boxes overlap or rest on each other.
    pub fn new(world: &World, until: f64) -> Result<Reference, Unsuitable> {
        let gravity = world.gravity.map_or([0.0; 2], |gravity| [gravity.x, gravity.y]);
        let points: Vec<Point> = world.bodies.iter().map(|body| Point::new(body, gravity)).collect();
        let next = vec![None; points.len()];
        let restitution = world.restitution.clone();
        let mut reference =
            Reference { points, next, restitution, now: Number::zero(), until, looks: 0, collisions: 0 };
        for place in 0..reference.points.len() {
            reference.foresee(place, 0..place)?;
        }
        Ok(reference)
    }

    /// Goes on to a later time, s.
    ///
    /// # Errors
    /// When boxes come to rest on each other, or too much happens.
    pub fn advance(&mut self, time: &Number) -> Result<(), Unsuitable> {
        loop {
            let due = self.next.iter().flatten().filter(|meeting| meeting.time <= *time);
            let first = due.min_by(|a, b| (&a.time, a.pair).cmp(&(&b.time, b.pair)));
            let Some(Meeting { time, pair, axis }) = first.cloned() else { return Ok(()) };
            self.now = time;
            self.collide(pair, axis);
            self.look_again(pair)?;
        }
    }

    /// Where the bodies of finite mass are at a time that has been reached, in creation order, m.
    pub fn places(&self, time: &Number) -> Vec<[Number; 2]> {
        let finite = self.points.iter().filter(|point| !point.body.is_infinite());
        finite.map(|point| [0, 1].map(|axis| point.state(axis, time).0)).collect()
    }

    fn collide(&mut self, pair: [usize; 2], axis: usize) {
        let now = self.now.clone();
        let [a, b] = pair.map(|place| &self.points[place]);
        let e = Number::from(self.restitution.between(a.body.material, b.body.material));
        let approach = &b.state(axis, &now).1 - &a.state(axis, &now).1;
        let impulse = &(&(&e + &Number::from(1.0)) * &approach) / &(&a.inverse_mass + &b.inverse_mass);
        for (place, impulse) in pair.into_iter().zip([impulse.clone(), -&impulse]) {
            let point = &mut self.points[place];
            point.advance(&now);
            point.velocity[axis] = &point.velocity[axis] + &(&impulse * &point.inverse_mass);
            point.take_rough();
        }
        self.collisions += 1;
    }

    /// Foresees anew for two whose motion has changed, and for whoever was to meet them.
    fn look_again(&mut self, pair: [usize; 2]) -> Result<(), Unsuitable> {
        let everyone = 0..self.points.len();
        let concerned = |meeting: &Option<Meeting>| {
            meeting.as_ref().is_some_and(|meeting| pair.iter().any(|place| meeting.pair.contains(place)))
        };
        let mut waiting: Vec<usize> = everyone.clone().filter(|&place| concerned(&self.next[place])).collect();
        waiting.extend(pair);
        waiting.sort_unstable();
        waiting.dedup();
        waiting.iter().for_each(|&place| self.next[place] = None);
        waiting.into_iter().try_for_each(|place| self.foresee(place, everyone.clone()))
    }

    /// Finds whom one of them meets first, and tells those who had a later meeting in view.
    fn foresee(&mut self, place: usize, others: std::ops::Range<usize>) -> Result<(), Unsuitable> {
        for other in others {
            let pair = if place < other { [place, other] } else { [other, place] };
            let infinite = pair.iter().all(|&place| self.points[place].body.is_infinite());
            if place == other || infinite || !self.are_near(pair) {
                continue;
            }
            self.looks += 1;
            let Some(meeting) = self.meeting(pair)? else { continue };
            for place in pair {
                let earlier = |next: &Meeting| (&meeting.time, meeting.pair) < (&next.time, next.pair);
                if self.next[place].as_ref().is_none_or(earlier) {
                    self.next[place] = Some(meeting.clone());
                }
            }
        }
        if self.looks > MOST_LOOKS { Err(Unsuitable::TooMany) } else { Ok(()) }
    }

    /// Whether two could meet in the time there is: generously, and with doubles, so that
    /// 77 decimals are kept for those who may.
    fn are_near(&self, pair: [usize; 2]) -> bool {
        let now = self.now.to_f64();
        let left = self.until - now;
        let [a, b] = pair.map(|place| &self.points[place]);
        [0, 1].into_iter().all(|axis| {
            let [(here, slow), (there, fast)] = [a, b].map(|point| point.rough[axis].at(now));
            let size = if here < there { &a.body.rect } else { &b.body.rect };
            let size = if axis == 0 { size.width() } else { size.height() };
            let acceleration = (a.rough[axis].acceleration - b.rough[axis].acceleration).abs();
            let way = left * ((fast - slow).abs() + 0.5 * acceleration * left);
            let doubt = 1e-6 * (1.0 + here.abs() + there.abs() + way);
            (there - here).abs() - size <= way + doubt
        })
    }

    /// When two next touch on a face while approaching.
    fn meeting(&self, pair: [usize; 2]) -> Result<Option<Meeting>, Unsuitable> {
        let [a, b] = pair.map(|place| &self.points[place]);
        let relative = [0, 1].map(|axis| a.sees(b, axis, &self.now));
        refuse_resting(a, b, &relative)?;
        let mut first: Option<Meeting> = None;
        for axis in [0, 1] {
            let other = &relative[1 - axis];
            for (face, ahead) in [(a.size[axis].clone(), true), (-&b.size[axis], false)] {
                for t in relative[axis].reaches(&face) {
                    let closing = relative[axis].velocity_after(&t);
                    let approaching = if ahead { closing < Number::zero() } else { closing > Number::zero() };
                    let beside = other.position_after(&t);
                    let facing = -&b.size[1 - axis] < beside && beside < a.size[1 - axis];
                    if t >= Number::from(-SAME) && approaching && facing {
                        let time = &self.now + &(if t < Number::zero() { Number::zero() } else { t });
                        if first.as_ref().is_none_or(|first| time < first.time) {
                            first = Some(Meeting { time, pair, axis });
                        }
                    }
                }
            }
        }
        Ok(first)
    }
}

impl Point {
    fn new(body: &Body, gravity: [f64; 2]) -> Point {
        let force = [body.constant_force.x, body.constant_force.y];
        let inverse_mass = match body.is_infinite() {
            true => Number::zero(),
            false => &Number::from(1.0) / &Number::from(body.mass),
        };
        let acceleration = |axis: usize| match body.is_infinite() {
            true => Number::zero(),
            false => &Number::from(gravity[axis]) + &(&Number::from(force[axis]) * &inverse_mass),
        };
        let mut point = Point {
            at: [body.rect.origin.x, body.rect.origin.y].map(Number::from),
            velocity: [body.velocity.x, body.velocity.y].map(Number::from),
            acceleration: [0, 1].map(acceleration),
            size: [body.rect.width(), body.rect.height()].map(Number::from),
            inverse_mass,
            since: Number::zero(),
            body: body.clone(),
            rough: [Rough { position: 0.0, velocity: 0.0, acceleration: 0.0, since: 0.0 }; 2],
        };
        point.take_rough();
        point
    }

    fn take_rough(&mut self) {
        self.rough = [0, 1].map(|axis| Rough {
            position: self.at[axis].to_f64(),
            velocity: self.velocity[axis].to_f64(),
            acceleration: self.acceleration[axis].to_f64(),
            since: self.since.to_f64(),
        });
    }

    /// Position and velocity along an axis.
    fn state(&self, axis: usize, time: &Number) -> (Number, Number) {
        let t = time - &self.since;
        let gained = &self.acceleration[axis] * &t;
        let mean = &self.velocity[axis] + &(&gained * &Number::from(0.5));
        (&self.at[axis] + &(&mean * &t), &self.velocity[axis] + &gained)
    }

    fn advance(&mut self, time: &Number) {
        for axis in [0, 1] {
            (self.at[axis], self.velocity[axis]) = self.state(axis, time);
        }
        self.since = time.clone();
    }

    fn sees(&self, other: &Point, axis: usize, time: &Number) -> Relative {
        let ((here, slow), (there, fast)) = (self.state(axis, time), other.state(axis, time));
        let acceleration = &other.acceleration[axis] - &self.acceleration[axis];
        Relative { position: &there - &here, velocity: &fast - &slow, half: &acceleration * &Number::from(0.5) }
    }
}

impl Relative {
    fn position_after(&self, t: &Number) -> Number {
        &(&self.position + &(&self.velocity * t)) + &(&self.half * &(t * t))
    }

    fn velocity_after(&self, t: &Number) -> Number {
        &self.velocity + &(&(&self.half * t) + &(&self.half * t))
    }

    /// The times, s, at which the position is `face`, found without cancellation.
    fn reaches(&self, face: &Number) -> Vec<Number> {
        let Relative { position, velocity, half } = self;
        let way = position - face;
        if half.is_zero() {
            return if velocity.is_zero() { Vec::new() } else { vec![&-&way / velocity] };
        }
        let discriminant = &(velocity * velocity) - &(&(half * &way) * &Number::from(4.0));
        let Some(root) = discriminant.square_root() else { return Vec::new() };
        let sum = if *velocity < Number::zero() { velocity - &root } else { velocity + &root };
        let q = &sum * &Number::from(-0.5);
        let first = (!half.is_zero()).then(|| &q / half);
        let second = (!q.is_zero()).then(|| &way / &q);
        first.into_iter().chain(second).collect()
    }
}

/// Two that overlap, or touch and are pressed together from rest, do not meet: they rest.
fn refuse_resting(a: &Point, b: &Point, relative: &[Relative; 2]) -> Result<(), Unsuitable> {
    let tiny = Number::from(SAME);
    let zero = Number::zero();
    // How far they are apart along each axis, and which way closes the gap.
    let gaps = [0, 1].map(|axis| {
        let (ahead, behind) = (&relative[axis].position - &a.size[axis], -&(&relative[axis].position + &b.size[axis]));
        if ahead > behind { (ahead, true) } else { (behind, false) }
    });
    if gaps.iter().all(|(gap, _)| *gap < -&tiny) {
        return Err(Unsuitable::Resting);
    }
    for axis in [0, 1] {
        let (gap, ahead) = &gaps[axis];
        let Relative { velocity, half, .. } = &relative[axis];
        let pressed = if *ahead { *half < zero } else { *half > zero };
        if gap.abs() <= tiny && velocity.abs() <= tiny && pressed && gaps[1 - axis].0 < zero {
            return Err(Unsuitable::Resting);
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::super::closed_form::{Bounce, galperin};
    use super::*;
    use crate::{run::Run, scene};

    /// Corner, size, mass and velocity.
    type Sketch = ([f64; 2], [f64; 2], f64, [f64; 2]);

    fn world(text: &str, spawns: &[Sketch]) -> World {
        let mut text = format!("[world]\nsize = [9.0, 9.0]\n{text}\n");
        for (at, size, mass, velocity) in spawns {
            text += &format!("[[spawn]]\nat = {at:?}\nsize = {size:?}\nmass = {mass:?}\nvelocity = {velocity:?}\n");
        }
        let mut run = Run::new(&scene::parse("test.toml", &text).unwrap_or_else(|error| panic!("{error}")));
        run.happen(Vec::new(), |error| Err(error.into())).unwrap();
        run.engine().world().clone()
    }

    const RUN: &str = "[run]\nrate = 60\nsteps = 1\nsolver = \"handout\"\n";
    const FLOOR: Sketch = ([0.0, 8.0], [9.0, 1.0], f64::INFINITY, [0.0; 2]);

    fn close(a: &Number, b: &Number) -> bool {
        (a - b).abs() < Number::from(1e-60)
    }

    #[test]
    fn bounces_as_the_closed_form_does() {
        for restitution in [1.0, 0.5, 0.9] {
            let text = format!("gravity = [0.0, 9.81]\n{RUN}[restitution]\ndefault = {restitution:?}");
            let mut reference =
                Reference::new(&world(&text, &[FLOOR, ([1.0, 3.0], [1.0, 1.0], 2.0, [0.0; 2])]), 5.0).unwrap();
            let bounce = Bounce { height: 4.0, gravity: 9.81, restitution };
            for time in [0.5, 1.0, 1.5, 2.0, 2.6].map(Number::from) {
                reference.advance(&time).unwrap();
                let (fallen, collisions) = bounce.at(&time);
                let [[x, y]] = reference.places(&time).try_into().unwrap();
                assert!(x == Number::from(1.0) && close(&y, &(&Number::from(3.0) + &fallen)), "e = {restitution}");
                assert_eq!(collisions, Some(reference.collisions), "e = {restitution}");
            }
        }
    }

    #[test]
    fn counts_pi() {
        for digits in 0..4 {
            let mass = 10.0_f64 * 10.0;
            let mass = (0..digits).fold(1.0, |product, _| product * mass);
            let spawns = [
                ([0.0, 0.0], [1.0, 9.0], f64::INFINITY, [0.0; 2]),
                ([4.0, 8.0], [1.0, 1.0], 1.0, [0.0; 2]),
                ([8.0, 7.0], [2.0, 2.0], mass, [-1.0, 0.0]),
            ];
            let mut reference = Reference::new(&world(RUN, &spawns), 1e6).unwrap();
            reference.advance(&Number::from(1e6)).unwrap();
            assert_eq!(reference.collisions, galperin(digits));
        }
    }

    #[test]
    fn a_touching_row_hands_the_blow_on() {
        let unit = |x: f64, velocity: f64| ([x, 1.0], [1.0, 1.0], 1.0, [velocity, 0.0]);
        let mut reference =
            Reference::new(&world(RUN, &[unit(0.0, 2.0), unit(2.0, 0.0), unit(3.0, 0.0), unit(4.0, 0.0)]), 2.0)
                .unwrap();
        let time = Number::from(2.0);
        reference.advance(&time).unwrap();
        let xs: Vec<f64> = reference.places(&time).iter().map(|[x, _]| x.to_f64()).collect();
        assert_eq!((xs, reference.collisions), (vec![1.0, 2.0, 3.0, 7.0], 3));
    }

    #[test]
    fn contacts_at_rest_are_refused() {
        let gravity = format!("gravity = [0.0, 10.0]\n{RUN}");
        let on_floor = ([1.0, 7.0], [1.0, 1.0], 1.0, [0.0; 2]);
        assert_eq!(Reference::new(&world(&gravity, &[FLOOR, on_floor]), 1.0).err(), Some(Unsuitable::Resting));
        assert!(Reference::new(&world(RUN, &[FLOOR, on_floor]), 1.0).is_ok(), "nothing presses");
        let inside = ([1.0, 7.5], [1.0, 1.0], 1.0, [0.0; 2]);
        assert_eq!(Reference::new(&world(RUN, &[FLOOR, inside]), 1.0).err(), Some(Unsuitable::Resting));
    }

    #[test]
    fn ends_of_endless_bouncing_are_refused() {
        let text = format!("gravity = [0.0, 9.81]\n{RUN}[restitution]\ndefault = 0.5");
        let mut reference =
            Reference::new(&world(&text, &[FLOOR, ([1.0, 3.0], [1.0, 1.0], 2.0, [0.0; 2])]), 5.0).unwrap();
        assert_eq!(reference.advance(&Number::from(5.0)), Err(Unsuitable::Resting));
    }
}
