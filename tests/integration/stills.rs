//! Single frames with every overlay and colouring, in both themes.

use crate::frames::{collision, moving, resized, view};
use crate::rebond::Workplace;
use crate::reference_image::assert_reference_image;
use rebond::internals::physics::{Rect, Vector};
use rebond::internals::picture::{
    CameraTarget, ColorBy, Frame, Look, Overlay, Painter, Picture, RenderError, Style, Theme, View, compose,
};

fn picture(frame: &Frame, view: &View) -> Picture {
    Painter::new().draw(&compose(frame, view))
}

#[test]
fn each_overlay_matches_its_reference_in_both_themes() {
    for theme in Theme::ALL {
        for overlay in Overlay::ALL {
            let view = view(*theme, &[*overlay], ColorBy::Body);
            assert_reference_image(
                &format!("frame-{}-{}", overlay.name(), theme.name()),
                &picture(&collision(), &view),
            );
        }
    }
}

#[test]
fn each_colouring_matches_its_reference_in_both_themes() {
    for theme in Theme::ALL {
        for color_by in ColorBy::ALL {
            let view = view(*theme, Overlay::ALL, *color_by);
            assert_reference_image(
                &format!("frame-by-{}-{}", color_by.name(), theme.name()),
                &picture(&collision(), &view),
            );
        }
    }
}

/// A window of the world, a followed body, and a followed body that does not exist.
#[test]
fn frames_show_the_camera_target() {
    let show = [Overlay::Name, Overlay::Grid, Overlay::Axes, Overlay::Scale, Overlay::Clock];
    let style = view(Theme::Light, &show, ColorBy::Body).style;
    let window = CameraTarget::Window(Rect::new(Vector::new(3.0, 2.0), 6.0, 4.0));
    let follow = CameraTarget::Follow { name: "hull".into(), size: Vector::new(8.0, 4.5) };
    let missing = CameraTarget::Follow { name: "missing".into(), size: Vector::new(8.0, 4.5) };
    for (name, camera_target) in [("window", window), ("follow", follow), ("follow-lost", missing)] {
        let look = Look { camera_target, caption: "Aimed at a part of it".into(), ..style.look.clone() };
        let view = View::new(crate::frames::WORLD, Style { look, ..style.clone() }).unwrap();
        assert_reference_image(&format!("frame-aim-{name}"), &picture(&collision(), &view));
    }
}

/// A followed body stays at the same position on the page, and resting bodies move by whole pixels.
#[test]
fn a_followed_body_stays_in_the_middle() {
    let mut style = view(Theme::Light, &[], ColorBy::Body).style;
    style.look.camera_target = CameraTarget::Follow { name: "#3".into(), size: Vector::new(8.0, 4.5) };
    let view = View::new(crate::frames::WORLD, style).unwrap();
    for step in 0..60 {
        let frame = moving(5, step);
        let camera = view.camera_for(&frame);
        let body = frame.sprites.iter().find(|sprite| sprite.appearance.name == "#3").unwrap();
        let offset = camera.rect(&body.rect).center().sub(camera.viewport.center());
        assert!(offset.x.abs() <= 0.75 && offset.y.abs() <= 0.75, "step {step}: {offset:?}");
        let moved = camera.origin.sub(view.camera.origin).mult(camera.scale);
        assert!((moved.x - moved.x.round()).abs() < 1e-6 && (moved.y - moved.y.round()).abs() < 1e-6, "step {step}");
    }
}

#[test]
fn a_frame_of_full_size_matches_its_reference() {
    let style = view(Theme::Light, &[Overlay::Name, Overlay::Clock, Overlay::Grid], ColorBy::Body).style;
    let view = View::new(crate::frames::WORLD, resized([1280, 720], style)).unwrap();
    assert_reference_image("frame-full-size", &picture(&moving(30, 90), &view));
}

#[test]
fn a_layout_matches_its_snapshot() {
    let view = view(Theme::Light, &[Overlay::Name, Overlay::Clock, Overlay::Velocity], ColorBy::Speed);
    let mut list = compose(&collision(), &view);
    list.backdrop.clear();
    crate::snapshot::assert_text("frame-layout", &list.to_string());
}

#[test]
fn a_reused_painter_draws_the_same_pixels_as_a_new_one() {
    let light = view(Theme::Light, Overlay::ALL, ColorBy::Body);
    let dark = view(Theme::Dark, &[Overlay::Clock], ColorBy::Speed);
    let mut painter = Painter::new();
    for (frame, view) in [(collision(), &light), (moving(5, 7), &light), (collision(), &dark), (collision(), &light)] {
        let list = compose(&frame, view);
        assert_eq!(painter.draw(&list), Painter::new().draw(&list));
    }
}

