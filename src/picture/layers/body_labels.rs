use super::bodies::{Hatching, image_of, marked_rect};
use super::footer::quoted;
use super::{LabeledArrow, LayoutContext, center_of_mass, grid};
use crate::physics::{Rect, Vector, smaller};
use crate::picture::Overlay;
use crate::picture::layers::labels::{Label, LabelPlacer};
use crate::picture::number::format_significant;
use crate::picture::text::{Line, truncated};
use crate::picture::{Color, Frame, Shape, Sprite, Style, color};

/// With more boxes than this only labels inside boxes are drawn, because labels next to them would be unreadable.
pub const MAX_PLACED: usize = 40;

/// Draws the labels of boxes and arrows where they cover as little as possible.
///
/// A label that would cover too much is omitted. With more than [`MAX_PLACED`] boxes, boxes are labelled by [`inside`]
/// instead.
pub fn draw(frame: &Frame, context: &LayoutContext, arrows: &[LabeledArrow], shapes: &mut Vec<Shape>) {
    let mut placer = LabelPlacer::within(context.camera.viewport);
    grid::labels(context).iter().for_each(|label| placer.reserve(label.bounds()));
    for LabeledArrow { arrow, .. } in arrows {
        placer.avoid_line(arrow.from, arrow.to, 3.0);
    }
    center_of_mass::bounds(frame, context).into_iter().for_each(|mark| placer.reserve(mark));
    let boxes = visible_boxes(frame, context);
    if are_placed(boxes.len()) && has_labels(context) {
        boxes.iter().for_each(|(_, rect)| placer.avoid(*rect, BOX_WEIGHT));
        let size = common_size(&boxes, context);
        for index in 0..boxes.len() {
            match place(&boxes[index], &boxes[index + 1..], size, &mut placer, context, shapes) {
                Some(PlacedLabel::Inside(label)) => label.draw_bare(shapes),
                Some(PlacedLabel::Outside(label)) => label.draw(&context.metrics, shapes),
                None => {}
            }
        }
    }
    for LabeledArrow { arrow, label, .. } in arrows.iter().filter(|arrow| !arrow.label.is_empty()) {
        let line = Line::math(label, context.metrics.text(0.8));
        let (gap, color) = (0.5 * context.metrics.font_size, context.metrics.palette.label(arrow.color));
        if let Some(label) = placer.place(line, arrow.to, arrow.to.sub(arrow.from), gap, color) {
            label.draw(&context.metrics, shapes);
        }
    }
}

fn are_placed(box_count: usize) -> bool {
    box_count <= MAX_PLACED
}

fn has_labels(context: &LayoutContext) -> bool {
    context.view.style.shows(Overlay::Name) || context.view.style.shows(Overlay::Mass)
}

fn visible_boxes<'a>(frame: &'a Frame, context: &LayoutContext) -> Vec<(&'a Sprite, Rect)> {
    let named = frame.sprites.iter().filter(|sprite| !sprite.appearance.is_wall);
    named.filter_map(|sprite| Some((sprite, marked_rect(&context.visible_rect(sprite)?, context)))).collect()
}

/// Maximum number of characters of a name next to a box.
const MAX_NAME_CHARS: usize = 24;

/// The label of a box as markup: its name, its mass, or both.
fn label_text(sprite: &Sprite, name: &str, context: &LayoutContext) -> String {
    let style = &context.view.style;
    let mass = || match sprite.appearance.mass {
        f64::INFINITY => "∞ \"kg\"".to_owned(),
        mass => style.look.language.decimal(format!("{} \"kg\"", format_significant(mass, 3))),
    };
    match (style.shows(Overlay::Name), style.shows(Overlay::Mass)) {
        (true, true) => format!("{}\", \"{}", quoted(name), mass()),
        (false, true) => mass(),
        (true, false) | (false, false) => quoted(name),
    }
}

/// Sizes tried for labels inside boxes, relative to the font size.
const SIZES: [f64; 3] = [1.0, 0.8, 0.65];

