use super::{Axis, BodyId, Collision, Engine, Event, Observer, Vector, larger};
use std::collections::BTreeSet;
use std::fmt::{self, Display, Formatter};

/// Positions are called accurate if they differ by at most this fraction of the largest side of a finite body.
pub const ACCURACY: f64 = 1e-10;

/// The distances, as fractions of the largest side of a finite body, for each of which the first step beyond it is
/// recorded.
const LEVELS: [f64; 10] = [1e-28, 1e-26, 1e-24, 1e-22, 1e-20, 1e-18, 1e-16, 1e-14, 1e-12, ACCURACY];

/// The factor by which one copy of a probe resolves positions more finely, and the other one more coarsely: large, so
/// that a result that depends on the resolution differs.
const RESOLUTION_FACTOR: f64 = 64.0;

/// Impacts up to this fraction of the greatest approach speed are too slow to count in a sequence of collisions.
const SLOW: f64 = 1e-6;

/// Likewise those up to this fraction of √(acceleration × largest side), about the speed gained in falling that far.
const SLOW_IN_FREE_FALL: f64 = 1.0 / (1_u64 << 20) as f64;

/// Impacts up to this fraction of a step apart belong to one instant: far more than rounding moves them.
const SAME_INSTANT: f64 = 1e-8;

/// The part of a run in which rounding cannot have moved a position noticeably or changed the order of collisions.
///
/// It is an estimate, not a bound: the runs that are compared may err alike.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Accuracy {
    /// The last step at which all positions are accurate to 1e-10 of the largest side of a finite body;
    /// `None` if they are throughout the run.
    pub until: Option<u64>,
}

/// Formats as `1e-10 throughout` or `1e-10 until step 64`.
impl Display for Accuracy {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        match self.until {
            None => write!(f, "{ACCURACY:e} throughout"),
            Some(step) => write!(f, "{ACCURACY:e} until step {step}"),
        }
    }
}

/// Estimates the accuracy of a run of the event-driven solver while it goes on.
///
/// Two copies of the engine make the same run, but move the last digit of each rounded result at random, and resolve
/// positions more finely and more coarsely. As long as all three agree, neither rounding nor resolution matters (random
/// rounding, J. Vignes 1993; three runs as in the library CADNA).
#[derive(Clone, Debug)]
pub struct AccuracyProbe {
    copies: [Engine; 2],
    /// The collisions so far in the engine and in the copies.
    collisions: [CollisionSequence; 3],
    accuracy: Accuracy,
    /// The largest side of a finite body so far, m.
    extent: f64,
    /// The greatest acceleration by gravity and a force along an axis so far, m/s².
    acceleration: f64,
    /// The first step at which the distance exceeds each of [`LEVELS`].
    first_beyond: [Option<u64>; LEVELS.len()],
}

impl AccuracyProbe {
    /// Starts with an engine that has no bodies yet; `None` with the handout solver, whose accuracy depends on the
    /// step.
    pub fn new(engine: &Engine) -> Option<AccuracyProbe> {
        let copies = [engine.perturbed(1, 1.0 / RESOLUTION_FACTOR)?, engine.perturbed(2, RESOLUTION_FACTOR)?];
        let instant = SAME_INSTANT * engine.period();
        Some(AccuracyProbe {
            copies,
            collisions: std::array::from_fn(|_| CollisionSequence { instant, ..CollisionSequence::default() }),
            accuracy: Accuracy::default(),
            extent: 0.0,
            acceleration: 0.0,
            first_beyond: [None; LEVELS.len()],
        })
    }

    /// Applies an event, as it was applied to the engine.
    pub fn apply(&mut self, event: &Event) {
        if let Event::Spawn(spawn) = event
            && spawn.mass.is_finite()
        {
            self.extent = larger(self.extent, larger(spawn.rect.width(), spawn.rect.height()));
            let gravity = self.copies[0].world().gravity.unwrap_or(Vector::ZERO);
            for (gravity, force) in [(gravity.x, spawn.force.x), (gravity.y, spawn.force.y)] {
                self.acceleration = larger(self.acceleration, (gravity + force / spawn.mass).abs());
            }
            let slow = SLOW_IN_FREE_FALL * self.acceleration.sqrt() * self.extent.sqrt();
            self.collisions.iter_mut().for_each(|sequence| sequence.slow = slow);
        }
        if self.accuracy.until.is_none() {
            self.copies.iter_mut().for_each(|copy| copy.apply(event));
        }
    }

