//! Slow motion and freeze frames, which show states of the event-driven solver between two steps.

use crate::rebond::Workplace;
use rebond::internals::physics::{
    Collision, Engine, EngineConfig, Event, Rect, Restitution, SolverKind, Spawn, Vector,
};
use rebond::internals::picture::Overlay;
use rebond::internals::recording::Recording;
use rebond::internals::replay::{ALL_STEPS, Replayer};
use std::io::Cursor;

/// A ball that hits a plate between two steps, at 0.425 s, and bounces back.
const SCENE: &str = r#"[world]
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
    let workplace = Workplace::with_scene(&SCENE.replace("event-driven", solver));
    workplace.done("record scene.toml -o run.mcap");
    workplace
}

/// The display time of each frame of a GIF, 1/100 s.
fn delays(file: &[u8]) -> Vec<u16> {
    let mut decoder = gif::DecodeOptions::new().read_info(Cursor::new(file)).unwrap();
    let mut delays = Vec::new();
    while let Some(frame) = decoder.read_next_frame().unwrap() {
        delays.push(frame.delay);
    }
    delays
}

#[test]
fn slow_motion_of_the_event_driven_solver_shows_instants_between_steps() {
    let workplace = workplace("event-driven");
    let output = workplace.done("render run.mcap -o slow.gif --slow 0.2 --fps 10").output;
    assert!(
        output.starts_with("slow.gif: ")
            && output.ends_with(" frames, 5 frames per step, 10 frames/s, 0.2 × real time\n"),
        "{output}"
    );
    assert_eq!(delays(&workplace.read("slow.gif")), [10; 61], "12 steps of 5 frames each and the last state");
}

#[test]
fn slow_motion_of_the_handout_solver_shows_each_state_longer() {
    let workplace = workplace("handout");
    let output = workplace.done("render run.mcap -o slow.gif --slow 0.2 --fps 10").output;
    assert!(
        output.starts_with("slow.gif: ") && output.ends_with(" frames, every step, 2 frames/s, 0.2 × real time\n"),
        "{output}"
    );
    assert_eq!(delays(&workplace.read("slow.gif")), [50; 13]);
}

#[test]
fn an_animation_freezes_at_the_instant_of_an_impact() {
    let workplace = workplace("event-driven");
    let output = workplace.done("render run.mcap -o held.gif --hold 0.5 at collisions --fps 10").output;
    assert!(
        output.starts_with("held.gif: ")
            && output.ends_with(" frames, every step, 10 frames/s, 1 freeze frame of 0.5 s\n"),
        "{output}"
    );
    let delays = delays(&workplace.read("held.gif"));
    // The impact is 0.025 s after step 4. Its frame is shown for the rest of the step and another 0.5 s.
    assert_eq!(delays, [10, 10, 10, 10, 3, 57, 10, 10, 10, 10, 10, 10, 10, 10]);
    workplace.done("render run.mcap -o held.apng --hold 0.5 at collisions --fps 10");
}

/// The freeze frame shows the ball in contact with the plate, as no recorded state does.
#[test]
fn a_freeze_frame_shows_the_bodies_in_contact() {
    use rebond::internals::picture::{Clip, PictureOptions, Source};
    let workplace = workplace("event-driven");
    let source = Source::open(&workplace.path("run.mcap")).unwrap();
    let mut options = PictureOptions::default();
    (options.hold, options.fps) = (Some(0.5), Some(10.0));
    let (clip, _) = Clip::video(&options, std::slice::from_ref(&source), &mut |_, _| ()).unwrap();
    let frames: Vec<_> =
        clip.instants.flat_map(|instant| instant.unwrap().frames().cloned().collect::<Vec<_>>()).collect();
    assert_eq!(frames.len(), 14);
    let right = |frame: &rebond::internals::picture::Frame| frame.sprites[0].rect.far_corner().x;
    assert_eq!(right(&frames[5]), 5.25, "the ball does not touch the plate");
    assert!((frames[5].time - 0.425).abs() < 1e-12, "at {}", frames[5].time);
    assert_eq!(frames[5].collisions.len(), 1, "the collision is not shown");
    let others = frames.iter().enumerate().filter(|(index, _)| *index != 5);
    assert!(others.map(|(_, frame)| right(frame)).all(|x| x < 5.25), "a recorded state shows contact");
    assert_eq!(
        frames.iter().map(|frame| frame.collisions.len()).sum::<usize>(),
        1,
        "the collision is shown more than once"
    );
}

