//! Figures of small runs, in both themes.

use crate::command_line::SCENE;
use crate::rebond::Workplace;
use crate::reference_image::assert_reference_image;
use crate::run_states::{BodySpec, WORLD, fall, galperin, pair, piston, run_with};
use rebond::internals::physics::{Rect, SolverKind, Vector};
use rebond::internals::picture::figures::{
    self, Axis, CollisionSubject, EnergyRun, EnergySample, FigureRun, Range, ReferenceFrame, SpacetimeRun,
};
use rebond::internals::picture::{
    CameraTarget, DisplayList, Look, Metadata, Overlay, Painter, Quantity, Style, TextAs, Theme, svg,
};

/// A small page with names and a grid.
pub fn options(theme: Theme, caption: &str) -> Style {
    let show = [Overlay::Name, Overlay::Grid].into();
    let look = Look { size: [800, 450], theme, show, caption: caption.to_owned(), ..Look::default() };
    Style { look, top_speed: 8.0, ..Style::default() }
}

/// Every kind of figure in a theme.
pub fn figures_of(theme: Theme) -> Vec<(&'static str, DisplayList)> {
    let (pair, fall) = (pair(), fall());
    let plain = options(theme, "");
    let captioned = options(theme, "Three boxes let fall, e = 0.8");
    let (pair_subjects, fall_subjects) = ([pair.first_collision()], [fall.first_collision()]);
    vec![
        ("collision", figures::collision(&pair_subjects, ReferenceFrame::Laboratory, &plain).unwrap()),
        ("collision-com", figures::collision(&pair_subjects, ReferenceFrame::CenterOfMass, &plain).unwrap()),
        ("pressure", figures::pressure(&[piston().pressure("")], piston().time(), &captioned).unwrap()),
        ("collision-close", figures::collision(&fall_subjects, ReferenceFrame::Laboratory, &captioned).unwrap()),
        ("minkowski", figures::minkowski(&pair_subjects, &plain).unwrap()),
        ("minkowski-close", figures::minkowski(&fall_subjects, &captioned).unwrap()),
        ("strobe", figures::strobe(&[fall.every_nth(6)], &captioned).unwrap()),
        ("filmstrip", figures::filmstrip(&[fall.every_nth(20)], &captioned).unwrap()),
        ("spacetime-x", figures::spacetime(&[fall.spacetime(Axis::X)], fall.time(), Axis::X, &plain).unwrap()),
        ("spacetime-y", figures::spacetime(&[fall.spacetime(Axis::Y)], fall.time(), Axis::Y, &captioned).unwrap()),
        ("energy", figures::energy(&[fall.energies()], fall.time(), &captioned).unwrap()),
        (
            "lines",
            figures::lines(&[fall.lines("", Quantity::Height)], fall.time(), Quantity::Height, &captioned).unwrap(),
        ),
        ("speeds", figures::speeds(&[fall.speeds("")], &captioned).unwrap()),
        ("velocity-space-pair", figures::velocity_space(&[galperin().velocity_path("")], &captioned).unwrap()),
        ("velocity-space-cloud", figures::velocity_space(&[fall.velocity_cloud("")], &plain).unwrap()),
    ]
}

