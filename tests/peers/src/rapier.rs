//! Rapier in both precisions.
//!
//! Rotation locked with an inertia of zero, friction and damping 0, restitution e on both
//! colliders, without the speed limit of 400 m/s. There is no restitution threshold. Everything else is the
//! default: 4 solver iterations, the block solver, SIMD.

macro_rules! rapier {
    ($module:ident, $rapier:ident, $real:ty) => {
        /// One precision.
        pub mod $module {
            use crate::{
                drive::PeerWorld,
                job::{Body, Job},
            };
            use $rapier::prelude::*;

            struct Rapier {
                world: PhysicsWorld,
                handles: Vec<RigidBodyHandle>,
                halves: Vec<[f64; 2]>,
            }

            /// Creates the world of a job.
            pub fn build(job: &Job) -> Result<Box<dyn PeerWorld>, String> {
                let mut world = PhysicsWorld::new();
                world.gravity = Vector::new(job.gravity[0] as $real, job.gravity[1] as $real);
                world.integration_parameters.dt = (1.0 / job.rate) as $real;
                world.integration_parameters.normalized_max_linear_velocity = <$real>::MAX;
                let handles = job.bodies.iter().map(|body| insert(&mut world, job, body)).collect();
                let halves = job.bodies.iter().map(|body| [0.5 * body.width, 0.5 * body.height]).collect();
                Ok(Box::new(Rapier { world, handles, halves }))
            }

            fn insert(world: &mut PhysicsWorld, job: &Job, body: &Body) -> RigidBodyHandle {
                let [half_width, half_height] = [0.5 * body.width, 0.5 * body.height];
                let kind = match body.mass {
                    None => RigidBodyBuilder::fixed(),
                    Some(mass) => RigidBodyBuilder::dynamic().additional_mass_properties(MassProperties::new(
                        Vector::ZERO,
                        mass as $real,
                        0.0,
                    )),
                };
                let rigid = kind
                    .translation(Vector::new((body.x + half_width) as $real, (body.y + half_height) as $real))
                    .linvel(Vector::new(body.vx as $real, body.vy as $real))
                    .lock_rotations()
                    .linear_damping(0.0)
                    .can_sleep(job.sleep)
                    .ccd_enabled(body.bullet);
                let collider = ColliderBuilder::cuboid(half_width as $real, half_height as $real)
                    .density(0.0)
                    .friction(0.0)
                    .restitution(job.restitution as $real);
                let handle = world.insert(rigid, collider).0;
                // A force acts until it is reset.
                world.bodies[handle].add_force(Vector::new(body.fx as $real, body.fy as $real), true);
                handle
            }

            impl PeerWorld for Rapier {
                fn step(&mut self) -> Result<(), String> {
                    self.world.step();
                    Ok(())
                }

                fn state(&self, body: usize) -> [f64; 4] {
                    let rigid = &self.world.bodies[self.handles[body]];
                    let [half_width, half_height] = self.halves[body];
                    let (center, velocity) = (rigid.translation(), rigid.linvel());
                    [
                        f64::from(center.x) - half_width,
                        f64::from(center.y) - half_height,
                        f64::from(velocity.x),
                        f64::from(velocity.y),
                    ]
                }
            }
        }
    };
}

rapier!(single, rapier2d, f32);
rapier!(double, rapier2d_f64, f64);