/// The common font size of labels inside non-static boxes, px: the largest of [`SIZES`] that fits all boxes that the
/// smallest fits.
fn common_size(boxes: &[(&Sprite, Rect)], context: &LayoutContext) -> f64 {
    let [.., smallest] = SIZES;
    let movable = boxes.iter().filter(|(sprite, _)| sprite.appearance.mass != f64::INFINITY);
    let fitting: Vec<&(&Sprite, Rect)> = movable.filter(|entry| fits(entry, smallest, context)).collect();
    let size = SIZES.into_iter().find(|&size| fitting.iter().all(|entry| fits(entry, size, context)));
    context.metrics.text(size.unwrap_or(smallest))
}

/// Returns true if the label of a box fits into the box at a size relative to the font size.
fn fits((sprite, rect): &(&Sprite, Rect), size: f64, context: &LayoutContext) -> bool {
    let line = Line::math(&label_text(sprite, &sprite.appearance.name, context), context.metrics.text(size));
    !candidates_inside(&line, rect, context).is_empty()
}

/// Maximum cost of a label next to a box, relative to its area. Labels of higher cost are omitted.
const MAX_COST: f64 = 1.0;

/// Places the label of a box inside the box or else next to it; `None` if both would cover too much. Covers the
/// hatching below it.
fn place(
    (sprite, rect): &(&Sprite, Rect),
    boxes_in_front: &[(&Sprite, Rect)],
    size: f64,
    placer: &mut LabelPlacer,
    context: &LayoutContext,
    shapes: &mut Vec<Shape>,
) -> Option<PlacedLabel> {
    let own = SIZES.into_iter().find(|&own| context.metrics.text(own) <= size && fits(&(sprite, *rect), own, context));
    let line = Line::math(
        &label_text(sprite, &sprite.appearance.name, context),
        own.map_or(size, |own| context.metrics.text(own)),
    );
    let mut own_placer = placer.clone();
    own_placer.avoid(*rect, -BOX_WEIGHT);
    boxes_in_front.iter().for_each(|(_, box_in_front)| own_placer.avoid(*box_in_front, BOX_WEIGHT));
    if let Some(bounds) = own_placer.first_free(candidates_inside(&line, rect, context)) {
        placer.reserve(bounds);
        let fill = color::body_color(sprite, &context.view.style);
        if has_pattern(sprite, &context.view.style) {
            // Text is not legible on hatching or an image.
            shapes.push(Shape::Rect { rect: bounds.inset(-context.metrics.line_width), ink: fill.into() });
        }
        return Some(PlacedLabel::Inside(Label::in_bounds(&bounds, line, context.metrics.palette.text_on(fill))));
    }
    let max_size = context.metrics.text(0.8);
    let name = truncated(&sprite.appearance.name, MAX_NAME_CHARS);
    let line = Line::math(&label_text(sprite, &name, context), smaller(size, max_size));
    let (bounds, cost) = placer.best(candidates_outside(&line, rect, context))?;
    if cost > MAX_COST * bounds.width() * bounds.height() || is_static_and_crowded(sprite, &bounds, placer, context) {
        return None;
    }
    placer.reserve(bounds);
    Some(PlacedLabel::Outside(Label::in_bounds(&bounds, line, context.metrics.palette.ink)))
}

/// Weight of the area of a box covered by a label.
const BOX_WEIGHT: f64 = 1.5;

/// Returns true if a box has hatching or an image.
fn has_pattern(sprite: &Sprite, style: &Style) -> bool {
    Hatching::of_body(sprite, style) != Hatching::None || image_of(sprite, style).is_some()
}

/// A placed label: inside its box, where it needs no halo, or next to it.
enum PlacedLabel {
    Inside(Label),
    Outside(Label),
}

/// Returns true for the label of a static body next to other labels or boxes. Such labels are omitted.
fn is_static_and_crowded(sprite: &Sprite, bounds: &Rect, placer: &LabelPlacer, context: &LayoutContext) -> bool {
    let expanded = Rect::new(
        bounds.origin.sub(Vector::new(context.metrics.font_size, 0.0)),
        bounds.width() + 2.0 * context.metrics.font_size,
        bounds.height(),
    );
    sprite.appearance.mass == f64::INFINITY && placer.cost(&expanded) > 0.0
}

