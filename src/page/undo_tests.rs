use crate::testing::*;
use crate::*;

#[test]
fn the_later_events_that_an_event_removes_are_counted() {
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
fn an_event_after_going_back_removes_all_later_ones() {
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
fn undo_has_the_same_effect_in_the_session_beside() {
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
