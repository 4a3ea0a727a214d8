use super::Error;
use super::source::open;
use crate::physics::{Rect, Vector};
use crate::recording::{Frame, FrameBody, Header, Playback};
use crate::render::area::{overlap, union};
use std::path::Path;

/// What has to be known of a whole recording before a part of it is drawn, so that parts drawn
/// apart fit together.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Survey {
    /// The last state in it; none if there is none.
    pub last_step: Option<u64>,
    /// The highest speed in any state, m/s.
    pub top_speed: f64,
    /// The greatest weight and constant force together, N.
    pub top_force: f64,
    /// The materials of its bodies, sorted.
    pub materials: Vec<String>,
    /// The names of all bodies that are ever seen.
    pub names: Vec<String>,
    /// The least rectangle that holds all bodies of finite mass in all states, m.
    pub reach: Option<Rect>,
    /// Whether any of them is ever in the part of the plane the scene calls its world.
    pub is_in_world: bool,
    /// What names it in pictures; none if it is unfinished.
    pub identity: Option<String>,
}

impl Survey {
    /// Looks through a recording once; `world` is the size of its world, m.
    ///
    /// # Errors
    /// When it cannot be read.
    pub fn of(path: &Path, world: Vector) -> Result<Survey, Error> {
        let mut playback = Playback::new(open(path)?);
        let header = playback.header().clone();
        let mut survey = Survey::default();
        let mut next_id = 0;
        for frame in playback.by_ref() {
            let frame = frame.map_err(|source| Error::Recording { path: path.into(), source })?;
            survey.see(&frame, world);
            for body in frame.bodies.iter().filter(|body| body.known.id >= next_id) {
                survey.meet(body, &header);
            }
            next_id = frame.bodies.last().map_or(next_id, |body| next_id.max(body.known.id + 1));
        }
        survey.materials.sort();
        survey.identity = playback.end().map(|end| end.identity.to_string());
        Ok(survey)
    }

    fn see(&mut self, frame: &Frame, world: Vector) {
        self.last_step = Some(frame.step);
        for body in &frame.bodies {
            let speed = body.velocity.norm();
            if speed > self.top_speed {
                self.top_speed = speed;
            }
            let size = &body.known.spawn.rect;
            let rect = Rect::new(body.position, size.width(), size.height());
            if body.known.spawn.mass != f64::INFINITY && rect.far_corner().is_finite() && rect.origin.is_finite() {
                self.reach = Some(self.reach.map_or(rect, |reach| union(&reach, &rect)));
                self.is_in_world |= overlap(&rect, &Rect::new(Vector::ZERO, world.x, world.y)).is_some();
            }
        }
    }

    /// Notes what never changes about a body.
    fn meet(&mut self, body: &FrameBody, header: &Header) {
        let spawn = &body.known.spawn;
        let force = super::style::force(spawn, header.settings.gravity).norm();
        if force > self.top_force {
            self.top_force = force;
        }
        self.names.push(spawn.name.clone());
        if !spawn.material.is_empty() && !self.materials.contains(&spawn.material) {
            self.materials.push(spawn.material.clone());
        }
    }
}
