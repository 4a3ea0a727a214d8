//! The scenes and recordings that come with rebond.

use crate::rebond::bundled_scenes;
use rebond::scene;
use std::fs;
use std::path::Path;

#[test]
fn every_bundled_scene_is_read() {
    let scenes = bundled_scenes();
    assert!(scenes.len() >= 12, "{} scenes", scenes.len());
    for path in scenes {
        let scene = scene::load(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
        assert!(scene.title.is_some(), "{}: a lecturer wants a title", path.display());
    }
}

/// The recordings and pictures were made once and committed: a change of an engine by one bit, or of
/// a drawing by one pixel, shows here.
#[test]
fn committed_recordings_and_pictures_are_what_their_scenes_give() {
    let mut command = assert_cmd::Command::new(env!("CARGO_BIN_EXE_rebond"));
    command.current_dir(env!("CARGO_MANIFEST_DIR"));
    let output = command.args(["check", "recordings", "snapshots", "--report", "failures/check"]).output().unwrap();
    let told = String::from_utf8_lossy(&output.stdout);
    assert!(output.status.success(), "{told}{}", String::from_utf8_lossy(&output.stderr));
    let held = |name: &str| told.lines().any(|line| line.starts_with(name) && line.contains(": same"));
    for path in bundled_scenes().iter().filter(|path| path.with_extension("mcap").exists()) {
        let name = path.with_extension("mcap").file_name().unwrap().to_string_lossy().into_owned();
        assert!(held(&format!("recordings/{name}: ")), "{name} in {told}");
    }
    assert!(held("snapshots/gallery/click-session.gif: "), "{told}");
}

/// The README shows what its commands give, all of it, and a page of it loads in no time.
#[test]
fn the_gallery_is_drawn_by_commands_and_shown_by_the_readme() {
    let package = Path::new(env!("CARGO_MANIFEST_DIR"));
    let [readme, commands] =
        ["README.md", "recordings/gallery.check"].map(|name| fs::read_to_string(package.join(name)).unwrap());
    let pictures: Vec<_> = fs::read_dir(package.join("snapshots/gallery")).unwrap().map(Result::unwrap).collect();
    assert!(pictures.len() >= 10, "{} pictures", pictures.len());
    for picture in pictures {
        let name = picture.file_name().into_string().unwrap();
        assert!(commands.contains(&format!(" -o ../snapshots/gallery/{name} ")), "no command draws {name}");
        assert!(readme.contains(&format!("](snapshots/gallery/{name})")), "the README does not show {name}");
        assert!(picture.metadata().unwrap().len() < 1_000_000, "{name} is too large");
    }
}