/// Every kind of figure of two solvers side by side in a theme: the same projectile hits a plate thinner than the
/// distance it moves in one step.
pub fn side_by_side(theme: Theme) -> Vec<(&'static str, DisplayList)> {
    let bodies: [BodySpec; 2] =
        [("c", [0.5, 1.8, 0.6, 0.6], [12.0, 0.0]), ("wall-plate", [5.0, 0.5, 0.3, 3.5], [0.0, 0.0])];
    let solvers = [("handout", SolverKind::Handout), ("event-driven", SolverKind::EventDriven)];
    let both = solvers.map(|(title, solver)| (title.to_owned(), run_with(solver, &bodies, None, 20.0, 12)));
    let runs = both.each_ref().map(|(title, run)| FigureRun { title: title.clone(), ..run.every_nth(1) });
    let strips = both.each_ref().map(|(title, run)| FigureRun { title: title.clone(), ..run.every_nth(4) });
    let energies = both.each_ref().map(|(title, run)| {
        let mut energies = run.energies();
        energies.title.clone_from(title);
        energies
    });
    let bands = both.each_ref().map(|(title, run)| {
        let mut bands = run.spacetime(Axis::X);
        bands.title.clone_from(title);
        bands
    });
    let time = both[0].1.time();
    let lines = both.each_ref().map(|(title, run)| run.lines(title, Quantity::X));
    let subjects =
        both.each_ref().map(|(title, run)| CollisionSubject { title: title.clone(), ..run.first_collision() });
    let options = options(theme, "One shot, two solvers");
    vec![
        ("collision", figures::collision(&subjects, ReferenceFrame::Laboratory, &options).unwrap()),
        ("minkowski", figures::minkowski(&subjects, &options).unwrap()),
        ("strobe", figures::strobe(&runs, &options).unwrap()),
        ("filmstrip", figures::filmstrip(&strips, &options).unwrap()),
        ("spacetime", figures::spacetime(&bands, time, Axis::X, &options).unwrap()),
        ("energy", figures::energy(&energies, time, &options).unwrap()),
        ("lines", figures::lines(&lines, time, Quantity::X, &options).unwrap()),
    ]
}

#[test]
fn figures_of_two_runs_match_their_references_in_both_themes() {
    for theme in Theme::ALL {
        for (kind, list) in side_by_side(*theme) {
            assert_reference_image(&format!("figure-two-{kind}-{}", theme.name()), &Painter::new().draw(&list));
        }
    }
}

/// A camera that shows a window of the world, and one that follows a body.
#[test]
fn filmstrips_show_the_camera_target() {
    let fall = fall();
    let window = Rect::new(Vector::new(2.0, 0.5), 4.0, 2.25);
    let targets = [
        ("window", CameraTarget::Window(window)),
        ("follow", CameraTarget::Follow { name: "middle".into(), size: Vector::new(4.0, 2.25) }),
    ];
    for (name, camera_target) in targets {
        let mut options = options(Theme::Light, "");
        options.look.camera_target = camera_target;
        let strip = figures::filmstrip(&[fall.every_nth(20)], &options).unwrap();
        assert_reference_image(&format!("figure-filmstrip-{name}"), &Painter::new().draw(&strip));
    }
}

#[test]
fn each_kind_of_figure_matches_its_reference_in_both_themes() {
    for theme in Theme::ALL {
        for (kind, list) in figures_of(*theme) {
            assert_reference_image(&format!("figure-{kind}-{}", theme.name()), &Painter::new().draw(&list));
        }
    }
}

#[test]
fn an_svg_figure_matches_its_snapshot() {
    let (subjects, mut file) = ([pair().first_collision()], Vec::new());
    let metadata = Metadata { entries: vec![("rebond steps".into(), subjects[0].collision.step.to_string())] };
    let list = figures::minkowski(&subjects, &options(Theme::Light, "")).unwrap();
    svg::encode(&list, &metadata, TextAs::Outlines, &mut file).unwrap();
    crate::snapshot::assert_text("figure-minkowski.svg", &String::from_utf8(file).unwrap());
}

#[test]
fn figures_without_data_have_only_a_caption() {
    let options = options(Theme::Light, "nothing");
    for list in [
        figures::collision(&[], ReferenceFrame::Laboratory, &options).unwrap(),
        figures::minkowski(&[], &options).unwrap(),
        figures::strobe(&[], &options).unwrap(),
        figures::filmstrip(&[], &options).unwrap(),
        figures::spacetime(&[], Range { from: 0.0, to: 1.0 }, Axis::X, &options).unwrap(),
        figures::energy(&[], Range { from: 0.0, to: 1.0 }, &options).unwrap(),
        figures::lines(&[], Range { from: 0.0, to: 1.0 }, Quantity::X, &options).unwrap(),
    ] {
        assert_eq!(list.leaves().count(), 1, "{list}");
    }
}

