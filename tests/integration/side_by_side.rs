//! Animations of several recordings: common time, one panel each, gaps, provenance.

use crate::legibility::assert_legible;
use crate::rebond::{Outcome, Workplace};
use rebond::internals::picture::{
    Animation, Clip, DisplayList, FigureOptions, Instant, Overlay, Overlays, Page, PictureOptions, Shape, Shot, Source,
    StillFormat, Subject, SubjectOptions, Timing,
};
use rebond::internals::recording::Playback;
use std::path::Path;

/// A box between two walls, with a title, rate and duration of its own.
fn scene(title: &str, solver: &str, rate: u32, seconds: f64, extra: &str) -> String {
    format!(
        "title = \"{title}\"\n[world]\nsize = [8.0, 4.5]\nwalls = true\n[run]\nrate = {rate}\nduration = {seconds:?}\n\
         solver = \"{solver}\"\n[[spawn]]\nname = \"c\"\nat = [1.0, 1.0]\nsize = [1.0, 1.0]\nmass = 1.0\n\
         velocity = [6.0, 0.5]\n{extra}"
    )
}

/// The sources recorded from scenes `0.toml`, `1.toml`, …
fn recorded(scenes: &[String]) -> (Workplace, Vec<Source>) {
    let workplace = Workplace::new();
    let sources = scenes.iter().enumerate().map(|(number, text)| {
        workplace.write(&format!("{number}.toml"), text);
        workplace.done(&format!("record {number}.toml -o {number}.mcap"));
        Source::open(&workplace.path(&format!("{number}.mcap"))).unwrap()
    });
    let sources = sources.collect();
    (workplace, sources)
}

fn small() -> PictureOptions {
    let mut options = PictureOptions::default();
    (options.size, options.fps) = (Some([480, 270]), Some(25.0));
    options
}

fn clip(options: &PictureOptions, sources: &[Source]) -> (Clip, Vec<Instant>) {
    let (mut clip, _) = Clip::video(options, sources, &mut |_, _| ()).unwrap();
    let instants = clip.instants.by_ref().map(Result::unwrap).collect();
    (clip, instants)
}

/// Position and velocity of the box in each recorded state.
fn states(path: &Path) -> Vec<[f64; 4]> {
    let playback = Playback::new(rebond::internals::recording::open(path).unwrap());
    let body = |state: rebond::internals::recording::SampledState| {
        let body = state.bodies.into_iter().find(|body| body.info.spawn.name == "c").unwrap();
        [body.position.x, body.position.y, body.velocity.x, body.velocity.y]
    };
    playback.map(|state| body(state.unwrap())).collect()
}

/// Position and velocity of the box in a panel.
fn shown(shot: &Shot) -> [f64; 4] {
    let Shot::Frame(frame) = shot else { panic!("{shot:?}") };
    let sprite = frame.sprites.iter().find(|sprite| sprite.appearance.name == "c").unwrap();
    [sprite.rect.origin.x, sprite.rect.origin.y, sprite.velocity.x, sprite.velocity.y]
}

/// Two solvers and four rates, of which some have no step in common but the first; the shortest run is the last one.
#[test]
fn each_panel_shows_the_state_of_its_recording_at_the_time_of_the_clock() {
    let kinds = [("handout", 60, 2.5), ("event-driven", 60, 2.0), ("event-driven", 35, 3.0), ("handout", 50, 1.5)];
    let scenes = kinds.map(|(solver, rate, seconds)| scene("Room", solver, rate, seconds, ""));
    let fine = scene("Room", "event-driven", 2100, 3.0, "");
    let (workplace, sources) = recorded(&[&scenes[..], &[fine]].concat());
    let fine = states(&workplace.path("4.mcap"));
    for slow in [1.0, 0.2] {
        let mut options = small();
        options.slow = Some(slow);
        let (clip, instants) = clip(&options, &sources[..4]);
        // The clock has the steps of the fastest solver without instants between them: 60 Hz.
        let (grid, last) = (&clip.schedule.grid, instants.last().unwrap());
        assert!(grid.rate == 60.0 && (last.time - 1.5).abs() <= 1.0 / 25.0, "{grid:?} {last:?}");
        assert_eq!(instants.len() as u64, clip.schedule.count());
        for instant in &instants {
            for (number, (shot, (solver, rate, _))) in instant.shots.iter().zip(&kinds).enumerate() {
                let steps = instant.time * f64::from(*rate);
                let step = (steps + 1e-9).floor() as usize;
                let own = states_of(&workplace, number);
                let is_state = (steps - step as f64).abs() < 1e-9;
                let (found, time) = (shown(shot), instant.time);
                if *solver == "handout" || is_state {
                    assert_eq!(found, own[step], "panel {number} at {time} s");
                } else {
                    // The exact motion, from a run whose steps are near the instant.
                    let (at, velocity) = (fine[(time * 2100.0).round() as usize], found[2].abs());
                    let distance = (found[0] - at[0]).abs();
                    assert!(distance <= velocity * 0.5001 / 2100.0, "panel {number} at {time} s: {found:?} {at:?}");
                }
            }
        }
    }
}

