//! Pictures held by reference images: decoded pixels, no tolerance.

use rebond::render::compare::{Comparison, compare, side_by_side};
use rebond::render::{Metadata, Picture, png};
use std::fs::{self, File};
use std::io::BufReader;
use std::path::PathBuf;

/// Fails unless `picture` is the reference image `snapshots/<name>.png` to the last bit.
///
/// With `REBOND_ACCEPT=1` the picture becomes the reference image instead.
#[track_caller]
pub fn assert_reference(name: &str, picture: &Picture) {
    let reference = in_package("snapshots", name);
    if std::env::var_os("REBOND_ACCEPT").is_some_and(|value| value == "1") {
        return accept(&reference, picture);
    }
    let Ok(file) = File::open(&reference) else {
        let failure = save_failure(name, picture);
        panic!("{name} has no reference image; the picture is {}; {ADVICE}", failure.display());
    };
    let (expected, _) = png::decode(BufReader::new(file)).unwrap();
    let comparison = compare(&expected, picture);
    if comparison != Comparison::Same {
        let failure = save_failure(name, &side_by_side(&expected, picture));
        panic!("{name}: {comparison}; expected, difference and actual are {}; {ADVICE}", failure.display());
    }
}

const ADVICE: &str = "look at it, and if it is as it should be, accept it by REBOND_ACCEPT=1 cargo test";

/// Leaves a reference image alone that has the same pixels already, whatever its bytes.
fn accept(reference: &PathBuf, picture: &Picture) {
    let known = File::open(reference).ok().and_then(|file| png::decode(BufReader::new(file)).ok());
    if known.is_none_or(|(known, _)| compare(&known, picture) != Comparison::Same) {
        save(reference, picture);
    }
}

fn save_failure(name: &str, picture: &Picture) -> PathBuf {
    let path = in_package("failures", name);
    save(&path, picture);
    path
}

fn save(path: &PathBuf, picture: &Picture) {
    fs::create_dir_all(path.parent().unwrap()).unwrap();
    png::encode(picture, &Metadata::default(), File::create(path).unwrap()).unwrap();
}

fn in_package(folder: &str, name: &str) -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join(folder).join(format!("{name}.png"))
}
