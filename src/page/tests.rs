use crate::history::{MAX_RECENT, Row};
use crate::*;
use proptest::prelude::*;
use rebond::{Language, LiveEvents, OnBadEvent, RecordOptions, Theme, parse_scene};
use std::sync::{Arc, Mutex};

const ROOM: &str = "[world]\nwalls = true\ngravity = [0.0, 9.81]\n[run]\nsteps = 120\n[restitution]\ndefault = 0.8\n\
                    [[spawn]]\nname = \"c\"\nat = [2.0, 3.0]\nsize = [1.0, 1.0]\nmass = 2.0\nvelocity = [3.0, -1.0]\n\
                    [[spawn]]\nat = [9.0, 3.0]\nsize = [2.0, 1.0]\nmass = 4.0\nmaterial = \"steel\"\n";

fn room() -> Session {
    Session::new("room.toml", ROOM).unwrap()
}

/// A file in memory.
#[derive(Clone, Default)]
struct File(Arc<Mutex<Vec<u8>>>);
impl std::io::Write for File {
    fn write(&mut self, bytes: &[u8]) -> std::io::Result<usize> {
        self.0.lock().unwrap().write(bytes)
    }
    fn flush(&mut self) -> std::io::Result<()> {
        Ok(())
    }
}

/// The recording that `rebond record SCENE --events LINES` writes.
fn recorded(name: &str, scene: &str, lines: &str) -> Vec<u8> {
    let scene = parse_scene(name, scene).unwrap();
    let options = RecordOptions::complete(&scene);
    let mut live = LiveEvents::new(lines.as_bytes(), OnBadEvent::Fail, options.steps);
    let file = File::default();
    // Without lines it is `rebond record SCENE`, whose recording has no note of live events.
    let live = if lines.is_empty() { None } else { Some(&mut live) };
    rebond::record(&scene, options, live, file.clone(), |_| ()).unwrap();
    file.0.lock().unwrap().clone()
}

fn saved(session: &Session) -> Vec<u8> {
    let mut save = session.save().unwrap();
    loop {
        if let Some(file) = save.advance(7).unwrap() {
            return file;
        }
    }
}

/// The bits of all positions and velocities.
fn bits(session: &Session) -> Vec<[u64; 4]> {
    let bodies = session.bodies().iter();
    bodies.map(|b| [b.rect.origin.x, b.rect.origin.y, b.velocity.x, b.velocity.y].map(f64::to_bits)).collect()
}

fn steps(session: &mut Session, count: u64) {
    (0..count).for_each(|_| session.step());
}

fn go_to(session: &mut Session, step: u64) {
    session.go_to(step);
    while !session.advance(5) {}
}

fn names(session: &Session) -> Vec<String> {
    session.bodies().iter().map(|body| body.name.clone()).filter(|name| !name.starts_with("wall")).collect()
}

fn click(x: f64, y: f64) -> String {
    format!("{{\"click\": {{\"at\": [{x:?}, {y:?}], \"spawn\": {{\"size\": [1.0, 1.0], \"mass\": 1.0}}}}}}")
}

fn verdict(file: Vec<u8>) -> String {
    let mut verdict = LiveVerdict::new(&file.into()).unwrap();
    while !verdict.advance(10).unwrap() {}
    verdict.verdict().to_string()
}

#[test]
fn a_click_makes_a_box_and_a_click_on_a_box_deletes_it_and_never_makes_one() {
    for when in [When::Now, When::Next] {
        let mut session = room();
        steps(&mut session, 10);
        let act = |session: &mut Session| {
            session.event(&click(6.0, 8.0), when).unwrap();
            steps(session, u64::from(when == When::Next));
        };
        act(&mut session);
        assert_eq!(names(&session), ["c", "#2", "box 1"]);
        act(&mut session);
        assert_eq!(names(&session), ["c", "#2"], "{when:?}");
        assert!(session.take_refused().is_empty());
    }
}

#[test]
fn a_click_on_a_wall_makes_a_box() {
    let mut session = room();
    session.event(&click(8.0, 9.5), When::Now).unwrap();
    assert_eq!(names(&session).len(), 3);
}

#[test]
fn a_saved_session_is_what_the_command_records() {
    let mut session = room();
    steps(&mut session, 20);
    session.event(&click(6.0, 5.0), When::Next).unwrap();
    steps(&mut session, 30);
    session.throw("c", [4.0, 2.0], [5.0, -4.0], When::Next).unwrap();
    steps(&mut session, 10);
    session.throw("#2", [8.0, 1.0], [-5.0, 0.1], When::Now).unwrap();
    assert!(session.take_refused().is_empty());
    let file = saved(&session);
    assert!(file == recorded("room.toml", ROOM, &session.lines()), "within the steps of the scene");
    assert_eq!(verdict(file), "same: 120 steps, 9 bodies");

    steps(&mut session, 200);
    assert_eq!(session.recorded_steps(), 260);
    let scene = session.recorded_scene().unwrap().source.text;
    assert!(saved(&session) == recorded("room.toml", &scene, &session.lines()), "beyond them");
}

