use crate::event_lines::EventLines;
use rebond::Scene;
use std::rc::Rc;

/// The largest number of sessions that undo can return to.
const MAX_UNDO: usize = 200;

/// A session that undo returns to.
#[derive(Clone)]
pub struct UndoPoint {
    /// Its scene.
    pub scene: Rc<Scene>,
    /// Its lines of events.
    pub lines: EventLines,
    /// If the session was left for one with another scene: the step shown and the last one reached.
    pub left_at: Option<[u64; 2]>,
}

/// The sessions that undo can return to, the last one at the end.
#[derive(Clone, Default)]
pub struct UndoList(Vec<UndoPoint>);

impl UndoList {
    /// Adds a session. The oldest one is dropped if there are too many.
    pub fn push(&mut self, point: UndoPoint) {
        if self.0.len() >= MAX_UNDO {
            self.0.remove(0);
        }
        self.0.push(point);
    }

    /// Removes and returns the last session.
    pub fn pop(&mut self) -> Option<UndoPoint> {
        self.0.pop()
    }

    /// The same sessions with their scenes changed by `change`, which makes `changed` from `scene`.
    ///
    /// # Errors
    /// Those of `change`.
    pub fn with_changed_scenes(
        &self,
        scene: &Rc<Scene>,
        changed: &Rc<Scene>,
        change: impl Fn(&Scene) -> Result<Rc<Scene>, String>,
    ) -> Result<UndoList, String> {
        // Sessions that follow each other mostly share their scene.
        let mut shared = (scene, changed.clone());
        let mut points = Vec::new();
        for point in self.0.iter().rev() {
            if !Rc::ptr_eq(&point.scene, shared.0) {
                shared = (&point.scene, change(&point.scene)?);
            }
            points.push(UndoPoint { scene: shared.1.clone(), ..point.clone() });
        }
        points.reverse();
        Ok(UndoList(points))
    }
}