/// Extreme and non-finite coordinates must not crash the drawing of a figure.
#[test]
fn extreme_coordinates_do_not_crash_a_figure() {
    let run = fall();
    let subject = run.first_collision();
    let coordinates = [1e300, f64::INFINITY, f64::NAN, 1e-300, -0.0];
    for coordinate in coordinates {
        let vector = Vector::new(coordinate, -coordinate);
        let mut extreme = subject.clone();
        let collision = &mut extreme.collision;
        (collision.penetration, collision.before[0], collision.impulse) = (vector, vector, coordinate);
        collision.rects[0].origin = vector;
        let mut frame = run.frames[0].clone();
        frame.sprites[3].rect.origin = vector;
        let sample = EnergySample { time: coordinate, kinetic: coordinate, potential: -coordinate, momentum: vector };
        let runs = [FigureRun {
            title: String::new(),
            world: WORLD,
            frames: vec![frame.clone(), frame.clone()],
            missing: Vec::new(),
        }];
        let mut energy = EnergyRun::new(String::new(), 0.0, true);
        (0..2).for_each(|_| energy.push(&sample));
        let mut bands = SpacetimeRun::new(String::new(), WORLD, Axis::Y, 0.0);
        frame.sprites.iter().for_each(|sprite| bands.push(coordinate, sprite, &Style::default()));
        let time = Range { from: 0.0, to: coordinate };
        let (subjects, options) = ([extreme], options(Theme::Dark, ""));
        for list in [
            figures::collision(&subjects, ReferenceFrame::Laboratory, &options).unwrap(),
            figures::minkowski(&subjects, &options).unwrap(),
            figures::strobe(&runs, &options).unwrap(),
            figures::filmstrip(&runs, &options).unwrap(),
            figures::spacetime(&[bands], time, Axis::Y, &options).unwrap(),
            figures::energy(&[energy], time, &options).unwrap(),
        ] {
            Painter::new().draw(&list);
        }
    }
}

/// A heavy box pushes a light one to and fro between itself and a wall: 31 collisions.
const GALPERIN: &str = "run.duration = 4.0\n\
    [[spawn]]\nname = \"wall\"\nat = [0.0, 2.0]\nsize = [1.0, 4.0]\nmass = inf\n\
    [[spawn]]\nname = \"light\"\nat = [2.0, 3.0]\nsize = [1.0, 1.0]\nmass = 1.0\n\
    [[spawn]]\nname = \"heavy\"\nat = [4.0, 3.0]\nsize = [1.0, 1.0]\nmass = 100.0\nvelocity = [-5.0, 0.0]\n";

/// A replay begins at the keyframe before `--from`; what happened in between is no part of the figure.
#[test]
fn velocity_space_counts_the_collisions_of_its_steps_alone() {
    let workplace = Workplace::with_scene(GALPERIN);
    workplace.done("record scene.toml -o run.mcap");
    let table = workplace.done("export run.mcap --table collisions").output;
    let steps: Vec<u64> = table.lines().skip(1).map(|row| row.split(',').nth(1).unwrap().parse().unwrap()).collect();
    for from in [0, 20, 26, 30, 40] {
        workplace.done(&format!("figure velocity-space run.mcap --from {from} -o from-{from}.svg"));
        let file = String::from_utf8(workplace.read(&format!("from-{from}.svg"))).unwrap();
        let count = steps.iter().filter(|step| **step >= from).count();
        assert!(file.contains(&format!(">n = {count}</text>")), "from step {from}: {count}");
    }
    assert_eq!(steps.len(), 31);
}