#[test]
fn the_states_of_a_session_are_those_of_its_recording() {
    let mut session = room();
    steps(&mut session, 20);
    session.event(&click(6.0, 5.0), When::Next).unwrap();
    steps(&mut session, 40);
    session.throw("c", [4.0, 2.0], [5.0, -4.0], When::Next).unwrap();
    steps(&mut session, 60);
    let mut film = Film::open("room.mcap", saved(&session)).unwrap();
    for step in [120, 3, 21, 60, 61, 62, 119, 0] {
        go_to(&mut session, step);
        assert_eq!(film.show(step).unwrap(), step);
        let [mut live, mut recorded] = [Vec::new(), Vec::new()];
        session.fill_columns(0.0, ColorKey::Body, &mut live);
        film.fill_columns(ColorKey::Body, &mut recorded);
        assert_eq!(live, recorded, "step {step}");
        assert_eq!(session.names(), film.names());
    }
}

#[test]
fn a_throw_is_a_delete_and_a_spawn_of_the_same_name_in_one_step() {
    let mut session = room();
    steps(&mut session, 5);
    assert_eq!(session.throw("c", [4.0, 4.0], [1.0, 2.0], When::Next).unwrap(), "c");
    assert_eq!(
        session.lines(),
        "{\"delete\": {\"step\": 6, \"name\": \"c\"}}\n\
         {\"spawn\": {\"step\": 6, \"at\": [4.0, 4.0], \"size\": [1.0, 1.0], \"mass\": 2.0, \"velocity\": [1.0, 2.0], \
         \"name\": \"c\", \"color\": \"#0072b2\"}}\n"
    );
    session.step();
    let body = session.bodies().last().unwrap();
    assert_eq!((body.name.as_str(), body.rect.origin, body.velocity.x), ("c", rebond::Vector::new(4.0, 4.0), 1.0));
}

#[test]
fn a_box_of_the_present_step_can_be_moved_again_and_again() {
    let mut session = room();
    session.event(&click(6.0, 5.0), When::Now).unwrap();
    session.throw("box 1", [1.0, 1.0], [0.0, 0.0], When::Now).unwrap();
    session.throw("box 1", [2.0, 1.0], [0.5, 0.0], When::Now).unwrap();
    assert_eq!(session.lines().lines().count(), 1);
    assert_eq!(session.bodies().last().unwrap().rect.origin.x, 2.0);
    steps(&mut session, 1);
    session.throw("box 1", [3.0, 1.0], [0.0, 0.0], When::Now).unwrap();
    session.throw("box 1", [4.0, 1.0], [0.0, 0.0], When::Now).unwrap();
    assert_eq!(session.bodies().last().unwrap().rect.origin.x, 4.0);
    assert!(saved(&session) == recorded("room.toml", ROOM, &session.lines()));
}

/// Checks that the names are these, in the order of creation, and that the recording is that of the command.
fn check_names(session: &Session, expected: &[&str]) {
    assert_eq!(names(session), expected, "{}", session.lines());
    assert!(saved(session) == recorded("room.toml", ROOM, &session.lines()));
}

#[test]
fn a_box_that_is_dropped_on_another_one_of_this_step_deletes_none() {
    for [x, y] in [[2.5, 6.5], [3.2, 6.5], [12.0, 7.0]] {
        for mass in ["1.0", "\"inf\""] {
            let mut session = room();
            session.event(&click(3.0, 7.0).replace("\"mass\": 1.0", &format!("\"mass\": {mass}")), When::Now).unwrap();
            session.event(&click(6.0, 5.0), When::Now).unwrap();
            session.event(&click(8.0, 5.0), When::Now).unwrap();
            let before = session.lines();
            session.throw("box 2", [x, y], [0.0, 0.0], When::Now).unwrap();
            check_names(&session, &["c", "#2", "box 1", "box 2", "box 3"]);
            assert_eq!(session.bodies()[session.bodies().len() - 2].rect.origin, rebond::Vector::new(x, y));
            session.undo();
            assert_eq!(session.lines(), before);
        }
    }
}

#[test]
fn a_box_that_is_dropped_where_one_was_deleted_in_this_step_does_not_bring_it_back() {
    let mut session = room();
    for (x, y) in [(4.0, 7.0), (4.0, 7.0), (6.0, 5.0), (8.0, 5.0)] {
        session.event(&click(x, y), When::Now).unwrap();
    }
    let [before, after] = [0, 1].map(|moves| {
        if moves == 1 {
            session.throw("box 3", [3.5, 6.5], [0.0, 0.0], When::Now).unwrap();
        }
        check_names(&session, &["c", "#2", "box 3", "box 4"]);
        let mut columns = Vec::new();
        session.fill_columns(0.0, ColorKey::Body, &mut columns);
        columns.chunks(BODY_COLUMNS).map(|body| body[8]).collect::<Vec<f64>>()
    });
    assert_eq!(before, after, "colours");
}

