use crate::columns::{ColorKey, push_body, push_collision};
use crate::event_lines::{EventLines, MAX_LINES};
use crate::film::added_lines;
use crate::history::{MAX_RECENT, Row, keep_last};
use crate::scene_text::{all_messages, retimed, with_events, with_steps, with_value};
use crate::spawned_bodies::{SpawnedBodies, spawned};
use crate::undo::{UndoList, UndoPoint};
use crate::{EnergyStrip, EventLine, FigureKind, History, Save, collision_figure};
use rebond::internals::picture::{EnergySample, body_color};
use rebond::internals::replay::RunSnapshot;
use rebond::internals::scene::{Action, Blueprint, Input, SpawnRequest};
use rebond::recordings::{BodyInfo, Change, Paint};
use rebond::{Body, BodyId, Collision, Language, Run, Scene, SceneError, StepError, Theme, Vector, parse_scene};
use serde_json::json;
use std::rc::Rc;
use std::sync::Arc;

/// The largest number of bodies alive.
pub const MAX_BODIES: usize = 20_000;

/// The largest limit of collisions within one step, which lasts seconds.
const MAX_EVENTS_PER_STEP: u64 = 10_000_000;

/// Bytes of snapshots of a session.
const HISTORY_BYTES: usize = 48 << 20;

/// The lines that are listed if none of a file is accepted.
const MAX_LISTED: usize = 5;

/// The state that an event changes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum When {
    /// The present one, which is computed again.
    Now,
    /// The next one.
    Next,
}

/// A scene and lines of events, and the run that follows from them.
///
/// The states are those that `rebond record` writes for the same scene and lines.
pub struct Session {
    scene: Rc<Scene>,
    lines: EventLines,
    run: Run,
    history: History,
    /// Energy and momentum.
    pub strip: EnergyStrip,
    spawned: SpawnedBodies,
    /// The collisions of the last step that changed a velocity or a place.
    pub collisions: Vec<Collision>,
    /// The last ones of all steps until now.
    recent: Vec<Row>,
    /// The last step that was reached.
    end: u64,
    /// The step to go to.
    target: u64,
    failure: Option<String>,
    refused: Vec<String>,
    /// The events after the present step that the last event removed.
    removed: usize,
    undo: UndoList,
    top_speed: f64,
    /// The word for a box without a name, before its number.
    pub box_name: &'static str,
}

impl Session {
    /// A session of the scene `text` at step 0; messages call it `name`.
    ///
    /// # Errors
    /// The messages of the parser, or of a scene that is too large for the page.
    pub fn new(name: &str, text: &str) -> Result<Session, String> {
        let scene = parse_scene(name, text).map_err(|error| all_messages(&error))?;
        Session::with_lines(Rc::new(scene), EventLines::default())
    }

    fn with_lines(scene: Rc<Scene>, lines: EventLines) -> Result<Session, String> {
        let spawns = scene.inputs.iter().filter(|input| !matches!(input.action, Action::Delete { .. })).count();
        if spawns > MAX_BODIES {
            return Err(format!("the scene spawns {spawns} bodies; the page shows at most {MAX_BODIES}"));
        }
        let limit = scene.run.events_per_step;
        if limit > MAX_EVENTS_PER_STEP {
            return Err(format!(
                "the scene allows {limit} events per step; the page allows at most {MAX_EVENTS_PER_STEP}: run it with rebond record"
            ));
        }
        let mut session = Session {
            run: Run::new(&scene),
            scene,
            lines,
            history: History::new(HISTORY_BYTES),
            strip: EnergyStrip::new(),
            spawned: SpawnedBodies::default(),
            collisions: Vec::new(),
            recent: Vec::new(),
            end: 0,
            target: 0,
            failure: None,
            refused: Vec::new(),
            removed: 0,
            undo: UndoList::default(),
            top_speed: 0.0,
            box_name: "box",
        };
        session.rewind(0);
        session.failure.clone().map_or(Ok(session), Err)
    }

    /// This session in the place of another one, to which undo returns.
    pub fn in_place_of(mut self, mut before: Session) -> Session {
        before.remember(Some([before.step_now(), before.end]));
        self.undo = before.undo;
        self
    }

    /// The scene.
    pub fn scene(&self) -> &Scene {
        &self.scene
    }

