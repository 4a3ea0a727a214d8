//! Hand-made frames, for pictures that do not depend on a solver.

use rebond::internals::physics::{Axis, Collision, Engine, EngineConfig, Event, Rect, SolverKind, Spawn, Vector};
use rebond::internals::picture::{Appearance, ColorBy, Frame, Look, Overlay, Overlays, Sprite, Style, Theme, View};
use std::sync::Arc;

/// The world of [`collision`] and [`moving`], m.
pub const WORLD: Vector = Vector::new(16.0, 9.0);

/// A view of that world for a small picture.
pub fn view(theme: Theme, show: &[Overlay], color_by: ColorBy) -> View {
    let materials = ["ice", "steel", "wood"].map(str::to_owned).to_vec();
    let plain = plain(theme);
    let look = Look { show: show.iter().copied().collect(), color_by, ..plain.look };
    View::new(WORLD, Style { look, top_speed: 7.5, materials, ..plain }).unwrap()
}

/// A style with arrow scales that suit the bodies of [`collision`].
pub fn plain(theme: Theme) -> Style {
    let look = Look { size: [640, 360], theme, show: Overlays::default(), ..Look::default() };
    Style { look, top_force: 20.0, top_impulse: 5.0, ..Style::default() }
}

/// A style for pictures of another size.
pub fn resized(size: [u32; 2], style: Style) -> Style {
    Style { look: Look { size, ..style.look }, ..style }
}

/// Two colliding boxes, some others, and four walls.
pub fn collision() -> Frame {
    let mut sprites = walls();
    sprites.push(sprite(4, "c", "steel", [4.5, 3.0, 2.0, 1.5], [3.0, 0.5]));
    sprites.push(sprite(5, "b", "wood", [6.4, 3.75, 1.5, 1.5], [-2.0, -1.0]));
    sprites.push(sprite(6, "floating", "", [2.0, 6.0, 0.5, 0.5], [0.0, 0.0]));
    sprites.push(sprite(7, "Δ", "ice", [10.0, 8.0, 1.0, 1.0], [7.5, 0.0]));
    sprites.push(sprite(8, "hull", "steel", [10.25, 7.2, 3.0, 0.8], [0.0, -4.0]));
    sprites.push(sprite(9, "leaving", "wood", [15.5, 1.0, 2.0, 1.0], [20.0, 0.0]));
    sprites.push(Sprite {
        appearance: Arc::new(Appearance { mass: f64::INFINITY, force: Vector::ZERO, ..appearance(10, "anchor", "") }),
        ..sprite(10, "", "", [11.0, 2.0, 2.5, 1.5], [0.0, 0.0])
    });
    for sprite in &mut sprites[4..] {
        sprite.trail = trail(sprite);
    }
    let collisions = vec![collision_between([&sprites[4], &sprites[5]])];
    Frame { step: 75, time: 1.25, sprites, collisions }
}

/// Boxes that move on straight lines and bounce between the walls, at 60 steps per second.
pub fn moving(count: u32, step: u64) -> Frame {
    let mut sprites = walls();
    let time = step as f64 / 60.0;
    for number in 0..count {
        let part = |k: u32| f64::from((number * k + 3) % 97) / 97.0;
        let (width, height) = (0.4 + part(31), 0.4 + part(57));
        let velocity = [6.0 * part(11) - 3.0, 6.0 * part(23) - 3.0];
        let x = reflected(part(41) * 15.0 + velocity[0] * time, WORLD.x - width);
        let y = reflected(part(73) * 8.0 + velocity[1] * time, WORLD.y - height);
        sprites.push(sprite(number + 4, &format!("#{number}"), "steel", [x, y, width, height], velocity));
    }
    Frame { step, time, sprites, collisions: Vec::new() }
}

/// Reflects a coordinate into 0 to `range`, as in uniform motion between two walls.
fn reflected(position: f64, range: f64) -> f64 {
    let position = position.rem_euclid(2.0 * range);
    if position < range { position } else { 2.0 * range - position }
}

fn walls() -> Vec<Sprite> {
    let (x, y) = (WORLD.x, WORLD.y);
    let walls = [
        ("wall-top", [-1.0, -1.0, x + 2.0, 1.0]),
        ("wall-bottom", [-1.0, y, x + 2.0, 1.0]),
        ("wall-left", [-1.0, 0.0, 1.0, y]),
        ("wall-right", [x, 0.0, 1.0, y]),
    ];
    let wall = |id: u32, name: &str| Appearance {
        mass: f64::INFINITY,
        force: Vector::ZERO,
        is_wall: true,
        ..appearance(id, name, "")
    };
    let sprites = walls.iter().zip(0..).map(|((name, rect), id)| Sprite {
        appearance: Arc::new(wall(id, name)),
        ..sprite(id, name, "", *rect, [0.0, 0.0])
    });
    sprites.collect()
}

fn sprite(id: u32, name: &str, material: &str, [x, y, width, height]: [f64; 4], [vx, vy]: [f64; 2]) -> Sprite {
    Sprite {
        appearance: Arc::new(appearance(id, name, material)),
        rect: Rect::new(Vector::new(x, y), width, height),
        velocity: Vector::new(vx, vy),
        trail: Vec::new(),
    }
}

fn appearance(id: u32, name: &str, material: &str) -> Appearance {
    let force = Vector::new(0.0, 9.81);
    Appearance {
        id,
        name: name.into(),
        material: material.into(),
        color: None,
        image: None,
        mass: 1.0,
        force,
        is_wall: false,
    }
}

/// The positions in the last half second of a body in free fall with this velocity.
fn trail(sprite: &Sprite) -> Vec<Vector> {
    let fallen = |ago: f64| Vector::new(0.0, 4.9 * ago * ago);
    let position = |ago: f64| sprite.rect.center().sub(sprite.velocity.mult(ago)).add(fallen(ago));
    (0..=30).rev().map(|step| position(f64::from(step) / 60.0)).collect()
}

fn collision_between([c, b]: [&Sprite; 2]) -> Collision {
    let mut collision = any_collision();
    collision.step = 74;
    collision.time = 0.0;
    collision.instant = 74.0 / 60.0;
    collision.axis = Axis::X;
    collision.bodies = [c.appearance.id, b.appearance.id];
    collision.rects = [c.rect, b.rect];
    collision.normal = Vector::new(-1.0, 0.0);
    collision.penetration = Vector::new(c.rect.origin.x - b.rect.origin.x + c.rect.width(), 0.0).mult(-1.0);
    collision.shares = [0.6, 0.4];
    collision.impulse = 5.0;
    collision.restitution = 1.0;
    collision.normal_velocity = [b.velocity.x - c.velocity.x, c.velocity.x - b.velocity.x];
    collision.before = [c.velocity, b.velocity];
    collision.after = [b.velocity, c.velocity];
    collision
}

/// The first collision of two boxes that approach, in the handout solver.
fn any_collision() -> Collision {
    let mut engine = Engine::new(EngineConfig::new(SolverKind::Handout, 60.0));
    for (name, x, vx) in [("a", 0.0, 1.0), ("b", 1.0, -1.0)] {
        let spawn = Spawn::new(name, Rect::new(Vector::new(x, 0.0), 1.0, 1.0), 1.0);
        engine.apply(&Event::Spawn(spawn.with_velocity(Vector::new(vx, 0.0))));
    }
    let mut collisions = Vec::new();
    engine.step(&mut collisions).expect("finite numbers");
    collisions.remove(0)
}
