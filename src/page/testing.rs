//! Sessions, recordings and comparisons for tests.

use crate::{LiveVerdict, Session};
use rebond::{LiveEvents, OnBadEvent, RecordOptions, parse_scene};
use std::sync::{Arc, Mutex};

/// Two boxes in a room.
pub const ROOM: &str = "[world]\nwalls = true\ngravity = [0.0, 9.81]\n[run]\nsteps = 120\n[restitution]\ndefault = 0.8\n\
                    [[spawn]]\nname = \"c\"\nat = [2.0, 3.0]\nsize = [1.0, 1.0]\nmass = 2.0\nvelocity = [3.0, -1.0]\n\
                    [[spawn]]\nat = [9.0, 3.0]\nsize = [2.0, 1.0]\nmass = 4.0\nmaterial = \"steel\"\n";

pub fn room() -> Session {
    Session::new("room.toml", ROOM).unwrap()
}

/// A file in memory.
#[derive(Clone, Default)]
pub struct File(pub Arc<Mutex<Vec<u8>>>);

impl std::io::Write for File {
    fn write(&mut self, bytes: &[u8]) -> std::io::Result<usize> {
        self.0.lock().unwrap().write(bytes)
    }
    fn flush(&mut self) -> std::io::Result<()> {
        Ok(())
    }
}

/// The recording that `rebond record SCENE --events LINES` writes.
pub fn recorded(name: &str, scene: &str, lines: &str) -> Vec<u8> {
    let scene = parse_scene(name, scene).unwrap();
    let options = RecordOptions::complete(&scene);
    let mut live = LiveEvents::new(lines.as_bytes(), OnBadEvent::Fail, options.steps);
    let file = File::default();
    // Without lines it is `rebond record SCENE`, whose recording has no note of live events.
    let live = if lines.is_empty() { None } else { Some(&mut live) };
    rebond::record(&scene, options, live, file.clone(), |_| ()).unwrap();
    file.0.lock().unwrap().clone()
}

pub fn saved(session: &Session) -> Vec<u8> {
    let mut save = session.save().unwrap();
    loop {
        if let Some(file) = save.advance(7).unwrap() {
            return file;
        }
    }
}

/// The bits of all positions and velocities.
pub fn bits(session: &Session) -> Vec<[u64; 4]> {
    let bodies = session.bodies().iter();
    bodies.map(|b| [b.rect.origin.x, b.rect.origin.y, b.velocity.x, b.velocity.y].map(f64::to_bits)).collect()
}

pub fn steps(session: &mut Session, count: u64) {
    (0..count).for_each(|_| session.step());
}

pub fn go_to(session: &mut Session, step: u64) {
    session.go_to(step);
    while !session.advance(5) {}
}

pub fn names(session: &Session) -> Vec<String> {
    session.bodies().iter().map(|body| body.name.clone()).filter(|name| !name.starts_with("wall")).collect()
}

pub fn click(x: f64, y: f64) -> String {
    format!("{{\"click\": {{\"at\": [{x:?}, {y:?}], \"spawn\": {{\"size\": [1.0, 1.0], \"mass\": 1.0}}}}}}")
}

pub fn verdict(file: Vec<u8>) -> String {
    let mut verdict = LiveVerdict::new(&file.into()).unwrap();
    while !verdict.advance(10).unwrap() {}
    verdict.verdict().to_string()
}
