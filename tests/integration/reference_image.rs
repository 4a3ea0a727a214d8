//! Compares pictures with reference images: decoded pixels, without tolerance.

use rebond::internals::picture::compare::{Comparison, compare, side_by_side};
use rebond::internals::picture::{Picture, png};
use std::fs::{self, File};
use std::io::BufReader;
use std::path::{Path, PathBuf};

/// Asserts that all pixels of `picture` equal those of the reference image `snapshots/<name>.png`.
///
/// With `REBOND_ACCEPT=1` the picture replaces the reference image instead.
#[track_caller]
pub fn assert_reference_image(name: &str, picture: &Picture) {
    let reference = in_package("snapshots", name);
    if std::env::var_os("REBOND_ACCEPT").is_some_and(|value| value == "1") {
        return accept(&reference, picture);
    }
    if let Err(problem) = check(name, picture, &reference, &in_package("failures", name)) {
        panic!("{problem}");
    }
}

/// Compares a picture with its reference image. If they differ, an error describes the difference and the file
/// `failure` shows it.
fn check(name: &str, picture: &Picture, reference: &Path, failure: &Path) -> Result<(), String> {
    let Ok(file) = File::open(reference) else {
        save(failure, picture);
        return Err(format!("{name} has no reference image; the picture is {}; {ADVICE}", failure.display()));
    };
    let (expected, _) = png::decode(BufReader::new(file)).unwrap();
    let comparison = compare(&expected, picture);
    if comparison == Comparison::Same {
        return Ok(());
    }
    save(failure, &side_by_side(&expected, picture));
    let failure = failure.display();
    Err(format!("{name}: {comparison}; {failure} shows expected image, difference and actual image; {ADVICE}"))
}

const ADVICE: &str = "if the change is intended, accept it with REBOND_ACCEPT=1 cargo test";

/// Replaces a reference image, unless its pixels are the same.
fn accept(reference: &Path, picture: &Picture) {
    let current = File::open(reference).ok().and_then(|file| png::decode(BufReader::new(file)).ok());
    if current.is_none_or(|(current, _)| compare(&current, picture) != Comparison::Same) {
        save(reference, picture);
    }
}

/// Writes a picture as PNG with the highest compression, because it is written rarely and kept for long.
fn save(path: &Path, picture: &Picture) {
    fs::create_dir_all(path.parent().unwrap()).unwrap();
    let mut encoder = ::png::Encoder::new(File::create(path).unwrap(), picture.size[0], picture.size[1]);
    encoder.set_color(::png::ColorType::Rgb);
    encoder.set_compression(::png::Compression::High);
    let mut writer = encoder.write_header().unwrap();
    let bytes: Vec<u8> = picture.pixels.iter().flat_map(|&[r, g, b, _]| [r, g, b]).collect();
    writer.write_image_data(&bytes).unwrap();
}

fn in_package(folder: &str, name: &str) -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join(folder).join(format!("{name}.png"))
}

#[test]
fn a_picture_that_differs_is_saved_beside_its_reference_image() {
    let folder = tempfile::TempDir::new().unwrap();
    let [reference, failure] = ["snapshots/a.png", "failures/a.png"].map(|name| folder.path().join(name));
    let expected = Picture { size: [6, 4], pixels: vec![[10, 20, 30, 255]; 24] };
    let mut actual = expected.clone();
    actual.pixels[9] = [10, 20, 31, 255];
    let problem = check("a", &actual, &reference, &failure).unwrap_err();
    assert!(problem.starts_with("a has no reference image; the picture is ") && failure.exists(), "{problem}");
    accept(&reference, &expected);
    assert_eq!(check("a", &expected, &reference, &failure), Ok(()));
    let problem = check("a", &actual, &reference, &failure).unwrap_err();
    assert!(problem.starts_with("a: 1 pixel differs, at (3, 1)"), "{problem}");
    let (shown, _) = png::decode(BufReader::new(File::open(&failure).unwrap())).unwrap();
    assert_eq!(shown, side_by_side(&expected, &actual));
}
