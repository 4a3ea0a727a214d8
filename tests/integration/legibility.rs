//! Texts of pictures neither overlap nor leave their panel, whatever the page, and contrast with what is below them.

use crate::figures::{figures_of, options, side_by_side};
use crate::laws::{random::Random, seeds_of};
use crate::run_states::{BodySpec, RunStates, WORLD, fall, pair, run_with};
use rebond::internals::physics::{Rect, SolverKind, Vector};
use rebond::internals::picture::figures::{
    self, Axis, CollisionSubject, EnergyRun, FigureRun, LineRun, PressureRun, ReferenceFrame, SpacetimeRun, SpeedRun,
    VelocityRun,
};
use rebond::internals::picture::{
    Appearance, Color, ColorBy, DisplayList, GapReason, Language, Look, Overlay, Overlays, Quantity, RenderError,
    Shape, Style, Theme, TraceGap, View, compose,
};
use std::sync::Arc;

/// Labels neither overlap each other nor extend beyond the page.
#[test]
fn labels_neither_overlap_nor_leave_the_page() {
    for (kind, list) in [figures_of(Theme::Light), side_by_side(Theme::Light)].concat() {
        assert_legible(&list, kind);
    }
}

/// Asserts that texts are at least 8 px high, within the page and their panel, and do not overlap where they are visible,
/// and that everything that no panel clips is on the page.
pub fn assert_legible(list: &DisplayList, case: &str) {
    let [width, height] = list.size.map(f64::from);
    let mut texts: Vec<(usize, String, Rect)> = Vec::new();
    let mut covers: Vec<(usize, Rect)> = Vec::new();
    let page = Rect::new(Vector::ZERO, width, height);
    let mut count = 0;
    for shapes in [&list.backdrop, &list.shapes] {
        visit(shapes, &page, false, &mut count, &mut |number, shape, window, is_clipped| match shape {
            Shape::Text { line, at, .. } => {
                let height = 0.8 * line.height();
                let bounds = Rect::new(at.sub(Vector::new(0.0, height)), line.width, height);
                assert!(line.size >= 8.0, "{case}: {:?} has {} px", line.text, line.size);
                let is_within = window.inset(-0.51).contains(&bounds);
                assert!(is_within || line.text.is_empty(), "{case}: {:?} {bounds:?} leaves {window:?}", line.text);
                if !line.text.is_empty() {
                    texts.push((number, line.text.clone(), bounds));
                }
            }
            Shape::Rect { rect, ink } if ink.opacity == 255 => {
                assert!(is_clipped || page.inset(-0.51).contains(rect), "{case}: {rect:?} leaves the page");
                covers.extend(rect.intersection(window).map(|visible| (number, visible)));
            }
            Shape::Rect { .. } | Shape::Clip { .. } | Shape::Image { .. } => {}
            Shape::Polygon { points, .. } | Shape::Polyline { points, .. } => {
                let is_on_page = |at: &Vector| page.inset(-2.0).contains(&Rect::new(*at, 0.0, 0.0));
                assert!(is_clipped || points.iter().all(is_on_page), "{case}: {points:?} leaves the page");
            }
        });
    }
    for (at, (number, text, bounds)) in texts.iter().enumerate() {
        for (other_number, other, other_bounds) in &texts[..at] {
            let Some(common) = bounds.intersection(other_bounds) else { continue };
            let is_hidden = |(cover, rect): &(usize, Rect)| {
                (other_number..number).contains(&cover) && rect.inset(-0.51).contains(&common)
            };
            assert!(covers.iter().any(is_hidden), "{case}: {text:?} overlaps {other:?} in {common:?}");
        }
    }
}