    /// The present step.
    pub fn step_now(&self) -> u64 {
        self.run.engine().current_step()
    }

    /// The last step that was reached.
    pub fn end(&self) -> u64 {
        self.end
    }

    /// The bodies alive.
    pub fn bodies(&self) -> &[Body] {
        &self.run.engine().world().bodies
    }

    /// The error that ended the run, if there is one. The session stays: an earlier step can be shown, an event undone.
    pub fn failure(&self) -> Option<&str> {
        self.failure.as_deref()
    }

    /// Messages about lines that were refused and dropped since the last call.
    pub fn take_refused(&mut self) -> Vec<String> {
        std::mem::take(&mut self.refused)
    }

    /// The number of later events that an event has removed since the last call.
    pub fn take_removed(&mut self) -> usize {
        std::mem::take(&mut self.removed)
    }

    /// The bytes of its snapshots.
    pub fn history_bytes(&self) -> usize {
        self.history.bytes()
    }

    /// A snapshot of the run.
    pub fn snapshot(&self) -> RunSnapshot {
        self.run.snapshot()
    }

    /// The lines of events, as `rebond record --events` reads them.
    pub fn lines(&self) -> String {
        self.lines.text()
    }

    /// Replaces the lines of events, and starts again at step 0. Lines that are refused are dropped and reported.
    ///
    /// # Errors
    /// The messages of a text whose lines are all refused; the session is then as before.
    pub fn set_lines(&mut self, text: &str) -> Result<(), String> {
        let (lines, mut refused) = EventLines::parse(text);
        if lines.is_empty() && !refused.is_empty() {
            refused.truncate(MAX_LISTED);
            return Err(refused.join("\n"));
        }
        self.remember(None);
        self.lines = lines;
        self.refused.extend(refused);
        self.end = 0;
        self.strip = EnergyStrip::new();
        self.history.forget_from(0);
        self.rewind(0);
        Ok(())
    }

    /// Advances by one step, and applies the events of the next one. A line that is refused is dropped and reported.
    /// An error is kept as the [failure](Session::failure); nothing happens after one.
    pub fn step(&mut self) {
        if self.failure.is_some() {
            return;
        }
        self.collisions.clear();
        let stepped: Result<(), StepError> = self.run.step(&mut self.collisions);
        if let Err(error) = stepped {
            self.failure = Some(error.to_string());
            return;
        }
        self.collisions.retain(changes_something);
        let rows: Vec<Row> =
            self.collisions.iter().map(|collision| Row::of(&self.spawned.in_order_of_figures(collision))).collect();
        self.recent.extend(rows);
        keep_last(&mut self.recent, MAX_RECENT);
        self.apply_lines();
        self.end = self.end.max(self.step_now());
    }

    /// Sets the step to go to, from the nearest snapshot if it is before the present one.
    pub fn go_to(&mut self, step: u64) {
        self.target = step;
        if step < self.step_now() {
            self.rewind(step);
        }
    }

    /// Goes to an earlier step, as if the session had never been beyond `end`.
    pub fn go_back(&mut self, step: u64, end: u64) {
        self.go_to(step);
        self.end = end;
        self.strip.forget_from(end + 1);
    }

    /// Makes up to `steps` steps to the one that was set, and returns true if it is reached or cannot be.
    pub fn advance(&mut self, steps: u64) -> bool {
        for _ in 0..steps {
            if self.step_now() >= self.target || self.failure.is_some() {
                break;
            }
            self.step();
        }
        let is_done = self.step_now() >= self.target || self.failure.is_some();
        if is_done {
            self.target = self.step_now();
        }
        is_done
    }

    /// Adds an event, a line of JSON whose step is ignored. What was after the present step is forgotten. A body
    /// without a name gets one, so that it can be thrown later.
    ///
    /// # Errors
    /// The message of a line that is refused; the session is then as before.
    pub fn event(&mut self, text: &str, when: When) -> Result<(), String> {
        let step = self.step_of(when);
        let mut line = EventLine::parse(text, Some(step))?;
        let name = self.free_name(1);
        if let Some(body) = line.blueprint_mut() {
            body.name.get_or_insert(name);
        }
        self.add(vec![line], when)
    }

