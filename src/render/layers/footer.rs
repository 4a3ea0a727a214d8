use super::super::palette::{self, SPEEDS};
use super::super::text::Line;
use super::super::{Frame, Ink, Shape};
use super::Page;
use super::grid::number;
use crate::physics::{Rect, Vector};
use crate::scene::{ColorBy, Overlay};

/// The strip below the world: the clock on the left, what colours mean on the right.
pub fn draw(frame: &Frame, page: &Page, shapes: &mut Vec<Shape>) {
    let camera = &page.view.camera;
    let [width, height] = camera.size.map(f64::from);
    let top = camera.window.far_corner().y;
    let strip = Rect::new(Vector::new(0.0, top), width, height - top);
    if page.view.style.shows(Overlay::Clock) {
        clock(frame.time, page, &strip, shapes);
    }
    match page.view.style.color_by {
        ColorBy::Body => {}
        ColorBy::Material => materials(page, &strip, shapes),
        ColorBy::Speed => speeds(page, &strip, shapes),
    }
}

/// Where a line stands in the middle of the strip's height.
fn baseline(line: &Line, strip: &Rect) -> f64 {
    (strip.center().y + line.height() / 2.0).round()
}

fn margin(page: &Page) -> f64 {
    page.look.text.round()
}

fn clock(time: f64, page: &Page, strip: &Rect, shapes: &mut Vec<Shape>) {
    let line = Line::plain(&format!("𝑡 = {time:.2} s"), page.look.text);
    let at = Vector::new(margin(page), baseline(&line, strip));
    shapes.push(Shape::Text { line, at, ink: Ink::from(page.look.palette.ink) });
}

/// A bar of the scale's colours between 0 and the top speed.
fn speeds(page: &Page, strip: &Rect, shapes: &mut Vec<Shape>) {
    let top = page.view.style.top_speed;
    let (zero, end) = (text("0", page), text(&format!("{} m/s", number(top, top / 10.0)), page));
    let swatch = (0.75 * page.look.text).round();
    let gap = (0.4 * page.look.text).round();
    let mut x = (strip.width() - margin(page) - end.width).round();
    shapes.push(Shape::Text { at: Vector::new(x, baseline(&end, strip)), line: end, ink: muted(page) });
    x -= gap + swatch * SPEEDS.len() as f64;
    for (place, &color) in SPEEDS.iter().enumerate() {
        let left = x + place as f64 * swatch;
        shapes.push(Shape::Rect { rect: square(left, swatch, swatch, strip), ink: Ink::from(color) });
    }
    let at = Vector::new((x - gap - zero.width).round(), baseline(&zero, strip));
    shapes.push(Shape::Text { at, line: zero, ink: muted(page) });
}

/// A coloured square and the name of each material, the last one at the right border.
fn materials(page: &Page, strip: &Rect, shapes: &mut Vec<Shape>) {
    let swatch = (0.75 * page.look.text).round();
    let gap = (0.4 * page.look.text).round();
    let mut x = strip.width() - margin(page);
    for name in page.view.style.materials.iter().rev() {
        let line = text(name, page);
        x = (x - line.width).round();
        let at = Vector::new(x, baseline(&line, strip));
        shapes.push(Shape::Text { line, at, ink: muted(page) });
        x -= gap + swatch;
        let color = palette::material_color(name, &page.view.style);
        shapes.push(Shape::Rect { rect: square(x, swatch, swatch, strip), ink: Ink::from(color) });
        x -= 2.0 * gap;
    }
}

fn text(text: &str, page: &Page) -> Line {
    Line::plain(text, 0.85 * page.look.text)
}

fn muted(page: &Page) -> Ink {
    Ink::from(page.look.palette.muted)
}

/// A rectangle in the middle of the strip's height.
fn square(x: f64, width: f64, height: f64, strip: &Rect) -> Rect {
    Rect::new(Vector::new(x, (strip.center().y - height / 2.0).round()), width, height)
}