/// Asserts that no text overlaps an arrow, whose shaft and head have one of these colours. Returns the number of arrows.
fn assert_clear_of_arrows(list: &DisplayList, colors: &[Color], case: &str) -> usize {
    let page = Rect::new(Vector::ZERO, f64::from(list.size[0]), f64::from(list.size[1]));
    let (mut texts, mut arrows) = (Vec::new(), Vec::new());
    visit(&list.shapes, &page, false, &mut 0, &mut |_, shape, window, _| match shape {
        Shape::Text { line, at, .. } if !line.text.is_empty() => {
            let height = line.height();
            texts.push((line.text.clone(), Rect::new(at.sub(Vector::new(0.0, height)), line.width, height)));
        }
        Shape::Polyline { points, width, ink } if colors.contains(&ink.color) => {
            arrows.extend(bounds_of(points).inset(-width / 2.0).intersection(window));
        }
        Shape::Polygon { points, ink } if colors.contains(&ink.color) => {
            arrows.extend(bounds_of(points).intersection(window));
        }
        _ => {}
    });
    for (text, bounds) in &texts {
        let crossed = arrows.iter().find_map(|arrow| arrow.intersection(bounds));
        assert_eq!(crossed, None, "{case}: {text:?} {bounds:?} is on an arrow");
    }
    arrows.len()
}

/// The part of a rectangle, which may be a line, within a window.
fn within(rect: &Rect, window: &Rect) -> Option<Rect> {
    let (near, far) = (rect.origin.max(window.origin), rect.far_corner().min(window.far_corner()));
    let size = far.sub(near);
    (size.x >= 0.0 && size.y >= 0.0).then(|| Rect::new(near, size.x, size.y))
}

fn bounds_of(points: &[Vector]) -> Rect {
    points.iter().map(|at| Rect::new(*at, 0.0, 0.0)).reduce(|all, at| all.union(&at)).unwrap()
}

/// The lengths of the Minkowski difference are beside their arrows or below the panels, never on an arrow, at any size,
/// and nearest to their own one.
#[test]
fn no_text_of_a_minkowski_difference_is_on_an_arrow() {
    let (mut arrows, mut names) = (0, 0);
    for (at, run) in [pair(), fall(), crate::run_states::galperin()].iter().enumerate() {
        for theme in Theme::ALL {
            for size in
                [[200, 200], [640, 360], [320, 180], [360, 640], [800, 450], [1000, 460], [1280, 720], [2400, 600]]
            {
                let mut style = options(*theme, "");
                style.look.size = size;
                let case = format!("scene {at}, {} at {size:?}", theme.name());
                let list = match figures::minkowski(&[run.first_collision()], &style) {
                    Err(RenderError::TooSmall { needed: Some(needed), .. }) => {
                        style.look.size = needed;
                        figures::minkowski(&[run.first_collision()], &style)
                    }
                    drawn => drawn,
                };
                let palette = rebond::internals::picture::Palette::of(*theme);
                let blue = Color::hex(0x0072b2).mix(palette.ink, 20);
                let list = list.unwrap();
                arrows += assert_clear_of_arrows(&list, &[blue, palette.penetration], &case);
                names += assert_named_beside_its_arrow(&list, [palette.penetration, blue], &case);
            }
        }
    }
    assert!(arrows > 300, "{arrows} parts of arrows");
    assert!(names > 30, "{names} names");
}

/// Asserts that the name of the shortest vector in a panel is nearer to an arrow of its own colour than to a blue one.
/// Returns the number of such names.
fn assert_named_beside_its_arrow(list: &DisplayList, [own, other]: [Color; 2], case: &str) -> usize {
    let page = Rect::new(Vector::ZERO, f64::from(list.size[0]), f64::from(list.size[1]));
    let (mut names, mut arrows) = (Vec::new(), Vec::new());
    visit(&list.shapes, &page, false, &mut 0, &mut |_, shape, window, _| match shape {
        Shape::Text { line, at, .. } if line.text.starts_with('|') && !line.text.contains(',') => {
            let height = line.height();
            names.push((*window, Rect::new(at.sub(Vector::new(0.0, height)), line.width, height)));
        }
        Shape::Polyline { points, ink, .. } | Shape::Polygon { points, ink } => {
            arrows.extend(within(&bounds_of(points), window).map(|bounds| (*window, bounds, ink.color)));
        }
        Shape::Rect { rect, ink } => arrows.push((*window, *rect, ink.color)),
        _ => {}
    });
    for (panel, name) in &names {
        let distance = |color: Color| {
            let of_panel = arrows.iter().filter(|(window, _, ink)| window == panel && *ink == color);
            let distances = of_panel.map(|(_, arrow, _)| {
                let [x, y] = [Axis::X, Axis::Y].map(|axis| -name.overlap_along(axis, arrow));
                Vector::new(x, y).max(Vector::ZERO).norm()
            });
            distances.min_by(f64::total_cmp).unwrap_or(f64::INFINITY)
        };
        let distances = [own, other].map(distance);
        assert!(distances[0] < distances[1] + 1.0, "{case}: |n| is {} and {} px away", distances[0], distances[1]);
    }
    names.len()
}

