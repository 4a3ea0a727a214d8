//! Box2D v3, compiled without its assertions.
//!
//! With a locked rotation alone the contacts still use the inertia, and a bounce loses a fifth of its
//! energy, so the inertia is set to zero, too. Friction and damping 0, restitution e on both shapes (the
//! larger counts), restitution threshold 0, no speed limit. Everything else is the default: 4 substeps, one
//! worker.

use crate::{
    drive::PeerWorld,
    job::{Body, Job},
};
use boxdd_sys::ffi;

/// As the documentation of Box2D recommends.
const SUBSTEPS: i32 = 4;

struct Box2d {
    world: ffi::b2WorldId,
    bodies: Vec<(ffi::b2BodyId, [f64; 2])>,
    /// The bodies with a constant force, which lasts for one step.
    forces: Vec<(ffi::b2BodyId, ffi::b2Vec2)>,
    step: f32,
}

/// Creates the world of a job.
pub fn build(job: &Job) -> Result<Box<dyn PeerWorld>, String> {
    // SAFETY: the definition is Box2D's own, and the world lives until it is dropped.
    let world = unsafe {
        let mut definition = ffi::b2DefaultWorldDef();
        definition.gravity = vector(job.gravity[0], job.gravity[1]);
        definition.restitutionThreshold = 0.0;
        definition.maximumLinearSpeed = 1e9;
        definition.enableSleep = job.sleep;
        ffi::b2CreateWorld(&definition)
    };
    let bodies = job.bodies.iter().map(|body| (insert(world, job, body), [0.5 * body.width, 0.5 * body.height]));
    let bodies: Vec<(ffi::b2BodyId, [f64; 2])> = bodies.collect();
    let pushed = job.bodies.iter().zip(&bodies).filter(|(body, _)| [body.fx, body.fy] != [0.0; 2]);
    let forces = pushed.map(|(body, (id, _))| (*id, vector(body.fx, body.fy))).collect();
    Ok(Box::new(Box2d { world, bodies, forces, step: (1.0 / job.rate) as f32 }))
}

/// The version, and the commit that the bindings were made from.
pub fn version() -> String {
    // SAFETY: the function only returns a constant.
    let version = unsafe { ffi::b2GetVersion() };
    format!("{}.{}.{} ({})", version.major, version.minor, version.revision, &boxdd_sys::UPSTREAM_SHA[..10])
}

fn insert(world: ffi::b2WorldId, job: &Job, body: &Body) -> ffi::b2BodyId {
    let [half_width, half_height] = [0.5 * body.width, 0.5 * body.height];
    // SAFETY: the definitions are Box2D's own, and the ids are of this world.
    unsafe {
        let mut definition = ffi::b2DefaultBodyDef();
        definition.position = vector(body.x + half_width, body.y + half_height);
        definition.linearVelocity = vector(body.vx, body.vy);
        definition.motionLocks.angularZ = true;
        definition.isBullet = body.bullet;
        definition.enableSleep = job.sleep;
        if body.mass.is_some() {
            definition.type_ = ffi::b2BodyType_b2_dynamicBody;
        }
        let id = ffi::b2CreateBody(world, &definition);
        let mut shape = ffi::b2DefaultShapeDef();
        shape.material.friction = 0.0;
        shape.material.restitution = job.restitution as f32;
        let polygon = ffi::b2MakeBox(half_width as f32, half_height as f32);
        ffi::b2CreatePolygonShape(id, &shape, &polygon);
        if let Some(mass) = body.mass {
            let data = ffi::b2MassData { mass: mass as f32, center: vector(0.0, 0.0), rotationalInertia: 0.0 };
            ffi::b2Body_SetMassData(id, data);
        }
        id
    }
}

fn vector(x: f64, y: f64) -> ffi::b2Vec2 {
    ffi::b2Vec2 { x: x as f32, y: y as f32 }
}

impl PeerWorld for Box2d {
    fn step(&mut self) -> Result<(), String> {
        for (body, force) in &self.forces {
            // SAFETY: the body is alive.
            unsafe { ffi::b2Body_ApplyForceToCenter(*body, *force, true) };
        }
        // SAFETY: the world is alive.
        unsafe { ffi::b2World_Step(self.world, self.step, SUBSTEPS) };
        Ok(())
    }

    fn state(&self, body: usize) -> [f64; 4] {
        let (id, [half_width, half_height]) = self.bodies[body];
        // SAFETY: the body is alive.
        let (center, velocity) = unsafe { (ffi::b2Body_GetPosition(id), ffi::b2Body_GetLinearVelocity(id)) };
        [
            f64::from(center.x) - half_width,
            f64::from(center.y) - half_height,
            f64::from(velocity.x),
            f64::from(velocity.y),
        ]
    }
}

impl Drop for Box2d {
    fn drop(&mut self) {
        // SAFETY: the world is alive, and is not used again.
        unsafe { ffi::b2DestroyWorld(self.world) };
    }
}