/// Two balls that bounce between walls, and a third one that touches a wall and moves towards it at the beginning, at
/// `rate` Hz.
fn bounces(rate: u32, weight: f64) -> String {
    let ball = |name: &str, x: f64, velocity: [f64; 2]| {
        format!(
            "[[spawn]]\nname = \"{name}\"\nat = [{x:?}, 1.0]\nsize = [0.7, 0.9]\nmass = 2.0\nvelocity = {velocity:?}\n"
        )
    };
    format!(
        "[world]\nsize = [16.0, 9.0]\nwalls = true\ngravity = [0.0, {weight:?}]\n[run]\nrate = {rate}\nduration = 6.0\n\
         [restitution]\ndefault = 0.9\n{}{}{}",
        ball("a", 3.1, [1.3, 0.0]),
        ball("b", 9.0, [-2.7, 3.3]),
        ball("c", 0.0, [-1.0, -0.5]),
    )
}

/// Each collision is in one frame, and a freeze frame contains those at its instant, with the velocities after them, also
/// beside a recording of another rate.
#[test]
fn freeze_frames_contain_their_collisions_with_the_velocities_after_them() {
    use rebond::internals::picture::{Clip, PictureOptions, Source};
    let workplace = Workplace::new();
    let runs = [(60, 9.81), (60, 0.0), (7, 9.81), (1000, 9.81)];
    let sources = runs.map(|(rate, weight)| {
        workplace.write("bounces.toml", &bounces(rate, weight));
        workplace.done(&format!("record bounces.toml -o {rate}-{weight}.mcap"));
        Source::open(&workplace.path(&format!("{rate}-{weight}.mcap"))).unwrap()
    });
    let mut options = PictureOptions::default();
    (options.hold, options.show) = (Some(0.5), Some([Overlay::Impulse].into()));
    for shown in [&sources[..1], &sources[1..2], &sources[2..3], &sources[3..], &sources[1..3], &sources[..]] {
        let (clip, _) = Clip::video(&options, shown, &mut |_, _| ()).unwrap();
        let schedule = clip.schedule.clone();
        let instants: Vec<_> = clip.instants.map(Result::unwrap).collect();
        let mut found = vec![0; shown.len()];
        for (number, instant) in instants.iter().enumerate().filter(|(at, _)| schedule.is_frozen_at(*at as u64)) {
            let is_now = |collision: &&Collision| (collision.instant - instant.time).abs() < 1e-6;
            let mut count = 0;
            for (at, frame) in instant.frames().enumerate() {
                for collision in frame.collisions.iter().filter(is_now) {
                    (count, found[at]) = (count + 1, found[at] + 1);
                    for (id, after) in collision.bodies.iter().zip(collision.after) {
                        let velocity =
                            frame.sprites.iter().find(|sprite| sprite.appearance.id == *id).unwrap().velocity;
                        let is_last = frame.collisions.iter().filter(|other| other.bodies.contains(id)).count() == 1;
                        assert!(!is_last || velocity.sub(after).norm() < 1e-6, "{velocity:?} after {collision:?}");
                    }
                }
            }
            assert!(count > 0, "the freeze frame {number} at {} s contains no collision", instant.time);
        }
        assert!(found.iter().all(|found| *found > 3), "{found:?}");
        for (at, source) in shown.iter().enumerate() {
            let mut all: Vec<Collision> = Vec::new();
            let recording = Recording::read(std::fs::File::open(&source.path).unwrap()).unwrap();
            Replayer::new(recording, ALL_STEPS).unwrap().run(&mut all, |_| ()).unwrap();
            let end = instants.last().unwrap().time;
            let all = all.iter().filter(|collision| collision.instant < end).count();
            let shown: usize = instants
                .iter()
                .filter_map(|instant| instant.frames().nth(at))
                .map(|frame| frame.collisions.len())
                .sum();
            assert_eq!(shown, all, "collisions are shown in no frame or in several");
        }
    }
}

#[test]
fn a_freeze_frame_of_the_handout_solver_is_at_a_state() {
    let scene =
        SCENE.replace("event-driven", "handout").replace("rate = 10", "rate = 100").replace("steps = 12", "steps = 60");
    let workplace = Workplace::with_scene(&scene);
    let output = workplace.done("render scene.toml -o held.gif --hold 0.5 at collisions --fps 50").output;
    assert!(
        output.starts_with("held.gif: ")
            && output.ends_with(" frames, every 2nd step, 50 frames/s, 1 freeze frame of 0.5 s\n"),
        "{output}"
    );
    let longest = delays(&workplace.read("held.gif")).into_iter().max();
    assert!(longest.is_some_and(|longest| (51..=52).contains(&longest)), "{longest:?}");
}

#[test]
fn slow_motion_and_freeze_frames_require_an_animation() {
    let workplace = workplace("event-driven");
    let outcome = workplace.rebond("render run.mcap -o frames/ --slow 0.5");
    assert_eq!(outcome.code, 1);
    assert!(outcome.errors.contains("slow motion and freeze frames require an animation"), "{outcome:?}");
    assert_eq!(workplace.rebond("render run.mcap -o held.gif --hold 0.5 at night").code, 2);
    assert_eq!(workplace.rebond("render run.mcap -o held.gif --slow 0").code, 2);
}