/// Visits the shapes within `window` in drawing order, each with its number, its visible area, and whether a panel clips
/// it.
fn visit(
    shapes: &[Shape],
    window: &Rect,
    is_clipped: bool,
    number: &mut usize,
    visitor: &mut impl FnMut(usize, &Shape, &Rect, bool),
) {
    for shape in shapes {
        match shape {
            Shape::Clip { window: inner, shapes } => {
                if let Some(visible) = window.intersection(inner) {
                    visit(shapes, &visible, true, number, visitor);
                }
            }
            Shape::Rect { .. }
            | Shape::Polygon { .. }
            | Shape::Polyline { .. }
            | Shape::Text { .. }
            | Shape::Image { .. } => {
                *number += 1;
                visitor(*number, shape, window, is_clipped);
            }
        }
    }
}

/// The kinds of pictures of the layout test.
const KINDS: [&str; 14] = [
    "collision",
    "collision-com",
    "pressure",
    "minkowski",
    "strobe",
    "filmstrip",
    "spacetime-x",
    "spacetime-y",
    "energy",
    "lines",
    "speeds",
    "velocity-space-pair",
    "velocity-space-cloud",
    "frame",
];

/// A picture of `count` copies of a run.
fn picture_of(kind: &str, run: &RunStates, count: usize, style: &Style) -> Result<DisplayList, RenderError> {
    let titles: Vec<String> = (0..count).map(|at| format!("run {at} with a title of some length")).collect();
    let runs = |steps: usize| -> Vec<FigureRun> {
        titles.iter().map(|title| FigureRun { title: title.clone(), ..run.every_nth(steps) }).collect()
    };
    let subjects: Vec<CollisionSubject> =
        titles.iter().map(|title| CollisionSubject { title: title.clone(), ..run.first_collision() }).collect();
    let bands = |axis| -> Vec<SpacetimeRun> {
        let copy = |title: &String| {
            let mut bands = run.spacetime(axis);
            bands.title.clone_from(title);
            bands
        };
        titles.iter().map(copy).collect()
    };
    match kind {
        "collision" => figures::collision(&subjects, ReferenceFrame::Laboratory, style),
        "collision-com" => figures::collision(&subjects, ReferenceFrame::CenterOfMass, style),
        "pressure" => figures::pressure(
            &titles.iter().map(|title| run.pressure(title)).collect::<Vec<PressureRun>>(),
            run.time(),
            style,
        ),
        "minkowski" => figures::minkowski(&subjects, style),
        "strobe" => figures::strobe(&runs(run.frames.len() / 5 + 1), style),
        "filmstrip" => figures::filmstrip(&runs(run.frames.len() / 4 + 1), style),
        "spacetime-x" => figures::spacetime(&bands(Axis::X), run.time(), Axis::X, style),
        "spacetime-y" => figures::spacetime(&bands(Axis::Y), run.time(), Axis::Y, style),
        "lines" => {
            let runs: Vec<LineRun> = titles.iter().map(|title| run.lines(title, Quantity::Speed)).collect();
            figures::lines(&runs, run.time(), Quantity::Speed, style)
        }
        "speeds" => figures::speeds(&titles.iter().map(|title| run.speeds(title)).collect::<Vec<SpeedRun>>(), style),
        "velocity-space-pair" | "velocity-space-cloud" => {
            let of_run = |title: &String| match kind {
                "velocity-space-pair" => run.velocity_path(title),
                _ => run.velocity_cloud(title),
            };
            figures::velocity_space(&titles.iter().map(of_run).collect::<Vec<VelocityRun>>(), style)
        }
        "energy" => {
            let copy = |title: &String| {
                let mut energies = run.energies();
                energies.title.clone_from(title);
                energies
            };
            figures::energy(&titles.iter().map(copy).collect::<Vec<EnergyRun>>(), run.time(), style)
        }
        _ => {
            let mut frame = run.frames[run.frames.len() / 2].clone();
            frame.collisions = run.collisions.iter().take(3).cloned().collect();
            Ok(compose(&frame, &View::new(WORLD, style.clone())?))
        }
    }
}

