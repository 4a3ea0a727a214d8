//! Tests of [`trace`](super::trace::trace).

use super::trace::{Between, Trace, Traced, trace};
use super::{Source, StepGrid, Thinning, recorded_world};
use crate::physics::{Collision, Vector};
use crate::picture::figures::{EnergySample, SystemSums, TimeCurve};
use crate::recording::Playback;
use crate::replay::{self, ALL_STEPS, RecordOptions, Replayer};
use crate::scene;
use std::fs::File;
use std::ops::RangeInclusive;

/// Two boxes between walls, and a third that comes and goes, at `rate` Hz for four seconds.
fn source(folder: &std::path::Path, rate: u64, e: f64) -> Source {
    source_of(folder, rate, e, "event-driven")
}

fn source_of(folder: &std::path::Path, rate: u64, e: f64, solver: &str) -> Source {
    let body = |name: &str, x: f64, y: f64, velocity: f64| {
        format!(
            "[[spawn]]\nname = \"{name}\"\nat = [{x:?}, {y:?}]\nsize = [1.0, 1.0]\nmass = 1.0\nvelocity = [{velocity:?}, 0.0]\n"
        )
    };
    let text = format!(
        "[world]\nsize = [16.0, 9.0]\nwalls = true\n[run]\nrate = {rate}\nsteps = {}\nsolver = \"{solver}\"\n[restitution]\ndefault = {e:?}\n{}{}{}\
         step = {rate}\n[[delete]]\nstep = {}\nname = \"late\"\n",
        4 * rate,
        body("a", 3.0, 1.0, 7.0),
        body("b", 8.0, 1.0, -5.0),
        body("late", 8.0, 5.0, 3.0),
        rate + rate / 2,
    );
    let path = folder.join(format!("{rate}.mcap"));
    let scene = scene::parse("scene.toml", &text).unwrap();
    replay::record(
        &scene,
        RecordOptions::complete(&scene),
        replay::NO_LIVE_EVENTS,
        File::create(&path).unwrap(),
        |_| (),
    )
    .unwrap();
    Source::open(&path).unwrap()
}

/// Time, kinetic energy, and the flags of each point.
fn points(source: &Source, column: f64) -> (Vec<(f64, f64, bool)>, Trace) {
    let grid = StepGrid::new(0..=source.header.steps, source.header.config.rate, Thinning::All);
    let mut points = Vec::new();
    let visit = |traced: Traced| {
        if let Traced::World(point) = traced {
            points.push((point.time, point.world.kinetic_energy(), point.is_after_change));
        }
    };
    let trace = trace(source, &grid, column, Between::Collisions, &mut |_, _| (), visit).unwrap();
    (points, trace)
}

#[test]
fn collisions_are_vertical_steps_at_their_instants_at_every_rate() {
    let folder = tempfile::tempdir().unwrap();
    for rate in [4, 20, 64] {
        let source = source(folder.path(), rate, 0.9);
        let (points, _) = points(&source, 1e-6);
        let mut collisions: Vec<Collision> = Vec::new();
        let recording = source.recording().unwrap();
        Replayer::new(recording, ALL_STEPS).unwrap().run(&mut collisions, |_| ()).unwrap();
        collisions.retain(|collision| collision.impulse != 0.0);
        assert!(collisions.len() > 3, "{} collisions at {rate} Hz", collisions.len());
        let mut lost = 0.0;
        for collision in &collisions {
            let at = |&(time, ..): &(f64, f64, bool)| (time - collision.instant).abs() < 1e-12;
            let energies: Vec<f64> = points.iter().filter(|point| at(point)).map(|point| point.1).collect();
            let [before, .., after] = energies[..] else { panic!("{} at {rate} Hz: {energies:?}", collision.instant) };
            assert!(after < before, "{} at {rate} Hz: {energies:?}", collision.instant);
            lost += before - after;
        }
        // Between collisions, spawns and deletes nothing changes: there are no ramps.
        let jumps = points.windows(2).filter(|pair| pair[0].0 == pair[1].0);
        let (all, vertical) =
            (points.windows(2).map(|pair| pair[1].1 - pair[0].1), jumps.map(|pair| pair[1].1 - pair[0].1));
        assert!((all.sum::<f64>() - vertical.sum::<f64>()).abs() < 1e-9 && lost > 1.0, "at {rate} Hz");
    }
}

