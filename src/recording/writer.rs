use std::io::Write;

use crate::physics::{Body, Engine, World};

use super::{
    BodyTable, Change, End, Error, Header, Keyframe, RecordedEvent, RecordedState, StateDigest, cdr, clock,
    container::Container,
    identity::IdentityChain,
    limits,
    messages::{BodiesMessage, EventMessage},
    metadata,
    topic::Topic,
};

/// Streams a recording out while the engine runs. Memory does not grow with the run.
///
/// For each step: the events applied to it, then [`Writer::state`]. A writer dropped
/// without [`Writer::finish`] leaves a file that is readable up to its last flush, which
/// happens after every batch of events and about every second of simulated time.
pub struct Writer<W: Write> {
    container: Container<W>,
    identity: IdentityChain,
    rate: f64,
    every: u64,
    table: BodyTable,
    last_step: Option<u64>,
    spawns: u64,
    events: u64,
    unflushed_events: bool,
    state: RecordedState,
    digest: StateDigest,
    bytes: Vec<u8>,
}

/// How a run ended, as the one who ran it knows.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Outcome {
    /// Collisions that gave an impulse.
    pub collisions: u64,
    /// The engine's error, if the run ended in one.
    pub error: Option<String>,
}

/// What [`Writer::finish`] gives back.
#[derive(Debug)]
pub struct Finished<W> {
    /// What was written at the end.
    pub end: End,
    /// Where it was written to.
    pub write: W,
}

impl<W: Write + Send + 'static> Writer<W> {
    /// Writes the head of a recording.
    ///
    /// # Errors
    /// If writing fails or the scene is too large.
    pub fn new(write: W, header: &Header) -> Result<Writer<W>, Error> {
        check("the scene's text in bytes", header.scene.text.len(), limits::SCENE_BYTES)?;
        check("the scene's file name in bytes", header.scene.file_name.len(), limits::STRING_BYTES)?;
        let mut container = Container::new(write, metadata::of_header(header), &header.scene)?;
        container.flush()?;
        Ok(Writer {
            container,
            identity: IdentityChain::new(header),
            rate: header.settings.rate,
            every: header.every,
            table: BodyTable::default(),
            last_step: None,
            spawns: 0,
            events: 0,
            unflushed_events: false,
            state: RecordedState::default(),
            digest: StateDigest::default(),
            bytes: Vec::new(),
        })
    }

    /// Records one event that was applied to the present step.
    ///
    /// # Errors
    /// If writing fails or a name is too long.
    pub fn event(&mut self, event: &RecordedEvent) -> Result<(), Error> {
        if let Change::Spawn { spawn, color, .. } = &event.change {
            let color = color.as_deref().unwrap_or_default();
            for text in [spawn.name.as_str(), &spawn.material, color] {
                check("a name in bytes", text.len(), limits::STRING_BYTES)?;
            }
            self.spawns += 1;
        }
        self.table.apply(&event.change);
        self.events += 1;
        self.unflushed_events = true;
        cdr::encode(&EventMessage::new(event), &mut self.bytes);
        self.identity.event(&self.bytes);
        self.put(Topic::Events, event.step)
    }

    /// Records the state of the engine's present step, with a keyframe when one is due.
    ///
    /// # Errors
    /// If writing fails, there are too many bodies, or events were not recorded.
    pub fn state(&mut self, engine: &Engine) -> Result<(), Error> {
        let step = engine.present_step();
        self.check_order(step)?;
        check("the number of bodies", engine.world().bodies.len(), limits::BODIES)?;
        let second = clock::steps_per_second(self.rate);
        if step.is_multiple_of(second) {
            self.keyframe(engine)?;
        }
        self.sample(step, engine.world())?;
        self.identity.state(step, self.state.digest);
        self.state.encode(&mut self.bytes);
        self.put(Topic::States, step)?;
        if self.unflushed_events || (step + 1).is_multiple_of(second) {
            self.unflushed_events = false;
            self.container.flush()?;
        }
        Ok(())
    }

    /// Writes the end of the recording and its index.
    ///
    /// # Errors
    /// If writing fails; the file is then readable up to its last flush.
    pub fn finish(self, outcome: &Outcome) -> Result<Finished<W>, Error> {
        let end = End {
            steps: self.last_step.unwrap_or(0),
            collisions: outcome.collisions,
            bodies: self.spawns,
            events: self.events,
            error: outcome.error.clone(),
            identity: self.identity.identity(),
        };
        let write = self.container.finish(metadata::of_end(&end))?;
        Ok(Finished { end, write })
    }

    /// A keyframe too large for one record is left out: a seek then starts before it.
    fn keyframe(&mut self, engine: &Engine) -> Result<(), Error> {
        let step = engine.present_step();
        let keyframe = Keyframe::new(engine.snapshot(), &self.table);
        cdr::encode(&BodiesMessage::new(&keyframe), &mut self.bytes);
        match self.bytes.len() <= limits::MESSAGE_BYTES {
            true => self.put(Topic::Bodies, step),
            false => Ok(()),
        }
    }

    /// Fills the state and its digest from the world.
    fn sample(&mut self, step: u64, world: &World) -> Result<(), Error> {
        if world.bodies.len() != self.table.bodies().len() {
            return Err(Error::Unrecorded { step });
        }
        let full = step.is_multiple_of(self.every);
        self.state.clear();
        self.digest.clear();
        for (place, body) in world.bodies.iter().enumerate() {
            let numbers = numbers(body);
            self.digest.body(body.id, numbers);
            if full && !(body.is_infinite() && self.table.bodies()[place].stands_at(numbers)) {
                self.state.push(body.id, numbers);
            }
        }
        self.state.step = step;
        self.state.digest = self.digest.value();
        Ok(())
    }

    fn check_order(&mut self, step: u64) -> Result<(), Error> {
        let due = self.last_step.map_or(0, |last| last + 1);
        if step != due {
            return Err(Error::OutOfOrder { due, found: step });
        }
        self.last_step = Some(step);
        Ok(())
    }

    fn put(&mut self, topic: Topic, step: u64) -> Result<(), Error> {
        self.container.message(topic, clock::nanoseconds(step, self.rate), &self.bytes)
    }
}

/// What a state says of a body: x, y (m), vx, vy (m/s).
pub fn numbers(body: &Body) -> [f64; 4] {
    let (position, velocity) = (body.rect.origin, body.velocity);
    [position.x, position.y, velocity.x, velocity.y]
}

fn check(what: &'static str, found: usize, limit: usize) -> Result<(), Error> {
    match found <= limit {
        true => Ok(()),
        false => Err(Error::TooLarge { what, found: found as u64, limit: limit as u64 }),
    }
}
