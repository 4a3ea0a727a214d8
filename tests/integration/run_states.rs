//! Small runs of both solvers, as the figures take them.

use rebond::internals::physics::{
    Body, Collision, Engine, EngineConfig, Event, Observer, Rect, Restitution, SolverKind, Spawn, Vector, World,
};
use rebond::internals::picture::figures::{
    Axis, CollisionSubject, EnergyRun, EnergySample, FigureRun, LineRun, LineSubject, PressureRun, Range, SpacetimeRun,
    SpeedRun, Velocities, VelocityPath, VelocityRun,
};
use rebond::internals::picture::{Appearance, Color, Frame, Quantity, Sprite, Style};
use std::sync::Arc;

pub const WORLD: Vector = Vector::new(8.0, 4.5);

/// All states and collisions of a run.
pub struct RunStates {
    bodies: Vec<Arc<Appearance>>,
    pub frames: Vec<Frame>,
    energy: Vec<EnergySample>,
    worlds: Vec<World>,
    pub collisions: Vec<Collision>,
}

/// Name, [x, y, width, height] and velocity. The mass is 1 kg, infinite for names that begin with `wall-`.
pub type BodySpec = (&'static str, [f64; 4], [f64; 2]);

fn run(bodies: &[BodySpec], gravity: Option<Vector>, rate: f64, steps: u64) -> RunStates {
    run_with(SolverKind::Handout, bodies, gravity, rate, steps)
}

pub fn run_with(solver: SolverKind, bodies: &[BodySpec], gravity: Option<Vector>, rate: f64, steps: u64) -> RunStates {
    let restitution = Restitution::new(0.8, &[]);
    let config =
        EngineConfig::new(solver, rate).with_gravity(gravity).with_restitution(restitution).with_events_per_step(1000);
    let mut engine = Engine::new(config);
    let mut run = RunStates {
        bodies: Vec::new(),
        frames: Vec::new(),
        energy: Vec::new(),
        worlds: Vec::new(),
        collisions: Vec::new(),
    };
    for spec in bodies {
        engine.apply(&Event::Spawn(spawn(spec)));
        let id = run.bodies.len() as u32;
        run.bodies.push(Arc::new(appearance(id, spec)));
    }
    for _ in 0..=steps {
        run.add_state(&engine, rate);
        engine.step(&mut run.collisions).unwrap();
    }
    run
}

fn spawn((name, [x, y, width, height], [vx, vy]): &BodySpec) -> Spawn {
    let rect = Rect::new(Vector::new(*x, *y), *width, *height);
    Spawn::new(*name, rect, mass(name)).with_velocity(Vector::new(*vx, *vy))
}

fn appearance(id: u32, (name, _, _): &BodySpec) -> Appearance {
    let is_wall = name.starts_with("wall-");
    let (material, force) = (String::new(), Vector::ZERO);
    Appearance { id, name: (*name).into(), material, color: None, image: None, mass: mass(name), force, is_wall }
}

fn mass(name: &str) -> f64 {
    if name.starts_with("wall-") { f64::INFINITY } else { 1.0 }
}

impl RunStates {
    fn add_state(&mut self, engine: &Engine, rate: f64) {
        let (step, world) = (engine.current_step(), engine.world());
        let time = step as f64 / rate;
        let sprite = |body: &rebond::internals::physics::Body| Sprite {
            appearance: self.bodies[body.id as usize].clone(),
            rect: body.rect,
            velocity: body.velocity,
            trail: Vec::new(),
        };
        let sprites = world.bodies.iter().map(sprite).collect();
        self.frames.push(Frame { step, time, sprites, collisions: Vec::new() });
        self.energy.push(EnergySample::of(world, time));
        self.worlds.push(world.clone());
    }

    /// Every `steps`-th frame.
    pub fn every_nth(&self, steps: usize) -> FigureRun {
        FigureRun {
            title: String::new(),
            world: WORLD,
            frames: self.frames.iter().step_by(steps).cloned().collect(),
            missing: Vec::new(),
        }
    }

    pub fn energies(&self) -> EnergyRun {
        let has_potential = self.energy.iter().any(|sample| sample.potential != 0.0);
        let mut run = EnergyRun::new(String::new(), 0.0, has_potential);
        self.energy.iter().for_each(|sample| run.push(sample));
        run
    }

    pub fn spacetime(&self, axis: Axis) -> SpacetimeRun {
        let mut run = SpacetimeRun::new(String::new(), WORLD, axis, 0.0);
        for frame in &self.frames {
            frame.sprites.iter().for_each(|sprite| run.push(frame.time, sprite, &Style::default()));
        }
        run
    }

    /// A quantity of all bodies of finite mass, or of all together.
    pub fn lines(&self, title: &str, quantity: Quantity) -> LineRun {
        let finite = || self.bodies.iter().filter(|body| body.mass.is_finite());
        let subject = match quantity {
            Quantity::Energy | Quantity::Momentum => LineSubject::System,
            _ => LineSubject::Bodies(finite().map(|body| (body.id, body.clone())).collect()),
        };
        let mut run = LineRun::new(title.to_owned(), quantity, subject, WORLD.y, 0.0);
        for (frame, world) in self.frames.iter().zip(&self.worlds) {
            run.push(frame.time, world);
        }
        run
    }

    pub fn speeds(&self, title: &str) -> SpeedRun {
        let mut run = SpeedRun::new(title.to_owned(), 15.0);
        let bodies = self.worlds.iter().flat_map(|world| &world.bodies);
        bodies.filter(|body| body.mass.is_finite()).for_each(|body| run.push(body.velocity.norm(), body.mass));
        run
    }

    /// The path of the first two bodies of finite mass along x.
    pub fn velocity_path(&self, title: &str) -> VelocityRun {
        let finite: Vec<&Body> = self.worlds[0].bodies.iter().filter(|body| body.mass.is_finite()).collect();
        let of_body = |body: &Body| (body.name.clone(), body.id, body.mass, body.velocity);
        let mut path = VelocityPath::new([of_body(finite[0]), of_body(finite[1 % finite.len()])], Axis::X);
        for (step, (frames, world)) in self.frames.windows(2).zip(&self.worlds[1..]).enumerate() {
            let collisions = self.collisions.iter().filter(|collision| collision.step == step as u64);
            collisions.for_each(|collision| path.collision(collision));
            let velocities = world.bodies.iter().map(|body| (body.id, body.velocity));
            path.advance(velocities, frames[1].time - frames[0].time);
        }
        VelocityRun { title: title.to_owned(), velocities: Velocities::Pair(Box::new(path)) }
    }

    pub fn velocity_cloud(&self, title: &str) -> VelocityRun {
        let frame = self.frames.last().unwrap();
        let bodies = frame.sprites.iter().filter(|sprite| !sprite.appearance.is_wall);
        let bodies = bodies.map(|sprite| (sprite.velocity, Color::hex(0x0072b2))).collect();
        VelocityRun { title: title.to_owned(), velocities: Velocities::Cloud { time: frame.time, bodies } }
    }

    /// The pressure on the bodies of infinite mass.
    pub fn pressure(&self, title: &str) -> PressureRun {
        let walls = self.bodies.iter().filter(|body| body.mass == f64::INFINITY);
        let walls = walls.map(|body| (body.id, body.clone())).collect();
        let mut run = PressureRun::new(title.to_owned(), WORLD, self.time(), walls);
        self.collisions.iter().for_each(|collision| run.collision(collision));
        self.frames.iter().zip(&self.worlds).for_each(|(frame, world)| run.push(frame.time, world));
        run
    }

    pub fn time(&self) -> Range {
        Range { from: 0.0, to: self.frames.last().unwrap().time }
    }

    /// The first collision with an impulse, and its bodies.
    pub fn first_collision(&self) -> CollisionSubject {
        let collision = self.collisions.iter().find(|collision| collision.impulse != 0.0).unwrap();
        let bodies = collision.bodies.map(|id| self.bodies[id as usize].clone());
        CollisionSubject { title: String::new(), collision: collision.clone(), bodies }
    }
}

/// Two boxes that approach each other.
pub fn pair() -> RunStates {
    let bodies: [BodySpec; 2] = [("c", [1.0, 1.2, 2.0, 1.2], [2.5, 0.5]), ("b", [4.3, 1.9, 1.6, 1.6], [-1.2, -0.4])];
    run(&bodies, None, 6.0, 12)
}

/// A heavy box that pushes a light one between itself and a wall (Galperin's billiard).
pub fn galperin() -> RunStates {
    let bodies: [BodySpec; 3] = [
        ("wall-left", [-1.0, 0.0, 1.0, 4.5], [0.0, 0.0]),
        ("small", [1.0, 2.0, 0.4, 0.4], [0.0, 0.0]),
        ("big", [3.0, 1.8, 0.8, 0.8], [-2.0, 0.0]),
    ];
    run_with(SolverKind::EventDriven, &bodies, None, 20.0, 60)
}

/// A gas of small boxes that a piston compresses.
pub fn piston() -> RunStates {
    let mut bodies: Vec<BodySpec> = vec![
        ("wall-piston", [-5.0, 0.0, 5.0, 4.5], [0.5, 0.0]),
        ("wall-right", [8.0, -1.0, 1.0, 6.5], [0.0, 0.0]),
        ("wall-top", [-1.0, -1.0, 10.0, 1.0], [0.0, 0.0]),
        ("wall-bottom", [-1.0, 4.5, 10.0, 1.0], [0.0, 0.0]),
    ];
    let speeds = |at: i32| [f64::from(at * 7 % 11) - 5.0, f64::from(at * 5 % 13) - 6.0];
    let place = |at: i32| [0.5 + 0.9 * f64::from(at % 8), 0.4 + 0.9 * f64::from(at / 8), 0.05, 0.05];
    bodies.extend((0..32).map(|at| ("gas", place(at), speeds(at))));
    run_with(SolverKind::EventDriven, &bodies, None, 10.0, 80)
}

/// Three boxes that fall on a floor and collide.
pub fn fall() -> RunStates {
    let bodies: [BodySpec; 6] = [
        ("wall-bottom", [-1.0, 4.5, 10.0, 1.0], [0.0, 0.0]),
        ("wall-left", [-1.0, 0.0, 1.0, 4.5], [0.0, 0.0]),
        ("wall-right", [8.0, 0.0, 1.0, 4.5], [0.0, 0.0]),
        ("left", [1.0, 0.5, 0.8, 0.8], [1.5, 0.0]),
        ("middle", [3.5, 1.5, 1.0, 0.6], [0.0, 0.0]),
        ("right", [6.0, 1.0, 0.6, 0.8], [-1.5, 0.0]),
    ];
    run(&bodies, Some(Vector::new(0.0, 9.81)), 60.0, 120)
}