#[test]
fn a_box_that_is_dropped_on_one_clicked_later_deletes_none() {
    for when in [When::Now, When::Next] {
        let mut session = room();
        steps(&mut session, 20);
        session.event(&click(12.0, 6.0), when).unwrap();
        session.throw("c", [11.5, 5.5], [0.0, 0.0], when).unwrap();
        steps(&mut session, u64::from(when == When::Next));
        check_names(&session, &["#2", "box 1", "c"]);
        // The same with a body that a click of this step deletes.
        steps(&mut session, 30);
        let body = session.bodies().iter().find(|body| body.name == "#2").unwrap().rect;
        session.event(&click(body.origin.x + 1.0, body.origin.y + 0.5), when).unwrap();
        session.throw("box 1", [body.origin.x, body.origin.y], [0.0, 0.0], when).unwrap();
        steps(&mut session, u64::from(when == When::Next));
        check_names(&session, &["c", "box 1"]);
        assert!(session.take_refused().is_empty());
    }
}

#[test]
fn a_box_is_not_dropped_under_a_click_of_the_scene_in_this_step() {
    let text = format!("{ROOM}[[click]]\nstep = 0\nat = [6.0, 5.0]\nspawn = {{ size = [1.0, 1.0], mass = 1.0 }}\n");
    let mut session = Session::new("room.toml", &text).unwrap();
    session.event(&click(12.0, 6.0), When::Now).unwrap();
    let before = (names(&session), session.lines());
    assert!(session.throw("box 1", [5.5, 4.5], [0.0, 0.0], When::Now).unwrap_err().contains("a click of the scene"));
    assert_eq!((names(&session), session.lines()), before);
    session.throw("box 1", [5.5, 4.5], [0.0, 0.0], When::Next).unwrap();
    steps(&mut session, 1);
    assert_eq!(names(&session), ["c", "#2", "#3", "box 1"]);
}

#[test]
fn an_event_tells_how_many_later_ones_it_removes() {
    let mut session = room();
    for at in [10, 20, 20, 30] {
        go_to(&mut session, at);
        session.event(&click(6.0, 5.0), When::Next).unwrap();
        assert_eq!(session.take_removed(), 0);
    }
    go_to(&mut session, 20);
    session.throw("box 1", [1.0, 1.0], [0.0, 0.0], When::Now).unwrap();
    assert_eq!((session.take_removed(), session.take_removed()), (3, 0));
    session.undo();
    assert_eq!(session.lines().lines().count(), 4);
}

#[test]
fn undo_returns_to_the_bits_before_the_event() {
    let mut session = room();
    let mut plain = room();
    steps(&mut plain, 90);
    steps(&mut session, 30);
    session.event(&click(6.0, 5.0), When::Next).unwrap();
    steps(&mut session, 20);
    session.event(&click(3.0, 8.0), When::Now).unwrap();
    steps(&mut session, 40);
    assert!(session.undo() && session.undo() && !session.undo());
    while !session.advance(9) {}
    assert_eq!((session.step_now(), session.lines()), (90, String::new()));
    assert_eq!(bits(&session), bits(&plain));
}

#[test]
fn a_refused_line_is_dropped_and_reported() {
    let mut session = room();
    steps(&mut session, 3);
    session.event("{\"delete\": {\"name\": \"d\"}}", When::Next).unwrap();
    session.event(&click(6.0, 5.0), When::Next).unwrap();
    steps(&mut session, 1);
    let refused = session.take_refused();
    assert!(refused.len() == 1 && refused[0].contains("no body named \"d\" is alive"), "{refused:?}");
    assert_eq!(session.lines().lines().count(), 1);
    assert_eq!(names(&session).len(), 3);
    assert!(session.failure().is_none());

    let before = bits(&session);
    let error = session.event("{\"delete\": {\"name\": \"d\"}}", When::Now).unwrap_err();
    assert!(error.contains("no body named \"d\""), "{error}");
    assert_eq!((bits(&session), session.lines().lines().count()), (before, 1));
    assert!(session.event("{\"spawn\": 3}", When::Next).is_err());
    assert!(session.event(&click(f64::MAX, f64::MAX).replace("1.0, 1.0", "1e308, 1e308"), When::Next).is_err());
}

#[test]
fn an_error_stops_the_run_and_keeps_the_session() {
    let crushing = "[run]\nsteps = 300\n[[spawn]]\nname = \"left\"\nat = [0.0, 0.0]\nsize = [1.0, 1.0]\nmass = inf\n\
                    velocity = [1.0, 0.0]\n[[spawn]]\nname = \"right\"\nat = [4.0, 0.0]\nsize = [1.0, 1.0]\nmass = inf\n\
                    [[spawn]]\nname = \"c\"\nat = [2.0, 0.0]\nsize = [1.0, 1.0]\nmass = 1.0\n";
    let crushing = format!("{crushing}[restitution]\ndefault = 0.0\n");
    let mut session = Session::new("crush.toml", &crushing).unwrap();
    go_to(&mut session, 300);
    let failed = session.step_now();
    assert!(session.failure().unwrap().contains("crushed"), "{:?}", session.failure());
    steps(&mut session, 3);
    assert_eq!(session.step_now(), failed);
    let file = saved(&session);
    assert!(file == recorded("crush.toml", &crushing, ""));
    assert!(verdict(file).contains("then the recorded error"));

    go_to(&mut session, failed - 40);
    assert!(session.failure().is_none());
    session.event("{\"delete\": {\"name\": \"c\"}}", When::Next).unwrap();
    go_to(&mut session, 300);
    assert_eq!((session.step_now(), session.failure()), (300, None));
}

