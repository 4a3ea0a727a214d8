use super::layers::force;
use crate::physics::{BodyId, Rect, Spawn, Vector};
use crate::recording::{self, BodyInfo, Change, Header, Item, RecordedState, Recording, StateBounds, Summary};
use std::collections::BTreeMap;
use std::io::{Read, Seek};

/// Properties of a whole run on which every picture depends, even one of a part of the run, so that parts drawn
/// separately have the same scales, colours and camera.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct RunStatistics {
    /// The step of the last full state; `None` if the recording contains no state.
    pub last_step: Option<u64>,
    /// The step of the last state, recorded in full or as a digest, up to which the run can be replayed.
    pub end_step: Option<u64>,
    /// The highest speed in any full state, m/s.
    pub top_speed: f64,
    /// The largest sum of weight and constant force of a body, N.
    pub top_force: f64,
    /// The materials of the bodies, sorted.
    pub materials: Vec<String>,
    /// The names of all bodies that ever exist.
    pub names: Vec<String>,
    /// The bounding box of all bodies of finite mass in all full states, m.
    pub bounds: Option<Rect>,
    /// True if a body of finite mass is inside the world of the scene in a full state.
    pub has_body_in_world: bool,
    /// The identity of the recording in pictures; `None` if the recording is unfinished.
    pub identity: Option<String>,
}

impl RunStatistics {
    /// Reads the statistics from the end record and the events of a recording, or from all states if the
    /// end record is missing or incomplete; both give the same result. `world` is the size of the world, m.
    ///
    /// # Errors
    /// If the recording cannot be read.
    pub fn read<R: Read + Seek>(mut recording: Recording<R>, world: Vector) -> Result<RunStatistics, recording::Error> {
        let summary = recording.summary()?;
        let state_bounds = summary.as_ref().and_then(|summary| summary.trailer.state_bounds);
        match (summary, state_bounds) {
            (Some(summary), Some(state_bounds)) => from_end_record(recording, &summary, &state_bounds, world),
            (Some(_), None) | (None, _) => from_states(recording, world),
        }
    }
}

/// The statistics of a finished recording, from its end record and events.
fn from_end_record<R: Read + Seek>(
    mut recording: Recording<R>,
    summary: &Summary,
    state_bounds: &StateBounds,
    world: Vector,
) -> Result<RunStatistics, recording::Error> {
    let Header { every, config, .. } = recording.header.clone();
    let mut stats = BodyStats::new(config.gravity);
    recording.for_each_event(|item| stats.add_item(&item))?;
    let has_body_in_world = match &state_bounds.bounds {
        Some(bounds) if overlaps_world(&bounds.rect(), world) => ever_in_world(&mut recording, world)?,
        Some(_) | None => false,
    };
    let end_step = (summary.states > 0).then_some(summary.trailer.steps);
    let identity = Some(summary.trailer.identity.to_string());
    Ok(RunStatistics {
        last_step: end_step.map(|step| step - step % every),
        end_step,
        has_body_in_world,
        identity,
        ..stats.statistics(state_bounds)
    })
}

/// The statistics from all states of a recording.
fn from_states<R: Read + Seek>(mut recording: Recording<R>, world: Vector) -> Result<RunStatistics, recording::Error> {
    let mut stats = BodyStats::new(recording.header.config.gravity);
    let mut state_bounds = StateBounds::default();
    let (mut last_step, mut end_step, mut has_body_in_world) = (None, None, false);
    while let Some(item) = recording.next() {
        let item = item?;
        stats.add_item(&item);
        for_each_body(&recording, &item, |info, numbers| {
            state_bounds.include(info, numbers);
            has_body_in_world = has_body_in_world || is_body_in_world(info, numbers, world);
        });
        last_step = full_state(&recording, &item).map(|state| state.step).or(last_step);
        if let Item::State(state) = &item
            && recording.table().is_some()
        {
            end_step = Some(state.step);
        }
    }
    let identity = recording.trailer().map(|end| end.identity.to_string());
    Ok(RunStatistics { last_step, end_step, has_body_in_world, identity, ..stats.statistics(&state_bounds) })
}

/// Returns true if a body of finite mass is ever inside the world. Usually the first state decides.
fn ever_in_world<R: Read + Seek>(recording: &mut Recording<R>, world: Vector) -> Result<bool, recording::Error> {
    let mut has_body_in_world = false;
    while !has_body_in_world && let Some(item) = recording.next() {
        for_each_body(recording, &item?, |info, numbers| has_body_in_world |= is_body_in_world(info, numbers, world));
    }
    Ok(has_body_in_world)
}

/// Calls `visit` with every body of a full state and its x, y (m), vx, vy (m/s). Does nothing for other
/// items.
fn for_each_body<R: Read + Seek>(recording: &Recording<R>, item: &Item, mut visit: impl FnMut(&BodyInfo, [f64; 4])) {
    if let Some(state) = full_state(recording, item)
        && let Some(table) = recording.table()
    {
        for (info, moved) in table.join_state(state) {
            visit(info, moved.unwrap_or_else(|| info.initial_state()));
        }
    }
}