fn states_of(workplace: &Workplace, number: usize) -> Vec<[f64; 4]> {
    states(&workplace.path(&format!("{number}.mcap")))
}

#[test]
fn one_recording_has_the_same_frames_alone_and_beside_another_one() {
    let scenes = [("event-driven", 30), ("event-driven", 30)].map(|(solver, rate)| scene("A", solver, rate, 1.0, ""));
    let (_workplace, sources) = recorded(&scenes);
    let (_, alone) = clip(&small(), &sources[..1]);
    let (_, both) = clip(&small(), &sources);
    assert_eq!(alone.len(), both.len());
    for (alone, both) in alone.iter().zip(&both) {
        assert_eq!((alone.step, alone.time, &alone.shots[0]), (both.step, both.time, &both.shots[0]));
    }
}

#[test]
fn an_animation_freezes_at_the_instants_of_the_collisions_of_every_recording() {
    let late = scene("Late", "event-driven", 20, 2.0, "").replace("velocity = [6.0, 0.5]", "velocity = [4.0, 0.0]");
    let (_workplace, sources) = recorded(&[scene("Early", "event-driven", 30, 2.0, ""), late]);
    let mut options = small();
    options.hold = Some(0.5);
    let (clip, instants) = clip(&options, &sources);
    // The box reaches the wall, 6 m away, after 1 s and after 1.5 s, and the floor and the other wall not before the end.
    assert_eq!(clip.schedule.freeze_count(), 2);
    let frozen = (0..clip.schedule.count()).filter(|frame| clip.schedule.is_frozen_at(*frame));
    let times: Vec<f64> = frozen.map(|frame| instants[frame as usize].time).collect();
    assert!((times[0] - 1.0).abs() < 1e-9 && (times[1] - 1.5).abs() < 1e-9, "{times:?}");
}

/// The texts of a page.
fn texts(list: &DisplayList) -> Vec<String> {
    let text = |shape: &Shape| match shape {
        Shape::Text { line, .. } => Some(line.text.clone()),
        _ => None,
    };
    list.leaves().filter_map(text).collect()
}

/// The recording `0.mcap` without a part of its states, as `gap.mcap`.
fn recovered(workplace: &Workplace) -> Source {
    let mut file = workplace.read("0.mcap");
    // A flipped bit in the third chunk with states.
    let place = file.windows(8).enumerate().filter(|(_, window)| window == b"\x04\0\0\0zstd").nth(3).unwrap().0 + 30;
    file[place] ^= 1;
    std::fs::write(workplace.path("flip.mcap"), file).unwrap();
    assert_eq!(workplace.rebond("recover flip.mcap -o gap.mcap").code, 4);
    Source::open(&workplace.path("gap.mcap")).unwrap()
}

/// Every recording has the same instants in a filmstrip, in panels of the same size, also those that it lacks and those of
/// a smaller world.
#[test]
fn a_filmstrip_has_a_hatched_panel_with_the_reason_for_each_missing_instant() {
    let small = scene("B", "event-driven", 10, 6.0, "").replace("[8.0, 4.5]", "[7.0, 3.0]");
    let (workplace, _) = recorded(&[scene("A", "event-driven", 10, 6.0, ""), small]);
    let gap = recovered(&workplace);
    let missing = gap.header.gaps[0].first_missing()..gap.header.gaps[0].before;
    let missing_count = missing.filter(|step| step.is_multiple_of(5)).count();
    assert!((1..4).contains(&missing_count));
    let picture = |sources: &str, code: i32| {
        let drawn = workplace
            .rebond(&format!("figure filmstrip {sources} --every 5 --size 1600x1200 --text text --force -o strip.svg"));
        assert_eq!(drawn.code, code, "{drawn:?}");
        String::from_utf8(workplace.read("strip.svg")).unwrap()
    };
    let sizes = |picture: &str| -> Vec<String> {
        let panels = picture.split("<svg ").skip(2).map(|panel| panel.split("viewBox").next().unwrap());
        let size = |panel: &str| panel.split(" width").nth(1).map(|size| format!("width{size}"));
        panels.filter_map(size).collect()
    };
    let whole = picture("0.mcap 1.mcap", 0);
    let gapped = picture("gap.mcap 1.mcap", 4);
    for picture in [&whole, &gapped] {
        assert_eq!(picture.matches('𝑡').count(), 26, "{picture}");
    }
    assert_eq!(sizes(&whole).first(), sizes(&gapped).first());
    let reason = "lost in a damaged recording";
    assert_eq!(whole.matches(reason).count(), 0);
    assert!(gapped.matches("damaged").count() > missing_count, "{gapped}");
}