    /// Makes the step that `engine` has made, and compares. The probe has observed the collisions of the engine.
    pub fn follow(&mut self, engine: &Engine) {
        if self.accuracy.until.is_some() {
            return;
        }
        let before = self.copies[0].current_step();
        let [collisions, copied @ ..] = &mut self.collisions;
        for (copy, sequence) in self.copies.iter_mut().zip(copied.iter_mut()) {
            // After an error the copy stays a step behind: unless the engine failed too, they differ.
            let _ = copy.step(sequence);
        }
        let distance = self.copies.iter().map(|copy| engine.distance_to(copy)).fold(0.0, larger);
        let step = engine.current_step();
        for (level, first) in LEVELS.into_iter().zip(&mut self.first_beyond) {
            if first.is_none() && distance > level * self.extent {
                *first = Some(step);
            }
        }
        let have_same_collisions = copied.iter().all(|sequence| sequence.is_same(collisions));
        let is_accurate = distance <= ACCURACY * self.extent;
        if !is_accurate || !have_same_collisions {
            self.accuracy.until = Some(before);
        }
    }

    /// The accuracy so far.
    pub fn accuracy(&self) -> Accuracy {
        self.accuracy
    }

    /// The growth of the rounding error: pairs of a distance, as a fraction of the largest side of a finite body, and
    /// the first step at which it is exceeded.
    pub fn growth(&self) -> impl Iterator<Item = (f64, u64)> + '_ {
        LEVELS.into_iter().zip(self.first_beyond).filter_map(|(level, step)| Some((level, step?)))
    }
}

/// Observes the collisions of the engine that the probe follows.
impl Observer for AccuracyProbe {
    fn collision(&mut self, collision: &Collision) {
        self.collisions[0].collision(collision);
    }
}

/// The sequence of the collisions of a run, as far as it is the same for any small error.
///
/// The resolution of positions and rounding decide how many impacts of an infinite sequence are carried out before its
/// limit is taken, and that is no error: the limit is the same. So impacts that are too slow do not count, and of the
/// impacts of an instant each pair counts once.
#[derive(Clone, Debug, Default)]
struct CollisionSequence {
    count: u64,
    digest: u64,
    /// The greatest normal velocity so far, m/s.
    greatest: f64,
    /// Slower impacts do not count, m/s.
    slow: f64,
    /// Impacts up to this long after the first one of an instant belong to it, s.
    instant: f64,
    /// The seconds since step 0 of the first impact of the present instant.
    first: f64,
    /// The pairs and axes of the impacts of the present instant.
    pairs: BTreeSet<([BodyId; 2], Axis)>,
}

impl CollisionSequence {
    /// True if the same pairs collided in the same order.
    fn is_same(&self, other: &CollisionSequence) -> bool {
        (self.count, self.digest) == (other.count, other.digest)
    }
}

impl Observer for CollisionSequence {
    fn collision(&mut self, collision: &Collision) {
        let speed = collision.normal_velocity[0].abs();
        self.greatest = larger(self.greatest, speed);
        if speed <= larger(SLOW * self.greatest, self.slow) {
            return;
        }
        if collision.instant - self.first > self.instant {
            self.first = collision.instant;
            self.pairs.clear();
        }
        if !self.pairs.insert((collision.bodies, collision.axis)) {
            return;
        }
        self.count += 1;
        let [first, second] = collision.bodies.map(|id: BodyId| u64::from(id));
        for number in [first, second, collision.axis as u64] {
            self.digest = (self.digest ^ number).wrapping_mul(0x0000_0100_0000_01b3).rotate_left(29);
        }
    }
}
