//! rebond itself, stepping without recording. The cost of a step includes sampling the state.

use crate::{drive::PeerWorld, job::Job};
use rebond::internals::{
    physics::{CollisionCount, SolverKind},
    replay::Run,
    scene,
};

struct Rebond {
    run: Run,
    collisions: CollisionCount,
}

/// The event-driven solver.
pub fn event_driven(job: &Job) -> Result<Box<dyn PeerWorld>, String> {
    build(job, SolverKind::EventDriven)
}

/// The handout solver, which tests all pairs in every step.
pub fn handout(job: &Job) -> Result<Box<dyn PeerWorld>, String> {
    if job.bodies.len() > 2000 {
        return Err("not run: it tests all pairs in every step".to_owned());
    }
    build(job, SolverKind::Handout)
}

fn build(job: &Job, solver: SolverKind) -> Result<Box<dyn PeerWorld>, String> {
    let mut scene = scene::parse("peers.toml", &job.toml).map_err(|error| error.to_string())?;
    scene.run.solver = solver;
    let mut run = Run::new(&scene);
    run.apply_inputs(Vec::new(), |error| Err(error.into())).map_err(|error| error.to_string())?;
    Ok(Box::new(Rebond { run, collisions: CollisionCount::default() }))
}

impl PeerWorld for Rebond {
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
