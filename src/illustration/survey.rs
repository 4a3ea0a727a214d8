use super::Error;
use super::source::open;
use super::style::force;
use crate::physics::{BodyId, Rect, Spawn, Vector};
use crate::recording::{self, Change, Extremes, Header, Item, KnownBody, Outline, RecordedState, Recording};
use crate::render::area::overlap;
use std::io::{Read, Seek};
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
    /// The names of all bodies that are ever there.
    pub names: Vec<String>,
    /// The least rectangle that holds all bodies of finite mass in all states, m.
    pub reach: Option<Rect>,
    /// Whether any of them is ever in the part of the plane the scene calls its world.
    pub is_in_world: bool,
    /// What names it in pictures; none if it is unfinished.
    pub identity: Option<String>,
}

impl Survey {
    /// Looks at what the end of a recording tells of it; where that is not enough, through all of
    /// it, and comes to the same. `world` is the size of its world, m.
    ///
    /// # Errors
    /// When it cannot be read.
    pub fn of(path: &Path, world: Vector) -> Result<Survey, Error> {
        let failed = |source| Error::Recording { path: path.into(), source };
        let mut recording = open(path)?;
        let outline = recording.outline().map_err(failed)?;
        let extremes = outline.as_ref().and_then(|outline| outline.end.extremes);
        let survey = match (outline, extremes) {
            (Some(outline), Some(extremes)) => told(recording, &outline, &extremes, world),
            (Some(_), None) | (None, _) => seen(recording, world),
        };
        survey.map_err(failed)
    }
}

/// What the end and the events of a finished recording tell.
fn told<R: Read + Seek>(
    mut recording: Recording<R>,
    outline: &Outline,
    extremes: &Extremes,
    world: Vector,
) -> Result<Survey, recording::Error> {
    let Header { every, settings, .. } = recording.header.clone();
    let mut crowd = Crowd::new(settings.gravity);
    recording.events(|event| crowd.event(&event.change))?;
    let is_in_world = match &extremes.reach {
        Some(reach) if is_in(&reach.rect(), world) => ever_in(&mut recording, world)?,
        Some(_) | None => false,
    };
    let last_step = (outline.states > 0).then(|| outline.end.steps - outline.end.steps % every);
    Ok(crowd.survey(last_step, extremes, is_in_world, Some(outline.end.identity.to_string())))
}

/// What all states show.
fn seen<R: Read + Seek>(mut recording: Recording<R>, world: Vector) -> Result<Survey, recording::Error> {
    let mut crowd = Crowd::new(recording.header.settings.gravity);
    let mut extremes = Extremes::default();
    let (mut last_step, mut is_in_world) = (None, false);
    while let Some(item) = recording.next() {
        let item = item?;
        crowd.item(&item);
        for_each_body(&recording, &item, |known, numbers| {
            extremes.see(known, numbers);
            is_in_world = is_in_world || stands_in(known, numbers, world);
        });
        last_step = full_state(&recording, &item).map(|state| state.step).or(last_step);
    }
    let identity = recording.end().map(|end| end.identity.to_string());
    Ok(crowd.survey(last_step, &extremes, is_in_world, identity))
}

/// Whether a body of finite mass is ever in the world: mostly at once.
fn ever_in<R: Read + Seek>(recording: &mut Recording<R>, world: Vector) -> Result<bool, recording::Error> {
    let mut is_in_world = false;
    while !is_in_world && let Some(item) = recording.next() {
        for_each_body(recording, &item?, |known, numbers| is_in_world |= stands_in(known, numbers, world));
    }
    Ok(is_in_world)
}

/// Hands out all bodies of a state that was recorded in full: x, y (m), vx, vy (m/s).
fn for_each_body<R: Read + Seek>(recording: &Recording<R>, item: &Item, mut take: impl FnMut(&KnownBody, [f64; 4])) {
    if let Some(state) = full_state(recording, item)
        && let Some(table) = recording.table()
    {
        for (known, moved) in table.with_state(state) {
            take(known, moved.unwrap_or_else(|| known.first_numbers()));
        }
    }
}

/// A state whose bodies are known and not thinned away.
fn full_state<'a, R: Read + Seek>(recording: &Recording<R>, item: &'a Item) -> Option<&'a RecordedState> {
    match item {
        Item::State(state) => {
            Some(state).filter(|state| recording.table().is_some() && state.step.is_multiple_of(recording.header.every))
        }
        Item::Event(_) | Item::Keyframe(_) | Item::Doubtful(_) => None,
        Item::View { .. } | Item::Damaged(_) | Item::Gap(_) | Item::End(_) => None,
    }
}

fn stands_in(known: &KnownBody, [x, y, ..]: [f64; 4], world: Vector) -> bool {
    let size = &known.spawn.rect;
    let rect = Rect::new(Vector::new(x, y), size.width(), size.height());
    known.spawn.mass.is_finite() && rect.far_corner().is_finite() && is_in(&rect, world)
}

