use super::pair::Pair;
use super::panels::{Layout, Panels, TITLE, caption, captioned_panels, dashed, joined_lines, outline};
use super::{CollisionSubject, legend_of_collisions};
use crate::physics::{Axis, Rect, Vector, larger, smaller};
use crate::picture::layers::bodies::border_color;
use crate::picture::layers::labels::{Halo, LabelPlacer};
use crate::picture::number::{Unit, format_significant, nice_spacing};
use crate::picture::text::Line;
use crate::picture::{Arrow, Camera, Color, DisplayList, DrawingMetrics, Language, RenderError, Shape, Style};

/// Figure 2 of the handout: (a) boxes c and b at contact; (b) their Minkowski difference s = b ⊖ c around the origin,
/// with the vectors from the origin to its four sides and their lengths; the shortest one is the penetration vector n⃗;
/// (c) the same magnified, if n⃗ is too short in (b).
///
/// # Errors
/// If the page is too small.
pub fn minkowski(subjects: &[CollisionSubject], style: &Style) -> Result<DisplayList, RenderError> {
    let rows: Vec<Vec<String>> = subjects.iter().map(|subject| lengths(subject, style)).collect();
    let fits = |cell: &Rect, metrics: &DrawingMetrics| {
        let are_within = |lengths: &Vec<String>| {
            joined_lines(lengths, metrics.text(LENGTH_SIZE), cell.width()).iter().all(|line| line.width <= cell.width())
        };
        let highest = rows.iter().map(|lengths| length_height(lengths, cell, metrics)).fold(0.0, larger);
        let above = Rect::new(cell.origin, cell.width(), cell.height() - highest);
        let panel = captioned_panels(&above, 3, metrics)[0];
        let caption = Line::math(titles_b(style.look.language)[1], metrics.text(0.7)).width;
        rows.iter().all(are_within)
            && panel.width() >= larger(caption, 7.0 * metrics.font_size)
            && panel.height() >= 6.0 * metrics.font_size
    };
    let titles: Vec<&str> = subjects.iter().map(|subject| subject.title.as_str()).collect();
    let layout = Layout {
        legend: &|metrics| legend_of_collisions(style, metrics),
        shape: Vector::new(3.0, 1.0),
        text_height: TITLE,
        ..Layout::new(style, &titles, &fits)
    };
    let (mut panels, cells) = layout.lay_out()?;
    for ((subject, lengths), cell) in subjects.iter().zip(&rows).zip(&cells) {
        panels.clip(cell, |panels| {
            let mut area = Panels::of_cell(cell, &panels.metrics);
            let strip = area.split_bottom(length_height(lengths, cell, &panels.metrics));
            let lines = joined_lines(lengths, panels.metrics.text(LENGTH_SIZE), cell.width());
            for (number, line) in lines.into_iter().enumerate() {
                let baseline = strip.origin.y + (number as f64 + 0.8) * LENGTH_SPACING * panels.metrics.font_size;
                panels.centered(line, Vector::new(cell.center().x, baseline), panels.metrics.palette.ink.into());
            }
            row(subject, &area.content, panels, style);
        });
    }
    Ok(panels.finish())
}

/// The font size of the lengths below the panels, relative to that of the page.
const LENGTH_SIZE: f64 = 0.9;

/// Distance of lines of lengths, in font sizes.
const LENGTH_SPACING: f64 = 1.4;

/// The lengths of the four vectors as markup, the shortest one first.
fn lengths(subject: &CollisionSubject, style: &Style) -> Vec<String> {
    let metrics = DrawingMetrics::new(style.look.theme, style.look.language, style.look.size);
    let difference = MinkowskiDifference::new(&Pair::new(subject, 0.0, style), &metrics);
    let language = style.look.language;
    let length = |index: usize| language.decimal(Unit::METRE.format(difference.vectors[index].norm(), 3));
    let mut others: Vec<usize> = (0..4).filter(|&index| index != difference.shortest).collect();
    others.sort_by(|a, b| difference.vectors[*a].norm().total_cmp(&difference.vectors[*b].norm()));
    let others: Vec<String> = others.into_iter().map(length).collect();
    let name = language.of("\"to the other sides:\"", "\"vers les autres côtés :\"");
    let mut lengths = vec![format!("|n⃗| = {}", length(difference.shortest)), format!("{name} {}", others[0])];
    lengths.extend_from_slice(&others[1..]);
    lengths
}

/// The height of the lines of lengths below a cell, px.
fn length_height(lengths: &[String], cell: &Rect, metrics: &DrawingMetrics) -> f64 {
    let lines = joined_lines(lengths, metrics.text(LENGTH_SIZE), cell.width());
    lines.len() as f64 * LENGTH_SPACING * metrics.font_size
}

