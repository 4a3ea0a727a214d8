use super::CollisionSubject;
use super::close_up::{CloseUp, label_arrow};
use super::pair::{ARROW_WIDTH, Pair};
use super::panels::{Layout, Panels, TITLE, caption, captioned_panels, dashed};
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
/// after the displacement, with their velocities after the rebound, dashed.
///
/// All arrows have the same scale, which the first row explains.
///
/// # Errors
/// If the page is too small.
pub fn collision(subjects: &[CollisionSubject], style: &Style) -> Result<DisplayList, RenderError> {
    let speeds = |subject: &CollisionSubject| {
        let collision = &subject.collision;
        collision.before.iter().chain(&collision.after).map(|velocity| velocity.norm()).fold(0.0, larger)
    };
    let top = subjects.iter().map(speeds).filter(|speed| speed.is_finite()).fold(0.0, larger);
    let language = style.look.language;
    let rows: Vec<Vec<String>> =
        subjects.iter().map(|subject| values(&subject.collision, style.time_format.finer(2), language)).collect();
    let fits = |cell: &Rect, metrics: &DrawingMetrics| {
        let lines = rows.iter().map(|values| value_lines(values, cell.width(), metrics));
        let longest = language.of("\"(b) they overlap, \"×1000", "\"(b) chevauchement, \"×1000");
        let caption = Line::math(longest, metrics.text(0.7)).width;
        let is_legible = |lines: Vec<Line>| {
            let panel = Row::new(cell, lines.len(), metrics).panels[0];
            let least = larger(caption, 10.0 * metrics.font_size);
            lines.iter().all(|line| line.width <= cell.width())
                && panel.width() >= least
                && panel.height() >= 7.0 * metrics.font_size
        };
        lines.into_iter().all(is_legible)
    };
    let layout = Layout {
        size: style.look.size,
        metrics: DrawingMetrics::new(style.look.theme, style.look.size),
        caption: &style.look.caption,
        legend: &|_| Legend::of_colors(style),
        titles: &subjects.iter().map(|subject| subject.title.as_str()).collect::<Vec<&str>>(),
        shape: Vector::new(3.2, 1.0),
        text_height: TITLE,
        fits: &fits,
    };
    let (mut panels, cells) = layout.lay_out()?;
    // The same scale in all rows.
    let line_count = |(values, cell): (&Vec<String>, &Rect)| value_lines(values, cell.width(), &panels.metrics).len();
    let most_lines = rows.iter().zip(&cells).map(line_count).max().unwrap_or(1);
    for ((subject, values), cell) in subjects.iter().zip(&rows).zip(&cells) {
        panels.clip(cell, |panels| {
            let row = Row::new(cell, most_lines, &panels.metrics);
            let lines = value_lines(values, cell.width(), &panels.metrics);
            row.draw_values(lines, top, panels);
            row.draw(&Pair::new(subject, row.arrow_scale(top), style), language, panels);
        });
    }
    Ok(panels.finish())
}

/// The areas of the figure of one collision.
struct Row {
    cell: Rect,
    panels: Vec<Rect>,
    /// The strip below the panels for the values and the key of the arrows.
    strip: Rect,
}

/// Distance of the lines of values, in font sizes.
const VALUE_SPACING: f64 = 1.4;

/// The longest arrow relative to the shorter side of a panel.
const MAX_ARROW: f64 = 0.35;

impl Row {
    fn new(cell: &Rect, value_lines: usize, metrics: &DrawingMetrics) -> Row {
        let mut area = Panels::of_cell(cell, metrics);
        // One more line for the key of the arrows.
        let strip = area.split_bottom((value_lines as f64 + 1.0) * VALUE_SPACING * metrics.font_size);
        let panels = captioned_panels(&area.content, 3, metrics);
        Row { cell: *cell, panels, strip }
    }

    /// Pixels per m/s with which an arrow of the top speed fits into a panel.
    fn arrow_scale(&self, top: f64) -> f64 {
        let panel = self.panels[0];
        if top > 0.0 { MAX_ARROW * smaller(panel.width(), panel.height()) / top } else { 0.0 }
    }

