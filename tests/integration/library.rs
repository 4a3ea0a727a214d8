//! The library as used in the tests of other programs.

use crate::check::{lecture_folder, record_with_modified_engine};
use rebond::internals::replay::{self, NO_LIVE_EVENTS, RecordOptions};
use rebond::testing::assert_replays;
use rebond::{
    Axis, BlueprintTable, CollisionFigure, FigureOptions, PictureOptions, SceneBuilder, Source, SpawnTable,
    StatesFigure, StillFormat, SubjectOptions, draw_to_vec,
};
use std::fs::File;
use std::panic::catch_unwind;
use std::path::Path;

/// The panic message of a failing assertion.
fn panic_message(path: &Path) -> String {
    *catch_unwind(|| assert_replays(path)).unwrap_err().downcast::<String>().expect("a message")
}

#[test]
fn a_scene_built_in_code_is_recorded_and_replays() {
    let folder = tempfile::TempDir::new().unwrap();
    let path = folder.path().join("builder.mcap");
    let spawn = SpawnTable::new([1.0, 1.0], BlueprintTable::new().velocity([1.0, 0.25]));
    let scene = SceneBuilder::new().spawn(spawn).build("builder.toml").unwrap();
    replay::record(&scene, RecordOptions::complete(&scene), NO_LIVE_EVENTS, File::create(&path).unwrap(), |_| ())
        .unwrap();
    assert_replays(&path);
    let stored = rebond::internals::picture::Source::open(&path).unwrap().scene;
    assert_eq!(stored.inputs, scene.inputs, "the recording carries the scene as text");
}

#[test]
fn a_recording_that_does_not_replay_panics_with_the_first_difference() {
    let workplace = lecture_folder();
    let path = workplace.path("scene.mcap");
    assert_replays(&path);
    record_with_modified_engine(&workplace);
    let message = panic_message(&path);
    assert!(message.contains("scene.mcap: diverged at step 1: body \"c\" vy recorded "), "{message}");
    std::fs::write(&path, "").unwrap();
    assert!(panic_message(&path).contains("scene.mcap: "));
}

#[test]
fn lecture_figures_are_drawn_with_the_types_of_the_api() {
    let folder = tempfile::TempDir::new().unwrap();
    let path = folder.path().join("wall.mcap");
    let scene = SceneBuilder::new()
        .world(rebond::WorldTable::new().walls(true))
        .spawn(SpawnTable::new([14.0, 3.0], BlueprintTable::new().velocity([4.0, 0.0])))
        .build("wall.toml")
        .unwrap();
    rebond::record(&scene, RecordOptions::complete(&scene), NO_LIVE_EVENTS, File::create(&path).unwrap(), |_| ())
        .unwrap();
    let collision = |figure| FigureOptions::Collision { figure, step: 0.into(), pair: None };
    let figures = [
        collision(CollisionFigure::Minkowski),
        FigureOptions::States(StatesFigure::Strobe),
        FigureOptions::States(StatesFigure::Spacetime(Axis::X)),
    ];
    let pictures = figures.map(|figure| {
        let subject = SubjectOptions::Figure { figure, format: StillFormat::Svg };
        draw_to_vec(&subject, &PictureOptions::default(), &[Source::open(&path).unwrap()]).unwrap()
    });
    for (index, picture) in pictures.iter().enumerate() {
        assert!(picture.starts_with(b"<svg") && !pictures[..index].contains(picture), "figure {index}");
    }
}