#[test]
fn going_back_and_acting_forgets_what_came_after() {
    let mut session = room();
    steps(&mut session, 40);
    session.event(&click(6.0, 5.0), When::Next).unwrap();
    steps(&mut session, 40);
    go_to(&mut session, 10);
    session.event(&click(12.0, 5.0), When::Next).unwrap();
    assert_eq!((session.end(), session.lines().lines().count()), (10, 1));
    go_to(&mut session, 60);
    let mut again = room();
    again.set_lines(&session.lines()).unwrap();
    go_to(&mut again, 60);
    assert_eq!(bits(&session), bits(&again));
}

#[test]
fn a_setting_runs_the_same_events_again_at_their_times() {
    let mut session = room();
    steps(&mut session, 60);
    session.event(&click(6.0, 5.0), When::Next).unwrap();
    steps(&mut session, 29);
    let mut finer = session.with_setting("run.rate", "120").unwrap();
    while !finer.advance(50) {}
    assert_eq!((finer.step_now(), finer.scene().run.steps), (178, 240));
    assert!(finer.lines().contains("\"step\": 122"), "{}", finer.lines());
    go_to(&mut session, 89);
    assert_eq!(bits(&finer), bits(&session), "the event-driven solver does not depend on a rate doubled");

    let mut moon = session.with_setting("world.gravity", "[0.0, 1.62]").unwrap();
    while !moon.advance(50) {}
    assert_eq!(moon.scene().gravity.unwrap().y, 1.62);
    assert!(saved(&moon) == recorded("room.toml", &moon.scene().source.text, &moon.lines()));
    assert!(session.with_setting("restitution.default", "2").is_err());
}

#[test]
fn settings_that_follow_each_other_at_once_keep_the_time() {
    let mut session = room();
    go_to(&mut session, 100);
    let mut session = session.with_setting("world.gravity", "[0.0, 5.0]").unwrap();
    session.advance(7);
    let mut session = session.with_setting("run.rate", "120").unwrap();
    session.advance(7);
    let mut beside = session.beside().unwrap();
    let mut session = session.with_setting("world.gravity", "[0.0, 6.0]").unwrap();
    for session in [&mut session, &mut beside] {
        while !session.advance(50) {}
        assert_eq!(session.step_now(), 200);
    }
}

#[test]
fn a_lower_rate_keeps_the_events_and_their_order() {
    let mut session = room();
    session.event(&click(3.0, 7.0), When::Now).unwrap();
    steps(&mut session, 7);
    for x in [5.0, 6.0, 7.0] {
        session.throw("box 1", [x, 2.0], [0.0, 0.0], When::Now).unwrap();
        session.step();
    }
    let post = click(12.0, 3.0).replace("\"mass\": 1.0", "\"mass\": \"inf\", \"name\": \"post\"");
    session.event(&post, When::Now).unwrap();
    session.step();
    session.event("{\"delete\": {\"name\": \"post\"}}", When::Now).unwrap();
    for rate in ["30", "15", "1"] {
        let mut slower = session.with_setting("run.rate", rate).unwrap();
        while !slower.advance(50) {}
        go_to(&mut slower, 40);
        assert!(slower.take_refused().is_empty(), "{rate} Hz");
        assert_eq!(slower.lines().lines().count(), session.lines().lines().count());
        assert_eq!(names(&slower), ["c", "#2", "box 1"]);
    }
}

#[test]
fn bundled_scenes_run_at_other_rates() {
    for (name, text) in BUNDLED {
        let session = Session::new(&format!("{name}.toml"), text).unwrap();
        for rate in ["15", "30", "240"] {
            let mut other = session.with_setting("run.rate", rate).unwrap_or_else(|error| panic!("{name}: {error}"));
            go_to(&mut other, 20);
            assert_eq!(other.failure(), None, "{name} at {rate} Hz");
        }
    }
}

#[test]
fn both_solvers_follow_the_same_clicks() {
    let mut exact = room();
    let mut handout = exact.with_setting("run.solver", "\"handout\"").unwrap();
    for session in [&mut exact, &mut handout] {
        steps(session, 10);
        session.event(&click(6.0, 5.0), When::Next).unwrap();
        steps(session, 10);
        session.event(&click(6.0, 5.2), When::Next).unwrap();
        steps(session, 30);
    }
    assert_eq!((exact.lines(), names(&exact)), (handout.lines(), names(&handout)));
    assert_ne!(bits(&exact), bits(&handout));
    assert!(saved(&handout) == recorded("room.toml", &handout.scene().source.text, &handout.lines()));
}