/// A replay is read to the end of the file; what happens after the last step is no part of the figure.
#[test]
fn velocity_space_of_a_thinned_recording_ends_with_its_last_full_state() {
    let workplace = Workplace::with_scene(GALPERIN);
    workplace.done("record scene.toml -o thin.mcap --steps 45 --every 30");
    let table = workplace.done("export thin.mcap --table collisions").output;
    let steps = table.lines().skip(1).map(|row| row.split(',').nth(1).unwrap().parse::<u64>().unwrap());
    let (before, after): (Vec<u64>, Vec<u64>) = steps.partition(|step| *step < 30);
    assert!(!before.is_empty() && !after.is_empty());
    workplace.done("figure velocity-space thin.mcap -o figure.svg");
    let file = String::from_utf8(workplace.read("figure.svg")).unwrap();
    assert!(file.contains(&format!(">n = {}</text>", before.len())), "{before:?}");
}

/// Figures of all states of a run are the same, to the byte, whichever of these states the recording stores.
#[test]
fn figures_of_all_states_do_not_depend_on_the_interval_of_the_recording() {
    for solver in ["handout", "event-driven"] {
        let late = "[[spawn]]\nname = \"fast\"\nstep = 88\nat = [1.0, 0.25]\nsize = [0.5, 0.5]\nmass = 50.0\n\
            velocity = [30.0, 0.0]\n";
        let workplace = Workplace::with_scene(&format!("{}{late}", SCENE.replace("handout", solver)));
        let intervals = [1, 7, 1000];
        for every in intervals {
            workplace.done(&format!("record scene.toml -o {every}.mcap --every {every}"));
        }
        for figure in ["energy", "lines --quantity E", "lines --bodies c", "spacetime", "spacetime --axis y"] {
            for range in ["", "--from 10 --to 83", "--from 85 --to 87", "--from 89"] {
                let drawn = intervals.map(|every| {
                    workplace.done(&format!("figure {figure} {every}.mcap {range} --force -o figure.svg"));
                    let file = String::from_utf8(workplace.read("figure.svg")).unwrap();
                    file.replace(&format!(" recorded_every={every}"), "")
                });
                assert!(drawn.iter().all(|file| *file == drawn[0]), "{solver}: {figure} {range}");
            }
        }
    }
}

#[test]
fn recordings_of_one_title_are_named_by_what_differs() {
    let workplace = Workplace::with_scene(&format!("title = \"two\"\n{GALPERIN}"));
    workplace.done("record scene.toml -o 60.mcap");
    workplace.done("record scene.toml -o 30.mcap --set run.rate=30");
    workplace.done("record scene.toml -o light.mcap --set spawn.heavy.mass=4");
    for (kind, files, names) in [
        ("energy", "60.mcap 30.mcap", ["two (event-driven, 60 Hz)", "two (event-driven, 30 Hz)"]),
        ("lines", "60.mcap 30.mcap", ["two (event-driven, 60 Hz)", "two (event-driven, 30 Hz)"]),
        ("spacetime", "60.mcap light.mcap", ["two (event-driven)", "two (event-driven, spawn.heavy.mass = 4)"]),
    ] {
        workplace.done(&format!("figure {kind} {files} -o {kind}.svg"));
        let file = String::from_utf8(workplace.read(&format!("{kind}.svg"))).unwrap();
        assert!(names.iter().all(|name| file.contains(&format!(">{name}</text>"))), "{kind}: {names:?}");
    }
}