    /// Moves a body, or throws it: deletes it and spawns it again with the same name and properties, in one step. A
    /// body with a name `#K`, which no event may give, gets another one, which is returned.
    ///
    /// # Errors
    /// If no such body is alive, or its new state is refused; the session is then as before.
    pub fn throw(&mut self, name: &str, at: [f64; 2], velocity: [f64; 2], when: When) -> Result<String, String> {
        let body =
            self.bodies().iter().find(|body| body.name == name).ok_or_else(|| format!("{name:?} is not alive"))?;
        let info = self.spawned.get(body.id).ok_or("the body is unknown")?.clone();
        let new_name = match name.strip_prefix('#') {
            Some(number) => self.free_name(number.parse().unwrap_or(1)),
            None => name.to_owned(),
        };
        let spawn = &info.spawn;
        let blueprint = Blueprint {
            name: Some(new_name.clone()),
            size: [spawn.rect.width(), spawn.rect.height()],
            mass: spawn.mass,
            velocity: Vector::new(velocity[0], velocity[1]),
            force: spawn.force,
            material: spawn.material.clone(),
            paint: Paint::new(Some(&body_color(&info).to_string()), info.paint.image()),
        };
        let step = self.step_of(when);
        let request = SpawnRequest { origin: Vector::new(at[0], at[1]), blueprint };
        let spawn = EventLine { step, action: Action::Spawn(request) };
        // The parser checks the numbers.
        EventLine::parse(&spawn.json(), None)?;
        let mut lines = self.lines_before_spawn(step);
        lines.throw(name, spawn);
        let count = self.bodies().len();
        let is_dropped = |session: &Session| {
            session.bodies().len() == count && session.bodies().iter().any(|body| body.name == new_name)
        };
        self.replace(lines, when, is_dropped)?;
        Ok(new_name)
    }

    /// The lines until `step`, before a spawn is added. Clicks of that step are replaced by their effect if it is
    /// known: clicks come after spawns, so they would hit a body that is spawned at their place later.
    fn lines_before_spawn(&self, step: u64) -> EventLines {
        let mut lines = self.lines.until(step);
        let is_click = |line: &EventLine| line.step == step && matches!(line.action, Action::Click { .. });
        if lines.iter().any(is_click)
            && let Some(done) = self.done_at(step)
        {
            lines.replace_from(step, done);
        }
        lines
    }

    /// The effect of the lines of `step`, as deletes and spawns in the order of creation. A body that they spawn and
    /// delete is left out.
    fn done_at(&self, step: u64) -> Option<Vec<EventLine>> {
        let run = self.run_before(step)?;
        let events = |live: Vec<Input>| run.clone().apply_inputs(live, |_| Ok(())).ok();
        let of_scene: Vec<BodyId> = events(Vec::new())?.iter().filter_map(spawned).map(|info| info.id).collect();
        let mut events = events(self.lines.inputs_at(step))?;
        let deleted = |id: BodyId| events.iter().any(|event| event.change == Change::Delete { id });
        let made: Vec<Arc<BodyInfo>> =
            events.iter().filter_map(spawned).filter(|info| !of_scene.contains(&info.id)).collect();
        let gone: Vec<BodyId> = made.iter().map(|info| info.id).filter(|id| deleted(*id)).collect();
        events.retain(|event| match &event.change {
            Change::Spawn(info) => !gone.contains(&info.id),
            Change::Delete { id } => !gone.contains(id),
        });
        let mut lines = added_lines(&self.scene, &run, &events);
        // Without bodies that are left out, the later ones have other ids: their colours stay.
        for body in lines.iter_mut().filter_map(EventLine::blueprint_mut).filter(|_| !gone.is_empty()) {
            let info = made.iter().find(|info| Some(&info.spawn.name) == body.name.as_ref());
            if let (None, Some(info)) = (body.paint.color_text(), info) {
                body.paint = Paint::new(Some(&body_color(info).to_string()), body.paint.image());
            }
        }
        Some(lines)
    }