#[test]
fn impulses_of_the_handout_solver_are_vertical_steps_at_the_beginning_of_their_step() {
    let folder = tempfile::tempdir().unwrap();
    for rate in [20, 64] {
        let source = source_of(folder.path(), rate, 0.9, "handout");
        let (points, _) = points(&source, 1e-6);
        let mut collisions: Vec<Collision> = Vec::new();
        Replayer::new(source.recording().unwrap(), ALL_STEPS).unwrap().run(&mut collisions, |_| ()).unwrap();
        collisions.retain(|collision| collision.impulse != 0.0);
        assert!(collisions.len() > 3, "{} collisions at {rate} Hz", collisions.len());
        for collision in &collisions {
            let at = |&(time, ..): &(f64, f64, bool)| (time - collision.instant).abs() < 1e-12;
            let energies: Vec<f64> = points.iter().filter(|point| at(point)).map(|point| point.1).collect();
            assert!(energies.last() < energies.first(), "{} at {rate} Hz: {energies:?}", collision.instant);
        }
        let ramps = points.windows(2).filter(|pair| pair[0].0 != pair[1].0 && pair[0].1 != pair[1].1);
        assert_eq!(ramps.count(), 0, "at {rate} Hz");
    }
}

/// With weight and a constant force: between the vertical steps, the velocity changes as these forces demand.
#[test]
fn forces_act_after_the_impulses_of_a_step_of_the_handout_solver() {
    let folder = tempfile::tempdir().unwrap();
    let text = "[world]\nsize = [16.0, 9.0]\nwalls = true\ngravity = [0.0, 8.0]\n[run]\nrate = 32\nsteps = 96\n\
        solver = \"handout\"\n[restitution]\ndefault = 0.5\n[[spawn]]\nat = [3.0, 6.0]\nsize = [1.0, 1.0]\nmass = 2.0\n\
        velocity = [1.0, 0.0]\nforce = [4.0, 0.0]\n";
    let path = folder.path().join("fall.mcap");
    let scene = scene::parse("scene.toml", text).unwrap();
    let options = RecordOptions::complete(&scene);
    replay::record(&scene, options, replay::NO_LIVE_EVENTS, File::create(&path).unwrap(), |_| ()).unwrap();
    let source = Source::open(&path).unwrap();
    let grid = StepGrid::new(0..=96, 32.0, Thinning::All);
    let mut points = Vec::new();
    let visit = |traced: Traced| match traced {
        Traced::World(point) => points.push((point.time, point.world.bodies.last().unwrap().velocity)),
        Traced::Impacts(impacts) => panic!("{impacts:?}"),
    };
    trace(&source, &grid, 1e-6, Between::Collisions, &mut |_, _| (), visit).unwrap();
    let steps = points.windows(2).filter(|pair| pair[0].0 == pair[1].0);
    assert!(steps.clone().count() > 10 && steps.clone().all(|pair| pair[1].1.y <= 0.0), "{points:?}");
    for pair in points.windows(2).filter(|pair| pair[0].0 < pair[1].0) {
        assert_eq!(pair[1].1.sub(pair[0].1), Vector::new(2.0 / 32.0, 8.0 / 32.0), "{pair:?}");
    }
}

