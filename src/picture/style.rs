use super::collisions::max_impulse;
use super::raster::color;
use super::{Appearance, Color, Error, Look, Overlay, Palette, Progress, Source, Style, source};
use crate::physics::{BodyId, Spawn, Vector, larger};
use crate::recording::{BodyInfo, Change, RecordedEvent};
use std::{collections::BTreeMap, sync::Arc};

impl Style {
    /// The style of a picture of these recordings, with scales common to all of them.
    ///
    /// # Errors
    /// If the scale of impulse arrows requires a replay and that fails.
    pub fn new(look: &Look, sources: &[Source], progress: Progress) -> Result<Style, Error> {
        let top = |of: fn(&Source) -> f64| sources.iter().map(of).fold(0.0, larger);
        let mut materials: Vec<String> =
            sources.iter().flat_map(|source| source.statistics.materials.clone()).collect();
        materials.sort();
        materials.dedup();
        let mut top_impulse = 0.0;
        if look.show.contains(Overlay::Impulse) {
            for source in sources {
                top_impulse = larger(max_impulse(source, progress)?, top_impulse);
            }
        }
        Ok(Style {
            look: look.clone(),
            top_speed: top(|source| source.statistics.top_speed),
            top_force: top(|source| source.statistics.top_force),
            top_impulse,
            body_count: sources.iter().map(|source| source.statistics.names.len() as u32).max().unwrap_or(0),
            materials,
        })
    }
}

/// The sum of weight and constant force, N; zero for an infinite mass.
pub fn force(spawn: &Spawn, gravity: Option<Vector>) -> Vector {
    if spawn.mass == f64::INFINITY {
        return Vector::ZERO;
    }
    gravity.map_or(Vector::ZERO, |gravity| gravity.mult(spawn.mass)).add(spawn.force)
}

/// The colour of a body in pictures with default options: red, green, blue.
pub fn body_color(info: &BodyInfo) -> [u8; 3] {
    let appearance = appearance(info.id, &info.spawn, info.color.as_deref(), None);
    let color = match appearance.is_wall {
        true => Palette::of(Look::default().theme).wall,
        false => color::color_by_body(&appearance),
    };
    [color.r, color.g, color.b]
}

/// The appearance of every body that is ever spawned.
pub fn appearances(source: &Source) -> Result<BTreeMap<BodyId, Arc<Appearance>>, Error> {
    let gravity = source.header.config.gravity;
    let mut bodies = BTreeMap::new();
    let add = |event: RecordedEvent| {
        if let Change::Spawn { id, spawn, color } = &event.change {
            bodies.insert(*id, Arc::new(appearance(*id, spawn, color.as_deref(), gravity)));
        }
    };
    source::open(&source.path)?.for_each_event(add).map_err(|error| source.read_error(error))?;
    Ok(bodies)
}

/// The appearance of a body with these parameters.
pub fn appearance(id: BodyId, spawn: &Spawn, color: Option<&str>, gravity: Option<Vector>) -> Appearance {
    let is_wall = spawn.mass == f64::INFINITY && spawn.name.starts_with("wall-");
    Appearance {
        id,
        name: spawn.name.clone(),
        material: spawn.material.clone(),
        color: color.and_then(Color::parse),
        mass: spawn.mass,
        force: force(spawn, gravity),
        is_wall,
    }
}
