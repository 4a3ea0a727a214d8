use super::super::text::Line;
use super::super::{Frame, Ink, Shape};
use super::Page;
use super::grid::{number, round_spacing};
use super::legend::{Legend, Place, baseline};
use crate::physics::{Rect, Vector};
use crate::scene::Overlay;

/// The strips below the world: the clock and a scale bar on the left, what colours mean on the
/// right; below them the caption.
pub fn draw(frame: &Frame, page: &Page, shapes: &mut Vec<Shape>) {
    let style = &page.view.style;
    let [width, height] = page.camera.size.map(f64::from);
    let strip = (if width < height { width } else { height } / 18.0).floor();
    let mut bottom = height;
    if !style.caption.is_empty() {
        bottom -= strip;
        caption(&Rect::new(Vector::new(0.0, bottom), width, strip), page, shapes);
    }
    if style.has_footer() {
        let margin = page.look.text.round();
        let strip = Rect::new(Vector::new(margin, bottom - strip), width - 2.0 * margin, strip);
        signs(frame, &strip, page, shapes);
    }
}

/// Clock, scale bar and legend.
fn signs(frame: &Frame, strip: &Rect, page: &Page, shapes: &mut Vec<Shape>) {
    let mut x = strip.origin.x;
    if page.view.style.shows(Overlay::Clock) {
        x = clock(frame.time, strip, page, shapes) + page.look.text;
    }
    if page.view.style.shows(Overlay::Scale) {
        x = scale_bar(x, strip, page, shapes) + page.look.text;
    }
    let rest = Rect::new(Vector::new(x, strip.origin.y), strip.far_corner().x - x, strip.height());
    Legend::of(&page.view.style).draw(&rest, Place::Right, &page.look, shapes);
}

fn caption(strip: &Rect, page: &Page, shapes: &mut Vec<Shape>) {
    let sizes = [1.0, 0.85, 0.7, 0.6];
    let lines = sizes.map(|size| Line::plain(&page.view.style.caption, size * page.look.text));
    let [first, .., last] = &lines;
    let line = lines.iter().find(|line| line.width < strip.width() - page.look.text).unwrap_or(last);
    let at = Vector::new(((strip.width() - line.width) / 2.0).round(), baseline(first, strip));
    shapes.push(Shape::Text { line: line.clone(), at, ink: Ink::from(page.look.palette.ink) });
}

/// The time, in as much room as it takes when the clock shows four digits of seconds; returns
/// where that ends.
fn clock(time: f64, strip: &Rect, page: &Page, shapes: &mut Vec<Shape>) -> f64 {
    let line = Line::plain(&format!("𝑡 = {time:.2} s"), page.look.text);
    let widest = Line::plain("𝑡 = 8888.88 s", page.look.text).width;
    let width = if line.width > widest { line.width } else { widest };
    let at = Vector::new(strip.origin.x, baseline(&line, strip));
    shapes.push(Shape::Text { line, at, ink: Ink::from(page.look.palette.ink) });
    (strip.origin.x + width).round()
}

/// Heights of text a scale bar is long, at least.
const SHORTEST_BAR: f64 = 3.0;

/// A bar of a round length with its length behind it; returns where that ends.
fn scale_bar(left: f64, strip: &Rect, page: &Page, shapes: &mut Vec<Shape>) -> f64 {
    let ink = Ink::from(page.look.palette.ink);
    let (line, text) = (page.look.line, page.look.text);
    let length = round_spacing(SHORTEST_BAR * text / page.camera.scale);
    let width = (length * page.camera.scale).round();
    let (left, y, tall) = (left.round(), strip.center().y.round(), (0.5 * text).round());
    let piece = |x: f64, y: f64, width: f64, height: f64| Shape::Rect {
        rect: Rect::new(Vector::new(x, y), width, height),
        ink,
    };
    let end = |x: f64| piece(x, (strip.center().y - tall / 2.0).round(), line, tall);
    shapes.extend([piece(left, y, width, line), end(left), end(left + width - line)]);
    let label = Line::plain(&format!("{} m", number(length, length)), 0.85 * text);
    let (at, width) = (left + width + (0.4 * text).round(), label.width);
    shapes.push(Shape::Text { at: Vector::new(at, baseline(&label, strip)), line: label, ink });
    (at + width).round()
}
