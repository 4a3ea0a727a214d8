//! The functions that the page calls. Bytes go in by one buffer and out by another; a function that can fail returns 1
//! and leaves its message in the output, else 0.
//!
//! `which` is 0 for the session and 1 for the one beside it, with the other solver.

use crate::{
    BODY_COLUMNS, BUNDLED, COLLISION_COLUMNS, ColorKey, EnergyStrip, FigureKind, Film, LiveVerdict, Save, Session,
    When, draw, table,
};
use rebond::internals::table::Table;
use rebond::{Language, Theme, Verdict};
use serde_json::json;
use std::cell::{Cell, RefCell};

thread_local! {
    static SESSIONS: RefCell<[Option<Session>; 2]> = const { RefCell::new([None, None]) };
    static FILM: RefCell<Option<Film>> = const { RefCell::new(None) };
    static SAVE: RefCell<Option<Save>> = const { RefCell::new(None) };
    static VERDICT: RefCell<Option<LiveVerdict>> = const { RefCell::new(None) };
    static INPUT: RefCell<Vec<u8>> = const { RefCell::new(Vec::new()) };
    static OUTPUT: RefCell<Vec<u8>> = const { RefCell::new(Vec::new()) };
    static BOX_NAME: Cell<&'static str> = const { Cell::new("box") };
    static COLUMNS: RefCell<Vec<f64>> = const { RefCell::new(Vec::new()) };
}

const NO_SESSION: &str = "there is no session";

fn give(bytes: impl Into<Vec<u8>>) {
    OUTPUT.set(bytes.into());
}

fn answer<T: Into<Vec<u8>>>(result: Result<T, String>) -> i32 {
    let code = i32::from(result.is_err());
    match result {
        Ok(bytes) => give(bytes),
        Err(message) => give(message),
    }
    code
}

fn text() -> Result<String, String> {
    String::from_utf8(INPUT.take()).map_err(|_| "the file is not UTF-8 text".into())
}

fn with<T>(which: usize, f: impl FnOnce(&mut Session) -> Result<T, String>) -> Result<T, String> {
    SESSIONS
        .with_borrow_mut(|sessions| sessions.get_mut(which).and_then(Option::as_mut).map_or(Err(NO_SESSION.into()), f))
}

fn keep(which: usize, session: Session) -> Result<(), String> {
    SESSIONS.with_borrow_mut(|sessions| match sessions.get_mut(which) {
        Some(place) => {
            *place = Some(session);
            Ok(())
        }
        None => Err(NO_SESSION.into()),
    })
}

fn columns(fill: impl FnOnce(&mut Vec<f64>), width: usize) -> usize {
    COLUMNS.with_borrow_mut(|columns| {
        columns.clear();
        fill(columns);
        columns.len() / width
    })
}

fn when(now: u32) -> When {
    if now == 1 { When::Now } else { When::Next }
}

fn color_key(key: u32) -> ColorKey {
    match key {
        1 => ColorKey::Material,
        2 => ColorKey::Speed,
        _ => ColorKey::Body,
    }
}

/// Makes a message of a panic the output, so that the page can show it.
#[unsafe(no_mangle)]
pub extern "C" fn start() {
    std::panic::set_hook(Box::new(|panic| give(format!("internal error: {panic}"))));
}

/// Reserves `length` bytes of input and returns their address.
#[unsafe(no_mangle)]
pub extern "C" fn input(length: usize) -> *mut u8 {
    INPUT.with_borrow_mut(|input| {
        *input = vec![0; length];
        input.as_mut_ptr()
    })
}

/// The address of the output.
#[unsafe(no_mangle)]
pub extern "C" fn output() -> *const u8 {
    OUTPUT.with_borrow(|output| output.as_ptr())
}

/// The bytes of the output.
#[unsafe(no_mangle)]
pub extern "C" fn output_length() -> usize {
    OUTPUT.with_borrow(Vec::len)
}

/// The address of the columns that were filled last.
#[unsafe(no_mangle)]
pub extern "C" fn column_numbers() -> *const f64 {
    COLUMNS.with_borrow(|columns| columns.as_ptr())
}

/// The bundled scenes: a JSON array of names and texts.
#[unsafe(no_mangle)]
pub extern "C" fn bundled() {
    give(json!(BUNDLED).to_string());
}

/// Starts a session in the place of the present one, to which undo returns. The input is the name of the scene, a line
/// feed, and its text; before the text may be lines of events and a zero byte.
#[unsafe(no_mangle)]
pub extern "C" fn load(which: usize) -> i32 {
    let session = text().and_then(|text| {
        let (name, text) = text.split_once('\n').unwrap_or(("scene.toml", &text));
        let (lines, text) = text.split_once('\0').unwrap_or(("", text));
        let mut session = Session::new(name, text)?;
        if !lines.is_empty() {
            session.set_lines(lines)?;
        }
        Ok(session)
    });
    let replaced = session.and_then(|session| {
        let before = SESSIONS.with_borrow_mut(|sessions| sessions.get_mut(which).and_then(Option::take));
        keep(
            which,
            match before {
                Some(before) => session.in_place_of(before),
                None => session,
            },
        )
    });
    answer(replaced.map(|()| ""))
}