/// Computing a state between two steps does not change the engine.
#[test]
fn a_state_between_steps_agrees_with_a_finer_run_and_changes_no_bit() {
    let engine = |rate: f64| {
        let config = EngineConfig::new(SolverKind::EventDriven, rate)
            .with_gravity(Some(Vector::new(0.0, 10.0)))
            .with_restitution(Restitution::new(0.5, &[]))
            .with_events_per_step(1000);
        let mut engine = Engine::new(config);
        for (x, y, mass, speed) in [(0.0, 4.0, f64::INFINITY, 0.0), (0.0, 0.0, 1.0, 2.0), (0.5, 1.5, 3.0, -1.0)] {
            let size = if mass == 1.0 { 1.0 } else { 2.0 };
            let spawn = Spawn::new(format!("{mass}"), Rect::new(Vector::new(x, y), size, 1.0), mass);
            engine.apply(&Event::Spawn(spawn.with_velocity(Vector::new(speed, 0.0))));
        }
        engine
    };
    let (mut coarse, mut fine, mut undisturbed) = (engine(8.0), engine(32.0), engine(8.0));
    for _ in 0..16 {
        for quarter in 0..4 {
            let world = coarse.world_after(f64::from(quarter) / 32.0, &mut Vec::new()).unwrap();
            for (found, expected) in world.bodies.iter().zip(&fine.world().bodies) {
                let position_error = found.rect.origin.sub(expected.rect.origin).norm();
                let error = position_error + found.velocity.sub(expected.velocity).norm();
                assert!(error < 1e-12, "step {}, quarter {quarter}: {found:?} {expected:?}", coarse.current_step());
            }
            fine.step(&mut Vec::new()).unwrap();
        }
        coarse.step(&mut Vec::new()).unwrap();
        undisturbed.step(&mut Vec::new()).unwrap();
        assert_eq!(coarse.snapshot(), undisturbed.snapshot());
    }
}

#[test]
fn long_clips_need_confirmation_and_have_a_limit() {
    let workplace = workplace("event-driven");
    for (slow, long, expected) in [
        ("1e-4", "", "or allow it with --long"),
        ("1e-6", " --long", "no clip may have more than 10000000 frames or 10000000 s"),
    ] {
        let outcome = workplace.rebond(&format!("render run.mcap -o slow.gif --slow {slow}{long}"));
        assert_eq!(outcome.code, 1, "{outcome:?}");
        assert!(outcome.errors.replace("\n  │ ", " ").contains(expected), "{outcome:?}");
        assert!(!workplace.path("slow.gif").exists());
    }
}

/// Fewer frames do not shorten a clip; a higher speed does.
#[test]
fn the_advice_for_a_clip_of_a_long_run_works() {
    let scene = SCENE.replace("rate = 10", "rate = 1e-4").replace("steps = 12", "steps = 3000");
    let workplace = Workplace::with_scene(&scene.replace("[10.0, 0.0]", "[0.0, 0.0]"));
    workplace.done("record scene.toml -o run.mcap");
    // With 31 frames, and with 30 per second.
    for (every, slow) in [(" --every 100", "9000"), ("", "10000")] {
        let outcome = workplace.rebond(&format!("render run.mcap -o long.gif{every}"));
        let advice = format!("play it faster with --slow {slow}, or draw a part with --from and --to");
        assert!(outcome.code == 1 && outcome.errors.replace("\n  │ ", " ").contains(&advice), "{outcome:?}");
    }
    workplace.done("render run.mcap -o long.gif --every 100 --slow 9000");
}

#[test]
fn freeze_frames_count_towards_the_length_of_a_clip() {
    // The ball hits a plate 30 times per second: many freeze frames of a minute.
    let second = "[[spawn]]\nat = [4.0, 0.5]\nsize = [0.1, 3.5]\nmass = inf\n[[spawn]]\nname = \"plate\"";
    let scene = SCENE.replace("rate = 10\nsteps = 12", "rate = 60\nsteps = 240");
    let scene = scene.replace("at = [0.5, 2.0]", "at = [4.2, 2.0]").replace("[[spawn]]\nname = \"plate\"", second);
    let workplace = Workplace::with_scene(&scene.replace("[10.0, 0.0]", "[19.5, 0.0]"));
    workplace.done("record scene.toml -o run.mcap");
    for output in ["held.gif", "held.apng"] {
        let outcome = workplace.rebond(&format!("render run.mcap -o {output} --hold 60 at collisions"));
        assert!(outcome.code == 1 && outcome.errors.contains("--long"), "{outcome:?}");
        assert!(!workplace.path(output).exists());
    }
    // A third as many make no long clip.
    workplace.done("render scene.toml -o held.gif --set spawn.ball.velocity=[6.5,0.0] --hold 60 at collisions");
}