#[test]
fn spawns_and_deletes_are_vertical_steps_and_are_listed() {
    let folder = tempfile::tempdir().unwrap();
    let (points, trace) = points(&source(folder.path(), 20, 1.0), 1e-6);
    assert_eq!((trace.changes, trace.gaps.len()), (vec![1.0, 1.5], 0));
    for time in [1.0, 1.5] {
        let energies: Vec<f64> = points.iter().filter(|point| point.0 == time).map(|point| point.1).collect();
        assert_eq!(energies, if time == 1.0 { [37.0, 41.5] } else { [41.5, 37.0] });
    }
    assert_eq!(points.iter().filter(|point| point.2).map(|point| point.0).collect::<Vec<f64>>(), [1.0, 1.5]);
}

/// A scene of some bodies that come and go, with or without walls, weight, constant forces and losses.
fn random_scene(seed: u32) -> String {
    let mut state = seed.wrapping_mul(2_654_435_769) | 1;
    let mut random = |from: f64, to: f64| {
        // Marsaglia's xorshift.
        state ^= state << 13;
        state ^= state >> 17;
        state ^= state << 5;
        from + (to - from) * f64::from(state >> 8) / f64::from(1 << 24)
    };
    let solver = ["handout", "event-driven"][seed as usize % 2];
    let gravity = if (seed / 2).is_multiple_of(2) { "" } else { "gravity = [0.5, 9.81]\n" };
    let rate = random(10.0, 70.0).round();
    let mut text = format!(
        "[world]\nsize = [16.0, 9.0]\nwalls = {}\n{gravity}[run]\nrate = {rate}\nsteps = 60\nsolver = \"{solver}\"\n\
         [restitution]\ndefault = {:?}\n",
        !seed.is_multiple_of(3),
        random(0.2, 1.0),
    );
    for body in 0..6 {
        let at = [1.0 + 2.3 * f64::from(body), random(1.0, 7.0)];
        let (size, velocity) = ([random(0.2, 1.0), random(0.2, 1.0)], [random(-6.0, 6.0), random(-6.0, 6.0)]);
        let (step, mass) = (if body < 3 { 0.0 } else { random(1.0, 30.0).round() }, random(0.1, 9.0));
        text += &format!(
            "[[spawn]]\nname = \"b{body}\"\nstep = {step}\nat = {at:?}\nsize = {size:?}\nmass = {mass:?}\n\
             velocity = {velocity:?}\n"
        );
        if seed.is_multiple_of(5) && body % 2 == 0 {
            text += &format!("force = [{:?}, {:?}]\n", random(-3.0, 3.0), random(-3.0, 3.0));
        }
        if body % 2 == 1 {
            text += &format!("[[delete]]\nstep = {}\nname = \"b{body}\"\n", random(31.0, 58.0).round());
        }
    }
    text
}

/// The energies of a figure are those of the table, which are computed from the recorded states.
#[test]
fn the_energy_of_each_state_is_that_of_the_exported_table_to_the_bit() {
    let folder = tempfile::tempdir().unwrap();
    let (mut with_potential, mut compared) = (0, 0);
    let seeds = if cfg!(debug_assertions) { 20 } else { 60 };
    for seed in 0..seeds {
        let path = folder.path().join(format!("{seed}.mcap"));
        let scene = scene::parse("scene.toml", &random_scene(seed)).unwrap();
        let options = RecordOptions::complete(&scene);
        replay::record(&scene, options, replay::NO_LIVE_EVENTS, File::create(&path).unwrap(), |_| ()).unwrap();
        let source = Source::open(&path).unwrap();
        let bits = |sample: EnergySample| {
            let EnergySample { kinetic, potential, momentum, .. } = sample;
            [kinetic, potential, sample.total(), momentum.x, momentum.y].map(f64::to_bits)
        };
        let table: Vec<(f64, [u64; 5])> = Playback::new(source.recording().unwrap())
            .map(|state| state.unwrap())
            .map(|state| (state.time, EnergySample::of(&recorded_world(&state, &source.header.config), state.time)))
            .map(|(time, sample)| (time, bits(sample)))
            .collect();
        let grid = StepGrid::new(0..=source.header.steps, source.header.config.rate, Thinning::All);
        for column in [1e-6, 1.0] {
            let mut drawn = Vec::new();
            let visit = |traced: Traced| {
                if let Traced::World(point) = traced {
                    drawn.push((point.time, bits(EnergySample::of(point.world, point.time))));
                }
            };
            trace(&source, &grid, column, Between::Collisions, &mut |_, _| (), visit).unwrap();
            for row in &table {
                assert!(drawn.contains(row), "seed {seed}, t = {}: {row:?} is not drawn", row.0);
                compared += 1;
            }
        }
        with_potential += u32::from(table.iter().any(|row| f64::from_bits(row.1[1]) != 0.0));
    }
    let of_seeds = |fraction: f64| f64::from(with_potential) > fraction * seeds as f64;
    assert!(of_seeds(0.3) && !of_seeds(0.85) && compared > 80 * seeds, "{with_potential}, {compared}");
}

