use super::close_up::{CloseUp, label_arrow};
use super::formula::{FORMULA_BASELINE, FORMULA_HEIGHT, Formula, FormulaLine, Term};
use super::momenta::{Momenta, TO_OTHERS};
use super::pair::{ARROW_WIDTH, Pair, seen_from};
use super::panels::{Layout, Panels, TITLE, caption, captioned_panels, dashed, joined_lines, outline};
use super::{CollisionSubject, ReferenceFrame, legend_of_collisions};
use crate::physics::{Collision, Rect, Vector, larger, smaller};
use crate::picture::layers::arrows::{LabeledArrow, key_entries};
use crate::picture::layers::bodies::border_color;
use crate::picture::layers::footer::{Alignment, Legend};
use crate::picture::layers::labels::LabelPlacer;
use crate::picture::number::{TimeFormat, Unit, format_significant};
use crate::picture::text::Line;
use crate::picture::{
    Arrow, ArrowLength, Camera, DisplayList, DrawingMetrics, Ink, Language, RenderError, Shape, Style,
};

/// Figure 1 of the handout: (a) boxes c and b at contact, with their velocities; (b) a close-up of their overlap with
/// the unit normal n̂, the penetration vector n⃗ and the share of it by which each box is displaced; (c) the boxes
/// after the displacement, with their velocities after the rebound, dashed; (d) their momenta head to tail, before and
/// after, with the momentum that goes to other bodies. Below them the formula of the impulse with the values inserted.
///
/// All arrows of velocities have the same scale, which the first row explains. Velocities and momenta are those in
/// `frame`.
///
/// # Errors
/// If the page is too small.
pub fn collision(
    subjects: &[CollisionSubject],
    frame: ReferenceFrame,
    style: &Style,
) -> Result<DisplayList, RenderError> {
    let (subjects, velocities): (Vec<CollisionSubject>, Vec<Vector>) =
        subjects.iter().map(|subject| seen_from(subject, frame)).unzip();
    let speeds = |subject: &CollisionSubject| {
        let collision = &subject.collision;
        collision.before.iter().chain(&collision.after).map(|velocity| velocity.norm()).fold(0.0, larger)
    };
    let top = subjects.iter().map(speeds).filter(|speed| speed.is_finite()).fold(0.0, larger);
    let symbol = symbol(frame);
    let rows: Vec<Numbers> = subjects
        .iter()
        .zip(&velocities)
        .map(|(subject, velocity)| {
            let pair = Pair::new(subject, 0.0, style);
            Numbers::new(&pair, (frame, *velocity), style.time_format.finer(2), style.look.language)
        })
        .collect();
    let fits = |cell: &Rect, metrics: &DrawingMetrics| {
        let caption = Line::math(LONGEST_CAPTION, metrics.text(0.7)).width;
        rows.iter().map(|numbers| numbers.lines(cell.width(), metrics)).all(|lines| {
            let row = Row::new(cell, lines.height(metrics), metrics);
            let panel = row.panels[0];
            lines.width() <= cell.width()
                && row.key(top, metrics).fits(row.strip.width(), metrics)
                && panel.width() >= larger(caption, 10.0 * metrics.font_size)
                && panel.height() >= 8.0 * metrics.font_size
        })
    };
    let titles: Vec<&str> = subjects.iter().map(|subject| subject.title.as_str()).collect();
    let layout = Layout {
        legend: &|metrics| legend_of_collisions(style, metrics),
        shape: Vector::new(4.2, 1.0),
        text_height: TITLE,
        ..Layout::new(style, &titles, &fits)
    };
    let (mut panels, cells) = layout.lay_out()?;
    // The same scale in all rows.
    let height =
        |(numbers, cell): (&Numbers, &Rect)| numbers.lines(cell.width(), &panels.metrics).height(&panels.metrics);
    let highest = rows.iter().zip(&cells).map(height).fold(0.0, larger);
    for ((subject, numbers), cell) in subjects.iter().zip(&rows).zip(&cells) {
        panels.clip(cell, |panels| {
            let row = Row::new(cell, highest, &panels.metrics);
            let lines = numbers.lines(cell.width(), &panels.metrics);
            row.draw_numbers(lines, top, panels);
            row.draw(&Pair::new(subject, row.arrow_scale(top), style), symbol, style.look.language, panels);
        });
    }
    Ok(panels.finish())
}

/// The symbol of velocities in a frame.
const fn symbol(frame: ReferenceFrame) -> &'static str {
    match frame {
        ReferenceFrame::Laboratory => "v⃗",
        ReferenceFrame::CenterOfMass => "u⃗",
    }
}

/// The widest of the short captions below the panels.
const LONGEST_CAPTION: &str = "\"(b) chevauchement, ×1000\"";