/// A long and a short title of the difference.
fn titles_b(language: Language) -> [&'static str; 2] {
    let short = "\"(b)\" s = b ⊖ c";
    let english = "\"(b)\" s = b ⊖ c \"around the origin\"";
    [language.of(english, "\"(b)\" s = b ⊖ c \"autour de l’origine\""), short]
}

/// Draws the panels of one collision.
fn row(subject: &CollisionSubject, cell: &Rect, panels: &mut Panels, style: &Style) {
    let pair = Pair::new(subject, 0.0, style);
    let (metrics, language) = (panels.metrics, style.look.language);
    let difference = MinkowskiDifference::new(&pair, &metrics);
    let scale = |panel: &Rect| smaller(pair.scale(panel), difference.scale(panel));
    let two = captioned_panels(cell, 2, &metrics);
    let zoom = difference.zoom(scale(&two[0]), &metrics);
    let panel_rects = if zoom == 1.0 { two } else { captioned_panels(cell, 3, &metrics) };
    let scale = scale(&panel_rects[0]);
    let camera = pair.camera(&panel_rects[0], scale);
    let shapes = pair.named_boxes(&camera, &pair.collision.rects, &[], &metrics);
    panels.shapes.push(Shape::Clip { window: panel_rects[0], shapes });
    let boxes = language.of("\"(a) the boxes\" c \"and\" b", "\"(a) les boîtes\" c \"et\" b");
    caption(&panel_rects[0], [boxes, "\"(a)\" c, b"], panels);
    let shortest = [difference.shortest];
    let others: Vec<usize> = (0..4).filter(|index| !shortest.contains(index)).collect();
    let labelled = if zoom == 1.0 { [&shortest[..], &others].concat() } else { others };
    difference.draw(&panel_rects[1], scale, difference.middle, &labelled, panels);
    caption(&panel_rects[1], titles_b(language), panels);
    if let Some(panel) = panel_rects.get(2) {
        difference.draw(panel, scale * zoom, Vector::ZERO, &shortest, panels);
        let zoom = language.decimal(format_significant(zoom, 1));
        let larger = language.of("times larger", "fois plus grand");
        caption(panel, [&format!("\"(c)\" {zoom} \"{larger}\""), &format!("\"(c)\" ×{zoom}")], panels);
    }
}

/// The Minkowski difference s = b ⊖ c and how it is drawn.
struct MinkowskiDifference {
    /// The difference s, m.
    rect: Rect,
    /// Fill colour of the difference.
    fill: Color,
    /// The vectors from the origin to the four sides in the handout's order: left, right, top, bottom, m.
    vectors: [Vector; 4],
    /// Index of the shortest vector.
    shortest: usize,
    /// Middle of the visible area, m.
    middle: Vector,
    /// Width and height of the visible area, m.
    extent: Vector,
}

/// A penetration up to this fraction of the size of the difference counts as zero.
const TOUCH_TOLERANCE: f64 = 1e-12;

/// Maximum extent of the visible area on each side of the origin, relative to the size of the smaller box.
const MAX_EXTENT: f64 = 2.5;

impl MinkowskiDifference {
    fn new(pair: &Pair, metrics: &DrawingMetrics) -> MinkowskiDifference {
        let [c, b] = &pair.collision.rects;
        let rect = c.minkowski_difference(b);
        let size = smaller(larger(c.width(), c.height()), larger(b.width(), b.height()));
        let max_extent = MAX_EXTENT * size;
        let limit = Vector::new(max_extent, max_extent);
        let near = rect.origin.min(Vector::ZERO).max(limit.mult(-1.0));
        let end = rect.far_corner().max(Vector::ZERO).min(limit);
        let mut vectors = to_sides(&rect);
        let shortest = shortest(&vectors);
        // If the boxes only touch, a tiny penetration is a rounding error.
        if vectors[shortest].norm() <= TOUCH_TOLERANCE * larger(rect.width(), rect.height()) {
            vectors[shortest] = Vector::ZERO;
        }
        let extent = end.sub(near);
        let margin = 0.25 * larger(extent.x, extent.y);
        MinkowskiDifference {
            rect,
            fill: pair.colors[0].mix(pair.colors[1], 50).mix(metrics.palette.background, 65),
            vectors,
            shortest,
            middle: near.add(end).mult(0.5),
            extent: extent.add(Vector::new(margin, margin)),
        }
    }

    /// The scale, in pixels per metre, with which the visible area fits into a panel.
    fn scale(&self, panel: &Rect) -> f64 {
        smaller(panel.width() / self.extent.x, panel.height() / self.extent.y)
    }