#[test]
fn settings_and_scenes_are_undone_in_their_order() {
    let mut session = room();
    steps(&mut session, 60);
    session.event(&click(6.0, 5.0), When::Next).unwrap();
    steps(&mut session, 20);
    let mut session = session.with_setting("world.gravity", "[0.5, 1.62]").unwrap();
    go_to(&mut session, 80);
    let mut session = session.with_setting("run.rate", "30").unwrap();
    while !session.advance(50) {}
    session.event(&click(9.0, 7.0), When::Next).unwrap();
    steps(&mut session, 2);
    let lines = session.lines();
    let mut session = Session::new("other.toml", "[run]\nsteps = 9\n").unwrap().in_place_of(session);
    session.event(&click(1.0, 1.0), When::Now).unwrap();
    let undo = |session: &mut Session| {
        assert!(session.undo());
        while !session.advance(9) {}
        let gravity = session.scene().gravity.map(|gravity| [gravity.x, gravity.y]);
        (session.scene().source.path.clone(), session.scene().run.rate, gravity, session.step_now(), names(session))
    };
    assert_eq!(undo(&mut session), ("other.toml".into(), 60.0, None, 0, vec![]));
    let box_names = |boxes: &[&str]| boxes.iter().map(|name| (*name).to_owned()).collect::<Vec<_>>();
    let all = box_names(&["c", "#2", "box 1", "box 2"]);
    assert_eq!(undo(&mut session), ("room.toml".into(), 30.0, Some([0.5, 1.62]), 42, all));
    assert_eq!(session.lines(), lines);
    let one = box_names(&["c", "#2", "box 1"]);
    assert_eq!(undo(&mut session), ("room.toml".into(), 30.0, Some([0.5, 1.62]), 42, one.clone()));
    assert_eq!(undo(&mut session), ("room.toml".into(), 60.0, Some([0.5, 1.62]), 84, one.clone()));
    assert_eq!(undo(&mut session), ("room.toml".into(), 60.0, Some([0.0, 9.81]), 84, one));
    assert_eq!(undo(&mut session), ("room.toml".into(), 60.0, Some([0.0, 9.81]), 84, box_names(&["c", "#2"])));
    assert!(!session.undo());
}

#[test]
fn what_is_undone_is_undone_in_the_session_beside_too() {
    let mut exact = room().with_setting("restitution.default", "0.5").unwrap();
    exact.event(&click(6.0, 5.0), When::Now).unwrap();
    let mut exact = exact.with_setting("run.solver", "\"handout\"").unwrap();
    let mut beside = exact.beside().unwrap();
    for expected in ["event-driven", "handout", "handout", "handout"] {
        assert_eq!(beside.scene().run.solver.name(), expected);
        assert_ne!(exact.scene().run.solver, beside.scene().run.solver);
        assert_eq!(exact.lines(), beside.lines());
        assert_eq!(exact.scene().restitution, beside.scene().restitution);
        assert_eq!(exact.undo(), beside.undo());
    }
    assert!(!exact.undo());
}

#[test]
fn the_table_of_collisions_does_not_depend_on_the_way_to_a_step() {
    let text = BUNDLED.iter().find(|(name, _)| *name == "falling-heap").unwrap().1;
    let mut session = Session::new("falling-heap.toml", text).unwrap();
    let mut tables = Vec::new();
    for step in (0..=160).step_by(20) {
        go_to(&mut session, step);
        tables.push((step, session.recent_collisions()));
    }
    assert!(tables[2].1.len() > 100 && tables[8].1.matches('[').count() == 201, "{:?}", tables[8]);
    for (step, table) in tables.iter().rev().chain(&tables) {
        go_to(&mut session, *step);
        assert_eq!(session.recent_collisions(), *table, "step {step}");
    }
}

#[test]
fn a_history_that_is_thinned_out_keeps_the_last_collisions() {
    let gas = "[world]\nsize = [4, 4]\nwalls = true\n[run]\nsteps = 9\n[[scatter]]\ncount = 20\nregion = [0, 0, 4, 4]\n\
               size = [[0.1, 0.1], [0.3, 0.3]]\nmass = [1, 2]\nvelocity = [[-2, -2], [2, 2]]\n";
    let mut session = Session::new("gas.toml", gas).unwrap();
    let mut history = History::new(200_000);
    let mut last = Vec::new();
    while session.step_now() < 2000 {
        session.step();
        last.extend(session.collisions.iter().map(Row::of));
        if history.wants(session.step_now()) {
            history.keep(session.snapshot(), &last[last.len().saturating_sub(MAX_RECENT)..]);
            let step = history.nearest(session.step_now()).unwrap().step();
            let until: Vec<f64> = last.iter().filter(|row| row.step < step).map(|row| row.instant).collect();
            let kept: Vec<f64> = history.recent(session.step_now()).iter().map(|row| row.instant).collect();
            assert_eq!(kept, until[until.len().saturating_sub(MAX_RECENT)..]);
        }
    }
    assert!(last.len() > 3 * MAX_RECENT && history.bytes() <= 200_000);
}

