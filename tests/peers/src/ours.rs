//! rebond itself, stepping without recording; what a step costs includes its sample.

use crate::{drive::Peer, job::Job};
use rebond::{
    physics::{CollisionCount, SolverKind},
    run::Run,
    scene,
};

struct Ours {
    run: Run,
    collisions: CollisionCount,
}

/// The exact solver.
pub fn event_driven(job: &Job) -> Result<Box<dyn Peer>, String> {
    build(job, SolverKind::EventDriven)
}

/// The handout's algorithm, which looks at every pair at every step.
pub fn handout(job: &Job) -> Result<Box<dyn Peer>, String> {
    if job.bodies.len() > 2000 {
        return Err("looks at every pair at every step".to_owned());
    }
    build(job, SolverKind::Handout)
}

fn build(job: &Job, solver: SolverKind) -> Result<Box<dyn Peer>, String> {
    let mut scene = scene::parse("peers.toml", &job.toml).map_err(|error| error.to_string())?;
    scene.run.solver = solver;
    let mut run = Run::new(&scene);
    run.happen(Vec::new(), |error| Err(error.into())).map_err(|error| error.to_string())?;
    Ok(Box::new(Ours { run, collisions: CollisionCount::default() }))
}

impl Peer for Ours {
    fn step(&mut self) -> Result<(), String> {
        self.run.step(&mut self.collisions).map_err(|error| error.to_string())
    }

    fn state(&self, body: usize) -> [f64; 4] {
        let body = &self.run.engine().world().bodies[body];
        [body.rect.origin.x, body.rect.origin.y, body.velocity.x, body.velocity.y]
    }

    fn collisions(&self) -> Option<u64> {
        Some(self.collisions.0)
    }
}