/// The areas of the figure of one collision.
struct Row {
    cell: Rect,
    panels: Vec<Rect>,
    /// The strip below the panels for the key of the arrows and the numbers.
    strip: Rect,
}

/// Distance of the lines of values, in font sizes.
const VALUE_SPACING: f64 = 1.4;

/// The longest arrow relative to the shorter side of a panel.
const MAX_ARROW: f64 = 0.35;

impl Row {
    fn new(cell: &Rect, height_of_numbers: f64, metrics: &DrawingMetrics) -> Row {
        let mut area = Panels::of_cell(cell, metrics);
        // One more line for the key of the arrows.
        let strip = area.split_bottom(height_of_numbers + VALUE_SPACING * metrics.font_size);
        let panels = captioned_panels(&area.content, 4, metrics);
        Row { cell: *cell, panels, strip }
    }

    /// Pixels per m/s with which an arrow of the top speed fits into a panel.
    fn arrow_scale(&self, top: f64) -> f64 {
        let panel = self.panels[0];
        if top > 0.0 { MAX_ARROW * smaller(panel.width(), panel.height()) / top } else { 0.0 }
    }

    /// The key of the arrows.
    fn key(&self, top: f64, metrics: &DrawingMetrics) -> Legend {
        let (scale, width) = (self.arrow_scale(top), ARROW_WIDTH * metrics.line_width);
        let entries = if scale > 0.0 {
            key_entries(scale, top, Unit::METRE_PER_SECOND, width, metrics.palette.ink, metrics.language).into()
        } else {
            Vec::new()
        };
        Legend { entries }
    }

    /// Draws the key of the arrows and the numbers of the collision.
    fn draw_numbers(&self, lines: NumberLines, top: f64, panels: &mut Panels) {
        let (metrics, ink) = (panels.metrics, panels.metrics.palette.ink.into());
        let spacing = VALUE_SPACING * metrics.font_size;
        let strip = Rect::new(self.strip.origin, self.strip.width(), spacing);
        self.key(top, &metrics).draw(&strip, Alignment::Center, &metrics, &mut panels.shapes);
        let (middle, mut y) = (self.cell.center().x, self.strip.origin.y + spacing);
        for line in lines.values {
            panels.centered(line, Vector::new(middle, y + 0.8 * spacing), ink);
            y += spacing;
        }
        for line in lines.formula {
            let size = metrics.text(NUMBER_SIZE);
            let at = Vector::new(middle - line.width / 2.0, y + FORMULA_BASELINE * size);
            line.draw(at, (metrics.line_width / 2.0).ceil(), ink, &mut panels.shapes);
            y += FORMULA_HEIGHT * size;
        }
    }

    /// Draws the four panels.
    fn draw(&self, pair: &Pair, symbol: &str, language: Language, panels: &mut Panels) {
        let [before, center, after, momenta] = self.panels[..] else { return };
        let scale = pair.scale(&before);
        let close_up = CloseUp::new(pair, &center, scale, &panels.metrics);
        draw_before(pair, symbol, &before, scale, close_up.detail(&center), panels);
        panels.clip(&center, |panels| close_up.draw(&center, panels));
        draw_after(pair, symbol, &after, scale, panels);
        let metrics = panels.metrics;
        panels.clip(&momenta, |panels| Momenta::new(pair, &metrics).draw(&momenta, language, panels));
        caption(&before, [language.of("\"(a) before\"", "\"(a) avant\""); 2], panels);
        caption(&center, close_up.titles(language).each_ref().map(String::as_str), panels);
        caption(&after, [language.of("\"(c) after\"", "\"(c) après\""); 2], panels);
        let momenta_titles = language
            .of(["\"(d) momenta, head to tail\"", "\"(d) momenta\""], ["\"(d) quantités de mouvement\"", "\"(d)\" p⃗"]);
        caption(&momenta, momenta_titles, panels);
    }
}

/// Draws the pair before the collision, and the area of a detail in m, if there is one.
fn draw_before(pair: &Pair, symbol: &str, panel: &Rect, scale: f64, detail: Option<Rect>, panels: &mut Panels) {
    let (camera, metrics) = (pair.camera(panel, scale), panels.metrics);
    let rects = pair.collision.rects;
    let arrows = pair.arrows(&camera, &rects, &pair.collision.before, symbol, &metrics);
    panels.clip(panel, |panels| {
        panels.shapes.extend(pair.named_boxes(&camera, &rects, &arrows, &metrics));
        let mut placer = placer(pair, panel, &camera, &rects, &arrows, &metrics);
        if let Some(detail) = detail {
            // A frame of a few pixels is still visible.
            let detail = camera.rect(&detail);
            let margin = larger(2.0 * metrics.line_width - smaller(detail.width(), detail.height()) / 2.0, 0.0);
            let thin = (metrics.line_width / 2.0).ceil();
            panels.shapes.extend(outline(&detail.inset(-margin), thin, metrics.palette.ink.into()));
            placer.avoid_border(&detail, 1.0);
        }
        arrows.iter().for_each(|LabeledArrow { arrow, .. }| arrow.draw(&metrics, &mut panels.shapes));
        let fills = pair.fills(&camera, &rects);
        for LabeledArrow { arrow, label, .. } in &arrows {
            label_arrow(arrow, label, &fills, &mut placer, panels);
        }
    });
}