/// The state of `item` if it is recorded in full and its bodies are known.
fn full_state<'a, R: Read + Seek>(recording: &Recording<R>, item: &'a Item) -> Option<&'a RecordedState> {
    match item {
        Item::State(state) => {
            Some(state).filter(|state| recording.table().is_some() && state.step.is_multiple_of(recording.header.every))
        }
        Item::Event(_) | Item::Keyframe(_) | Item::SuspectState(_) => None,
        Item::SceneUpdate { .. } | Item::Damaged(_) | Item::Gap(_) | Item::Trailer(_) => None,
    }
}

fn is_body_in_world(info: &BodyInfo, [x, y, ..]: [f64; 4], world: Vector) -> bool {
    let size = &info.spawn.rect;
    let rect = Rect::new(Vector::new(x, y), size.width(), size.height());
    info.spawn.mass.is_finite() && rect.far_corner().is_finite() && overlaps_world(&rect, world)
}

fn overlaps_world(rect: &Rect, world: Vector) -> bool {
    rect.intersection(&Rect::new(Vector::ZERO, world.x, world.y)).is_some()
}

/// Constant properties of all bodies that ever exist.
struct BodyStats {
    gravity: Option<Vector>,
    top_force: f64,
    materials: Vec<String>,
    names: BTreeMap<BodyId, String>,
}

impl BodyStats {
    fn new(gravity: Option<Vector>) -> BodyStats {
        BodyStats { gravity, top_force: 0.0, materials: Vec::new(), names: BTreeMap::new() }
    }

    /// Keyframes count too, because the spawn events may be lost.
    fn add_item(&mut self, item: &Item) {
        match item {
            Item::Event(event) => match &event.change {
                Change::Spawn(info) => self.add_body(info.id, &info.spawn),
                Change::Delete { .. } => {}
            },
            Item::Keyframe(keyframe) => {
                keyframe.bodies.iter().for_each(|body| self.add_body(body.info.id, &body.info.spawn));
            }
            Item::State(_) | Item::SuspectState(_) | Item::SceneUpdate { .. } => {}
            Item::Damaged(_) | Item::Gap(_) | Item::Trailer(_) => {}
        }
    }

    fn add_body(&mut self, id: BodyId, spawn: &Spawn) {
        if self.names.insert(id, spawn.name.clone()).is_some() {
            return;
        }
        let force = force(spawn, self.gravity).norm();
        if force > self.top_force {
            self.top_force = force;
        }
        if let Err(place) = self.materials.binary_search(&spawn.material)
            && !spawn.material.is_empty()
        {
            self.materials.insert(place, spawn.material.clone());
        }
    }

    fn statistics(self, state_bounds: &StateBounds) -> RunStatistics {
        RunStatistics {
            top_speed: state_bounds.top_speed,
            top_force: self.top_force,
            materials: self.materials,
            names: self.names.into_values().collect(),
            bounds: state_bounds.bounds.map(|bounds| bounds.rect()),
            ..RunStatistics::default()
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::replay::{self, RecordOptions};
    use crate::scene;
    use std::fs::File;

    /// A box that leaves the world, one that exists only between two full states, and a moving body of
    /// infinite mass.
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
        let options = RecordOptions { every, ..RecordOptions::complete(&scene) };
        replay::record(&scene, options, replay::NO_LIVE_EVENTS, File::create(&path).unwrap(), |_| ()).unwrap();
        let summary = recording::open(&path).unwrap().summary().unwrap();
        assert!(summary.unwrap().trailer.state_bounds.is_some(), "the end record has no state bounds");
        let world = Vector::new(scene.size[0], scene.size[1]);
        let from_end_record = RunStatistics::read(recording::open(&path).unwrap(), world).unwrap();
        assert_eq!(from_end_record, from_states(recording::open(&path).unwrap(), world).unwrap());
        assert_eq!(from_end_record.has_body_in_world, expected_in_world);
        assert_eq!(
            (from_end_record.names.len(), from_end_record.materials.join(" ").as_str()),
            (3, "steel stone wood")
        );
        assert!(
            from_end_record.top_speed > 9.0
                && from_end_record.top_force > 490.0
                && from_end_record.last_step == Some(50 - 50 % every)
                && from_end_record.end_step == Some(50)
        );
    }

    #[test]
    fn the_end_record_and_the_states_give_the_same_statistics() {
        compare(SCENE, 1, true);
        compare(SCENE, 7, true);
    }

    #[test]
    fn a_body_outside_of_the_world_does_not_count_as_inside() {
        let outside = SCENE
            .replace("size = [8.0, 6.0]", "size = [0.5, 0.5]")
            .replace("at = [2.0, 3.0]", "at = [-3.0, 3.0]")
            .replace("velocity = [-3.0, -8.0]", "velocity = [0.0, -9.5]");
        compare(&outside, 1, false);
    }
}