/// Extreme and non-finite coordinates must not crash the drawing of a frame.
#[test]
fn extreme_coordinates_do_not_crash_a_frame() {
    let view = view(Theme::Light, Overlay::ALL, ColorBy::Speed);
    let mut frame = collision();
    let coordinates = [1e300, -1e300, f64::INFINITY, f64::NEG_INFINITY, f64::NAN, 1e-300];
    for (sprite, coordinate) in frame.sprites[4..].iter_mut().zip(coordinates) {
        sprite.rect = Rect::new(Vector::new(coordinate, coordinate), 1e200, 1e-200);
        sprite.velocity = Vector::new(coordinate, -coordinate);
        sprite.trail = vec![Vector::ZERO, Vector::new(coordinate, coordinate)];
    }
    frame.collisions[0].rects = [frame.sprites[4].rect, frame.sprites[6].rect];
    frame.collisions[0].normal = Vector::new(f64::NAN, 0.0);
    assert_eq!(picture(&frame, &view).size, view.camera.size);
}

#[test]
fn pictures_of_any_aspect_ratio_are_drawn() {
    let sizes = [[1, 1], [17, 1], [1, 300], [40, 30], [300, 900]];
    let bare = view(Theme::Light, &[], ColorBy::Body).style;
    for size in sizes {
        let view = View::new(crate::frames::WORLD, resized(size, bare.clone())).unwrap();
        assert_eq!(picture(&collision(), &view).size, size);
    }
    // With text, a picture is legible or is refused with a sufficient size.
    let style = view(Theme::Light, Overlay::ALL, ColorBy::Speed).style;
    for size in sizes {
        match View::new(crate::frames::WORLD, resized(size, style.clone())) {
            Ok(view) => assert_eq!(picture(&collision(), &view).size, size),
            Err(RenderError::TooSmall { needed: Some(needed), .. }) => {
                let view = View::new(crate::frames::WORLD, resized(needed, style.clone())).unwrap();
                assert_eq!(picture(&collision(), &view).size, needed);
            }
            Err(RenderError::TooSmall { needed: None, .. }) => assert!(size[0].min(size[1]) == 1, "{size:?}"),
            Err(error) => panic!("{error}"),
        }
    }
}

#[test]
fn a_camera_rejects_invalid_sizes() {
    let error = |world, size| View::new(world, resized(size, Style::default())).unwrap_err().to_string();
    assert_eq!(
        error(Vector::new(16.0, 9.0), [0, 720]),
        "a picture of 0×720 pixels cannot be drawn: each side must be 1 to 16384 pixels"
    );
    assert_eq!(
        error(Vector::new(16.0, f64::INFINITY), [1280, 720]),
        "an area of 16 m × inf m cannot be shown: width and height must be finite and positive"
    );
}

/// Two boxes fly apart over an empty plane, and one of them is deleted.
const FLIGHT: &str = "[run]\nsteps = 120\n[world]\nsize = [4.0, 4.0]\n\
    [[spawn]]\nname = \"a\"\nat = [1.0, 1.0]\nsize = [1.0, 1.0]\nmass = 1.0\nvelocity = [-3.0, 0.0]\n\
    [[spawn]]\nname = \"b\"\nat = [3.0, 1.0]\nsize = [1.0, 1.0]\nmass = 1.0\n\
    [[delete]]\nname = \"b\"\nstep = 60\n";

#[test]
fn bodies_that_are_never_in_a_picture_are_announced() {
    let workplace = Workplace::with_scene(FLIGHT);
    for (options, expected) in [
        ("--at 0 -o a.png", None),
        ("--at 50 -o a.png", Some("1 of 2 bodies is outside the world of the picture; --window bodies shows all")),
        ("--at 50 --window bodies -o a.png", None),
        ("--at 100 -o a.png", Some("no body is in the picture; choose another part of the world with --window")),
        ("--at 0 --window 100,100,1,1 -o a.png", Some("no body is in the picture")),
        ("--from 45 --to 55 -o a.gif", Some("1 of 2 bodies is outside the world")),
        ("-o a.gif", None),
        ("--follow b --window 4x3 --from 40 -o a.gif", Some("does not exist in 31 of 41 pictures")),
        ("--follow b --window 4x3 --at 20 -o a.png", None),
    ] {
        let drawn = workplace.done(&format!("render scene.toml --force --size 200x260 {options}"));
        match expected {
            Some(sentence) => assert!(drawn.errors.contains(sentence), "{options}: {drawn:?}"),
            None => assert!(!drawn.errors.contains("picture"), "{options}: {drawn:?}"),
        }
    }
}

/// The labels of the vertical axis are all there, with the unit at the topmost, also where they are long.
#[test]
fn the_vertical_axis_has_all_its_labels() {
    let workplace = Workplace::with_scene(FLIGHT);
    for window in ["0,0,4,4", "1000000,500000,4,3", "3.00001,3.00001,1e-6,1e-6", "-1e9,-1e9,2e9,2e9"] {
        let options = format!("--at 0 --show axes --text text --force --window={window} -o a.svg");
        workplace.done(&format!("render scene.toml {options}"));
        let picture = String::from_utf8(workplace.read("a.svg")).unwrap();
        let texts = picture.split("</tspan></text>").filter_map(|part| part.rsplit('>').next());
        let with_unit = texts.filter(|text| text.ends_with('m')).count();
        assert_eq!(with_unit, 2, "{window}: one unit on each axis");
    }
}
