//! Scenes in which events coincide. The first lines of each scene state the exact result.

use crate::world_builder::assert_close;
use rebond::internals::{
    physics::{Body, Collision, StepError, Vector},
    replay::Run,
    scene,
};
use std::path::Path;

/// A run of a scene and its collisions.
struct Scene {
    run: Run,
    collisions: Vec<Collision>,
    steps: u64,
}

impl Scene {
    fn start(name: &str) -> Scene {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/coincident");
        let scene = scene::load(&folder.join(format!("{name}.toml"))).expect("a scene");
        let mut run = Run::new(&scene);
        run.apply_inputs(Vec::new(), |error| Err(error.into())).expect("the events of the scene");
        Scene { run, collisions: Vec::new(), steps: scene.run.steps }
    }

    /// The scene after all of its steps.
    fn finish(name: &str) -> Scene {
        let mut scene = Scene::start(name);
        for _ in 0..scene.steps {
            scene.step().unwrap_or_else(|error| panic!("{name}: {error}"));
        }
        scene
    }

    fn step(&mut self) -> Result<(), StepError> {
        self.run.step(&mut self.collisions)
    }

    fn body(&self, name: &str) -> &Body {
        let bodies = &self.run.engine().world().bodies;
        bodies.iter().find(|body| body.name == name).expect("a body with this name")
    }

    fn at(&self, name: &str) -> Vector {
        self.body(name).rect.origin
    }

    fn velocity(&self, name: &str) -> Vector {
        self.body(name).velocity
    }

    /// Seconds since the start.
    fn time(&self, rate: f64) -> f64 {
        self.run.engine().current_step() as f64 / rate
    }
}

#[test]
fn no_impulse_is_negative_in_any_of_these_scenes() {
    for name in ["burst-bystander", "burst-heavy-on-light", "burst-row-at-wall", "rate-64", "mirror-a", "mirror-b"] {
        let scene = Scene::finish(name);
        assert!(scene.collisions.iter().all(|collision| collision.impulse > 0.0), "{name}");
    }
}

#[test]
fn a_body_that_separates_takes_no_part_in_a_burst() {
    let scene = Scene::finish("burst-bystander");
    assert_eq!(scene.velocity("bystander").x, 1.0);
}

/// The velocities are those of the same impacts in 400-bit arithmetic.
#[test]
fn a_finite_burst_is_carried_out_to_its_end() {
    for name in ["burst-heavy-on-light", "burst-heavy-on-light-gap"] {
        let scene = Scene::finish(name);
        assert_eq!(scene.collisions.len(), 314, "{name}");
        assert_close(scene.velocity("light").x, 0.48140942503570644, 1e-15);
        assert_close(scene.velocity("heavy").x, 0.8543824383660995, 1e-15);
    }
}

/// The velocities are those of the same impacts in 400-bit arithmetic.
#[test]
fn a_row_at_a_wall_leaves_it_after_its_sequential_impacts() {
    let scene = Scene::finish("burst-row-at-wall");
    assert_eq!(scene.collisions.len(), 396);
    let expected = [
        0.8498053842462672,
        0.8498332395357335,
        0.8498545033315332,
        0.8498707529193705,
        0.8498829988098376,
        0.8498918478240333,
        0.8498976380155923,
        0.8499005313077513,
        0.850162171421019,
        0.8506477265979858,
        0.8512596746881239,
        0.8519982613620966,
        0.8528636538811494,
        0.8538561629688646,
        0.8549759729964883,
        0.8562234562124256,
    ];
    for (number, velocity) in expected.into_iter().enumerate() {
        assert_close(scene.velocity(&format!("b{number}")).x, velocity, 1e-15);
    }

    let apart = Scene::finish("burst-row-nanometre-gaps");
    assert_eq!(apart.collisions.len(), 256);
    assert_close(apart.velocity("b15").x, 0.8562192807567659, 1e-13);
}

#[test]
fn a_slow_impact_far_from_the_origin_is_not_plastic() {
    let scene = Scene::finish("capture-speed-absolute");
    assert_eq!(scene.velocity("box").x, 5e-6);
}

#[test]
fn an_overlap_that_shrinks_to_zero_and_grows_again_changes_nothing() {
    let mut scene = Scene::start("graze-pressed");
    for _ in 0..57 {
        scene.step().unwrap();
        let (at, time) = (scene.at("b"), scene.time(60.0));
        assert_eq!(at.x, 1.5);
        assert_close(at.y, 0.75 - 2.0 * time + 4.0 * time * time, 1e-14);
    }
    let mut scene = Scene::start("graze-slide-back");
    for _ in 0..289 {
        scene.step().unwrap();
        let (at, time) = (scene.at("b"), scene.time(60.0));
        assert_eq!(at.y, 3.0);
        assert_close(at.x, 3.0 - time + time * time / 4.0, 1e-14);
    }
}