/// Bodies of infinite mass that are only named like walls keep their colour, their name and their motion.
#[test]
fn bodies_named_like_walls_are_drawn_as_they_are() {
    let scene = |left: &str, right: &str| {
        format!(
            "run.duration = 2.0\n[[spawn]]\nname = \"gas\"\nat = [3.0, 3.0]\nsize = [1.0, 1.0]\nmass = 1.0\n\
             velocity = [5.0, 0.0]\n[[spawn]]\nname = \"{left}\"\nat = [0.0, 1.0]\nsize = [1.0, 5.0]\nmass = inf\n\
             color = \"#cc0000\"\n[[spawn]]\nname = \"{right}\"\nat = [12.0, 1.0]\nsize = [1.0, 5.0]\nmass = inf\n\
             velocity = [-2.0, 0.0]\ncolor = \"#00cc00\"\n"
        )
    };
    let workplace = Workplace::new();
    workplace.write("named.toml", &scene("wall-left", "wall-right"));
    workplace.write("plain.toml", &scene("solid-left", "solid-right"));
    let table = workplace.done("export named.toml --table bodies").output;
    assert!(table.contains("#cc0000") && table.contains("#00cc00"), "{table}");
    for command in ["figure spacetime", "figure strobe", "render --at 30"] {
        for file in ["named", "plain"] {
            workplace.done(&format!("{command} {file}.toml --show none -o {file}.png --force"));
        }
        let [named, plain] = ["named.png", "plain.png"].map(|file| {
            let file = workplace.read(file);
            rebond::internals::picture::png::decode_bitmap(&file).unwrap().pixels
        });
        assert!(named == plain, "{command}");
    }
    let walls = "run.steps = 1\nworld.walls = true\n";
    workplace.write("walls.toml", walls);
    let table = workplace.done("export walls.toml --table bodies").output;
    assert_eq!(table.matches("#dfe2e6").count(), 4, "{table}");
}

#[test]
fn an_svg_file_has_no_character_that_xml_forbids_and_can_be_drawn_again() {
    let workplace = Workplace::with_scene(&format!("title = \"T \\uFFFF\"\n{GALPERIN}"));
    for name in ["a", "b"] {
        workplace.done(&format!("record scene.toml -o {name}.mcap"));
    }
    workplace.done("figure energy a.mcap b.mcap --title T\u{fffe} --title U\u{ffff} -o energy.svg");
    workplace.done("figure energy a.mcap b.mcap -o titled.svg");
    for file in ["energy.svg", "titled.svg"] {
        let text = String::from_utf8(workplace.read(file)).unwrap();
        assert!(!text.contains(['\u{fffe}', '\u{ffff}']), "{file}");
        assert!(file == "titled.svg" || text.contains("T\\ufffe"), "the title is lost");
    }
}

/// A box at rest relative to its own time, with a mass and a velocity.
fn moving_box(mass: &str, velocity: &str) -> String {
    format!(
        "[run]\nsteps = 120\n[[spawn]]\nname = \"a\"\nat = [1.0, 1.0]\nsize = [1.0, 1.0]\nmass = {mass}\nvelocity = [{velocity}, 0.0]\n"
    )
}

#[test]
fn values_beyond_the_range_of_numbers_are_refused() {
    let workplace = Workplace::with_scene(&moving_box("1e300", "1e10"));
    for kind in ["energy", "speeds", "lines --quantity E", "lines --quantity p"] {
        let drawn = workplace.rebond(&format!("figure {kind} scene.toml -o figure.svg"));
        let is_named = drawn.errors.contains("exceeds the range of numbers");
        assert!(drawn.code == 1 && is_named && !workplace.path("figure.svg").exists(), "{kind}: {drawn:?}");
    }
}

/// A diagram of one state has a mark, and ticks with different labels.
#[test]
fn a_single_state_is_visible_in_diagrams_over_time() {
    let workplace = Workplace::with_scene(&moving_box("2.0", "0.1"));
    for kind in ["energy", "lines --quantity vx", "spacetime"] {
        for steps in ["--from 100 --to 100", "--from 100 --to 101"] {
            workplace.done(&format!("figure {kind} scene.toml {steps} --text text --force -o figure.svg"));
            let picture = String::from_utf8(workplace.read("figure.svg")).unwrap();
            let texts = picture.split("</tspan></text>").filter_map(|part| part.rsplit('>').next());
            let labels: Vec<&str> = texts.filter(|text| text.parse::<f64>().is_ok()).collect();
            assert!(labels.iter().all(|label| label.len() < 10), "{kind} {steps}: {labels:?}");
            assert!(labels.len() >= 4, "{kind} {steps}: {labels:?}");
        }
        let marks = |steps: &str| {
            workplace.done(&format!("figure {kind} scene.toml {steps} --force -o figure.svg"));
            String::from_utf8(workplace.read("figure.svg")).unwrap().matches("<path").count()
        };
        assert!(marks("--from 100 --to 100") > 0, "{kind}");
    }
}