fn draw_after(pair: &Pair, symbol: &str, panel: &Rect, scale: f64, panels: &mut Panels) {
    let (camera, metrics) = (pair.camera(panel, scale), panels.metrics);
    let rects = pair.displaced();
    let arrows = pair.arrows(&camera, &rects, &pair.collision.after, &format!("{symbol}′"), &metrics);
    panels.clip(panel, |panels| {
        panels.shapes.extend(pair.named_boxes(&camera, &rects, &arrows, &metrics));
        for (initial, _) in pair.collision.rects.iter().zip(&rects).filter(|(initial, displaced)| initial != displaced)
        {
            panels.shapes.extend(dashed_outline(&camera.rect(initial), panel, &metrics));
        }
        let mut placer = placer(pair, panel, &camera, &rects, &arrows, &metrics);
        arrows.iter().for_each(|LabeledArrow { arrow, .. }| draw_dashed(arrow, &metrics, &mut panels.shapes));
        let fills = pair.fills(&camera, &rects);
        for LabeledArrow { arrow, label, .. } in &arrows {
            label_arrow(arrow, label, &fills, &mut placer, panels);
        }
    });
}

/// A label placer that avoids arrows, names and the borders of boxes.
fn placer(
    pair: &Pair,
    panel: &Rect,
    camera: &Camera,
    rects: &[Rect; 2],
    arrows: &[LabeledArrow],
    metrics: &DrawingMetrics,
) -> LabelPlacer {
    let mut placer = LabelPlacer::within(*panel);
    pair.names(camera, rects, arrows, metrics).iter().for_each(|name| placer.reserve(name.bounds()));
    for rect in rects.iter().filter_map(|rect| camera.rect(rect).intersection(panel)) {
        // Also avoids the vicinity of the border, so that labels do not appear to touch it.
        for distance in [-0.3, 0.0, 0.3] {
            placer.avoid_border(&rect.inset(distance * metrics.font_size), 1.0);
        }
        placer.avoid(rect, 0.3);
    }
    for LabeledArrow { arrow, .. } in arrows {
        placer.avoid_line(arrow.from, arrow.to, 3.0);
    }
    placer
}

/// The numbers of a collision: values, as markup, and the formula of its impulse.
struct Numbers {
    values: Vec<String>,
    formula: Formula,
}

/// [`Numbers`] in lines.
struct NumberLines {
    values: Vec<Line>,
    formula: Vec<FormulaLine>,
}

/// The font size of numbers, relative to that of the page.
const NUMBER_SIZE: f64 = 0.9;

impl Numbers {
    /// The numbers of a collision in a frame of reference that moves with a velocity, m/s.
    fn new(
        pair: &Pair,
        (frame, velocity): (ReferenceFrame, Vector),
        format: TimeFormat,
        language: Language,
    ) -> Numbers {
        let collision = &pair.collision;
        let time = format!("t = {} \"{}\"", format.number(collision.instant), format.unit());
        let mut values = vec![format!("\"{}\" {}", language.of("step", "pas"), collision.step), time];
        if frame == ReferenceFrame::CenterOfMass {
            let of_center = language.of("\"centre of mass:\"", "\"centre de masse :\"");
            let unit = Unit::METRE_PER_SECOND.for_size(velocity.norm());
            let [x, y] =
                [velocity.x, velocity.y].map(|part| language.decimal(format_significant(unit.scaled(part), 3)));
            let separator = language.of(",", " ;");
            values.push(format!("{of_center} u⃗ = v⃗ - ({x}{separator} {y}) \"{unit}\""));
        }
        if collision.penetration != Vector::ZERO {
            values.push(format!("|n⃗| = {}", language.decimal(Unit::METRE.format(collision.penetration.norm(), 3))));
            let shares = ["N_c", "N_b"].into_iter().zip(collision.shares);
            let share = |(symbol, share)| format!("{symbol} = {}", language.decimal(format_significant(share, 3)));
            values.extend(shares.map(share));
        }
        let mut formula = Formula::default();
        if collision.impulse == 0.0 {
            let is_at_rest = collision.before.iter().all(|velocity| *velocity == Vector::ZERO);
            values.push(if is_at_rest {
                "|v⃗_c| = |v⃗_b| = 0".to_owned()
            } else {
                format!("\"{}\"", language.of("no impulse", "sans impulsion"))
            });
        } else {
            values.push(format!("e = {}", language.decimal(format_significant(collision.restitution, 3))));
            formula = impulse_formula(pair, symbol(frame), language);
            if pair.pushes_others() {
                let others = language.of("to the bodies that they push", "aux corps qu’elles poussent");
                values.push(format!("{TO_OTHERS}: \"{others}\""));
            }
        }
        Numbers { values, formula }
    }

