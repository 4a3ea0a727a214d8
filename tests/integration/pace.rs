//! Slow motion and stops: what lies between two steps is the exact solver's own.

use crate::rebond::Workplace;
use rebond::physics::{Engine, Event, Rect, Restitution, Settings, SolverKind, Spawn, Vector};
use std::io::Cursor;

/// A ball that hits a plate between two steps, at 0.425 s, and comes back.
const SHOT: &str = r#"[world]
size = [8.0, 4.5]
[run]
rate = 10
steps = 12
solver = "event-driven"
[[spawn]]
name = "ball"
at = [0.5, 2.0]
size = [0.5, 0.5]
mass = 1.0
velocity = [10.0, 0.0]
[[spawn]]
name = "plate"
at = [5.25, 0.5]
size = [0.1, 3.5]
mass = inf
[figure]
size = [160, 90]
show = ["normal", "clock"]
"#;

fn workplace(solver: &str) -> Workplace {
    let workplace = Workplace::with_scene(&SHOT.replace("event-driven", solver));
    workplace.done("record scene.toml -o run.mcap");
    workplace
}

/// How long each picture of a GIF is shown, 1/100 s.
fn delays(file: &[u8]) -> Vec<u16> {
    let mut decoder = gif::DecodeOptions::new().read_info(Cursor::new(file)).unwrap();
    let mut delays = Vec::new();
    while let Some(frame) = decoder.read_next_frame().unwrap() {
        delays.push(frame.delay);
    }
    delays
}

#[test]
fn slow_motion_of_the_exact_solver_shows_instants_between_steps() {
    let workplace = workplace("event-driven");
    let told = workplace.done("render run.mcap -o slow.gif --slow 0.2 --fps 10").output;
    assert_eq!(told, "slow.gif: 5 instants a step, 10 frames/s, 0.2 × as fast as it happens\n");
    assert_eq!(delays(&workplace.read("slow.gif")), [10; 61], "12 steps of 5 instants each, and the last");
}

#[test]
fn slow_motion_of_the_handouts_solver_shows_its_states_longer() {
    let workplace = workplace("handout");
    let told = workplace.done("render run.mcap -o slow.gif --slow 0.2 --fps 10").output;
    assert_eq!(told, "slow.gif: every step, 2 frames/s, 0.2 × as fast as it happens\n");
    assert_eq!(delays(&workplace.read("slow.gif")), [50; 13]);
}

#[test]
fn a_clip_stops_at_the_very_instant_of_an_impact() {
    let workplace = workplace("event-driven");
    let told = workplace.done("render run.mcap -o held.gif --hold 0.5 at collisions --fps 10").output;
    assert_eq!(told, "held.gif: every step, 10 frames/s, 1 stop of 0.5 s\n");
    let delays = delays(&workplace.read("held.gif"));
    // The impact comes 0.025 s after step 4; its frame stays for the rest of the step and half a second more.
    assert_eq!(delays, [10, 10, 10, 10, 3, 57, 10, 10, 10, 10, 10, 10, 10, 10]);
    workplace.done("render run.mcap -o held.apng --hold 0.5 at collisions --fps 10");
}

/// The picture of the stop shows the ball where it touches the plate, though no state does.
#[test]
fn the_stop_shows_the_bodies_touching() {
    use rebond::illustration::{Source, Wish, WishedSubject, frames, timeline};
    let workplace = workplace("event-driven");
    let sources = [Source::open(&workplace.path("run.mcap")).unwrap()];
    let wish =
        Wish { hold: Some(0.5), fps: Some(10.0), ..Wish::new(WishedSubject::Animation { fastest: f64::INFINITY }) };
    let request = wish.request(&sources, &mut |_, _| ()).unwrap();
    let timeline = timeline(&request, &sources[0], &mut |_, _| ()).unwrap();
    let frames: Vec<_> = frames(&request, &sources[0], &timeline).unwrap().map(Result::unwrap).collect();
    assert_eq!(frames.len(), 14);
    let right = |frame: &rebond::render::Frame| frame.sprites[0].rect.far_corner().x;
    assert_eq!(right(&frames[5]), 5.25, "touching");
    assert!((frames[5].time - 0.425).abs() < 1e-12, "at {}", frames[5].time);
    assert_eq!(frames[5].collisions.len(), 1, "and the collision is shown");
    let others = frames.iter().enumerate().filter(|(at, _)| *at != 5);
    assert!(others.map(|(_, frame)| right(frame)).all(|x| x < 5.25), "no recorded state does");
    assert_eq!(frames.iter().map(|frame| frame.collisions.len()).sum::<usize>(), 1, "shown once");
}

