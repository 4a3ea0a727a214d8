use super::{Error, Progress, Request, Source, source};
use crate::physics::{BodyId, Collision, Observer, Spawn, Vector};
use crate::recording::KnownBody;
use crate::render::area::larger;
use crate::render::{Appearance, Color, Palette, Style, palette};
use crate::replay::replay;
use crate::scene::Overlay;

/// How everything in an illustration of these recordings looks, on scales that fit them all.
///
/// # Errors
/// When a recording has to be replayed for that and cannot be.
pub fn style(request: &Request, sources: &[Source], progress: Progress) -> Result<Style, Error> {
    let top = |of: fn(&Source) -> f64| sources.iter().map(of).fold(0.0, larger);
    let mut materials: Vec<String> = sources.iter().flat_map(|source| source.survey.materials.clone()).collect();
    materials.sort();
    materials.dedup();
    let mut top_impulse = 0.0;
    if request.show.contains(&Overlay::Impulse) {
        for source in sources {
            top_impulse = larger(strongest(source, progress)?, top_impulse);
        }
    }
    Ok(Style {
        theme: request.theme,
        show: request.show.clone(),
        color_by: request.color_by,
        top_speed: top(|source| source.survey.top_speed),
        top_force: top(|source| source.survey.top_force),
        top_impulse,
        crowd: sources.iter().map(|source| source.survey.names.len() as u32).max().unwrap_or(0),
        caption: request.caption.clone(),
        materials,
    })
}

/// The strongest impulse of a run, N·s.
fn strongest(source: &Source, progress: Progress) -> Result<f64, Error> {
    struct Strongest(f64);
    impl Observer for Strongest {
        fn collision(&mut self, collision: &Collision) {
            self.0 = larger(collision.impulse.abs(), self.0);
        }
    }
    let mut strongest = Strongest(0.0);
    let steps = source.header.steps;
    let recording = source::open(&source.path)?;
    let verdict = replay(recording, 0..=u64::MAX, &mut strongest, &mut |step| progress(step, steps));
    verdict.map_err(|error| source.unreadable(error))?;
    Ok(strongest.0)
}

/// Weight and constant force together, N; null for an infinite mass.
pub fn force(spawn: &Spawn, gravity: Option<Vector>) -> Vector {
    if spawn.mass == f64::INFINITY {
        return Vector::ZERO;
    }
    gravity.map_or(Vector::ZERO, |gravity| gravity.mult(spawn.mass)).add(spawn.force)
}

/// The colour of a body in pictures whose scene asks for nothing else: red, green, blue.
pub fn paint(known: &KnownBody) -> [u8; 3] {
    let appearance = appearance(known.id, &known.spawn, known.color.as_deref(), None);
    let color = match appearance.is_wall {
        true => Palette::of(Style::default().theme).wall,
        false => palette::box_color(&appearance),
    };
    [color.r, color.g, color.b]
}

/// How a body that was spawned so looks.
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
