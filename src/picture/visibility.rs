//! The bodies that a picture or an animation shows.

use super::layers::LayoutContext;
use super::{CameraTarget, Frame, View};
use crate::physics::BodyId;
use crate::text::counted;
use std::collections::BTreeSet;

/// Collects which bodies are visible, to warn about those that never are.
#[derive(Debug, Default)]
pub struct Visibility {
    /// All bodies but walls, by panel and id.
    bodies: BTreeSet<(usize, BodyId)>,
    /// The bodies that were at least partly in the picture in some frame.
    seen: BTreeSet<(usize, BodyId)>,
    /// The number of frames.
    frames: u64,
    /// The number of frames in which the followed body is not alive.
    unfollowed: u64,
}

impl Visibility {
    /// Adds a frame of a panel.
    pub fn add(&mut self, panel: usize, frame: &Frame, view: &View) {
        let context = LayoutContext::new(view, view.camera_for(frame));
        for sprite in frame.sprites.iter().filter(|sprite| !sprite.appearance.is_wall) {
            let body = (panel, sprite.appearance.id);
            self.bodies.insert(body);
            if !self.seen.contains(&body) && context.visible_rect(sprite).is_some() {
                self.seen.insert(body);
            }
        }
        self.frames += 1;
        let is_followed = |name: &String| frame.sprites.iter().any(|sprite| sprite.appearance.name == *name);
        self.unfollowed += u64::from(view.follow.as_ref().is_some_and(|name| !is_followed(name)));
    }

    /// Sentences about bodies that are not in the picture.
    pub fn warnings(&self, target: &CameraTarget) -> Vec<String> {
        let hidden = (self.bodies.len() - self.seen.len()) as u64;
        let mut warnings = Vec::new();
        if let CameraTarget::Follow { name, .. } = target
            && self.unfollowed > 0
        {
            let frames = counted(self.frames, "picture");
            warnings.push(format!(
                "the followed body {name:?} does not exist in {} of {frames}: the camera shows the middle of the world there",
                self.unfollowed
            ));
        } else if hidden > 0 && self.seen.is_empty() {
            warnings.push("no body is in the picture; choose another part of the world with --window".into());
        } else if hidden > 0 && *target == CameraTarget::World {
            let of = counted(self.bodies.len() as u64, "body");
            let verb = if hidden == 1 { "is" } else { "are" };
            warnings
                .push(format!("{hidden} of {of} {verb} outside the world of the picture; --window bodies shows all"));
        }
        warnings
    }
}