    /// The magnification that makes n⃗ clearly visible; 1 if it is large enough already.
    fn zoom(&self, scale: f64, metrics: &DrawingMetrics) -> f64 {
        let (length, target_length) = (self.vectors[self.shortest].norm() * scale, 5.0 * metrics.font_size);
        let is_visible = length == 0.0 || length >= 0.3 * target_length;
        if is_visible { 1.0 } else { smaller(nice_spacing(target_length / length), 1e9) }
    }

    /// Draws the difference in a panel whose middle shows the point `middle` (m), with the lengths of these vectors in
    /// the order in which they are placed.
    fn draw(&self, panel: &Rect, scale: f64, middle: Vector, labelled: &[usize], panels: &mut Panels) {
        let metrics = panels.metrics;
        let origin = middle.sub(panel.center().mult(1.0 / scale));
        let world = self.rect.far_corner();
        let camera = Camera { size: [1, 1], viewport: *panel, scale, origin, world };
        let page_rect = camera.rect(&self.rect);
        let mut shapes = vec![Shape::Rect { rect: page_rect, ink: self.fill.into() }];
        shapes.extend(outline(&page_rect, metrics.line_width, border_color(self.fill, &metrics).into()));
        let origin_on_page = camera.point(Vector::ZERO);
        let mut placer = LabelPlacer::within(*panel);
        placer.avoid_border(&page_rect, 1.0);
        let fills = [(page_rect, self.fill)];
        let arrow = |(vector, color, width): (Vector, Color, f64)| {
            Arrow::new(origin_on_page, origin_on_page.add(vector.mult(scale)), width, color)
        };
        let arrows: Vec<Arrow> = self.candidates(&metrics).into_iter().map(arrow).collect();
        arrows.iter().for_each(|arrow| placer.keep_clear(arrow.bounds(&metrics)));
        draw_axes(origin_on_page, panel, &fills, &mut placer, &metrics, &mut shapes);
        arrows.iter().for_each(|arrow| arrow.draw(&metrics, &mut shapes));
        if self.vectors[self.shortest] == Vector::ZERO {
            let side = 4.0 * metrics.line_width;
            let mark = Rect::new(origin_on_page.sub(Vector::new(side / 2.0, side / 2.0)), side, side);
            shapes.push(Shape::Rect { rect: mark, ink: metrics.palette.penetration.into() });
        }
        self.draw_name(&page_rect, panel, &mut placer, &metrics, &mut shapes);
        let visible = self.vectors.map(|vector| {
            let to = origin_on_page.add(vector.mult(scale));
            [origin_on_page, to.max(panel.origin).min(panel.far_corner())]
        });
        for &index in labelled {
            self.label_length(index, &visible, &fills, &mut placer, &metrics, &mut shapes);
        }
        panels.shapes.push(Shape::Clip { window: *panel, shapes });
        if !panel.contains(&page_rect) {
            panels.draw_frame(panel);
        }
    }

    /// The four vectors with colour and line width, the shortest last and highlighted.
    fn candidates(&self, metrics: &DrawingMetrics) -> Vec<(Vector, Color, f64)> {
        let others = (0..4).filter(|&index| index != self.shortest);
        let mut candidates: Vec<_> =
            others.map(|index| (self.vectors[index], blue(metrics), metrics.line_width)).collect();
        candidates.push((self.vectors[self.shortest], metrics.palette.penetration, 2.0 * metrics.line_width));
        candidates
    }

    /// Draws the name s of the difference in one of its visible corners.
    fn draw_name(
        &self,
        page_rect: &Rect,
        panel: &Rect,
        placer: &mut LabelPlacer,
        metrics: &DrawingMetrics,
        shapes: &mut Vec<Shape>,
    ) {
        let Some(visible) = page_rect.intersection(panel) else { return };
        let visible = visible.inset(smaller(metrics.font_size, smaller(visible.width(), visible.height()) / 2.0));
        let (near, far) = (visible.origin, visible.far_corner());
        let corners = [far, near, Vector::new(near.x, far.y), Vector::new(far.x, near.y)];
        let line = Line::math("s", 1.2 * metrics.font_size);
        let name = placer.place_along(line, &corners, Vector::new(-1.0, -1.0), 0.0, metrics.palette.ink);
        let fills = [(*page_rect, self.fill)];
        name.into_iter().for_each(|name| name.draw_over(&fills, Halo::Around, metrics, shapes));
    }