    /// The run at `step`, before the events of that step.
    fn run_before(&self, step: u64) -> Option<Run> {
        let earlier = step.checked_sub(1).and_then(|last| self.history.nearest(last));
        let restored = earlier.and_then(|snapshot| Run::restore(&self.scene, snapshot).ok());
        // A snapshot has the events of its step.
        let mut has_events = restored.is_some();
        let mut run = restored.unwrap_or_else(|| Run::new(&self.scene));
        while run.engine().current_step() < step {
            if !has_events {
                run.apply_inputs(self.lines.inputs_at(run.engine().current_step()), |_| Ok(())).ok()?;
            }
            run.step(&mut Vec::new()).ok()?;
            has_events = false;
        }
        Some(run)
    }

    /// Returns to the session before the last event, setting or scene. The present time stays to be reached, or the
    /// step at which the scene was left; see [`Session::advance`].
    pub fn undo(&mut self) -> bool {
        let Some(UndoPoint { scene, lines, left_at }) = self.undo.pop() else { return false };
        let now = self.target.max(self.step_now());
        if Rc::ptr_eq(&scene, &self.scene) {
            self.change_lines(lines);
            self.target = now;
            return true;
        }
        let [from, to] = [self.scene.run.rate, scene.run.rate];
        let [target, end] = left_at.unwrap_or_else(|| [now, self.end].map(|step| retimed(step, from, to)));
        let Ok(before) = Session::with_lines(scene, lines) else { return false };
        *self = Session { undo: std::mem::take(&mut self.undo), target, end, ..before };
        true
    }

    /// A session with a changed scene and the same events at the same times in seconds, to be
    /// [advanced](Session::advance) to the same time. `path` is a key such as `world.gravity`.
    ///
    /// # Errors
    /// The message of a value that the scene does not accept.
    pub fn with_setting(&self, path: &str, value: &str) -> Result<Session, String> {
        let scene = with_value(&self.scene, path, value)?;
        let [from, to] = [self.scene.run.rate, scene.run.rate];
        let mut session = Session::with_lines(Rc::new(scene), self.lines.retimed(from, to))?;
        session.undo.clone_from(&self.undo);
        session.undo.push(UndoPoint { scene: self.scene.clone(), lines: self.lines.clone(), left_at: None });
        session.target = retimed(self.target.max(self.step_now()), from, to);
        session.end = retimed(self.end, from, to);
        Ok(session)
    }

    /// The session with the other solver, beside this one: all that can be undone here can be undone there, too.
    ///
    /// # Errors
    /// The message of a scene that the other solver does not accept.
    pub fn beside(&self) -> Result<Session, String> {
        let with_other_solver = |scene: &Scene| {
            let solver = if scene.run.solver.name() == "handout" { "\"event-driven\"" } else { "\"handout\"" };
            with_value(scene, "run.solver", solver).map(Rc::new)
        };
        let scene = with_other_solver(&self.scene)?;
        let mut session = Session::with_lines(scene.clone(), self.lines.clone())?;
        session.undo = self.undo.with_changed_scenes(&self.scene, &scene, with_other_solver)?;
        session.target = self.target.max(self.step_now());
        session.end = self.end;
        Ok(session)
    }

    /// The last step of the recording: the end of the scene as long as the session stays within it, else the last step
    /// that was reached. After an error the step that cannot be completed is part of it.
    pub fn recorded_steps(&self) -> u64 {
        let last_line = self.lines.last().map_or(0, |line| line.step);
        let failed = if self.failure.is_some() { self.step_now() + 1 } else { 0 };
        self.scene.run.steps.max(self.end).max(last_line).max(failed)
    }

    /// The scene of the recording: that of the session with the number of steps of the recording.
    ///
    /// # Errors
    /// If its text cannot be changed.
    pub fn recorded_scene(&self) -> Result<Scene, String> {
        let text = with_steps(&self.scene, self.recorded_steps())?;
        parse_scene(&self.scene.source.path, &text).map_err(|error| error.to_string())
    }

    /// Starts the recording of the session.
    ///
    /// # Errors
    /// If it cannot be started.
    pub fn save(&self) -> Result<Save, String> {
        Save::new(&self.recorded_scene()?, self.lines())
    }

    /// The session as one scene, with its events as tables.
    ///
    /// # Errors
    /// If the tables cannot be appended.
    pub fn scene_with_events(&self) -> Result<String, String> {
        with_events(&self.scene, &self.lines, self.recorded_steps())
    }

    /// Energy and momentum of the present state.
    pub fn energy(&self) -> EnergySample {
        let engine = self.run.engine();
        EnergySample::of(engine.world(), self.step_now() as f64 / self.scene.run.rate)
    }