#[test]
fn a_gap_is_a_hatched_panel_with_the_reason_and_the_other_panels_go_on() {
    let (workplace, sources) = recorded(&[scene("A", "event-driven", 10, 6.0, ""), scene("B", "handout", 10, 6.0, "")]);
    let gap = recovered(&workplace);
    let missing = gap.header.gaps[0].first_missing()..gap.header.gaps[0].before;
    assert!(!missing.is_empty());
    let both = [gap.clone(), sources[1].clone()];
    for sources in [&both[..], &[gap][..]] {
        let (clip, instants) = clip(&small(), sources);
        assert_eq!(instants.last().unwrap().step, 60);
        for instant in &instants {
            let is_missing = matches!(instant.shots[0], Shot::Missing { .. });
            assert_eq!(is_missing, missing.contains(&instant.step), "step {}", instant.step);
            let reason = format!("steps {}–{} lost in a damaged recording", missing.start, missing.end - 1);
            let page = texts(&clip.stage.compose(instant)).join(" ");
            // Once in the legend, and once in the panel that lacks the state.
            assert_eq!(page.matches(&reason).count(), 1 + usize::from(is_missing), "{page}");
        }
        assert!(instants.iter().all(|instant| instant.shots.len() < 2 || matches!(instant.shots[1], Shot::Frame(_))));
    }
    for output in ["gap.gif", "gap.apng", "frames/"] {
        let drawn = workplace.rebond(&format!("render gap.mcap 1.mcap --size 480x270 -o {output}"));
        assert!(drawn.code == 4 && drawn.errors.contains("gap.mcap is incomplete"), "{drawn:?}");
    }
    assert_eq!(std::fs::read_dir(workplace.path("frames")).unwrap().count(), 61);
}

#[test]
fn files_of_every_format_carry_the_recordings_and_are_redrawn_to_the_byte() {
    let (workplace, sources) =
        recorded(&[scene("Room", "handout", 60, 0.5, ""), scene("Room", "event-driven", 50, 0.4, "")]);
    for output in ["both.gif", "both.apng", "at.png --at 0.2s", "at.svg --at 6", "at.pdf --at 6"] {
        let (name, _) = output.split_once(' ').unwrap_or((output, ""));
        workplace.done(&format!("render 0.mcap 1.mcap --size 480x270 -o {output}"));
        let info = workplace.done(&format!("info {name}")).output;
        for source in &sources {
            assert!(info.contains(source.statistics.identity.as_ref().unwrap()), "{info}");
        }
        let file = workplace.read(name);
        assert!(rebond::redraw(&file, &sources).unwrap() == file, "{name} is redrawn differently");
    }
    let page = String::from_utf8(workplace.read("at.svg")).unwrap();
    assert!(page.contains(">Room (handout)</text>") && page.contains(">Room (event-driven)</text>"), "{page}");
    workplace.done("render 0.mcap 1.mcap --size 480x270 --fps 10 -o frames/");
    let names: Vec<String> = std::fs::read_dir(workplace.path("frames"))
        .unwrap()
        .map(|entry| entry.unwrap().file_name().into_string().unwrap())
        .collect();
    assert!(names.contains(&"000000.png".to_owned()) && names.contains(&"000024.png".to_owned()), "{names:?}");
    let file = std::fs::read(workplace.path("frames").join("000012.png")).unwrap();
    assert!(rebond::redraw(&file, &sources).unwrap() == file);
}