/// Thinned figures, and those of a recording that stores few states in full, show the same motion, in every range of
/// steps: where a body moves while others collide, sums over all bodies have its present values, and what happens
/// after the range is no part of it.
#[test]
fn thinned_runs_are_traced_like_complete_ones() {
    let folder = tempfile::tempdir().unwrap();
    let sums = |source: &Source, every: u64, column: f64, steps: &RangeInclusive<u64>| {
        let grid = StepGrid::new(steps.clone(), source.header.config.rate, Thinning::Every(every));
        let (mut sums, mut samples) = (SystemSums::default(), Vec::new());
        let visit = |part: Traced| match part {
            Traced::World(point) => {
                let sample = EnergySample::of(point.world, point.time);
                sums.set(point.world, sample);
                samples.push(sample);
            }
            Traced::Impacts(impacts) => samples.extend(sums.collide(impacts).into_iter().flatten()),
        };
        let trace = trace(source, &grid, column, Between::Collisions, &mut |_, _| (), visit).unwrap();
        (samples, trace.changes, trace.gaps)
    };
    for seed in 0..12 {
        let scene = scene::parse("scene.toml", &random_scene(seed)).unwrap();
        let sources = [1, 7, 10].map(|every| {
            let path = folder.path().join(format!("{seed}-{every}.mcap"));
            let options = RecordOptions::complete(&scene).every(every);
            replay::record(&scene, options, replay::NO_LIVE_EVENTS, File::create(&path).unwrap(), |_| ()).unwrap();
            Source::open(&path).unwrap()
        });
        for column in [1e-6, 0.02, 1.0] {
            for steps in [0..=60, 0..=56, 0..=57, 30..=59, 58..=60, 60..=60] {
                let complete = sums(&sources[0], 1, column, &steps);
                for (source, every) in [(0, 30), (1, 1), (2, 10)] {
                    let is_at_multiple = steps.start().is_multiple_of(every);
                    let is_same = !is_at_multiple || sums(&sources[source], every, column, &steps) == complete;
                    assert!(is_same, "seed {seed}, column {column}, steps {steps:?}, recording {source}");
                }
            }
        }
    }
}

/// A ball that crosses a slot 100 times per second, with or without weight.
fn slot(folder: &std::path::Path, rate: u32, gravity: &str) -> Source {
    let text = format!(
        "world = {{ size = [1.6, 0.9]{gravity} }}\nrun = {{ duration = 4.0, rate = {rate} }}\n\
         [[spawn]]\nname = \"left\"\nat = [0.0, 0.0]\nsize = [0.5, 0.9]\nmass = inf\n\
         [[spawn]]\nname = \"right\"\nat = [1.1, 0.0]\nsize = [0.5, 0.9]\nmass = inf\n\
         [[spawn]]\nname = \"ball\"\nat = [0.5, 0.4]\nsize = [0.1, 0.1]\nmass = 2.0\nvelocity = [50.0, 0.0]\n"
    );
    let scene = scene::parse("scene.toml", &text).unwrap();
    let path = folder.join(format!("{rate}{}.mcap", gravity.len()));
    let options = RecordOptions::complete(&scene);
    replay::record(&scene, options, replay::NO_LIVE_EVENTS, File::create(&path).unwrap(), |_| ()).unwrap();
    Source::open(&path).unwrap()
}