#[test]
fn a_collision_without_impulse_has_its_shares_and_displacements() {
    let text = BUNDLED.iter().find(|(name, _)| *name == "overlapping-boxes").unwrap().1;
    let mut session = Session::new("overlapping-boxes.toml", text).unwrap();
    while session.collisions.is_empty() {
        session.step();
    }
    let mut columns = Vec::new();
    session.fill_collisions(&mut columns);
    assert_eq!((session.step_now(), columns.len()), (3, COLLISION_COLUMNS));
    assert_eq!((columns[5], columns[10]), (0.0, 0.0));
    assert!((columns[9].abs() - 1.0).abs() < 1e-12, "{columns:?}");
    assert_eq!(columns[19..], [0.0, 1.0]);
    assert!(session.recent_collisions().contains("\"10 kg\",\"1 kg\""), "{}", session.recent_collisions());
    for kind in [FigureKind::Stages, FigureKind::Minkowski] {
        assert!(session.figure(0, kind, Theme::Dark, Language::French).is_ok());
    }
    // A displacement by rounding alone is not a collision.
    let at = session.step_now();
    while session.step_now() < at + 2 {
        session.step();
        assert!(session.collisions.is_empty(), "{:?}", session.collisions);
    }
}

#[test]
fn boxes_of_clicks_have_a_name_in_the_language_of_the_page() {
    let mut session = room();
    session.box_name = "boîte";
    session.event(&click(6.0, 5.0), When::Now).unwrap();
    assert_eq!(names(&session), ["c", "#2", "boîte 1"]);
}

#[test]
fn going_back_forgets_how_far_the_session_was() {
    let mut session = room();
    steps(&mut session, 150);
    let end = session.end();
    steps(&mut session, 900);
    session.go_back(100, end);
    while !session.advance(50) {}
    assert_eq!((session.step_now(), session.end(), session.recorded_steps()), (100, 150, 150));
    assert!(session.strip.numbers.chunks(EnergyStrip::WIDTH).all(|sample| sample[0] <= 150.0));
}

#[test]
fn the_lines_of_a_recording_repeat_its_events() {
    let mut session = room();
    session.event(&click(6.0, 5.0), When::Now).unwrap();
    session.event(&click(6.0, 5.0), When::Now).unwrap();
    session.event(&click(9.3, 5.1), When::Now).unwrap();
    session
        .event(&click(4.0, 7.0).replace("\"mass\": 1.0", "\"mass\": \"inf\", \"name\": \"post\""), When::Now)
        .unwrap();
    steps(&mut session, 50);
    session.throw("c", [4.0, 2.0], [5.0, -4.0], When::Next).unwrap();
    steps(&mut session, 40);
    session.throw("#2", [8.0, 1.0], [-5.0, 0.1], When::Now).unwrap();
    let file = saved(&session);
    let film = Film::open("room.mcap", file.clone()).unwrap();
    let lines: String = film.lines().unwrap().iter().map(|line| line.json() + "\n").collect();
    let mut again = Session::new("room.toml", &film.scene).unwrap();
    again.set_lines(&lines).unwrap();
    go_to(&mut session, 120);
    go_to(&mut again, 120);
    assert_eq!((bits(&again), again.names()), (bits(&session), session.names()), "{lines}");
    let mut one = Session::new("one.toml", &film.scene_with_events().unwrap()).unwrap();
    go_to(&mut one, 120);
    assert_eq!(bits(&one), bits(&session));
    // The events of a scene are not added once more.
    for name in ["click-session", "spawn-and-delete"] {
        let path = format!("{}/../../recordings/{name}.mcap", env!("CARGO_MANIFEST_DIR"));
        assert_eq!(Film::open(name, std::fs::read(path).unwrap()).unwrap().lines().unwrap(), []);
    }
    let mut session =
        Session::new("two.toml", BUNDLED.iter().find(|(name, _)| *name == "click-session").unwrap().1).unwrap();
    steps(&mut session, 31);
    session.event(&click(2.0, 1.0), When::Now).unwrap();
    steps(&mut session, 30);
    let film = Film::open("two.mcap", saved(&session)).unwrap();
    assert_eq!(film.lines().unwrap().len(), 1);
}

#[test]
fn a_body_of_an_event_is_told_from_one_of_the_scene() {
    let mut session = room();
    steps(&mut session, 5);
    session.event(&click(6.0, 5.0), When::Next).unwrap();
    assert!(!session.is_made_by_event("box 1"));
    session.step();
    assert!(
        session.is_made_by_event("box 1") && !session.is_made_by_event("c") && !session.is_made_by_event("wall-top")
    );
}

#[test]
fn a_file_without_any_event_leaves_the_session_as_it_is() {
    let mut session = room();
    session.event(&click(6.0, 5.0), When::Now).unwrap();
    let lines = session.lines();
    let error = session.set_lines(&"nonsense\n".repeat(9)).unwrap_err();
    assert!(error.starts_with("line 1: ") && error.lines().count() == 5, "{error}");
    assert_eq!((session.lines(), names(&session).len()), (lines, 3));
    session.set_lines("").unwrap();
    assert_eq!(session.lines(), "");
}

