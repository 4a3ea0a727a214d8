//! Assertions of `rebond::testing`: they hold files, and leave new contents beside them.

use crate::check::lecture_folder;
use crate::command_line::SCENE;
use rebond::testing::{Update, hold, hold_picture};
use std::fs;
use std::path::Path;

#[test]
fn a_folder_a_recording_and_a_picture_that_are_the_same_pass() {
    let workplace = lecture_folder();
    rebond::testing::assert_folder(workplace.path(""));
    rebond::testing::assert_recording(workplace.path("scene.mcap"));
    rebond::testing::assert_picture(workplace.path("fall.png"));
    rebond::testing::assert_picture(workplace.path("alone.png"));
    rebond::testing::assert_same_picture(workplace.path("hit.svg"), &workplace.read("hit.svg"));
}

#[test]
fn a_difference_leaves_new_content_which_a_review_accepts_or_rejects() {
    let workplace = lecture_folder();
    let before = workplace.read("fall.png");
    workplace.done("render scene.mcap -o fall.png --force --at 20 --show velocity,name --theme dark");
    workplace.done("figure collision scene.mcap -o hit.svg --force --caption other");
    let changed = ["fall.png", "hit.svg"].map(|name| workplace.read(name));
    let message = hold(&workplace.path(""), Update::No).unwrap_err();
    assert!(message.starts_with("2 files not the same:\n") && message.contains("theme: dark → light"), "{message}");
    let picture = message.split("; see ").nth(1).and_then(|rest| rest.lines().next()).unwrap();
    assert!(Path::new(picture).is_file(), "{message}");
    let page = message.split("\nDifferences: ").nth(1).and_then(|rest| rest.lines().next()).unwrap();
    assert!(Path::new(page).is_file(), "{message}");
    assert!(!workplace.path("fall.png.new").exists());
    let message = hold(&workplace.path(""), Update::New).unwrap_err();
    assert!(message.contains("rebond check --review"), "{message}");
    assert!(["fall.png", "hit.svg"].map(|name| workplace.read(name)) == changed, "the files are kept");
    assert!(workplace.read("fall.png.new") == before);
    let outcome = workplace.rebond("check .");
    assert!(outcome.output.contains("; pending: 2 files, see --review"), "{outcome:?}");
    let outcome = workplace.rebond_with_input("check . --review", "a\nr\n");
    assert!(
        outcome.output.contains("fall.png: accepted\n") && outcome.output.contains("hit.svg: rejected\n"),
        "{outcome:?}"
    );
    assert!(workplace.read("fall.png") == before && workplace.read("hit.svg") == changed[1]);
    assert!(workplace.names().iter().all(|name| !name.ends_with(".new")));
    hold(&workplace.path(""), Update::Always).unwrap();
    hold(&workplace.path(""), Update::No).unwrap();
}

#[test]
fn a_recording_follows_its_scene_and_its_pictures_follow_it() {
    let workplace = lecture_folder();
    workplace.write("scene.toml", &SCENE.replace("velocity = [3.0", "velocity = [2.0"));
    let message = hold(&workplace.path("scene.mcap"), Update::New).unwrap_err();
    assert!(message.contains("drifted: ") && workplace.path("scene.mcap.new").is_file(), "{message}");
    hold(&workplace.path(""), Update::Always).unwrap();
    hold(&workplace.path(""), Update::No).unwrap();
}

#[test]
fn foreign_files_are_never_replaced() {
    let workplace = lecture_folder();
    let picture = workplace.read("fall.png");
    workplace.write("photo.png", "a photo");
    let message = hold_picture(&workplace.path("photo.png"), &picture, Update::Always).unwrap_err();
    assert!(message.contains("it carries no rebond provenance"), "{message}");
    assert_eq!(fs::read_to_string(workplace.path("photo.png")).unwrap(), "a photo");
    hold_picture(&workplace.path("new.png"), &picture, Update::Always).unwrap();
    assert!(workplace.read("new.png") == picture);
    assert!(hold(&workplace.path("nothing"), Update::Always).is_err());
}