    /// Appends the columns of the bodies `offset` seconds after the present state, which the event-driven solver
    /// defines between two steps.
    pub fn fill_columns(&self, offset: f64, key: ColorKey, columns: &mut Vec<f64>) {
        let engine = self.run.engine();
        let between = if offset > 0.0 { engine.world_after(offset, &mut Vec::new()).ok() } else { None };
        let bodies = between.as_ref().map_or(self.bodies(), |world| &world.bodies);
        let materials = if key == ColorKey::Material { self.spawned.materials() } else { Vec::new() };
        for body in bodies {
            if let Some(info) = self.spawned.get(body.id) {
                push_body(columns, info, &body.rect, body.velocity, key, self.top_speed, &materials);
            }
        }
    }

    /// Names and materials of the bodies alive, as JSON.
    pub fn names(&self) -> String {
        let infos = self.bodies().iter().filter_map(|body| self.spawned.get(body.id));
        let names = infos.map(|info| [info.spawn.name.as_str(), &info.spawn.material]);
        serde_json::to_string(&names.collect::<Vec<_>>()).unwrap_or_default()
    }

    /// Returns true if an event made the body of this name, rather than the scene.
    pub fn is_made_by_event(&self, name: &str) -> bool {
        let is_named = |body: &Blueprint| body.name.as_deref() == Some(name);
        let mut until_now = self.lines.iter().take_while(|line| line.step <= self.step_now());
        until_now.any(|line| line.blueprint().is_some_and(is_named))
    }

    /// Appends the columns of the collisions of the last step.
    pub fn fill_collisions(&self, columns: &mut Vec<f64>) {
        self.collisions
            .iter()
            .for_each(|collision| push_collision(columns, &self.spawned.in_order_of_figures(collision)));
    }

    /// The last collisions as JSON: instant, names of c and b, normal on c, e, vn before and after, impulse.
    pub fn recent_collisions(&self) -> String {
        let rows = self.recent.iter().map(|row| {
            let [c, b] = row.bodies.map(|id| self.spawned.name(id));
            json!([row.instant, c, b, row.normal.x, row.normal.y, row.e, row.vn[0], row.vn[1], row.impulse])
        });
        serde_json::Value::from_iter(rows).to_string()
    }

    /// Draws a figure of a collision of the last step as SVG.
    ///
    /// # Errors
    /// If there is no such collision.
    pub fn figure(&self, index: usize, kind: FigureKind, theme: Theme, language: Language) -> Result<Vec<u8>, String> {
        let collision = self.collisions.get(index).ok_or("there is no collision in this step")?;
        let [c, b] = collision.bodies.map(|id| self.spawned.get(id).map(Arc::as_ref));
        let (Some(c), Some(b)) = (c, b) else { return Err("the bodies of the collision are unknown".into()) };
        collision_figure(collision, [c, b], self.scene.gravity, kind, theme, language)
    }

    /// A name that no body alive and no event has, numbered from `number` on.
    fn free_name(&self, number: u64) -> String {
        let is_taken = |name: &str| {
            let is_named = |body: &Blueprint| body.name.as_deref() == Some(name);
            self.bodies().iter().any(|body| body.name == name)
                || self.lines.iter().any(|line| line.blueprint().is_some_and(is_named))
                || self.spawned.has_name(name)
        };
        (number..).map(|number| format!("{} {number}", self.box_name)).find(|name| !is_taken(name)).unwrap_or_default()
    }

    fn step_of(&self, when: When) -> u64 {
        match when {
            When::Now => self.step_now(),
            When::Next => self.step_now() + 1,
        }
    }

    fn add(&mut self, added: Vec<EventLine>, when: When) -> Result<(), String> {
        let spawns = added.iter().filter(|line| line.blueprint().is_some()).count();
        if self.bodies().len() + spawns > MAX_BODIES {
            return Err(format!("the page shows at most {MAX_BODIES} bodies"));
        }
        let step = self.step_of(when);
        let has_spawn = added.iter().any(|line| matches!(line.action, Action::Spawn(_)));
        let mut lines = if has_spawn { self.lines_before_spawn(step) } else { self.lines.until(step) };
        lines.extend(added);
        self.replace(lines, when, |_| true)
    }