#[test]
fn a_study_is_drawn_with_its_values_as_titles_and_a_manifest_makes_it_again() {
    let workplace = Workplace::with_scene(&scene("Room", "event-driven", 20, 1.0, "[restitution]\ndefault = 1.0\n"));
    let set = "--set restitution.default=[0.9|0.5]";
    workplace.done(&format!("render scene.toml {set} --size 640x360 --at 10 -o study.svg"));
    let page = String::from_utf8(workplace.read("study.svg")).unwrap();
    for value in ["0.9", "0.5"] {
        assert!(page.contains(&format!(">Room, restitution.default = {value}</text>")), "{page}");
    }
    workplace.write(
        "all.check",
        "rebond record scene.toml -o a.mcap --set restitution.default=0.9\n\
         rebond record scene.toml -o b.mcap --set restitution.default=0.5\n\
         rebond render a.mcap b.mcap --size 320x180 --fps 10 --title 'e = 0.9' --title 'e = 0.5' -o both.gif\n\
         rebond render a.mcap b.mcap --size 320x180 --at 10 -o both.png\nskip scene.toml\n",
    );
    workplace.rebond("check --update all.check");
    let checked = workplace.done("check all.check a.mcap b.mcap both.gif both.png");
    assert!(workplace.path("both.gif").exists() && workplace.path("both.png").exists(), "{checked:?}");
    // Found by its own provenance.
    workplace.done("render a.mcap b.mcap --size 320x180 --fps 10 -o own.gif");
    workplace.done("check a.mcap b.mcap own.gif");
}

#[test]
fn an_error_of_one_source_names_it() {
    let (workplace, _) = recorded(&[scene("A", "handout", 60, 0.5, ""), scene("B", "handout", 60, 0.5, "")]);
    workplace.write("wrong.toml", "[run]\nsteps = -1\n");
    workplace.write("cut.mcap", "\u{89}MCAP0\r\n");
    let other = scene("B", "handout", 60, 0.5, "").replace("\"c\"", "\"other\"");
    workplace.write("other.toml", &other);
    for (line, named) in [
        ("render 0.mcap wrong.toml -o x.gif", "wrong.toml"),
        ("render 0.mcap missing.mcap -o x.gif", "missing.mcap"),
        ("render 0.mcap cut.mcap -o x.gif", "cut.mcap"),
        ("render 0.mcap other.toml --follow c -o x.gif", "other.toml: no body is named \"c\""),
        ("render 0.mcap 1.mcap --set run.rate=30 -o x.gif", "--set changes scenes"),
        ("render 0.mcap 1.mcap --title one -o x.gif", "1 title given for 2 recordings"),
    ] {
        let Outcome { code, errors, .. } = workplace.rebond(line);
        assert!(code != 0 && errors.contains(named), "{line}: {errors}");
        assert!(!workplace.path("x.gif").exists());
    }
    let drawn = workplace.done("render 0.toml other.toml --size 320x180 --fps 10 -o x.gif");
    assert!(drawn.errors.contains("0.toml: same:") && drawn.errors.contains("other.toml: same:"), "{drawn:?}");
}

#[test]
fn pages_of_every_size_and_number_of_recordings_are_legible_or_refused_with_a_sufficient_size() {
    let scenes: Vec<String> = (0..3).map(|number| scene(&format!("Room {number}"), "handout", 60, 0.1, "")).collect();
    let (_workplace, sources) = recorded(&scenes);
    let all = Overlays::all();
    for count in [2, 5, 24] {
        let many: Vec<Source> = (0..count).map(|number| sources[number % 3].clone()).collect();
        for size in [[64, 64], [320, 180], [200, 800], [1280, 160], [1280, 720]] {
            for show in [Overlays::from([Overlay::Name, Overlay::Clock]), all.clone()] {
                let mut options = PictureOptions::default();
                (options.size, options.show) = (Some(size), Some(show));
                let attempt = |options: &PictureOptions| {
                    let (steps, look, titles) =
                        options.resolve_sequence(&many).map(|page| (page.steps, page.look, page.titles)).unwrap();
                    let animation = Animation { steps, every: 1, timing: Timing::REAL_TIME };
                    let clip = Clip::new(&animation, &look, &titles, &many, &mut |_, _| ());
                    match clip {
                        Ok(mut clip) => {
                            let instant = clip.instants.next().unwrap().unwrap();
                            let list = clip.stage.compose(&instant);
                            assert_legible(&list, &format!("{count} recordings at {size:?}"));
                            None
                        }
                        Err(error) => {
                            let text = error.to_string();
                            let needed = text
                                .split("--size ")
                                .nth(1)
                                .and_then(|rest| rest.split_once(' '))
                                .map(|(size, _)| size.to_owned());
                            Some(needed.unwrap_or_else(|| panic!("{count} at {size:?}: {text}")))
                        }
                    }
                };
                if let Some(needed) = attempt(&options) {
                    let (width, height) = needed.split_once('x').unwrap();
                    options.size = Some([width.parse().unwrap(), height.parse().unwrap()]);
                    let (steps, look) = options.resolve_sequence(&many).map(|page| (page.steps, page.look)).unwrap();
                    let animation = Animation { steps, every: 1, timing: Timing::REAL_TIME };
                    Clip::new(&animation, &look, &[], &many, &mut |_, _| ()).map(|_| ()).unwrap();
                }
            }
        }
    }
}

