//! The world within a step, from the collisions in it alone.

use crate::physics::{Body, Collision, Engine, Observer, Vector, World, larger};

/// The collisions of a step.
pub struct StepCollisions {
    /// The step.
    pub step: u64,
    /// The seconds of a column.
    pub column: f64,
    /// The first instant of a collision in each column, s after the start of the step.
    pub offsets: Vec<f64>,
    /// All collisions, in order; `None` if there are more than [`MAX_CHANGES`].
    pub changes: Option<Vec<Collision>>,
}

/// The largest number of collisions of a step that are kept, 24 MB.
const MAX_CHANGES: usize = 100_000;

impl Observer for StepCollisions {
    fn collision(&mut self, collision: &Collision) {
        if collision.step != self.step || collision.impulse == 0.0 {
            return;
        }
        if self.offsets.last().is_none_or(|last| collision.time - last >= self.column) {
            self.offsets.push(collision.time);
        }
        match &mut self.changes {
            Some(changes) if changes.len() < MAX_CHANGES => changes.push(collision.clone()),
            _ => self.changes = None,
        }
    }
}

/// The world within a step, moved on from its start by the collisions of two bodies each. Bodies move uniformly
/// accelerated in between.
pub struct MovingWorld {
    world: World,
    /// The instant of the position and velocity of each body, s after the start of the step.
    since: Vec<f64>,
    /// The acceleration of each body, m/s².
    accelerations: Vec<Vector>,
}

impl MovingWorld {
    /// The world at the start of a step, if its collisions explain the state at the end: no body rests on another or is
    /// pushed together with one, and all collisions are known.
    pub fn through(engine: &Engine, collisions: &StepCollisions, end: &World, duration: f64) -> Option<MovingWorld> {
        let start = engine.world();
        let changes = collisions.changes.as_ref()?;
        let new = || MovingWorld::new(start);
        let mut moved = new();
        changes.iter().for_each(|change| moved.apply(change));
        let moved = moved.at(duration);
        let size = |value: Vector| larger(value.x.abs(), value.y.abs());
        let reach = end.bodies.iter().map(|body| size(body.rect.far_corner())).fold(0.0, larger);
        let speed = end.bodies.iter().map(|body| size(body.velocity)).fold(0.0, larger);
        let is_near = |a: Vector, b: Vector, scale: f64| size(a.sub(b)) <= 1e-9 * scale;
        let is_explained = moved.bodies.len() == end.bodies.len()
            && moved.bodies.iter().zip(&end.bodies).all(|(a, b)| {
                a.id == b.id
                    && is_near(a.rect.origin, b.rect.origin, reach + speed * duration)
                    && is_near(a.velocity, b.velocity, speed)
            });
        is_explained.then(new)
    }

    /// The world at the start of a step.
    pub fn new(start: &World) -> MovingWorld {
        let world = World {
            // Names are not needed, and would have to be copied.
            bodies: start.bodies.iter().map(|body| Body { name: String::new(), ..body.clone() }).collect(),
            gravity: start.gravity,
            restitution: start.restitution.clone(),
        };
        let gravity = start.gravity.unwrap_or(Vector::ZERO);
        let acceleration = |body: &Body| {
            if body.mass.is_finite() { gravity.add(body.constant_force.mult(1.0 / body.mass)) } else { Vector::ZERO }
        };
        MovingWorld {
            since: vec![0.0; world.bodies.len()],
            accelerations: world.bodies.iter().map(acceleration).collect(),
            world,
        }
    }

    /// Moves a body to an instant of the step.
    fn advance(&mut self, at: usize, time: f64) {
        let (body, elapsed) = (&mut self.world.bodies[at], time - self.since[at]);
        let change = self.accelerations[at].mult(elapsed);
        let mean = body.velocity.add(change.mult(0.5));
        body.rect.origin = body.rect.origin.add(mean.mult(elapsed));
        body.velocity = body.velocity.add(change);
        self.since[at] = time;
    }

    /// Moves the two bodies of a collision to its instant, and gives them the velocities after it.
    pub fn apply(&mut self, change: &Collision) {
        for (id, velocity) in change.bodies.iter().zip(change.after) {
            if let Ok(at) = self.world.bodies.binary_search_by_key(id, |body| body.id) {
                self.advance(at, change.time);
                self.world.bodies[at].velocity = velocity;
            }
        }
    }

    /// The world at an instant of the step that is not before the last collision.
    pub fn at(&mut self, time: f64) -> &World {
        (0..self.world.bodies.len()).for_each(|at| self.advance(at, time));
        &self.world
    }
}

/// The world at the beginning of a step of the handout's solver, from `start` to `end`, after its impulses: the
/// velocities are those at the end, without the change that forces have caused since.
pub fn after_impulses(start: &World, end: &World, duration: f64) -> World {
    let mut world = MovingWorld::new(start);
    for (at, body) in world.world.bodies.iter_mut().enumerate() {
        if let Ok(after) = end.bodies.binary_search_by_key(&body.id, |body| body.id) {
            body.velocity = end.bodies[after].velocity.sub(world.accelerations[at].mult(duration));
        }
    }
    world.world
}