    /// Sets the lines, which differ from the present ones from the step of `when` on, and forgets all later ones.
    /// If `is_as_meant` is false for the new present step, the session stays as before.
    fn replace(&mut self, lines: EventLines, when: When, is_as_meant: impl Fn(&Session) -> bool) -> Result<(), String> {
        if lines.len() > MAX_LINES {
            return Err(format!("the page keeps at most {MAX_LINES} events"));
        }
        let step = self.step_now();
        let last = self.step_of(when);
        self.remember(None);
        let before = std::mem::replace(&mut self.lines, lines);
        self.removed = before.iter().filter(|line| line.step > last).count();
        self.end = step;
        self.history.forget_from(last);
        self.strip.forget_from(last);
        if when == When::Next {
            return Ok(());
        }
        let reported = self.refused.len();
        self.remake(step);
        if self.refused.len() == reported && is_as_meant(self) {
            return Ok(());
        }
        let mut message = self.refused.split_off(reported).join("\n");
        if message.is_empty() {
            message = format!("a click of the scene at step {step} changes the body");
        }
        self.lines = before;
        self.removed = 0;
        self.undo.pop();
        self.remake(step);
        Err(message)
    }

    /// Computes the present step again, from the lines before it on.
    fn remake(&mut self, step: u64) {
        self.history.forget_from(step);
        self.strip.forget_from(step);
        self.rewind(step);
        while self.step_now() < step && self.failure.is_none() {
            self.step();
        }
    }

    /// Sets the lines and restarts from the last state that they leave as it is.
    fn change_lines(&mut self, lines: EventLines) {
        let first = self.lines.first_difference(&lines);
        self.lines = lines;
        self.history.forget_from(first);
        self.strip.forget_from(first);
        self.rewind(first.saturating_sub(1));
    }

    fn remember(&mut self, left_at: Option<[u64; 2]>) {
        self.undo.push(UndoPoint { scene: self.scene.clone(), lines: self.lines.clone(), left_at });
    }

    /// Goes back to the last snapshot at or before `step`.
    fn rewind(&mut self, step: u64) {
        self.failure = None;
        self.collisions.clear();
        let restored = self.history.nearest(step).and_then(|snapshot| Run::restore(&self.scene, snapshot).ok());
        let is_at_start = restored.is_none();
        self.run = restored.unwrap_or_else(|| Run::new(&self.scene));
        self.recent = if is_at_start { Vec::new() } else { self.history.recent(step) };
        self.spawned.forget_from(self.run.engine().next_id());
        if is_at_start {
            self.apply_lines();
        }
    }

    /// Applies the events of the present step.
    fn apply_lines(&mut self) {
        let step = self.step_now();
        let live = self.lines.inputs_at(step);
        let mut refused: Vec<(usize, String)> = Vec::new();
        let applied = self.run.apply_inputs(live, |error| {
            let message = error.diagnostics().map_or_else(|| error.to_string(), ToString::to_string);
            if let SceneError::Event { line, .. } = error {
                refused.push((line as usize, message));
            }
            Ok(())
        });
        refused.sort_by_key(|(index, _)| *index);
        for (index, message) in refused.into_iter().rev() {
            self.lines.remove(index);
            self.refused.push(message);
        }
        match applied {
            Ok(events) => self.spawned.add(&events),
            Err(error) => self.failure = Some(error.to_string()),
        }
        if self.failure.is_none() && self.history.wants(step) {
            self.history.keep(self.run.snapshot(), &self.recent);
        }
        if self.strip.wants(step) {
            self.strip.keep(step, &self.energy());
        }
        let speeds = self.bodies().iter().filter(|body| !body.is_infinite()).map(|body| body.velocity.norm());
        self.top_speed = speeds.fold(self.top_speed, |top, speed| if speed > top { speed } else { top });
    }
}

/// True if a collision changed a velocity, or a place by more than rounding.
fn changes_something(collision: &Collision) -> bool {
    let corners = collision.rects.iter().flat_map(|rect| [rect.origin, rect.far_corner()]);
    let reach = corners.fold(0.0, |reach, corner| if corner.norm() > reach { corner.norm() } else { reach });
    collision.impulse != 0.0 || collision.penetration.norm() > 1e-12 * reach
}