fn is_in(rect: &Rect, world: Vector) -> bool {
    overlap(rect, &Rect::new(Vector::ZERO, world.x, world.y)).is_some()
}

/// All bodies that are ever there: what never changes about them.
struct Crowd {
    gravity: Option<Vector>,
    next_id: BodyId,
    top_force: f64,
    materials: Vec<String>,
    names: Vec<String>,
}

impl Crowd {
    fn new(gravity: Option<Vector>) -> Crowd {
        Crowd { gravity, next_id: 0, top_force: 0.0, materials: Vec::new(), names: Vec::new() }
    }

    /// Where spawns are lost, a keyframe tells of the bodies.
    fn item(&mut self, item: &Item) {
        match item {
            Item::Event(event) => self.event(&event.change),
            Item::Keyframe(keyframe) => {
                keyframe.bodies.iter().for_each(|body| self.meet(body.known.id, &body.known.spawn));
            }
            Item::State(_) | Item::Doubtful(_) | Item::View { .. } => {}
            Item::Damaged(_) | Item::Gap(_) | Item::End(_) => {}
        }
    }

    fn event(&mut self, change: &Change) {
        match change {
            Change::Spawn { id, spawn, .. } => self.meet(*id, spawn),
            Change::Delete { .. } => {}
        }
    }

    fn meet(&mut self, id: BodyId, spawn: &Spawn) {
        if id < self.next_id {
            return;
        }
        self.next_id = id.saturating_add(1);
        let force = force(spawn, self.gravity).norm();
        if force > self.top_force {
            self.top_force = force;
        }
        self.names.push(spawn.name.clone());
        if let Err(place) = self.materials.binary_search(&spawn.material)
            && !spawn.material.is_empty()
        {
            self.materials.insert(place, spawn.material.clone());
        }
    }

    fn survey(
        self,
        last_step: Option<u64>,
        extremes: &Extremes,
        is_in_world: bool,
        identity: Option<String>,
    ) -> Survey {
        Survey {
            last_step,
            top_speed: extremes.top_speed,
            top_force: self.top_force,
            materials: self.materials,
            names: self.names,
            reach: extremes.reach.map(|reach| reach.rect()),
            is_in_world,
            identity,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::run::{self, RecordOptions};
    use crate::scene;
    use std::fs::File;

    /// A box that leaves the world, one that comes and goes between two steps that are recorded
    /// in full, and a wall that moves.
    const SCENE: &str = r##"
[world]
size = [8.0, 6.0]
gravity = [0.0, 9.81]
[run]
rate = 20
steps = 50
solver = "handout"
[[spawn]]
name = "a"
at = [2.0, 3.0]
size = [1.0, 1.0]
mass = 2.0
velocity = [-3.0, -8.0]
material = "wood"
[[spawn]]
name = "lift"
at = [5.0, 3.0]
size = [1.0, 1.0]
mass = inf
velocity = [0.0, -9.0]
material = "steel"
[[spawn]]
step = 13
name = "b"
at = [3.0, 5.0]
size = [1.0, 1.0]
mass = 50.0
force = [7.0, 0.0]
material = "stone"
[[delete]]
step = 14
name = "b"
"##;

    fn compare(text: &str, every: u64, expected_in_world: bool) {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("run.mcap");
        let scene = scene::parse("scene.toml", text).unwrap();
        let options = RecordOptions { steps: scene.run.steps, every, viewer: None };
        run::record(&scene, options, run::NO_LIVE_EVENTS, File::create(&path).unwrap(), |_| ()).unwrap();
        let outline = open(&path).unwrap().outline().unwrap();
        assert!(outline.unwrap().end.extremes.is_some(), "the end tells nothing");
        let world = Vector::new(scene.size[0], scene.size[1]);
        let told = Survey::of(&path, world).unwrap();
        assert_eq!(told, seen(open(&path).unwrap(), world).unwrap());
        assert_eq!(told.is_in_world, expected_in_world);
        assert_eq!((told.names.len(), told.materials.join(" ").as_str()), (3, "steel stone wood"));
        assert!(told.top_speed > 9.0 && told.top_force > 490.0 && told.last_step == Some(50 - 50 % every));
    }

    #[test]
    fn what_the_end_tells_is_what_the_states_show() {
        compare(SCENE, 1, true);
        compare(SCENE, 7, true);
    }

    #[test]
    fn nobody_in_the_world_is_told_from_somebody_around_it() {
        let outside = SCENE
            .replace("size = [8.0, 6.0]", "size = [0.5, 0.5]")
            .replace("at = [2.0, 3.0]", "at = [-3.0, 3.0]")
            .replace("velocity = [-3.0, -8.0]", "velocity = [0.0, -9.5]");
        compare(&outside, 1, false);
    }
}
