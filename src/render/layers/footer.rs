use super::super::text::Line;
use super::super::{Frame, Ink, Shape};
use super::LayoutContext;
use super::grid::{nice_spacing, tick_label};
use super::legend::{Alignment, Legend, baseline};
use crate::physics::{Rect, Vector};
use crate::scene::Overlay;

/// Draws the strips below the world: clock and scale bar on the left and the legend on the right; below them the
/// caption.
pub fn draw(frame: &Frame, context: &LayoutContext, shapes: &mut Vec<Shape>) {
    let style = &context.view.style;
    let [width, height] = context.camera.size.map(f64::from);
    let strip = (if width < height { width } else { height } / 18.0).floor();
    let mut bottom = height;
    if !style.caption.is_empty() {
        bottom -= strip;
        caption(&Rect::new(Vector::new(0.0, bottom), width, strip), context, shapes);
    }
    if style.has_footer() {
        let margin = context.metrics.font_size.round();
        let strip = Rect::new(Vector::new(margin, bottom - strip), width - 2.0 * margin, strip);
        draw_info_strip(frame, &strip, context, shapes);
    }
}

/// Draws clock, scale bar and legend.
fn draw_info_strip(frame: &Frame, strip: &Rect, context: &LayoutContext, shapes: &mut Vec<Shape>) {
    let mut x = strip.origin.x;
    if context.view.style.shows(Overlay::Clock) {
        x = clock(frame.time, strip, context, shapes) + context.metrics.font_size;
    }
    if context.view.style.shows(Overlay::Scale) {
        x = scale_bar(x, strip, context, shapes) + context.metrics.font_size;
    }
    let rest = Rect::new(Vector::new(x, strip.origin.y), strip.far_corner().x - x, strip.height());
    Legend::of(&context.view.style).draw(&rest, Alignment::Right, &context.metrics, shapes);
}

fn caption(strip: &Rect, context: &LayoutContext, shapes: &mut Vec<Shape>) {
    let sizes = [1.0, 0.85, 0.7, 0.6];
    let lines = sizes.map(|size| Line::plain(&context.view.style.caption, size * context.metrics.font_size));
    let [first, .., last] = &lines;
    let line = lines.iter().find(|line| line.width < strip.width() - context.metrics.font_size).unwrap_or(last);
    let at = Vector::new(((strip.width() - line.width) / 2.0).round(), baseline(first, strip));
    shapes.push(Shape::Text { line: line.clone(), at, ink: Ink::from(context.metrics.palette.ink) });
}

/// Draws the time and returns the right end of its space, which is wide enough for four digits of seconds so that the
/// following elements do not move.
fn clock(time: f64, strip: &Rect, context: &LayoutContext, shapes: &mut Vec<Shape>) -> f64 {
    let line = Line::plain(&format!("𝑡 = {time:.2} s"), context.metrics.font_size);
    let widest = Line::plain("𝑡 = 8888.88 s", context.metrics.font_size).width;
    let width = if line.width > widest { line.width } else { widest };
    let at = Vector::new(strip.origin.x, baseline(&line, strip));
    shapes.push(Shape::Text { line, at, ink: Ink::from(context.metrics.palette.ink) });
    (strip.origin.x + width).round()
}

/// Minimum length of the scale bar, in font sizes.
const MIN_BAR: f64 = 3.0;

/// Draws a scale bar of a round length with its label and returns the right end of the label.
fn scale_bar(left: f64, strip: &Rect, context: &LayoutContext, shapes: &mut Vec<Shape>) -> f64 {
    let ink = Ink::from(context.metrics.palette.ink);
    let (line, text) = (context.metrics.line_width, context.metrics.font_size);
    let length = nice_spacing(MIN_BAR * text / context.camera.scale);
    let width = (length * context.camera.scale).round();
    let (left, y, height) = (left.round(), strip.center().y.round(), (0.5 * text).round());
    let bar = |x: f64, y: f64, width: f64, height: f64| Shape::Rect {
        rect: Rect::new(Vector::new(x, y), width, height),
        ink,
    };
    let end = |x: f64| bar(x, (strip.center().y - height / 2.0).round(), line, height);
    shapes.extend([bar(left, y, width, line), end(left), end(left + width - line)]);
    let label = Line::plain(&format!("{} m", tick_label(length, length)), 0.85 * text);
    let (at, width) = (left + width + (0.4 * text).round(), label.width);
    shapes.push(Shape::Text { at: Vector::new(at, baseline(&label, strip)), line: label, ink });
    (at + width).round()
}
