use std::{io::Cursor, ops::RangeInclusive};

use super::*;
use crate::{
    physics::{Collision, CollisionCount, Observer, Rect, Vector},
    recording::{
        BodyInfo, BodyTable, Change, Item, RecordedEvent, RecordedState, Recording, StateDigest,
        testing::{self, body, bounce, record, record_altered},
    },
    text::counted,
};

fn verdict_of(bytes: &[u8], steps: RangeInclusive<u64>) -> String {
    let recording = Recording::read(Cursor::new(bytes)).unwrap();
    Replayer::new(recording, steps).unwrap().run(&mut CollisionCount::default(), |_| ()).unwrap().to_string()
}

fn verdict(bytes: &[u8]) -> String {
    verdict_of(bytes, ALL_STEPS)
}

fn flip(number: &mut f64) {
    *number = f64::from_bits(number.to_bits() ^ 1);
}

/// Sets the digest of a state to the one that its values have.
fn update_digest(run: &testing::Run, state: &mut RecordedState) {
    let mut digest = StateDigest::default();
    let mut table = BodyTable::default();
    run.events.iter().filter(|event| event.step <= state.step).for_each(|event| table.apply(&event.change));
    for (info, recorded) in table.join_state(state) {
        digest.add(info.id, recorded.unwrap_or_else(|| info.initial_state()));
    }
    state.digest = digest.value();
}

#[test]
fn a_recording_replays_the_same() {
    assert_eq!(verdict(&record(&bounce(50))), "same: 50 steps, 7 bodies");
}

#[test]
fn only_the_chosen_steps_are_compared() {
    let bytes = record(&bounce(50));
    assert_eq!(verdict_of(&bytes, 20..=30), "same: 10 steps, 7 bodies");
    let altered = record_altered(&bounce(50), |state| {
        if state.step == 31 {
            flip(&mut state.x[0])
        }
    });
    assert_eq!(verdict_of(&altered, 20..=30), "same: 10 steps, 7 bodies");
}

#[test]
fn one_flipped_bit_of_one_number_is_reported_exactly() {
    let run = bounce(50);
    for is_digest_updated in [false, true] {
        let mut original = None;
        let bytes = record_altered(&run, |state| {
            if state.step == 17 {
                original = Some(state.vy[1]);
                flip(&mut state.vy[1]);
                if is_digest_updated {
                    update_digest(&run, state);
                }
            }
        });
        let replayed = original.unwrap();
        let recorded = f64::from_bits(replayed.to_bits() ^ 1);
        assert_eq!(
            verdict(&bytes),
            format!(
                "diverged at step 17: body \"c\" vy recorded {recorded:?} replayed {replayed:?} (1 ulp), \
                 after event spawn \"b\" at step 10"
            )
        );
    }
}

#[test]
fn the_first_differing_body_and_field_are_named() {
    let bytes = record_altered(&bounce(50), |state| {
        if state.step == 40 {
            [&mut state.vx[1], &mut state.y[1], &mut state.vy[0]].into_iter().for_each(flip);
        }
    });
    let found = verdict(&bytes);
    assert!(found.starts_with("diverged at step 40: body \"c\" vy recorded "), "{found}");
    assert!(found.ends_with(" (1 ulp), after event delete \"a\" at step 25"), "{found}");
}

#[test]
fn a_thinned_out_state_is_compared_by_its_digest() {
    let mut run = bounce(50);
    run.header.every = 10;
    assert_eq!(verdict(&record(&run)), "same: 50 steps, 7 bodies");
    let mut digest = 0;
    let bytes = record_altered(&run, |state| {
        if state.step == 5 {
            digest = state.digest;
            state.digest ^= 1;
        }
    });
    let recorded = digest ^ 1;
    assert_eq!(
        verdict(&bytes),
        format!(
            "diverged at step 5: the digest of all bodies recorded {recorded:016x} replayed {digest:016x}, \
             after event spawn \"c\" at step 0"
        )
    );
}

#[test]
fn a_recorded_error_is_reproduced() {
    let mut run = bounce(50);
    let fast = body("fast");
    let spawn = crate::physics::Spawn {
        rect: Rect::new(Vector::new(1e300, 1e300), 1.0, 1.0),
        velocity: Vector::new(1.7e308, 0.0),
        force: Vector::new(1.7e308, 0.0),
        ..fast
    };
    let change = Change::Spawn(BodyInfo::new(7, spawn).into());
    run.events.push(RecordedEvent { step: 30, change });
    let found = verdict(&record(&run));
    let error = "step 31: the position or velocity of body \"fast\" exceeds the range of numbers; start it smaller, slower or nearer to the origin";
    assert_eq!(found, format!("same: 31 steps, then the recorded error: {error}"));
}

#[test]
fn a_wall_can_be_deleted_and_its_name_taken_at_step_0() {
    let body = "name = \"wall-top\"\nat = [1.0, 2.0]\nsize = [1.0, 1.0]\nmass = 2.0";
    let text = format!("[world]\nwalls = true\n[run]\nsteps = 10\n[[spawn]]\n{body}\n[[delete]]\nname = \"wall-top\"");
    let mut run = Run::new(&crate::scene::parse("test.toml", &text).unwrap());
    run.apply_inputs(Vec::new(), |error| Err(error.into())).unwrap();
    let names: Vec<&str> = run.engine().world().bodies.iter().map(|body| body.name.as_str()).collect();
    assert_eq!(names, ["wall-bottom", "wall-left", "wall-right", "wall-top"]);
}

#[test]
fn the_rest_of_a_cut_recording_replays_the_same() {
    let bytes = record(&bounce(50));
    let cut = &bytes[..bytes.len() / 2];
    let found = verdict(cut);
    assert!(found.starts_with("incomplete: truncated after step ") && found.ends_with(" same"), "{found}");
}

#[test]
fn a_replay_from_any_step_starts_at_a_keyframe_and_is_the_same() {
    let bytes = record(&bounce(50));
    for from in 0..=50 {
        assert_eq!(verdict_of(&bytes, from..=u64::MAX), format!("same: {}, 7 bodies", counted(50 - from, "step")));
    }
    let altered = record_altered(&bounce(50), |state| {
        if state.step == 31 {
            flip(&mut state.x[0])
        }
    });
    let found = verdict_of(&altered, 25..=40);
    assert!(found.starts_with("diverged at step 31: body \"c\" x recorded "), "{found}");
}

#[test]
fn replay_continues_after_a_damaged_chunk() {
    let mut bytes = record(&bounce(100));
    let offset = bytes.len() / 3;
    bytes[offset] ^= 1;
    let found = verdict(&bytes);
    assert!(found.starts_with("corrupt chunk "), "{found}");
    let same: u64 = found.rsplit(' ').nth(2).unwrap().parse().unwrap();
    assert!((100 - 21..100).contains(&same), "{found}");
}

#[test]
fn the_observer_receives_the_collisions_of_the_run() {
    let run = bounce(50);
    let mut collisions: Vec<Collision> = Vec::new();
    let recording = Recording::read(Cursor::new(record(&run))).unwrap();
    Replayer::new(recording, ALL_STEPS).unwrap().run(&mut collisions, |_| ()).unwrap();
    let mut count = CollisionCount::default();
    collisions.iter().for_each(|collision| count.collision(collision));
    let recorded = Recording::read(Cursor::new(record(&run))).unwrap().filter_map(|item| match item {
        Ok(Item::Trailer(trailer)) => Some(trailer.collisions),
        _ => None,
    });
    assert_eq!(recorded.collect::<Vec<_>>(), [Some(count.0)]);
    assert!(count.0 > 0);
}