    /// The numbers in lines of at most `width` px.
    fn lines(&self, width: f64, metrics: &DrawingMetrics) -> NumberLines {
        let size = metrics.text(NUMBER_SIZE);
        NumberLines { values: joined_lines(&self.values, size, width), formula: self.formula.lines(size, width) }
    }
}

impl NumberLines {
    /// The width of the widest line, px.
    fn width(&self) -> f64 {
        let values = self.values.iter().map(|line| line.width);
        values.chain(self.formula.iter().map(|line| line.width)).fold(0.0, larger)
    }

    /// The height of all lines, px.
    fn height(&self, metrics: &DrawingMetrics) -> f64 {
        self.values.len() as f64 * VALUE_SPACING * metrics.font_size
            + self.formula.len() as f64 * FORMULA_HEIGHT * metrics.text(NUMBER_SIZE)
    }
}

/// The formula of the impulse with its values inserted: j = −(1 + e) v⃗·n̂ / (1/M_c + 1/M_b). If the bodies act
/// together with others that they push, which the formula does not contain, the impulse alone.
fn impulse_formula(pair: &Pair, symbol: &str, language: Language) -> Formula {
    let Collision { restitution: e, normal_velocity: [approach, _], impulse, .. } = pair.collision;
    let impulse = language.decimal(Unit::NEWTON_SECOND.format(impulse, 3));
    let term = |text: String, fraction: Option<[String; 2]>| Term { text, fraction };
    if pair.pushes_others() {
        let together = language.of("with the bodies that they push", "avec les corps qu’elles poussent");
        return Formula { terms: vec![term(format!("j = {impulse} \"({together})\""), None)] };
    }
    let inverse_mass = |mass: f64| {
        if mass.is_finite() {
            format!("1/({})", language.decimal(Unit::KILOGRAM.format(mass, 4)))
        } else {
            "0".to_owned()
        }
    };
    let symbols = [format!("-(1 + e) {symbol} · n̂"), "1/M_c + 1/M_b".to_owned()];
    let [e, approach] = [format_significant(e, 4), Unit::METRE_PER_SECOND.format(approach, 4)];
    let numerator = language.decimal(format!("-(1 + {e}) · ({approach})"));
    let denominator = pair.masses.map(inverse_mass).join(" + ");
    Formula {
        terms: vec![
            term("j =".to_owned(), Some(symbols)),
            term("=".to_owned(), Some([numerator, denominator])),
            term(format!("= {impulse}"), None),
        ],
    }
}

/// Draws an arrow with a dashed shaft.
fn draw_dashed(arrow: &Arrow, metrics: &DrawingMetrics, shapes: &mut Vec<Shape>) {
    let direction = arrow.to.sub(arrow.from);
    let length = direction.norm();
    let head = 6.0 * arrow.width;
    if length <= head || arrow.length == ArrowLength::Short {
        return arrow.draw(metrics, shapes);
    }
    let neck = arrow.to.sub(direction.mult(head / length));
    let halo = Ink::from(metrics.palette.background);
    shapes.push(Shape::Polyline { points: vec![arrow.from, neck], width: arrow.width + metrics.line_width, ink: halo });
    shapes.extend(dashed(arrow.from, neck, 2.0 * arrow.width, arrow.width, arrow.color.into()));
    Arrow { from: neck, ..*arrow }.draw(metrics, shapes);
}

/// The outline of a box, dashed. Of a box far larger than the panel, only the part around it is drawn.
fn dashed_outline(rect: &Rect, panel: &Rect, metrics: &DrawingMetrics) -> Vec<Shape> {
    let around = panel.inset(-larger(panel.width(), panel.height()));
    let Some(visible) = rect.intersection(&around) else { return Vec::new() };
    let (near, far) = (visible.origin, visible.far_corner());
    let corners = [near, Vector::new(far.x, near.y), far, Vector::new(near.x, far.y), near];
    let ink = Ink::from(border_color(metrics.palette.muted, metrics));
    corners
        .windows(2)
        .flat_map(|side| dashed(side[0], side[1], 3.0 * metrics.line_width, metrics.line_width / 2.0, ink))
        .collect()
}
