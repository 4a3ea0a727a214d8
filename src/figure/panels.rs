use super::{FigureOptions, Meeting, Run};
use crate::physics::{Rect, Vector};
use crate::render::area::{inset, larger, smaller};
use crate::render::layers::legend::{Legend, Place};
use crate::render::text::Line;
use crate::render::{Aim, Camera, DisplayList, Frame, Ink, Look, Shape, View};

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

/// Height of what is above a titled panel, in texts' heights.
pub const TITLE: f64 = 1.8;

impl Panels {
    /// An empty page with a caption and a legend below.
    pub fn new(options: &FigureOptions, legend: &Legend) -> Panels {
        let look = Look::new(options.style.theme, options.size);
        let [width, height] = options.size.map(f64::from);
        let margin = look.text.round();
        let room = Rect::new(Vector::new(margin, margin), width - 2.0 * margin, height - 2.0 * margin);
        let mut panels = Panels { look, room, size: options.size, shapes: Vec::new() };
        panels.caption(&options.style.caption);
        panels.legend(legend);
        panels
    }

    fn caption(&mut self, caption: &str) {
        if caption.is_empty() {
            return;
        }
        let lines = [1.0, 0.85, 0.7].map(|size| Line::plain(caption, size * self.look.text));
        let [.., last] = &lines;
        let line = lines.iter().find(|line| line.width <= self.room.width()).unwrap_or(last).clone();
        let strip = self.take_below(1.5 * self.look.text);
        let ink = self.look.palette.ink.into();
        self.centered(line, Vector::new(strip.center().x, strip.far_corner().y), ink);
    }

    fn legend(&mut self, legend: &Legend) {
        if !legend.entries.is_empty() {
            let strip = self.take_below(1.5 * self.look.text);
            let low =
                Rect::new(strip.origin.add(Vector::new(0.0, 0.5 * self.look.text)), strip.width(), self.look.text);
            legend.draw(&low, Place::Middle, &self.look, &mut self.shapes);
        }
    }

    /// Cuts a strip off the lower end of the room.
    pub fn take_below(&mut self, height: f64) -> Rect {
        let (room, rest) = (self.room, self.room.height() - height);
        self.room = Rect::new(room.origin, room.width(), rest);
        Rect::new(room.origin.add(Vector::new(0.0, rest)), room.width(), height)
    }

    /// A place for each of several runs, with its title above; all of the room for a single one.
    pub fn titled(&mut self, titles: &[&str], columns: usize) -> Vec<Rect> {
        if titles.len() < 2 {
            return vec![self.room; titles.len()];
        }
        let above = TITLE * self.look.text;
        let places = self.grid(titles.len(), columns);
        let ink = self.look.palette.ink.into();
        for (title, place) in titles.iter().zip(&places) {
            let lines = [1.0, 0.85, 0.7].map(|size| Line::plain(title, size * self.look.text));
            let [.., last] = &lines;
            let line = lines.iter().find(|line| line.width <= place.width()).unwrap_or(last).clone();
            self.centered(line, Vector::new(place.center().x, place.origin.y + self.look.text), ink);
        }
        let below =
            |place: Rect| Rect::new(place.origin.add(Vector::new(0.0, above)), place.width(), place.height() - above);
        places.into_iter().map(below).collect()
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

    /// The number of columns with which pictures of these extents are seen largest, with so much
    /// written above and below each, px.
    pub fn columns(&self, extents: &[Vector], written: f64) -> usize {
        let widest = extents.iter().fold(Vector::ZERO, |a, b| Vector::new(larger(a.x, b.x), larger(a.y, b.y)));
        let scale = |columns: usize| {
            let (across, rows) = (columns as f64, extents.len().div_ceil(columns) as f64);
            let gap = self.look.text;
            let width = (self.room.width() + gap) / across - gap;
            let height = (self.room.height() + gap) / rows - gap - written;
            smaller(width / widest.x, height / widest.y)
        };
        let better = |best: usize, columns: usize| if scale(columns) > scale(best) { columns } else { best };
        (1..=extents.len()).reduce(better).unwrap_or(1)
    }

    /// Writes a line around the middle `at` of its baseline.
    pub fn centered(&mut self, line: Line, at: Vector, ink: Ink) {
        let at = Vector::new((at.x - line.width / 2.0).round(), at.y.round());
        self.shapes.push(Shape::Text { line, at, ink });
    }

    /// A thin frame around a panel whose content is cut off there.
    pub fn frame(&mut self, room: &Rect) {
        let thin = (self.look.line / 2.0).ceil();
        self.shapes.extend(outline(&inset(room, thin), thin, self.look.palette.wall_edge.into()));
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

/// A page with a row for each collision, as `row` draws it.
pub fn in_rows(
    meetings: &[Meeting],
    options: &FigureOptions,
    row: impl Fn(&Meeting, &mut Panels, &FigureOptions),
) -> DisplayList {
    let mut panels = Panels::new(options, &Legend::of(&options.style));
    let titles: Vec<&str> = meetings.iter().map(|meeting| meeting.title.as_str()).collect();
    let page = panels.room;
    for (meeting, place) in meetings.iter().zip(panels.titled(&titles, 1)) {
        panels.room = place;
        row(meeting, &mut panels, options);
        panels.room = page;
    }
    panels.finish()
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

/// What of a world is aimed at, in the middle of a part of the page, with a margin for its walls,
/// px; without a frame it is followed in none.
pub fn world_view(room: &Rect, margin: f64, run: &Run, frame: &Frame, options: &FigureOptions) -> View {
    let world = Rect::new(Vector::ZERO, run.world.x, run.world.y);
    let area = match &options.aim {
        Aim::World => world,
        Aim::Window(area) => *area,
        Aim::Follow { size, .. } => Rect::new(world.center().sub(size.mult(0.5)), size.x, size.y),
    };
    let camera = Camera::over(&area, options.size, *room, margin);
    let window = inset(&camera.rect(&area), -margin);
    let camera = Camera { window, world: run.world, ..camera };
    let follow = options.aim.follows().map(str::to_owned);
    let view = View { camera, follow, style: options.style.clone() };
    View { camera: view.camera_at(frame), follow: None, ..view }
}

/// Width and height of what is aimed at, m.
pub fn extent(run: &Run, options: &FigureOptions) -> Vector {
    match &options.aim {
        Aim::World => run.world,
        Aim::Window(area) => Vector::new(area.width(), area.height()),
        Aim::Follow { size, .. } => *size,
    }
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