/// Every kind of figure at any size, of 1 to 24 recordings, is legible, or is refused with a size at which it is.
#[test]
#[cfg_attr(debug_assertions, ignore = "slow in debug")]
fn pictures_of_every_size_and_number_of_recordings_are_legible_or_refused_with_a_sufficient_size() {
    let bullet: [BodySpec; 3] = [
        ("a body with a name that fits nowhere", [0.5, 1.8, 0.6, 0.6], [12.0, 0.0]),
        ("wall-plate", [5.0, 0.5, 0.3, 3.5], [0.0, 0.0]),
        ("speck", [3.0, 1.9, 1e-3, 1e-3], [1e-3, 0.0]),
    ];
    let scenes = [pair(), fall(), run_with(SolverKind::EventDriven, &bullet, None, 20.0, 24)];
    let sizes = [
        [64, 64],
        [90, 160],
        [200, 200],
        [320, 180],
        [360, 640],
        [1024, 128],
        [128, 1024],
        [800, 800],
        [1280, 720],
        [720, 1280],
        [2000, 250],
        [4096, 2160],
        [1024, 8192],
        [8192, 1024],
        [8192, 8192],
    ];
    let looks = [
        (Overlays::from([Overlay::Name, Overlay::Clock]), ""),
        (Overlays::all(), "A caption of two lines:\nwith $E = m c^2$ and many more words than a narrow page can hold"),
        (Overlays::from([Overlay::Velocity, Overlay::Grid, Overlay::Scale, Overlay::Name]), "short"),
    ];
    // Each size with each kind, and the other choices in turn.
    let mut number = 0_usize;
    for size in sizes {
        for kind in KINDS {
            for count in [1, [2, 3, 5, 24, 7, 12, 4][number % 7]] {
                number += 1;
                let ((show, caption), run) = (&looks[number % 3], &scenes[number / 3 % 3]);
                let theme = if number.is_multiple_of(2) { Theme::Light } else { Theme::Dark };
                let color_by = ColorBy::ALL[number / 2 % 3];
                let look =
                    Look { size, theme, show: show.clone(), caption: (*caption).into(), color_by, ..Look::default() };
                let materials = (0..25).map(|at| format!("material {at}")).collect();
                let style = Style { look, top_speed: 12.0, materials, ..Style::default() };
                let case = format!("{kind} of {count} at {size:?}, look {}, scene {}", number % 3, number / 3 % 3);
                match picture_of(kind, run, count, &style) {
                    Ok(list) => assert_legible(&list, &case),
                    Err(RenderError::TooSmall { needed: Some(needed), .. }) => {
                        let look = Look { size: needed, ..style.look.clone() };
                        let list = picture_of(kind, run, count, &Style { look, ..style.clone() });
                        assert_legible(&list.unwrap_or_else(|error| panic!("{case}: {error}")), &case);
                    }
                    Err(error) => panic!("{case}: {error}"),
                }
            }
        }
    }
}

/// Random kinds, numbers of recordings, scenes and looks on random pages. `REBOND_LAYOUT_CASES` sets the number of cases, or
/// a range of seeds.
#[test]
#[cfg_attr(debug_assertions, ignore = "slow in debug")]
fn random_pictures_are_legible_or_refused_with_a_sufficient_size() {
    /// Cases that were not legible once: keys of arrows and scales of speeds that are wider than their rows, a tick at the
    /// edge of the page.
    const MENDED: [u64; 6] = [1060, 1537, 1786, 1965, 2428, 6067];
    let mut failures = Vec::new();
    for seed in seeds_of("REBOND_LAYOUT_CASES", 100).chain(MENDED) {
        if std::panic::catch_unwind(|| check_random_picture(seed)).is_err() {
            failures.push(seed);
        }
    }
    assert_eq!(failures, Vec::<u64>::new(), "seeds of pictures that are not legible");
}