#[test]
fn an_hour_stays_within_the_budget_of_bytes() {
    let mut history = History::new(200_000);
    let mut session = room();
    let mut kept = 0;
    while session.step_now() < 20_000 {
        session.step();
        if history.wants(session.step_now()) {
            kept += 1;
            history.keep(session.snapshot(), &[]);
            assert!(history.bytes() <= 200_000);
        }
    }
    assert!(kept > 50 && history.nearest(19_999).is_some_and(|snapshot| snapshot.step() > 10_000));
    assert!(session.strip.numbers.len() <= EnergyStrip::MAX * EnergyStrip::WIDTH);
    assert!(session.history_bytes() < 49 << 20);
}

#[test]
fn a_session_as_one_scene_has_the_same_states() {
    let mut session = room();
    session.event(&click(6.0, 5.0), When::Now).unwrap();
    steps(&mut session, 50);
    session.throw("c", [4.0, 2.0], [5.0, -4.0], When::Next).unwrap();
    steps(&mut session, 80);
    let mut one = Session::new("one.toml", &session.scene_with_events().unwrap()).unwrap();
    go_to(&mut one, 130);
    assert_eq!((bits(&one), names(&one)), (bits(&session), names(&session)));
    let inline = "run.steps = 9\nspawn = [{ at = [1, 1], size = [1, 1], mass = 1 }]\n";
    let mut session = Session::new("inline.toml", inline).unwrap();
    session.event(&click(6.0, 5.0), When::Next).unwrap();
    steps(&mut session, 1);
    assert!(session.scene_with_events().is_ok());
}

#[test]
fn every_bundled_scene_runs_and_its_recording_replays_the_same() {
    for (name, text) in BUNDLED {
        let mut session = Session::new(&format!("{name}.toml"), text).unwrap_or_else(|error| panic!("{name}: {error}"));
        go_to(&mut session, 30);
        assert!(session.failure().is_none(), "{name}");
        let path = format!("{}/../../recordings/{name}.mcap", env!("CARGO_MANIFEST_DIR"));
        if let Ok(file) = std::fs::read(path) {
            let mut film = Film::open(name, file.clone()).unwrap();
            let step = film.steps.min(30);
            assert_eq!(film.show(step).unwrap(), step, "{name}");
            if file.len() < 100_000 {
                assert!(verdict(file).starts_with("same"), "{name}");
            }
        }
    }
}

#[test]
fn a_recording_that_diverges_names_the_step() {
    use rebond::internals::recording::{RunEnd, Writer};
    use rebond::internals::replay::engine_config;
    use rebond::recordings::{Header, SceneText};
    let [stated, other] = ["3.0", "3.5"].map(|vx| {
        let text = ROOM.replace("velocity = [3.0", &format!("velocity = [{vx}"));
        parse_scene("room.toml", &text).unwrap()
    });
    let text = SceneText { file_name: "room.toml".into(), text: stated.source.text.clone() };
    let file = File::default();
    let mut writer = Writer::new(file.clone(), &Header::new(engine_config(&stated), 3, text)).unwrap();
    let [mut run, mut other] = [&stated, &other].map(rebond::Run::new);
    for step in 0..=3 {
        for event in run.apply_inputs(Vec::new(), |error| Err(error.into())).unwrap() {
            writer.write_event(&event).unwrap();
        }
        other.apply_inputs(Vec::new(), |error| Err(error.into())).unwrap();
        writer.write_state(if step < 2 { run.engine() } else { other.engine() }).unwrap();
        run.step(&mut Vec::new()).unwrap();
        other.step(&mut Vec::new()).unwrap();
    }
    writer.finish(RunEnd::default()).unwrap();
    let bytes = file.0.lock().unwrap().clone();
    let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/page/diverged.mcap");
    if std::env::var_os("REBOND_ACCEPT").is_some_and(|value| value == "1") {
        std::fs::write(&path, &bytes).unwrap();
    }
    assert_eq!(std::fs::read(&path).unwrap(), bytes, "the file of the browser test; REBOND_ACCEPT=1 renews it");
    let verdict = verdict(bytes);
    assert!(verdict.starts_with("diverged at step 2: body \"c\" x recorded"), "{verdict}");
}