/// Candidate bounds of a label in the visible part of a box: the middle, corners and sides. The middle is left out if
/// arrows begin there.
fn candidates_inside(line: &Line, rect: &Rect, context: &LayoutContext) -> Vec<Rect> {
    let margin = 2.0 * context.metrics.line_width;
    let Some(visible) = rect.intersection(&context.camera.viewport).map(|visible| visible.inset(margin)) else {
        return Vec::new();
    };
    let (width, height) = (line.width, line.height());
    let (free_width, free_height) = (visible.width() - width, visible.height() - height);
    if free_width < 0.0 || free_height < 0.0 {
        return Vec::new();
    }
    let padding = if free_width > 2.0 * margin && free_height > 2.0 * margin { margin } else { 0.0 };
    let at = |x: f64, y: f64| Rect::new(visible.origin.add(Vector::new(x, y)), width, height);
    let [left, top, right, bottom] = [padding, padding, free_width - padding, free_height - padding];
    let corners = [at(left, top), at(right, top), at(left, bottom), at(right, bottom)];
    let sides = [
        at(free_width / 2.0, top),
        at(free_width / 2.0, bottom),
        at(left, free_height / 2.0),
        at(right, free_height / 2.0),
    ];
    let middle = at(free_width / 2.0, free_height / 2.0);
    if has_centered_arrows(context) {
        [corners, sides].concat()
    } else {
        [&[middle], &corners[..], &sides[..]].concat()
    }
}

/// Returns true if arrows begin in the middle of boxes.
fn has_centered_arrows(context: &LayoutContext) -> bool {
    [Overlay::Velocity, Overlay::Momentum, Overlay::Force].into_iter().any(|overlay| context.view.style.shows(overlay))
}

/// Candidate bounds of a label above, below, right and left of a box, and at its corners, within the viewport.
fn candidates_outside(line: &Line, rect: &Rect, context: &LayoutContext) -> Vec<Rect> {
    let (width, height, gap) = (line.width, line.height(), 2.0 * context.metrics.line_width);
    let (near, far, middle) = (rect.origin, rect.far_corner(), rect.center());
    let above = near.y - gap - height;
    let below = far.y + gap;
    let candidates = [
        (middle.x - width / 2.0, above),
        (middle.x - width / 2.0, below),
        (far.x + gap, middle.y - height / 2.0),
        (near.x - gap - width, middle.y - height / 2.0),
        (far.x + gap, above),
        (near.x - gap - width, above),
        (far.x + gap, below),
        (near.x - gap - width, below),
        (near.x, above),
        (far.x - width, above),
        (near.x, below),
        (far.x - width, below),
    ];
    let viewport = &context.camera.viewport;
    let candidates = candidates.map(|(x, y)| Rect::new(Vector::new(x, y), width, height));
    candidates.into_iter().filter(|bounds| viewport.contains(bounds)).collect()
}

/// The label inside a box if there are more than [`MAX_PLACED`] boxes. It is drawn together with its box, so that boxes
/// in front cover it. If arrows begin in the middle of boxes, it is in the upper third of the box.
pub fn inside(sprite: &Sprite, rect: &Rect, fill: Color, box_count: usize, context: &LayoutContext) -> Vec<Shape> {
    if are_placed(box_count) || !has_labels(context) {
        return Vec::new();
    }
    let height = if has_centered_arrows(context) { rect.height() / 3.0 } else { rect.height() };
    let area = Rect::new(rect.origin, rect.width(), height);
    let (text, sizes) =
        (label_text(sprite, &sprite.appearance.name, context), SIZES.map(|size| context.metrics.text(size)));
    let largest = Line::math(&text, sizes[0]);
    // The width of a label is in proportion to its size, so that one layout excludes most sizes in a crowd. A
    // thousandth is left for rounding.
    let is_too_wide = |size: f64| largest.width * size > 1.001 * area.width() * largest.size;
    let fitting = sizes.into_iter().filter(|size| !is_too_wide(*size)).find_map(|size| {
        let line = if size == largest.size { largest.clone() } else { Line::math(&text, size) };
        let bounds = *candidates_inside(&line, &area, context).first()?;
        Some((line, bounds))
    });
    let Some((line, bounds)) = fitting else { return Vec::new() };
    let mut shapes = Vec::new();
    if has_pattern(sprite, &context.view.style) {
        shapes.push(Shape::Rect { rect: bounds.inset(-context.metrics.line_width), ink: fill.into() });
    }
    Label::in_bounds(&bounds, line, context.metrics.palette.text_on(fill)).draw_bare(&mut shapes);
    shapes
}