#[test]
fn boxes_pressed_corner_to_corner_slide_along_their_free_axis() {
    let scene = Scene::finish("livelock-corners");
    let square = scene.time(64.0) * scene.time(64.0);
    assert_eq!(scene.at("b0"), Vector::new(3.0, 0.0));
    assert_eq!(scene.at("b1"), Vector::new(2.0 + 2.25 * square, 1.0 + 5.0 * square));
    assert_eq!(scene.at("b2"), Vector::new(3.0 + 2.25 * square, 2.0 - 7.5 * square));
    assert_eq!(scene.collisions, []);
}

#[test]
fn masses_whose_sum_overflows_move_together() {
    let scene = Scene::finish("masses-overflow");
    for (name, x) in [("a", 0.0), ("b", 1.0), ("c", 2.0)] {
        assert_close(scene.at(name).x, x - 0.25, 1e-15);
    }
}

#[test]
fn a_mirrored_scene_gives_mirrored_results() {
    let [scene, image] = ["mirror-a", "mirror-b"].map(Scene::finish);
    assert_close(scene.velocity("b3").x, 0.05, 1e-15);
    for name in ["b0", "b1", "b2", "b3"] {
        assert_close(image.at(name).x + 1.0, -scene.at(name).x, 1e-12);
        assert_close(image.velocity(name).x, -scene.velocity(name).x, 1e-15);
    }
    assert_eq!(scene.collisions.len(), image.collisions.len());
}

#[test]
fn endless_impacts_in_a_slot_without_room_end_the_run_with_an_error_that_says_so() {
    let mut scene = Scene::start("packed-slot");
    let error = (0..scene.steps).find_map(|_| scene.step().err()).expect("an error");
    assert!(matches!(&error, StepError::Endless { .. }), "{error}");
    assert_eq!(scene.step(), Err(error), "the error is returned again");
}

#[test]
fn a_scene_with_coincident_events_does_not_depend_on_the_rate() {
    let [slow, fast] = ["rate-64", "rate-960"].map(Scene::finish);
    for scene in [&slow, &fast] {
        assert_eq!((scene.at("b2").x, scene.velocity("b2").x), (1.0, 0.0));
    }
    let sequence = |scene: &Scene| -> Vec<_> {
        scene.collisions.iter().map(|collision| (collision.bodies, collision.instant, collision.impulse)).collect()
    };
    assert_eq!(sequence(&slow), sequence(&fast));
}

#[test]
fn a_supported_box_slides_over_seams_whatever_the_order_of_creation() {
    for name in ["seam-left-tile-first", "seam-right-tile-first"] {
        let scene = Scene::finish(name);
        assert_eq!((scene.velocity("b"), scene.collisions.len()), (Vector::new(1.0, 0.0), 0), "{name}");
    }
    let scene = Scene::finish("seam-row");
    assert_eq!((scene.velocity("b"), scene.collisions.len()), (Vector::new(2.0, 0.0), 0));
    assert_close(scene.at("b").x, 10.25, 1e-14);
    let scene = Scene::finish("seam-endless");
    assert_eq!(scene.velocity("b"), Vector::new(0.25, 0.0));
    assert_close(scene.at("b").x, 4.0 + 0.25 * scene.time(60.0), 1e-14);
}

#[test]
fn a_box_twice_as_wide_as_a_tile_slides_on_tiles_as_on_a_plank() {
    let mut scene = Scene::start("seam-tiles-1.6");
    for step in 0..scene.steps {
        scene.step().unwrap();
        let [plank, tiles] = ["on a plank", "on tiles"].map(|name| scene.at(name).x);
        assert_eq!(plank.to_bits(), tiles.to_bits(), "after {} steps", step + 1);
    }
}

#[test]
fn lengths_whose_squares_underflow_give_scaled_results() {
    let mut scene = Scene::start("squares-underflow");
    for _ in 0..60 {
        scene.step().unwrap();
    }
    assert_close(scene.at("box").y, -5e-201, 1e-215);
    assert_close(scene.velocity("box").y, 1e-200, 1e-215);
}

#[test]
fn a_box_a_few_ulps_wide_is_not_passed_through() {
    let scene = Scene::finish("thin-rod-far-away");
    assert_eq!((scene.at("box").y, scene.velocity("box").y), (-8.0, -8.0));
}