/// The panels make a page flat, which must not make its texts small: a lecture shows it at the width of any other picture.
#[test]
fn titles_and_clock_of_a_flat_page_are_as_large_as_those_of_other_pages() {
    let (_workplace, sources) = recorded(&["one", "two"].map(|title| scene(title, "handout", 60, 0.1, "")));
    let size_of = |size: [u32; 2], sources: &[Source], text: &str| {
        let mut options = PictureOptions::default();
        options.size = Some(size);
        let (clip, instants) = clip(&options, sources);
        let list = clip.stage.compose(&instants[0]);
        let found = list.leaves().find_map(|shape| match shape {
            Shape::Text { line, .. } if line.text.contains(text) => Some(line.size),
            _ => None,
        });
        found.unwrap_or_else(|| panic!("no {text} at {size:?}"))
    };
    let alone = size_of([1280, 720], &sources[..1], "0.0");
    for text in ["one", "two", "0.0"] {
        assert_eq!(size_of([1280, 440], &sources, text), alone, "{text}");
    }
    assert!(size_of([1280, 440], &sources, "c") >= 0.8 * alone);
    assert!(size_of([1280, 160], &sources, "one") < 0.7 * alone, "a title as high as a third of a panel");
}

/// `--from` and `--to` in steps are those of the clock, the faster recording, in animations and figures.
#[test]
fn steps_are_those_of_the_clock_if_rates_differ() {
    let scenes = [scene("slow", "event-driven", 60, 2.0, ""), scene("fast", "event-driven", 240, 1.5, "")];
    let (_workplace, sources) = recorded(&scenes);
    let mut options = small();
    (options.from, options.to) = (Some(24.into()), Some(48.into()));
    let (_, instants) = clip(&options, &sources);
    let times = [&instants[0], instants.last().unwrap()].map(|instant| (instant.step, instant.time));
    assert!(times[0].0 >= 24 && times[1].0 <= 48 && times[1].0 > times[0].0, "{times:?}");
    assert!(times.iter().all(|(step, time)| (*step as f64 / 240.0 - time).abs() < 1e-12), "{times:?}");
    let energy = SubjectOptions::Figure { figure: FigureOptions::Energy, format: StillFormat::Png };
    let resolved = options.resolve(&energy, &sources, &mut |_, _| ()).unwrap();
    let Subject::Page { page: Page::Energy { steps }, .. } = &resolved.subject else { panic!("{resolved:?}") };
    let steps: Vec<_> = steps.iter().map(|range| range.steps.clone()).collect();
    assert_eq!(steps, [6..=12, 24..=48]);
}

#[test]
fn bodies_that_a_common_legend_does_not_name_are_counted() {
    let extra = "[[scatter]]\ncount = 12\nregion = [2.5, 0.5, 7.5, 4.0]\nsize = [[0.3, 0.3], [0.3, 0.3]]\n\
                 mass = [1.0, 1.0]\nvelocity = [[0.0, 0.0], [0.0, 0.0]]\nseed = 1\n";
    let (workplace, _) = recorded(&["one", "two"].map(|title| scene(title, "event-driven", 60, 0.5, extra)));
    for kind in ["strobe", "filmstrip"] {
        workplace.done(&format!("figure {kind} 0.mcap 1.mcap -o {kind}.svg"));
        let svg = std::fs::read_to_string(workplace.path(&format!("{kind}.svg"))).unwrap();
        assert!(svg.contains("13 bodies"), "{kind}");
    }
}