/// Every crossing is in the trace, if several collisions are in a column and if several steps are.
#[test]
fn the_colliding_bodies_are_traced_at_every_collision() {
    let folder = tempfile::tempdir().unwrap();
    for (rate, column) in [(10, 0.05), (1000, 0.05), (10, 1e-6)] {
        let source = slot(folder.path(), rate, "");
        let mut collisions: Vec<Collision> = Vec::new();
        Replayer::new(source.recording().unwrap(), ALL_STEPS).unwrap().run(&mut collisions, |_| ()).unwrap();
        let grid = StepGrid::new(0..=source.header.steps, f64::from(rate), Thinning::All);
        let (mut traced, mut last) = (Vec::new(), 0.0);
        let visit = |part: Traced| {
            let (time, at) = match part {
                Traced::World(point) => (point.time, point.world.bodies[2].rect.origin.x),
                Traced::Impacts(impacts) => {
                    assert!(impacts.are_complete(), "{impacts:?}");
                    (impacts.time, impacts.bodies[&2].rect.origin.x)
                }
            };
            assert!(time >= last, "{time} after {last}");
            last = time;
            traced.push((time, at));
        };
        trace(&source, &grid, column, Between::Collisions, &mut |_, _| (), visit).unwrap();
        assert!(collisions.len() > 390, "{}", collisions.len());
        for Collision { instant, rects, .. } in &collisions {
            let expected = rects.iter().find(|rect| rect.width() == 0.1).unwrap().origin.x;
            let is_shown = |(time, at): &(f64, f64)| (time - instant).abs() < 1e-9 && (at - expected).abs() < 1e-9;
            assert!(traced.iter().any(is_shown), "{instant} at {rate} Hz, column {column}");
        }
    }
}

#[test]
fn figures_show_fast_motion_as_a_band() {
    let folder = tempfile::tempdir().unwrap();
    for (rate, gravity) in [(10, ""), (1000, ""), (10, ", gravity = [30.0, 0.0]"), (1000, ", gravity = [30.0, 0.0]")] {
        let source = slot(folder.path(), rate, gravity);
        let grid = StepGrid::new(0..=source.header.steps, f64::from(rate), Thinning::All);
        let mut sums = SystemSums::default();
        let (mut momenta, mut energies) = (TimeCurve::new(0.05), TimeCurve::new(0.05));
        let visit = |part: Traced| {
            let samples = match part {
                Traced::World(point) => {
                    let sample = EnergySample::of(point.world, point.time);
                    sums.set(point.world, sample);
                    vec![sample]
                }
                Traced::Impacts(impacts) => sums.collide(impacts).unwrap().into(),
            };
            for sample in samples {
                momenta.push(sample.time, sample.momentum.x);
                energies.push(sample.time, sample.total());
            }
        };
        trace(&source, &grid, 0.05, Between::Collisions, &mut |_, _| (), visit).unwrap();
        let energies: Vec<f64> = energies.values().collect();
        assert!(energies.iter().all(|energy| (energy - energies[0]).abs() < 1e-9 * energies[0].abs()), "{energies:?}");
        let parts = momenta.parts();
        for column in 0..79 {
            let within = parts[0].iter().filter(|point| (point[0] / 0.05).floor() == f64::from(column));
            let values: Vec<f64> = within.map(|point| point[1]).collect();
            assert!(values.iter().any(|p| *p > 99.0) && values.iter().any(|p| *p < -99.0), "{column}: {values:?}");
        }
    }
}

#[test]
fn wide_columns_show_the_states_and_the_colliding_bodies() {
    let folder = tempfile::tempdir().unwrap();
    let (points, trace) = points(&source(folder.path(), 64, 0.5), 0.1);
    assert_eq!((points.len(), trace.changes.len()), (257, 2));
}