/// All texts of a picture in SVG with text, one after the other.
fn texts_of(workplace: &Workplace, command: &str) -> String {
    workplace.done(&format!("{command} --text text --force -o picture.svg"));
    let picture = String::from_utf8(workplace.read("picture.svg")).unwrap();
    let lines = picture.split("<text").skip(1).map(|line| line.split("</text>").next().unwrap());
    lines.flat_map(|line| line.split('<').filter_map(|part| part.split_once('>'))).map(|(_, text)| text).collect()
}

#[test]
fn numbers_in_french_pictures_have_decimal_commas() {
    let workplace = Workplace::with_scene(
        "[run]\nsteps = 90\n[world]\nwalls = true\ngravity = [0.0, 9.81]\n[restitution]\ndefault = 0.85\n\
         [[spawn]]\nname = \"c\"\nat = [1.25, 1.5]\nsize = [1.0, 1.0]\nmass = 1.5\nvelocity = [2.5, 0.0]\n\
         [[spawn]]\nname = \"b\"\nat = [5.25, 3.5]\nsize = [1.5, 1.0]\nmass = 2.25\nvelocity = [-2.5, 0.5]\n\
         [[spawn]]\nname = \"d\"\nat = [10.0, 1.5]\nsize = [1.25, 1.25]\nmass = 1.0\nvelocity = [3.5, 0.5]\n",
    );
    let show = "--show velocity,impulse,mass,grid,axes,scale,clock";
    let mut commands = vec![format!("render scene.toml --at 1.25s {show} --color-by speed")];
    let kinds = ["energy", "spacetime", "lines", "pressure", "speeds", "velocity-space", "strobe --every 20"];
    commands.extend(kinds.map(|kind| format!("figure {kind} scene.toml")));
    commands.push(format!("figure filmstrip scene.toml --every 30 {show}"));
    for solver in ["handout", "event-driven"] {
        let of_pair = format!("scene.toml --pair c,b --set run.solver={solver}");
        commands.push(format!("figure collision {of_pair} --frame com"));
        commands.push(format!("figure minkowski {of_pair}"));
    }
    for command in commands {
        let english = texts_of(&workplace, &command);
        let french = texts_of(&workplace, &format!("{command} --language fr"));
        assert!(english.contains('.'), "{command}: {english}");
        assert!(!french.contains('.') && french.contains(','), "{command}: {french}");
    }
}

#[test]
fn moving_bodies_of_infinite_mass_have_bands() {
    let body = |name: &str, x: f64, mass: &str, velocity: f64| {
        format!(
            "[[spawn]]\nname = \"{name}\"\nat = [{x:?}, 1.0]\nsize = [1.0, 1.0]\nmass = {mass}\nvelocity = [{velocity:?}, 0.0]\n"
        )
    };
    let bodies = [body("pusher", 2.0, "inf", 2.0), body("box", 5.0, "1.0", 0.0), body("block", 12.0, "inf", 0.0)];
    let workplace = Workplace::with_scene(&format!("[run]\nsteps = 60\n{}", bodies.concat()));
    let texts = texts_of(&workplace, "figure spacetime scene.toml");
    assert!(texts.contains("pusher") && texts.contains("box"), "{texts}");
    assert!(!texts.contains("block"), "a body at rest outside of the range of the others: {texts}");
}