fn check_random_picture(seed: u64) {
    let random = &mut Random::new(seed);
    let run = random_run(random);
    // Areas up to 8192×1024, so that most cases take little time.
    let width = random.magnitude(64.0, 6);
    let height = random.magnitude(64.0, 6).clamp(64.0, 8192.0 * 1024.0 / width);
    let texts =
        ["", "short", "two lines:\n$E = m c^2$", "a caption with $\\sqrt{x^2 + y_1}$ and many more words than fit"];
    let gap = |from: f64| TraceGap { steps: 3..=7, times: [from, from + 0.3], reason: GapReason::Lost };
    let look = Look {
        size: [width as u32, height as u32],
        theme: random.pick(Theme::ALL),
        show: Overlay::ALL.iter().copied().filter(|_| random.chance(30)).collect(),
        caption: random.pick(&texts).into(),
        color_by: random.pick(ColorBy::ALL),
        language: random.pick(Language::ALL),
        ..Look::default()
    };
    let top = |random: &mut Random| random.magnitude(1e-9, 60);
    let style = Style {
        look,
        top_speed: top(random),
        top_momentum: top(random),
        top_force: top(random),
        top_impulse: top(random),
        materials: (0..random.below(30)).map(|at| format!("material {at}")).collect(),
        gaps: (0..random.below(3)).map(|_| gap(random.between(0.0, 1.0))).collect(),
        ..Style::default()
    };
    let (kind, count) = (random.pick(&KINDS), random.pick(&[1, 1, 1, 2, 2, 3, 4, 5, 6, 8, 12, 17, 24]));
    let case = format!("seed {seed}: {kind} of {count} at {:?}", style.look.size);
    match picture_of(kind, &run, count, &style) {
        Ok(list) => assert_legible(&list, &case),
        Err(RenderError::TooSmall { needed: Some(needed), .. }) => {
            let look = Look { size: needed, ..style.look.clone() };
            let list = picture_of(kind, &run, count, &Style { look, ..style });
            assert_legible(&list.unwrap_or_else(|error| panic!("{case}, then {needed:?}: {error}")), &case);
        }
        Err(error) => panic!("{case}: {error}"),
    }
}

/// A run of boxes in the fields of a grid, with or without walls, in which at least two boxes collide.
fn random_run(random: &mut Random) -> RunStates {
    const NAMES: [&str; 9] =
        ["a", "ball", "", "$x_1^2$", "#12", "<&>\"'", "été 東", "a name that is longer than its box", "wall-plate"];
    loop {
        let [columns, rows] = [random.whole(1, 8), random.whole(1, 5)];
        let field = [WORLD.x / columns as f64, WORLD.y / rows as f64];
        let mut bodies: Vec<BodySpec> = Vec::new();
        for (column, row) in (0..columns).flat_map(|column| (0..rows).map(move |row| (column, row))) {
            let size = field.map(|width| width / random.pick(&[1.0, 1.0, 1e5]) / random.magnitude(1.1, 3));
            let at = [0, 1]
                .map(|axis| random.between(0.0, field[axis] - size[axis]) + [column, row][axis] as f64 * field[axis]);
            let mut velocity = || random.between(-6.0, 6.0) * random.pick(&[0.0, 1.0, 1.0, 1e-6]);
            let velocity = [velocity(), velocity()];
            let name = random.pick(&NAMES);
            let is_wall = name.starts_with("wall-");
            bodies.push((name, [at[0], at[1], size[0], size[1]], if is_wall { [0.0, 0.0] } else { velocity }));
        }
        if random.chance(50) {
            bodies.push(("wall-left", [-1.0, -1.0, 1.0, 6.5], [0.0, 0.0]));
            bodies.push(("wall-right", [8.0, -1.0, 1.0, 6.5], [0.0, 0.0]));
            bodies.push(("wall-bottom", [-1.0, 4.5, 10.0, 1.0], [0.0, 0.0]));
        }
        if !bodies.iter().any(|(name, ..)| !name.starts_with("wall-")) {
            continue;
        }
        let solver = random.pick(&[SolverKind::Handout, SolverKind::EventDriven]);
        let gravity = random.chance(30).then_some(Vector::new(0.0, 9.81));
        let run = run_with(solver, &bodies, gravity, 20.0, random.below(40) + 1);
        if run.collisions.iter().any(|collision| collision.impulse != 0.0) {
            return run;
        }
    }
}

