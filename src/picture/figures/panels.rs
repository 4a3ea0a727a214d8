use super::{CollisionSubject, FigureRun};
use crate::physics::{Rect, Vector, smaller};
use crate::picture::layers::footer::{Alignment, Caption, Legend};
use crate::picture::text::Line;
use crate::picture::{Camera, CameraTarget, DisplayList, DrawingMetrics, Frame, Ink, Shape, Style, View};

/// The page of a figure while it is being drawn: an area for panels, with a legend and a caption below.
pub struct Panels {
    /// Colours, font size and line width.
    pub metrics: DrawingMetrics,
    /// The area left for panels, px.
    pub content: Rect,
    size: [u32; 2],
    /// The shapes drawn so far, in drawing order.
    pub shapes: Vec<Shape>,
}

/// Height of the title above a panel, in font sizes.
pub const TITLE: f64 = 1.8;

impl Panels {
    /// Creates a page with the caption of `options` and a legend.
    pub fn new(style: &Style, legend: &Legend) -> Panels {
        let metrics = DrawingMetrics::new(style.look.theme, style.look.size);
        Panels::with_metrics(style.look.size, metrics, &style.look.caption, legend)
    }

    /// Creates a page of the given size and metrics with a caption and a legend.
    pub fn with_metrics(size: [u32; 2], metrics: DrawingMetrics, caption: &str, legend: &Legend) -> Panels {
        let [width, height] = size.map(f64::from);
        let margin = metrics.font_size.round();
        let content = Rect::new(Vector::new(margin, margin), width - 2.0 * margin, height - 2.0 * margin);
        let mut panels = Panels { metrics, content, size, shapes: Vec::new() };
        panels.caption(caption);
        panels.legend(legend);
        panels
    }

    fn caption(&mut self, text: &str) {
        if text.is_empty() {
            return;
        }
        let [width, height] = self.size.map(f64::from);
        let caption = Caption::new(text, [width - self.metrics.font_size, height], self.metrics.font_size);
        let below = caption.additional_height();
        let strip = self.split_bottom(1.5 * self.metrics.font_size + below);
        let ink = self.metrics.palette.ink.into();
        caption.draw(strip.center().x, strip.far_corner().y - below, ink, &mut self.shapes);
    }

    fn legend(&mut self, legend: &Legend) {
        if !legend.entries.is_empty() {
            let is_one_row = legend.fits(self.content.width(), &self.metrics);
            let rows =
                if is_one_row { self.metrics.font_size } else { legend.height(self.content.width(), &self.metrics) };
            let strip = self.split_bottom(rows + 0.5 * self.metrics.font_size);
            let legend_strip =
                Rect::new(strip.origin.add(Vector::new(0.0, 0.5 * self.metrics.font_size)), strip.width(), rows);
            legend.draw(&legend_strip, Alignment::Center, &self.metrics, &mut self.shapes);
        }
    }

    /// Cuts a strip off the lower end of the content area and returns it.
    pub fn split_bottom(&mut self, height: f64) -> Rect {
        let (content, rest) = (self.content, self.content.height() - height);
        self.content = Rect::new(content.origin, content.width(), rest);
        Rect::new(content.origin.add(Vector::new(0.0, rest)), content.width(), height)
    }

    /// Draws a title for each of several cells and returns the areas below the titles. A single cell has no title and
    /// fills the content area.
    pub fn titled_cells(&mut self, titles: &[&str], columns: usize) -> Vec<Rect> {
        if titles.len() < 2 {
            return vec![self.content; titles.len()];
        }
        let above = TITLE * self.metrics.font_size;
        let cells = self.grid(titles.len(), columns);
        let ink = self.metrics.palette.ink.into();
        for (title, cell) in titles.iter().zip(&cells) {
            let line = Line::fitting(title, self.title_sizes(), cell.width());
            self.centered(line, Vector::new(cell.center().x, cell.origin.y + self.metrics.font_size), ink);
        }
        let below =
            |cell: Rect| Rect::new(cell.origin.add(Vector::new(0.0, above)), cell.width(), cell.height() - above);
        cells.into_iter().map(below).collect()
    }

    /// Font sizes tried for titles and the caption, px.
    fn title_sizes(&self) -> [f64; 3] {
        [1.0, 0.85, 0.7].map(|size| size * self.metrics.font_size)
    }

    /// Divides the content area into `count` equal cells with gaps, `columns` per row.
    pub fn grid(&self, count: usize, columns: usize) -> Vec<Rect> {
        let rows = count.div_ceil(columns).max(1);
        let gap = self.metrics.font_size.round();
        let width = ((self.content.width() - gap * (columns - 1) as f64) / columns as f64).floor();
        let height = ((self.content.height() - gap * (rows - 1) as f64) / rows as f64).floor();
        let cell = |at: usize| {
            let (column, row) = ((at % columns) as f64, (at / columns) as f64);
            Rect::new(self.content.origin.add(Vector::new(column * (width + gap), row * (height + gap))), width, height)
        };
        (0..count).map(cell).collect()
    }