/// Starts the session with the other solver beside the first one.
#[unsafe(no_mangle)]
pub extern "C" fn beside() -> i32 {
    answer(with(0, |session| session.beside()).and_then(|session| keep(1, session)).map(|()| ""))
}

/// Ends a session.
#[unsafe(no_mangle)]
pub extern "C" fn unload(which: usize) {
    SESSIONS.with_borrow_mut(|sessions| sessions.get_mut(which).map(Option::take));
}

/// Replaces the lines of events by the input and starts again, if any of its lines is accepted.
#[unsafe(no_mangle)]
pub extern "C" fn set_lines(which: usize) -> i32 {
    answer(text().and_then(|text| with(which, |session| session.set_lines(&text).map(|()| ""))))
}

/// The state of a session, as JSON. Lines that were refused are reported once.
#[unsafe(no_mangle)]
pub extern "C" fn status(which: usize) -> i32 {
    answer(with(which, |session| {
        let (refused, removed) = (session.take_refused(), session.take_removed());
        let scene = session.scene();
        let gravity = scene.gravity.map(|gravity| [gravity.x, gravity.y]);
        Ok(json!({
            "step": session.step_now(), "end": session.end(), "rate": scene.run.rate, "steps": scene.run.steps,
            "size": scene.size, "title": scene.title, "name": scene.source.file_name(),
            "solver": scene.run.solver.name(), "gravity": gravity,
            "restitution": scene.restitution.default_restitution(), "materials": scene.restitution.names(),
            "failure": session.failure(), "refused": refused, "removed": removed, "bodies": session.bodies().len(),
            "images": session.scene().image_names().len(),
            "recorded_steps": session.recorded_steps(), "history": session.history_bytes(),
        })
        .to_string())
    }))
}

/// Makes up to `steps` steps; returns 1 after a failure.
#[unsafe(no_mangle)]
pub extern "C" fn step(which: usize, steps: u32) -> i32 {
    let failed = with(which, |session| {
        (0..steps).for_each(|_| session.step());
        Ok(session.failure().is_some())
    });
    i32::from(failed != Ok(false))
}

/// The present step.
#[unsafe(no_mangle)]
pub extern "C" fn step_now(which: usize) -> f64 {
    with(which, |session| Ok(session.step_now() as f64)).unwrap_or(0.0)
}

/// Sets the step to go to.
#[unsafe(no_mangle)]
pub extern "C" fn go_to(which: usize, to: f64) {
    let _ = with(which, |session| {
        session.go_to(to as u64);
        Ok(())
    });
}

/// Goes back to a step, as if the session had never been beyond `end`.
#[unsafe(no_mangle)]
pub extern "C" fn go_back(which: usize, to: f64, end: f64) {
    let _ = with(which, |session| {
        session.go_back(to as u64, end as u64);
        Ok(())
    });
}

/// Makes up to `steps` steps to the one that was set; returns 1 if it is reached.
#[unsafe(no_mangle)]
pub extern "C" fn advance(which: usize, steps: u32) -> i32 {
    i32::from(with(which, |session| Ok(session.advance(steps.into()))) != Ok(false))
}

/// Names the boxes of clicks in English, or in French (1).
#[unsafe(no_mangle)]
pub extern "C" fn name_boxes(french: u32) {
    BOX_NAME.set(if french == 1 { "boîte" } else { "box" });
}

/// Adds the event in the input, now or in the next step.
#[unsafe(no_mangle)]
pub extern "C" fn event(which: usize, now: u32) -> i32 {
    let add = |session: &mut Session, line: &str| {
        session.box_name = BOX_NAME.get();
        session.event(line, when(now))
    };
    answer(text().and_then(|line| with(which, |session| add(session, &line))).map(|()| ""))
}

/// Throws the body whose name is the input. Its name after that is the output.
#[unsafe(no_mangle)]
pub extern "C" fn throw_body(which: usize, x: f64, y: f64, vx: f64, vy: f64, now: u32) -> i32 {
    let throw = |session: &mut Session, name: &str| {
        session.box_name = BOX_NAME.get();
        session.throw(name, [x, y], [vx, vy], when(now))
    };
    answer(text().and_then(|name| with(which, |session| throw(session, &name))))
}

/// Undoes the last event, setting or scene; returns 1 if there is none.
#[unsafe(no_mangle)]
pub extern "C" fn undo(which: usize) -> i32 {
    i32::from(with(which, |session| Ok(session.undo())) != Ok(true))
}