/// Every text of figures 1 and 2 and the colours below it have a contrast of at least 4.5, whatever the colours of the
/// boxes.
#[test]
fn texts_of_collisions_contrast_with_the_boxes_below_them() {
    let colors = [0x0072b2, 0xd55e00, 0x56b4e9, 0xf0e442, 0x000000, 0xffffff, 0x7f7f7f, 0x808000];
    let mut texts_on_boxes = 0;
    for run in [pair(), fall()] {
        for (at, theme) in (0..colors.len()).flat_map(|at| Theme::ALL.iter().map(move |theme| (at, *theme))) {
            let mut subject = run.first_collision();
            for (body, shift) in subject.bodies.iter_mut().zip([0, 3]) {
                let color = Some(Color::hex(colors[(at + shift) % colors.len()]));
                *body = Arc::new(Appearance { color, ..(**body).clone() });
            }
            for size in [[800, 450], [450, 800], [1600, 500], [2400, 1600]] {
                let mut style = options(theme, "");
                style.look.size = size;
                let subjects = [subject.clone()];
                for list in [
                    figures::collision(&subjects, ReferenceFrame::Laboratory, &style),
                    figures::minkowski(&subjects, &style),
                ] {
                    texts_on_boxes += assert_contrast(&list.unwrap(), &format!("{at} {} {size:?}", theme.name()));
                }
            }
        }
    }
    assert!(texts_on_boxes > 500, "{texts_on_boxes} texts on boxes");
}

/// Asserts the contrast of all texts with the rectangles below them. Returns the number of texts on another colour than
/// that of the page.
fn assert_contrast(list: &DisplayList, case: &str) -> usize {
    let [width, height] = list.size.map(f64::from);
    let page = Rect::new(Vector::ZERO, width, height);
    let mut fills: Vec<(Rect, Rect, Color)> = vec![(page, page, list.background)];
    let mut on_boxes = 0;
    visit(&list.shapes, &page, false, &mut 0, &mut |_, shape, window, _| match shape {
        Shape::Rect { rect, ink } if ink.opacity == 255 => {
            // A box is a rectangle in the colour of its border and a smaller one in its own.
            if let Some((_, outer, color)) = fills.last_mut()
                && outer.contains(rect)
                && rect.contains(&outer.inset(8.0))
            {
                *color = ink.color;
            }
            fills.push((*window, *rect, ink.color));
        }
        Shape::Text { line, at, ink } if !line.text.is_empty() => {
            let bounds = Rect::new(at.sub(Vector::new(0.0, line.height())), line.width, line.height());
            let steps = [0.05, 0.25, 0.5, 0.75, 0.95];
            let points = steps.iter().flat_map(|x| steps.map(|y| [x * bounds.width(), y * bounds.height()]));
            let points = points.map(|[x, y]| Rect::new(bounds.origin.add(Vector::new(x, y)), 0.0, 0.0));
            let grounds: Vec<Color> = points
                .filter_map(|at| {
                    let is_below =
                        |(window, rect, _): &&(Rect, Rect, Color)| window.contains(&at) && rect.contains(&at);
                    fills.iter().rev().find(is_below).map(|(_, _, color)| *color)
                })
                .collect();
            for ground in &grounds {
                let contrast = ink.color.contrast(*ground);
                assert!(contrast >= 4.5, "{case}: {:?} in {} on {ground}: {contrast:.2}", line.text, ink.color);
            }
            on_boxes += usize::from(grounds.iter().any(|ground| *ground != list.background));
        }
        _ => {}
    });
    on_boxes
}