#[test]
fn pictures_and_tables_are_those_of_the_command() {
    let mut session = room();
    steps(&mut session, 60);
    let file: Arc<[u8]> = saved(&session).into();
    let folder = std::env::temp_dir().join(format!("rebond-page-{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    let path = folder.join("room.mcap");
    std::fs::write(&path, &file).unwrap();
    let options = "{\"size\": [320, 180], \"theme\": \"dark\", \"show\": [\"velocity\", \"name\", \"clock\"]}";
    let source = rebond::Source::open(&path).unwrap();
    let subject = rebond::SubjectOptions::State { step: 30.into(), format: rebond::StillFormat::Svg };
    let expected = rebond::draw_to_vec(&subject, &serde_json::from_str(options).unwrap(), &[source]).unwrap();
    assert!(draw(file.clone(), "svg", 30, options).unwrap() == expected);
    std::fs::remove_dir_all(folder).unwrap();
    let states = String::from_utf8(table(file.clone(), rebond::internals::table::Table::States).unwrap()).unwrap();
    assert!(states.starts_with("step,time,name,x,y,vx,vy\n0,0.0,wall-top,") && states.lines().count() == 1 + 121 * 6);
    let collisions = table(file, rebond::internals::table::Table::Collisions).unwrap();
    assert!(collisions.starts_with(b"time,step,a,b,axis"));
}

#[test]
fn the_collisions_of_a_step_have_both_figures() {
    for solver in ["event-driven", "handout"] {
        let mut session = room().with_setting("run.solver", &format!("\"{solver}\"")).unwrap();
        while session.collisions.is_empty() {
            session.step();
        }
        for kind in [FigureKind::Stages, FigureKind::Minkowski] {
            let [english, french] = [Language::English, Language::French]
                .map(|language| session.figure(0, kind, Theme::Dark, language).unwrap());
            assert!(english.starts_with(b"<svg") && french.starts_with(b"<svg"), "{solver} {kind:?}");
            assert_ne!(english, french);
        }
        assert!(session.figure(99, FigureKind::Stages, Theme::Light, Language::English).is_err());
        assert!(session.recent_collisions().contains("\"wall-bottom\""));
    }
}

#[test]
fn messages_of_a_scene_name_the_line_and_what_is_accepted() {
    let error = Session::new("x.toml", "[run]\nsteps = 3\n[world]\nwals = true\n").err().unwrap();
    assert!(error.starts_with("line 4: unknown key `world.wals`"), "{error}");
}

#[test]
fn hostile_files_end_in_a_message() {
    for bytes in [&b""[..], b"\x89MCAP0\r\n", &[0xff; 300]] {
        assert!(Film::open("x", bytes.into()).is_err());
    }
    let mut file = saved(&room());
    let middle = file.len() / 2;
    file[middle] ^= 1;
    let verdict = Film::open("x", file.clone()).map(|_| verdict(file));
    assert!(verdict.is_err() || verdict.unwrap().starts_with("corrupt"));
    let many = "[run]\nsteps = 1\n[[scatter]]\ncount = 30000\nregion = [0, 0, 9, 9]\nsize = [[0.01, 0.01], [0.01, 0.01]]\n\
                mass = [1, 1]\noverlap = true\n";
    assert!(Session::new("x", many).err().unwrap().contains("at most 20000"));
    let long = "[run]\nsteps = 1\nevents_per_step = 1000000000\n";
    assert!(Session::new("x", long).err().unwrap().contains("at most 10000000"));
}

#[test]
fn lines_that_are_opened_are_those_of_the_command() {
    let lines = "{\"click\": {\"at\": [4, 5], \"spawn\": {\"size\": [1, 1], \"mass\": \"inf\"}}}\n\n\
                 {\"delete\": {\"step\": 30, \"name\": \"c\"}}\nnonsense\n{\"delete\": {\"step\": 2, \"name\": \"c\"}}\n";
    let mut session = room();
    session.set_lines(lines).unwrap();
    go_to(&mut session, 60);
    assert_eq!(session.take_refused().len(), 2);
    assert_eq!(names(&session), ["#2", "#3"]);
    assert!(saved(&session) == recorded("room.toml", ROOM, &session.lines()));
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]
    #[test]
    fn whatever_is_done_the_recording_is_that_of_the_command(
        actions in prop::collection::vec((0_u8..8, 0.5..15.5_f64, 0.5..8.5_f64, 0_u64..40), 1..14),
    ) {
        let mut session = room();
        for (action, x, y, count) in actions {
            let when = if action % 2 == 0 { When::Now } else { When::Next };
            match action {
                0..=2 => session.event(&click(x, y), when).unwrap(),
                3 | 4 => if let Some(name) = names(&session).last().cloned() {
                    let _ = session.throw(&name, [x - 0.5, y - 0.5], [y, x - 8.0], when);
                },
                5 => {
                    session.undo();
                    while !session.advance(20) {}
                }
                6 => {
                    let step = session.end().saturating_sub(count);
                    go_to(&mut session, step);
                }
                // On another body, which stays where it is.
                _ => if let [name, .., other] = &names(&session)[..] {
                    let at = session.bodies().iter().find(|body| body.name == *other).unwrap().rect.origin;
                    let (count, is_bundled) = (session.bodies().len(), session.step_now() == 0);
                    if session.throw(name, [at.x, at.y], [0.0, 0.0], When::Now).is_err() {
                        prop_assert!(is_bundled, "a body of the scene at its first step");
                    }
                    prop_assert_eq!(session.bodies().len(), count);
                }
            }
            steps(&mut session, count);
        }
        prop_assert!(session.failure().is_none());
        let scene = session.recorded_scene().unwrap().source.text;
        prop_assert!(saved(&session) == recorded("room.toml", &scene, &session.lines()));
        let (now, live) = (session.step_now(), bits(&session));
        let mut again = Session::new("room.toml", &scene).unwrap();
        again.set_lines(&session.lines()).unwrap();
        go_to(&mut again, now);
        prop_assert_eq!(bits(&again), live);
        prop_assert!(again.take_refused().is_empty());
    }
}
