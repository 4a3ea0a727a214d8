//! The scenes, recordings and pictures in the repository.

use crate::rebond::bundled_scenes;
use rebond::internals::scene;
use std::fs;
use std::path::Path;

#[test]
fn every_bundled_scene_is_valid_and_has_a_title() {
    let scenes = bundled_scenes();
    assert!(scenes.len() >= 12, "{} scenes", scenes.len());
    for path in scenes {
        let scene = scene::load(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
        assert!(scene.title.is_some(), "{}: no title", path.display());
    }
}

/// Fails if a state changes by one bit or a drawing by one pixel.
#[test]
#[cfg_attr(debug_assertions, ignore = "slow in debug")]
fn committed_recordings_and_pictures_are_unchanged() {
    let mut command = assert_cmd::Command::new(env!("CARGO_BIN_EXE_rebond"));
    command.current_dir(env!("CARGO_MANIFEST_DIR"));
    let output = command.args(["check", "recordings", "snapshots", "--report", "failures/check"]).output().unwrap();
    let output_text = String::from_utf8_lossy(&output.stdout);
    assert!(output.status.success(), "{output_text}{}", String::from_utf8_lossy(&output.stderr));
    let is_same = |name: &str| output_text.lines().any(|line| line.starts_with(name) && line.contains(": same"));
    for path in bundled_scenes().iter().filter(|path| path.with_extension("mcap").exists()) {
        let name = path.with_extension("mcap").file_name().unwrap().to_string_lossy().into_owned();
        assert!(is_same(&format!("recordings/{name}: ")), "{name} in {output_text}");
    }
    assert!(is_same("snapshots/gallery/click-session.gif: "), "{output_text}");
}

/// Every picture of the gallery is at most 3 MB, drawn by a listed command and shown in the README. `page.png` is a photograph
/// of the live page.
#[test]
fn every_gallery_picture_is_listed_and_shown_in_the_readme() {
    let package = Path::new(env!("CARGO_MANIFEST_DIR"));
    let [readme, commands] =
        ["README.md", "recordings/gallery.check"].map(|name| fs::read_to_string(package.join(name)).unwrap());
    let pictures: Vec<_> = fs::read_dir(package.join("snapshots/gallery")).unwrap().map(Result::unwrap).collect();
    assert!(pictures.len() >= 10, "{} pictures", pictures.len());
    for picture in pictures {
        let name = picture.file_name().into_string().unwrap();
        let is_drawn = commands.contains(&format!(" -o ../snapshots/gallery/{name} "));
        assert!(is_drawn || name == "page.png", "no command draws {name}");
        assert!(readme.contains(&format!("](snapshots/gallery/{name})")), "the README does not show {name}");
        assert!(picture.metadata().unwrap().len() < 3_000_000, "{name} is too large");
    }
}
