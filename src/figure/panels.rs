use super::FigureOptions;
use crate::physics::{Rect, Vector};
use crate::render::area::inset;
use crate::render::text::Line;
use crate::render::{Camera, DisplayList, Ink, Look, Shape, View};

/// A figure being made: a page with room for panels, and a caption below.
pub struct Panels {
    /// Colours and sizes.
    pub look: Look,
    /// What is not caption or margin, px.
    pub room: Rect,
    size: [u32; 2],
    /// Drawn in this order.
    pub shapes: Vec<Shape>,
}

impl Panels {
    /// An empty page.
    pub fn new(options: &FigureOptions) -> Panels {
        let look = Look::new(options.style.theme, options.size);
        let [width, height] = options.size.map(f64::from);
        let margin = look.text.round();
        let mut panels =
            Panels { look, room: Rect::new(Vector::ZERO, width, height), size: options.size, shapes: Vec::new() };
        let mut bottom = margin;
        if let Some(caption) = &options.caption {
            bottom += 1.5 * look.text;
            let line = Line::plain(caption, look.text);
            panels.centered(line, Vector::new(width / 2.0, height - margin), look.palette.ink.into());
        }
        panels.room = Rect::new(Vector::new(margin, margin), width - 2.0 * margin, height - margin - bottom);
        panels
    }

    /// The room in equal parts, `columns` in a row, with gaps between.
    pub fn grid(&self, count: usize, columns: usize) -> Vec<Rect> {
        let rows = count.div_ceil(columns).max(1);
        let gap = self.look.text.round();
        let width = ((self.room.width() - gap * (columns - 1) as f64) / columns as f64).floor();
        let height = ((self.room.height() - gap * (rows - 1) as f64) / rows as f64).floor();
        let place = |at: usize| {
            let (column, row) = ((at % columns) as f64, (at / columns) as f64);
            Rect::new(self.room.origin.add(Vector::new(column * (width + gap), row * (height + gap))), width, height)
        };
        (0..count).map(place).collect()
    }

    /// Writes a line around the middle `at` of its baseline.
    pub fn centered(&mut self, line: Line, at: Vector, ink: Ink) {
        let at = Vector::new((at.x - line.width / 2.0).round(), at.y.round());
        self.shapes.push(Shape::Text { line, at, ink });
    }

    /// The finished page.
    pub fn finish(self) -> DisplayList {
        DisplayList {
            size: self.size,
            background: self.look.palette.background,
            backdrop: Vec::new(),
            shapes: self.shapes,
        }
    }
}

/// The part of a panel that is not caption.
pub fn above_caption(place: &Rect, look: &Look) -> Rect {
    Rect::new(place.origin, place.width(), place.height() - 2.0 * look.text)
}

/// What is written below a panel.
pub fn caption(room: &Rect, markup: &str, panels: &mut Panels) {
    let line = Line::math(markup, panels.look.text);
    let at = Vector::new(room.center().x, room.far_corner().y + 1.5 * panels.look.text);
    panels.centered(line, at, panels.look.palette.ink.into());
}

/// The whole world in the middle of a part of the page, with a margin for its walls, px.
pub fn world_view(room: &Rect, margin: f64, options: &FigureOptions) -> View {
    let world = Rect::new(Vector::ZERO, options.world.x, options.world.y);
    let camera = Camera::over(&world, options.size, *room, margin);
    let window = inset(&camera.rect(&world), -margin);
    View { camera: Camera { window, ..camera }, style: options.style.clone() }
}

/// A frame of four thin rectangles around the outside of another, px.
pub fn outline(rect: &Rect, width: f64, ink: Ink) -> [Shape; 4] {
    let (near, far) = (rect.origin, rect.far_corner());
    let side = |x: f64, y: f64, width: f64, height: f64| Shape::Rect {
        rect: Rect::new(Vector::new(x, y), width, height),
        ink,
    };
    let across = rect.width() + 2.0 * width;
    [
        side(near.x - width, near.y - width, across, width),
        side(near.x - width, far.y, across, width),
        side(near.x - width, near.y, width, rect.height()),
        side(far.x, near.y, width, rect.height()),
    ]
}

/// The pieces of a dashed line.
pub fn dashed(from: Vector, to: Vector, dash: f64, width: f64, ink: Ink) -> Vec<Shape> {
    let length = to.sub(from).norm();
    if length == 0.0 || !length.is_finite() {
        return Vec::new();
    }
    let at = |along: f64| from.add(to.sub(from).mult(along / length));
    let count = (length / (2.0 * dash)).ceil() as u32;
    let piece = |number: u32| {
        let start = f64::from(number) * 2.0 * dash;
        let end = if start + dash < length { start + dash } else { length };
        Shape::Polyline { points: vec![at(start), at(end)], width, ink }
    };
    (0..count).map(piece).collect()
}
