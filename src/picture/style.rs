use super::{Error, Progress, ResolvedPicture, Source, source};
use crate::physics::{BodyId, Collision, Observer, Spawn, Vector};
use crate::recording::BodyInfo;
use crate::render::area::larger;
use crate::render::{Appearance, Color, Palette, Style, palette};
use crate::replay::replay;
use crate::scene::Overlay;

/// The style of a picture of these recordings, with scales common to all of them.
///
/// # Errors
/// If the scale of impulse arrows requires a replay and that fails.
pub fn style(picture: &ResolvedPicture, sources: &[Source], progress: Progress) -> Result<Style, Error> {
    let top = |of: fn(&Source) -> f64| sources.iter().map(of).fold(0.0, larger);
    let mut materials: Vec<String> = sources.iter().flat_map(|source| source.summary.materials.clone()).collect();
    materials.sort();
    materials.dedup();
    let mut top_impulse = 0.0;
    if picture.show.contains(&Overlay::Impulse) {
        for source in sources {
            top_impulse = larger(max_impulse(source, progress)?, top_impulse);
        }
    }
    Ok(Style {
        theme: picture.theme,
        show: picture.show.clone(),
        color_by: picture.color_by,
        top_speed: top(|source| source.summary.top_speed),
        top_force: top(|source| source.summary.top_force),
        top_impulse,
        body_count: sources.iter().map(|source| source.summary.names.len() as u32).max().unwrap_or(0),
        caption: picture.caption.clone(),
        materials,
    })
}

/// The largest impulse of a run, N·s.
fn max_impulse(source: &Source, progress: Progress) -> Result<f64, Error> {
    struct MaxImpulse(f64);
    impl Observer for MaxImpulse {
        fn collision(&mut self, collision: &Collision) {
            self.0 = larger(collision.impulse.abs(), self.0);
        }
    }
    let mut max = MaxImpulse(0.0);
    let steps = source.header.steps;
    let recording = source::open(&source.path)?;
    let verdict = replay(recording, 0..=u64::MAX, &mut max, &mut |step| progress(step, steps));
    verdict.map_err(|error| source.read_error(error))?;
    Ok(max.0)
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
        true => Palette::of(Style::default().theme).wall,
        false => palette::color_by_body(&appearance),
    };
    [color.r, color.g, color.b]
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