/// Changes the scene of a session. The input is a key, a line feed and a value in TOML.
#[unsafe(no_mangle)]
pub extern "C" fn set(which: usize) -> i32 {
    let changed = text().and_then(|text| {
        let (path, value) = text.split_once('\n').unwrap_or((&text, ""));
        with(which, |session| session.with_setting(path, value))
    });
    answer(changed.and_then(|session| keep(which, session)).map(|()| ""))
}

/// The text of the scene.
#[unsafe(no_mangle)]
pub extern "C" fn scene(which: usize) -> i32 {
    answer(with(which, |session| Ok(session.scene().source.text.clone())))
}

/// The text of the scene with the number of steps of the recording.
#[unsafe(no_mangle)]
pub extern "C" fn recorded_scene(which: usize) -> i32 {
    answer(with(which, |session| Ok(session.recorded_scene()?.source.text)))
}

/// The scene with its events as tables.
#[unsafe(no_mangle)]
pub extern "C" fn scene_with_events(which: usize) -> i32 {
    answer(with(which, |session| session.scene_with_events()))
}

/// The lines of events.
#[unsafe(no_mangle)]
pub extern "C" fn lines(which: usize) -> i32 {
    answer(with(which, |session| Ok(session.lines())))
}

/// Fills the columns with the bodies `offset` seconds after the present state, and returns their number.
#[unsafe(no_mangle)]
pub extern "C" fn bodies(which: usize, offset: f64, key: u32) -> usize {
    let fill = |columns: &mut Vec<f64>| {
        let _ = with(which, |session| {
            session.fill_columns(offset, color_key(key), columns);
            Ok(())
        });
    };
    columns(fill, BODY_COLUMNS)
}

/// Names and materials of the bodies, in the order of the columns, as JSON.
#[unsafe(no_mangle)]
pub extern "C" fn names(which: usize) -> i32 {
    answer(with(which, |session| Ok(session.names())))
}

/// Returns 1 if an event made the body whose name is the input, rather than the scene.
#[unsafe(no_mangle)]
pub extern "C" fn is_made_by_event(which: usize) -> i32 {
    let is_made = text().and_then(|name| with(which, |session| Ok(session.is_made_by_event(&name))));
    i32::from(is_made == Ok(true))
}

/// Fills the columns with the collisions of the last step, and returns their number.
#[unsafe(no_mangle)]
pub extern "C" fn collisions(which: usize) -> usize {
    let fill = |columns: &mut Vec<f64>| {
        let _ = with(which, |session| {
            session.fill_collisions(columns);
            Ok(())
        });
    };
    columns(fill, COLLISION_COLUMNS)
}

/// The last collisions, as JSON.
#[unsafe(no_mangle)]
pub extern "C" fn recent_collisions(which: usize) -> i32 {
    answer(with(which, |session| Ok(session.recent_collisions())))
}

/// Fills the columns with the samples of energy and momentum, and returns their number.
#[unsafe(no_mangle)]
pub extern "C" fn energy(which: usize) -> usize {
    let fill = |columns: &mut Vec<f64>| {
        let _ = with(which, |session| {
            columns.extend(&session.strip.numbers);
            Ok(())
        });
    };
    columns(fill, EnergyStrip::WIDTH)
}

/// Fills the columns with the energy and momentum of the present state: kinetic, potential, px, py.
#[unsafe(no_mangle)]
pub extern "C" fn energy_now(which: usize) {
    let fill = |columns: &mut Vec<f64>| {
        let _ = with(which, |session| {
            let sample = session.energy();
            columns.extend([sample.kinetic, sample.potential, sample.momentum.x, sample.momentum.y]);
            Ok(())
        });
    };
    columns(fill, 4);
}

/// Draws Figure 1 (`kind` 0) or 2 (1) of a collision of the last step as SVG.
#[unsafe(no_mangle)]
pub extern "C" fn figure(which: usize, index: usize, kind: u32, dark: u32, french: u32) -> i32 {
    let kind = if kind == 1 { FigureKind::Minkowski } else { FigureKind::Stages };
    let theme = if dark == 1 { Theme::Dark } else { Theme::Light };
    let language = if french == 1 { Language::French } else { Language::English };
    answer(with(which, |session| session.figure(index, kind, theme, language)))
}

/// Starts the recording of a session.
#[unsafe(no_mangle)]
pub extern "C" fn save_start(which: usize) -> i32 {
    answer(with(which, |session| session.save()).map(|save| {
        SAVE.set(Some(save));
        ""
    }))
}