    /// Draws the key of the arrows and the values of the collision.
    fn draw_values(&self, lines: Vec<Line>, top: f64, panels: &mut Panels) {
        let (metrics, ink) = (panels.metrics, panels.metrics.palette.ink.into());
        let spacing = VALUE_SPACING * metrics.font_size;
        let key = match self.arrow_scale(top) > 0.0 {
            true => {
                let width = ARROW_WIDTH * metrics.line_width;
                key_entries(self.arrow_scale(top), top, Unit::METRE_PER_SECOND, width, metrics.palette.ink).into()
            }
            false => Vec::new(),
        };
        let strip = Rect::new(self.strip.origin, self.strip.width(), spacing);
        Legend { entries: key }.draw(&strip, Alignment::Center, &metrics, &mut panels.shapes);
        for (number, line) in lines.into_iter().enumerate() {
            let baseline = self.strip.origin.y + (number as f64 + 1.8) * spacing;
            panels.centered(line, Vector::new(self.cell.center().x, baseline), ink);
        }
    }

    /// Draws the three panels.
    fn draw(&self, pair: &Pair, language: Language, panels: &mut Panels) {
        let [before, center, after] = self.panels[..] else { return };
        let scale = pair.scale(&before);
        draw_before(pair, &before, scale, panels);
        let close_up = CloseUp::new(pair, &center, scale, &panels.metrics);
        panels.clip(&center, |panels| close_up.draw(&center, panels));
        draw_after(pair, &after, scale, panels);
        caption(&before, [language.of("\"(a) before\"", "\"(a) avant\""); 2], panels);
        caption(&center, close_up.titles(language).each_ref().map(String::as_str), panels);
        caption(&after, [language.of("\"(c) after\"", "\"(c) après\""); 2], panels);
    }
}

fn draw_before(pair: &Pair, panel: &Rect, scale: f64, panels: &mut Panels) {
    let (camera, metrics) = (pair.camera(panel, scale), panels.metrics);
    let rects = pair.collision.rects;
    let arrows = pair.arrows(&camera, &rects, &pair.collision.before, &metrics);
    panels.clip(panel, |panels| {
        panels.shapes.extend(pair.named_boxes(&camera, &rects, &arrows, &metrics));
        let mut placer = placer(pair, panel, &camera, &rects, &arrows, &metrics);
        arrows.iter().for_each(|LabeledArrow { arrow, .. }| arrow.draw(&metrics, &mut panels.shapes));
        let fills = pair.fills(&camera, &rects);
        for LabeledArrow { arrow, label, .. } in &arrows {
            label_arrow(arrow, label, &fills, &mut placer, panels);
        }
    });
}

fn draw_after(pair: &Pair, panel: &Rect, scale: f64, panels: &mut Panels) {
    let (camera, metrics) = (pair.camera(panel, scale), panels.metrics);
    let rects = pair.displaced();
    let arrows = pair.arrows(&camera, &rects, &pair.collision.after, &metrics);
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

/// The values in as many lines of at most `width` px as they need.
fn value_lines(values: &[String], width: f64, metrics: &DrawingMetrics) -> Vec<Line> {
    let line = |values: &[String]| Line::math(&values.join(",   "), metrics.text(0.9));
    let (mut lines, mut start) = (Vec::new(), 0);
    for end in 1..=values.len() {
        if end == values.len() || line(&values[start..=end]).width > width {
            lines.push(line(&values[start..end]));
            start = end;
        }
    }
    lines
}

/// The values of the collision, as markup.
fn values(collision: &Collision, format: TimeFormat, language: Language) -> Vec<String> {
    let time = format!("t = {} \"{}\"", format.number(collision.instant), format.unit());
    let mut values = vec![format!("\"{}\" {}", language.of("step", "pas"), collision.step), time];
    if collision.penetration != Vector::ZERO {
        values.push(format!("|n⃗| = {}", Unit::METRE.format(collision.penetration.norm(), 3)));
        let shares = ["N_c", "N_b"].into_iter().zip(collision.shares);
        values.extend(shares.map(|(symbol, share)| format!("{symbol} = {}", format_significant(share, 3))));
    }
    if collision.impulse == 0.0 {
        let is_at_rest = collision.before.iter().all(|velocity| *velocity == Vector::ZERO);
        values.push(if is_at_rest {
            "|v⃗_c| = |v⃗_b| = 0".to_owned()
        } else {
            format!("\"{}\"", language.of("no impulse", "sans impulsion"))
        });
    } else {
        values.push(format!("e = {}", format_significant(collision.restitution, 3)));
        values.push(format!("j = {}", Unit::NEWTON_SECOND.format(collision.impulse, 3)));
    }
    values
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