#[test]
fn a_stop_of_the_handouts_solver_is_at_the_state_it_found() {
    let slower =
        SHOT.replace("event-driven", "handout").replace("rate = 10", "rate = 100").replace("steps = 12", "steps = 60");
    let workplace = Workplace::with_scene(&slower);
    let told = workplace.done("render scene.toml -o held.gif --hold 0.5 at collisions --fps 50").output;
    assert_eq!(told, "held.gif: every 2nd step, 50 frames/s, 1 stop of 0.5 s\n");
    let longest = delays(&workplace.read("held.gif")).into_iter().max();
    assert!(longest.is_some_and(|longest| (51..=52).contains(&longest)), "{longest:?}");
}

#[test]
fn pace_is_for_animations() {
    let workplace = workplace("event-driven");
    let outcome = workplace.rebond("render run.mcap -o frames/ --slow 0.5");
    assert_eq!(outcome.code, 1);
    assert!(outcome.errors.contains("slow motion and stops are for animations"), "{outcome:?}");
    assert_eq!(workplace.rebond("render run.mcap -o held.gif --hold 0.5 at night").code, 2);
    assert_eq!(workplace.rebond("render run.mcap -o held.gif --slow 0").code, 2);
}

/// Looking between two steps goes nowhere: the engine goes on to the bit.
#[test]
fn a_look_between_steps_changes_no_bit_and_agrees_with_a_finer_run() {
    let engine = |rate: f64| {
        let settings = Settings {
            solver: SolverKind::EventDriven,
            rate,
            gravity: Some(Vector::new(0.0, 10.0)),
            restitution: Restitution::new(0.5, &[]),
            events_per_step: 1000,
        };
        let mut engine = Engine::new(settings);
        for (x, y, mass, speed) in [(0.0, 4.0, f64::INFINITY, 0.0), (0.0, 0.0, 1.0, 2.0), (0.5, 1.5, 3.0, -1.0)] {
            let size = if mass == 1.0 { 1.0 } else { 2.0 };
            engine.apply(&Event::Spawn(Spawn {
                name: format!("{mass}"),
                rect: Rect::new(Vector::new(x, y), size, 1.0),
                mass,
                velocity: Vector::new(speed, 0.0),
                force: Vector::ZERO,
                material: String::new(),
            }));
        }
        engine
    };
    let (mut coarse, mut fine, mut unseen) = (engine(8.0), engine(32.0), engine(8.0));
    for _ in 0..16 {
        for part in 0..4 {
            let seen = coarse.between(f64::from(part) / 32.0, &mut Vec::new()).unwrap();
            for (seen, exact) in seen.bodies.iter().zip(&fine.world().bodies) {
                let off = seen.rect.origin.sub(exact.rect.origin).norm() + seen.velocity.sub(exact.velocity).norm();
                assert!(off < 1e-12, "step {} part {part}: {seen:?} {exact:?}", coarse.present_step());
            }
            fine.step(&mut Vec::new()).unwrap();
        }
        coarse.step(&mut Vec::new()).unwrap();
        unseen.step(&mut Vec::new()).unwrap();
        assert_eq!(coarse.snapshot(), unseen.snapshot());
    }
}