    /// The number of columns that allows the largest scale for pictures of these extents, with `text_height` px of text
    /// above and below each picture.
    pub fn columns(&self, extents: &[Vector], text_height: f64) -> usize {
        let widest = extents.iter().fold(Vector::ZERO, |widest, &extent| widest.max(extent));
        let scale = |columns: usize| {
            let (column_count, rows) = (columns as f64, extents.len().div_ceil(columns) as f64);
            let gap = self.metrics.font_size;
            let width = (self.content.width() + gap) / column_count - gap;
            let height = (self.content.height() + gap) / rows - gap - text_height;
            smaller(width / widest.x, height / widest.y)
        };
        let better = |best: usize, columns: usize| if scale(columns) > scale(best) { columns } else { best };
        (1..=extents.len()).reduce(better).unwrap_or(1)
    }

    /// Draws a line of text with the middle of its baseline at `at`.
    pub fn centered(&mut self, line: Line, at: Vector, ink: Ink) {
        let at = Vector::new((at.x - line.width / 2.0).round(), at.y.round());
        self.shapes.push(Shape::Text { line, at, ink });
    }

    /// Draws a thin frame around a panel whose content is clipped.
    pub fn draw_frame(&mut self, panel: &Rect) {
        let thin = (self.metrics.line_width / 2.0).ceil();
        self.shapes.extend(outline(&panel.inset(thin), thin, self.metrics.palette.wall_edge.into()));
    }

    /// Returns the display list of the page.
    pub fn finish(self) -> DisplayList {
        DisplayList {
            size: self.size,
            background: self.metrics.palette.background,
            backdrop: Vec::new(),
            shapes: self.shapes,
        }
    }
}

/// A page with one row per collision, drawn by `row`.
pub fn draw_rows(
    subjects: &[CollisionSubject],
    style: &Style,
    row: impl Fn(&CollisionSubject, &mut Panels, &Style),
) -> DisplayList {
    let mut panels = Panels::new(style, &Legend::of(style));
    let titles: Vec<&str> = subjects.iter().map(|subject| subject.title.as_str()).collect();
    let page_content = panels.content;
    for (subject, cell) in subjects.iter().zip(panels.titled_cells(&titles, 1)) {
        panels.content = cell;
        row(subject, &mut panels, style);
        panels.content = page_content;
    }
    panels.finish()
}

/// The part of a cell above its caption.
pub fn above_caption(cell: &Rect, metrics: &DrawingMetrics) -> Rect {
    Rect::new(cell.origin, cell.width(), cell.height() - 2.0 * metrics.font_size)
}

/// Draws the caption below a panel.
pub fn caption(panel: &Rect, markup: &str, panels: &mut Panels) {
    let line = Line::math(markup, panels.metrics.font_size);
    let at = Vector::new(panel.center().x, panel.far_corner().y + 1.5 * panels.metrics.font_size);
    panels.centered(line, at, panels.metrics.palette.ink.into());
}

/// The view of the camera target at `frame`, in the middle of `panel`, with a margin for the walls, px.
pub fn world_view(panel: &Rect, margin: f64, run: &FigureRun, frame: &Frame, style: &Style) -> View {
    let world = Rect::new(Vector::ZERO, run.world.x, run.world.y);
    let area = match &style.look.camera_target {
        CameraTarget::World => world,
        CameraTarget::Window(area) => *area,
        CameraTarget::Follow { size, .. } => Rect::new(world.center().sub(size.mult(0.5)), size.x, size.y),
    };
    let camera = Camera::fit(&area, style.look.size, *panel, margin);
    let viewport = camera.rect(&area).inset(-margin);
    let camera = Camera { viewport, world: run.world, ..camera };
    let follow = style.look.camera_target.followed_body().map(str::to_owned);
    let view = View { camera, follow, style: style.clone() };
    View { camera: view.camera_for(frame), follow: None, ..view }
}

/// Width and height of the camera target, m.
pub fn target_extent(run: &FigureRun, style: &Style) -> Vector {
    match &style.look.camera_target {
        CameraTarget::World => run.world,
        CameraTarget::Window(area) => Vector::new(area.width(), area.height()),
        CameraTarget::Follow { size, .. } => *size,
    }
}

/// A frame around the outside of a rectangle, as four rectangles of `width` px.
pub fn outline(rect: &Rect, width: f64, ink: Ink) -> [Shape; 4] {
    let (near, far) = (rect.origin, rect.far_corner());
    let side = |x: f64, y: f64, width: f64, height: f64| Shape::Rect {
        rect: Rect::new(Vector::new(x, y), width, height),
        ink,
    };
    let full_width = rect.width() + 2.0 * width;
    [
        side(near.x - width, near.y - width, full_width, width),
        side(near.x - width, far.y, full_width, width),
        side(near.x - width, near.y, width, rect.height()),
        side(far.x, near.y, width, rect.height()),
    ]
}

/// The segments of a dashed line.
pub fn dashed(from: Vector, to: Vector, dash: f64, width: f64, ink: Ink) -> Vec<Shape> {
    let length = to.sub(from).norm();
    if length == 0.0 || !length.is_finite() {
        return Vec::new();
    }
    let at = |along: f64| from.add(to.sub(from).mult(along / length));
    let count = (length / (2.0 * dash)).ceil() as u32;
    let segment = |number: u32| {
        let start = f64::from(number) * 2.0 * dash;
        let end = smaller(start + dash, length);
        Shape::Polyline { points: vec![at(start), at(end)], width, ink }
    };
    (0..count).map(segment).collect()
}