/// Records up to `states` states. Returns 1 with a message, 2 with the file as output, and 0 in between.
#[unsafe(no_mangle)]
pub extern "C" fn save_advance(states: u32) -> i32 {
    let advanced = SAVE.with_borrow_mut(|save| save.as_mut().ok_or("nothing is saved")?.advance(states.into()));
    match advanced {
        Ok(None) => 0,
        Ok(Some(file)) => {
            give(file);
            SAVE.set(None);
            2
        }
        Err(message) => {
            give(message);
            SAVE.set(None);
            1
        }
    }
}

/// Ends the recording before its end.
#[unsafe(no_mangle)]
pub extern "C" fn save_stop() {
    SAVE.set(None);
}

/// The last step that is recorded.
#[unsafe(no_mangle)]
pub extern "C" fn save_step() -> f64 {
    SAVE.with_borrow(|save| save.as_ref().map_or(0.0, |save| save.step as f64))
}

/// Opens the recording in the input.
#[unsafe(no_mangle)]
pub extern "C" fn film_open() -> i32 {
    VERDICT.set(None);
    let film = Film::open("the recording", INPUT.take());
    answer(film.map(|film| {
        let about = json!({
            "steps": film.steps, "rate": film.rate(), "size": film.size, "title": film.title, "solver": film.solver(),
            "scene": film.scene,
        });
        FILM.set(Some(film));
        about.to_string()
    }))
}

/// Closes the recording.
#[unsafe(no_mangle)]
pub extern "C" fn film_close() {
    FILM.set(None);
    VERDICT.set(None);
}

fn with_film<T>(f: impl FnOnce(&mut Film) -> Result<T, String>) -> Result<T, String> {
    FILM.with_borrow_mut(|film| film.as_mut().map_or(Err("no recording is open".into()), f))
}

/// Shows the state of a step of the recording. The step that is shown is the output.
#[unsafe(no_mangle)]
pub extern "C" fn film_show(to: f64) -> i32 {
    answer(with_film(|film| Ok(film.show(to as u64)?.to_string())))
}

/// Fills the columns with the bodies of the recording, and returns their number.
#[unsafe(no_mangle)]
pub extern "C" fn film_bodies(key: u32) -> usize {
    let fill = |columns: &mut Vec<f64>| {
        let _ = with_film(|film| {
            film.fill_columns(color_key(key), columns);
            Ok(())
        });
    };
    columns(fill, BODY_COLUMNS)
}

/// Names and materials of the bodies of the recording, as JSON.
#[unsafe(no_mangle)]
pub extern "C" fn film_names() -> i32 {
    answer(with_film(|film| Ok(film.names())))
}

/// The lines of events of the recording.
#[unsafe(no_mangle)]
pub extern "C" fn film_lines() -> i32 {
    answer(with_film(|film| film.lines().map(|lines| lines.iter().map(|line| line.json() + "\n").collect::<String>())))
}

/// The scene of the recording with its events as tables.
#[unsafe(no_mangle)]
pub extern "C" fn film_scene_with_events() -> i32 {
    answer(with_film(|film| film.scene_with_events()))
}

/// Starts to replay the recording.
#[unsafe(no_mangle)]
pub extern "C" fn verdict_start() -> i32 {
    answer(with_film(|film| LiveVerdict::new(film.bytes())).map(|verdict| {
        VERDICT.set(Some(verdict));
        ""
    }))
}

/// Compares up to `states` states. The output is JSON: the step, the word and the line of the verdict, whether it is
/// final, and the step that diverged.
#[unsafe(no_mangle)]
pub extern "C" fn verdict_advance(states: u32) -> i32 {
    answer(VERDICT.with_borrow_mut(|verdict| {
        let verdict = verdict.as_mut().ok_or("no recording is replayed")?;
        let is_final = verdict.advance(states.into())?;
        let so_far = verdict.verdict();
        let diverged = match &so_far {
            Verdict::Diverged(divergence) => Some(divergence.step),
            _ => None,
        };
        let line = so_far.to_string();
        Ok(json!({ "step": verdict.step, "word": so_far.word(), "line": line, "final": is_final, "diverged": diverged })
            .to_string())
    }))
}

/// Draws a picture of the recording. The input is a format, a step and options as JSON, on a line each.
#[unsafe(no_mangle)]
pub extern "C" fn picture() -> i32 {
    let drawn = text().and_then(|request| {
        let mut parts = request.splitn(3, '\n');
        let mut part = || parts.next().unwrap_or_default();
        let (format, step, options) = (part(), part().parse().map_err(|_| "the step is no number")?, part());
        with_film(|film| draw(film.bytes().clone(), format, step, options))
    });
    answer(drawn)
}

/// The states (`kind` 0) or collisions (1) of the recording as CSV.
#[unsafe(no_mangle)]
pub extern "C" fn csv(kind: u32) -> i32 {
    let kind = if kind == 1 { Table::Collisions } else { Table::States };
    answer(with_film(|film| table(film.bytes().clone(), kind)))
}