    /// Draws the label with the length of a vector, if there is space for it that is free of arrows and nearer to this
    /// vector than to any other. `visible` are the ends of the visible parts of all vectors, px. All lengths are also
    /// below the panels.
    fn label_length(
        &self,
        index: usize,
        visible: &[[Vector; 2]; 4],
        fills: &[(Rect, Color)],
        placer: &mut LabelPlacer,
        metrics: &DrawingMetrics,
        shapes: &mut Vec<Shape>,
    ) {
        let length = metrics.language.decimal(Unit::METRE.format(self.vectors[index].norm(), 3));
        let (text, color, size) = if index == self.shortest {
            (format!("|n⃗| = {length}"), metrics.palette.penetration, 1.0)
        } else {
            (length, blue(metrics), 0.9)
        };
        let [from, to] = visible[index];
        let along = to.sub(from);
        let (normal, gap) = (Vector::new(along.y, -along.x), 0.7 * metrics.font_size);
        let anchors = [0.5, 0.35, 0.65, 0.8, 0.2, 1.0].map(|part| from.add(along.mult(part)));
        let is_nearest = |bounds: &Rect| {
            let distance = |[from, to]: [Vector; 2]| distance(bounds, &bounds_of(from, to));
            let to_others = (0..4).filter(|other| *other != index).map(|other| distance(visible[other]));
            distance(visible[index]) <= to_others.fold(f64::INFINITY, smaller)
        };
        let label = [size, 0.9, 0.75].into_iter().find_map(|size| {
            let line = Line::math(&text, metrics.text(size));
            placer.place_where(line, &anchors, (normal, gap), color, is_nearest)
        });
        let Some(label) = label else { return };
        if along == Vector::ZERO {
            // Beside three arrows from one point, there is only space on the axis.
            let plate = label.bounds().inset(-metrics.line_width);
            shapes.push(Shape::Rect { rect: plate, ink: metrics.palette.background.into() });
        }
        label.draw_over(fills, Halo::Around, metrics, shapes);
    }
}

/// The rectangle with these opposite corners.
fn bounds_of(a: Vector, b: Vector) -> Rect {
    Rect::new(a, 0.0, 0.0).union(&Rect::new(b, 0.0, 0.0))
}

/// The distance of two rectangles, 0 if they touch.
fn distance(a: &Rect, b: &Rect) -> f64 {
    let along = |axis: Axis| larger(0.0, -a.overlap_along(axis, b));
    Vector::new(along(Axis::X), along(Axis::Y)).norm()
}

fn to_sides(s: &Rect) -> [Vector; 4] {
    let far = s.far_corner();
    [Vector::new(s.origin.x, 0.0), Vector::new(far.x, 0.0), Vector::new(0.0, s.origin.y), Vector::new(0.0, far.y)]
}

/// The index of the shortest vector; the first one if several are equal, as in the handout's solver.
fn shortest(vectors: &[Vector; 4]) -> usize {
    let mut best = 0;
    for index in 1..4 {
        if vectors[index].norm() < vectors[best].norm() {
            best = index;
        }
    }
    best
}

/// The colour of the candidates, blue as in the handout.
fn blue(metrics: &DrawingMetrics) -> Color {
    Color::hex(0x0072b2).mix(metrics.palette.ink, 20)
}

/// Draws the axes through the origin, dashed, with their names and the label of the origin.
fn draw_axes(
    origin_on_page: Vector,
    panel: &Rect,
    fills: &[(Rect, Color)],
    placer: &mut LabelPlacer,
    metrics: &DrawingMetrics,
    shapes: &mut Vec<Shape>,
) {
    let far = panel.far_corner();
    let muted = metrics.palette.muted;
    let ends = [
        [Vector::new(panel.origin.x, origin_on_page.y), Vector::new(far.x, origin_on_page.y)],
        [Vector::new(origin_on_page.x, panel.origin.y), Vector::new(origin_on_page.x, far.y)],
    ];
    for [from, to] in ends {
        shapes.extend(dashed(from, to, 3.0 * metrics.line_width, metrics.line_width / 2.0, muted.into()));
        placer.avoid_line(from, to, 1.0);
    }
    let line = Line::math("0", metrics.font_size);
    let (towards, gap) = (Vector::new(-1.0, 1.0), 0.5 * metrics.font_size);
    let origin = placer.place(line, origin_on_page, towards, gap, metrics.palette.ink);
    origin.into_iter().for_each(|origin| origin.draw_over(fills, Halo::Around, metrics, shapes));
    for ([_, end], name) in ends.iter().zip(["x", "y"]) {
        let inward = origin_on_page.sub(*end).mult(metrics.font_size / origin_on_page.sub(*end).norm());
        let line = Line::math(name, metrics.font_size);
        let name = placer.place(line, end.add(inward), Vector::new(-1.0, -1.0), 0.6 * metrics.font_size, muted);
        name.into_iter().for_each(|name| name.draw_over(fills, Halo::Around, metrics, shapes));
    }
}
