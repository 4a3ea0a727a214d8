use crate::history::{MAX_RECENT, Row};
use crate::testing::*;
use crate::*;
use rebond::{Language, Theme};

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
fn bodies_of_events_and_of_the_scene_are_distinguished() {
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
fn messages_about_a_scene_name_the_line() {
    let error = Session::new("x.toml", "[run]\nsteps = 3\n[world]\nwals = true\n").err().unwrap();
    assert!(error.starts_with("line 4: unknown key `world.wals`"), "{error}");
}
