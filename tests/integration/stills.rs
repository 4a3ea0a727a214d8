//! Single frames: every overlay, both themes, every colouring.

use crate::frames::{collision, moving, view};
use crate::reference::assert_reference;
use rebond::physics::{Rect, Vector};
use rebond::render::{Aim, Frame, Painter, Picture, Style, View, compose};
use rebond::scene::{ColorBy, Overlay, Theme};

fn picture(frame: &Frame, view: &View) -> Picture {
    Painter::new().draw(&compose(frame, view))
}

#[test]
fn each_overlay_in_both_themes() {
    for theme in Theme::ALL {
        for overlay in Overlay::ALL {
            let view = view(*theme, &[*overlay], ColorBy::Body);
            assert_reference(&format!("frame-{}-{}", overlay.name(), theme.name()), &picture(&collision(), &view));
        }
    }
}

#[test]
fn each_colouring_in_both_themes_with_all_overlays() {
    for theme in Theme::ALL {
        for color_by in ColorBy::ALL {
            let view = view(*theme, Overlay::ALL, *color_by);
            assert_reference(&format!("frame-by-{}-{}", color_by.name(), theme.name()), &picture(&collision(), &view));
        }
    }
}

/// A part of the world larger than it is, and a body kept in the middle.
#[test]
fn a_camera_that_is_aimed_at_something() {
    let show = [Overlay::Name, Overlay::Grid, Overlay::Axes, Overlay::Scale, Overlay::Clock];
    let style = Style { caption: "Aimed at a part of it".into(), ..view(Theme::Light, &show, ColorBy::Body).style };
    let window = Aim::Window(Rect::new(Vector::new(3.0, 2.0), 6.0, 4.0));
    let follow = Aim::Follow { name: "hull".into(), size: Vector::new(8.0, 4.5) };
    let lost = Aim::Follow { name: "nobody".into(), size: Vector::new(8.0, 4.5) };
    for (name, aim) in [("window", window), ("follow", follow), ("follow-lost", lost)] {
        let view = View::new(crate::frames::WORLD, [640, 360], &aim, style.clone()).unwrap();
        assert_reference(&format!("frame-aim-{name}"), &picture(&collision(), &view));
    }
}

/// What is followed stands still on the page, and what stands still moves by whole pixels.
#[test]
fn a_followed_body_stays_in_the_middle() {
    let aim = Aim::Follow { name: "#3".into(), size: Vector::new(8.0, 4.5) };
    let style = view(Theme::Light, &[], ColorBy::Body).style;
    let view = View::new(crate::frames::WORLD, [640, 360], &aim, style).unwrap();
    for step in 0..60 {
        let frame = moving(5, step);
        let camera = view.camera_at(&frame);
        let body = frame.sprites.iter().find(|sprite| sprite.appearance.name == "#3").unwrap();
        let off = camera.rect(&body.rect).center().sub(camera.window.center());
        assert!(off.x.abs() <= 0.75 && off.y.abs() <= 0.75, "step {step}: {off:?}");
        let moved = camera.origin.sub(view.camera.origin).mult(camera.scale);
        assert!((moved.x - moved.x.round()).abs() < 1e-6 && (moved.y - moved.y.round()).abs() < 1e-6, "step {step}");
    }
}

#[test]
fn a_lecture_frame_in_full_size() {
    let style = view(Theme::Light, &[Overlay::Name, Overlay::Clock, Overlay::Grid], ColorBy::Body).style;
    let view = View::fit(crate::frames::WORLD, [1280, 720], style).unwrap();
    assert_reference("frame-full-size", &picture(&moving(30, 90), &view));
}

#[test]
fn a_layout_is_held_as_text() {
    let view = view(Theme::Light, &[Overlay::Name, Overlay::Clock, Overlay::Velocity], ColorBy::Speed);
    let mut list = compose(&collision(), &view);
    list.backdrop.clear();
    crate::snapshot::assert_text("frame-layout", &list.to_string());
}

#[test]
fn a_painter_that_has_drawn_other_frames_draws_the_same() {
    let light = view(Theme::Light, Overlay::ALL, ColorBy::Body);
    let dark = view(Theme::Dark, &[Overlay::Clock], ColorBy::Speed);
    let mut painter = Painter::new();
    for (frame, view) in [(collision(), &light), (moving(5, 7), &light), (collision(), &dark), (collision(), &light)] {
        let list = compose(&frame, view);
        assert_eq!(painter.draw(&list), Painter::new().draw(&list));
    }
}

/// Whatever a solver makes of its bodies, the picture is of what can be seen.
#[test]
fn bodies_beyond_all_measure_are_drawn_without_harm() {
    let view = view(Theme::Light, Overlay::ALL, ColorBy::Speed);
    let mut frame = collision();
    let places = [1e300, -1e300, f64::INFINITY, f64::NEG_INFINITY, f64::NAN, 1e-300];
    for (sprite, far) in frame.sprites[4..].iter_mut().zip(places) {
        sprite.rect = Rect::new(Vector::new(far, far), 1e200, 1e-200);
        sprite.velocity = Vector::new(far, -far);
        sprite.trail = vec![Vector::ZERO, Vector::new(far, far)];
    }
    frame.collisions[0].rects = [frame.sprites[4].rect, frame.sprites[6].rect];
    frame.collisions[0].normal = Vector::new(f64::NAN, 0.0);
    assert_eq!(picture(&frame, &view).size, view.camera.size);
}

#[test]
fn pictures_of_any_shape_are_drawn() {
    let style = view(Theme::Light, Overlay::ALL, ColorBy::Speed).style;
    for size in [[1, 1], [17, 1], [1, 300], [40, 30], [300, 900]] {
        let view = View::fit(crate::frames::WORLD, size, style.clone()).unwrap();
        assert_eq!(picture(&collision(), &view).size, size);
    }
}

#[test]
fn a_camera_refuses_what_no_picture_can_show() {
    let refusal = |world, size| View::fit(world, size, Style::default()).unwrap_err().to_string();
    assert_eq!(
        refusal(Vector::new(16.0, 9.0), [0, 720]),
        "a picture of 0×720 pixels cannot be drawn: each side must be 1 to 16384 pixels"
    );
    assert_eq!(
        refusal(Vector::new(16.0, f64::INFINITY), [1280, 720]),
        "a world of 16 m × inf m cannot be shown: both must be finite and positive"
    );
}
