use super::{FigureRun, hatched};
use crate::physics::{Rect, Vector, larger, smaller};
use crate::picture::layers::footer::{Alignment, Caption, Legend};
use crate::picture::text::{Line, truncated, wrapped};
use crate::picture::view::{MIN_TEXT, validate_size};
use crate::picture::{Camera, CameraTarget, DisplayList, DrawingMetrics, Frame, Ink, RenderError, Shape, Style, View};

/// The demands of a figure on its page: texts around the panels, and the space of each panel.
pub struct Layout<'a> {
    /// Width and height of the page, px.
    pub size: [u32; 2],
    /// The metrics of a page of this size. A smaller font is used if the panels have no space otherwise.
    pub metrics: DrawingMetrics,
    /// The caption; none if empty.
    pub caption: &'a str,
    /// The legend in given metrics.
    pub legend: &'a dyn Fn(&DrawingMetrics) -> Legend,
    /// A title for each cell.
    pub titles: &'a [&'a str],
    /// The preferred width and height of a cell, in any unit.
    pub shape: Vector,
    /// The height of text above and below the content of a cell, in font sizes.
    pub text_height: f64,
    /// Returns true if the content of a cell is legible in this area, px.
    pub fits: &'a dyn Fn(&Rect, &DrawingMetrics) -> bool,
}

impl<'a> Layout<'a> {
    /// A page in `style` with a square cell for each title, without a legend. `fits` returns true if the content of a
    /// cell is legible in an area, px.
    pub fn new(
        style: &'a Style,
        titles: &'a [&'a str],
        fits: &'a dyn Fn(&Rect, &DrawingMetrics) -> bool,
    ) -> Layout<'a> {
        let size = style.look.size;
        Layout {
            size,
            metrics: DrawingMetrics::new(style.look.theme, style.look.language, size),
            caption: &style.look.caption,
            legend: &|_| Legend { entries: Vec::new() },
            titles,
            shape: Vector::new(1.0, 1.0),
            text_height: 0.0,
            fits,
        }
    }

    /// Lays out the page in the largest font in which every cell is legible, and draws caption, legend and titles.
    /// Returns the page and the area of each cell below its title.
    ///
    /// The number of columns is the one with the largest cells of the preferred shape, so it follows the page.
    ///
    /// # Errors
    /// If the page is too small even for the smallest legible font.
    pub fn lay_out(&self) -> Result<(Panels, Vec<Rect>), RenderError> {
        let Layout { size, metrics, .. } = self;
        validate_size(*size)?;
        self.attempt(*size, *metrics).ok_or_else(|| {
            RenderError::too_small(*size, |larger| {
                // The font grows with the page, but no further than the page needs.
                let scaled = DrawingMetrics::new(metrics.theme, metrics.language, larger);
                self.attempt(larger, scaled).is_some()
            })
        })
    }

    /// The page in the largest font in which it is legible.
    fn attempt(&self, size: [u32; 2], metrics: DrawingMetrics) -> Option<(Panels, Vec<Rect>)> {
        let smaller_font = |font: &f64| (*font > MIN_TEXT).then(|| larger((0.9 * font).floor(), MIN_TEXT));
        let fonts = std::iter::successors(Some(metrics.font_size), smaller_font);
        fonts.map(|font| metrics.with_font_size(font)).find_map(|metrics| self.page(size, metrics))
    }

    /// The page in these metrics; `None` if something on it is illegible.
    fn page(&self, size: [u32; 2], metrics: DrawingMetrics) -> Option<(Panels, Vec<Rect>)> {
        let [width, height] = size.map(f64::from);
        let margin = metrics.font_size.round();
        let content = Rect::new(Vector::new(margin, margin), width - 2.0 * margin, height - 2.0 * margin);
        let mut panels = Panels { metrics, content, size, shapes: Vec::new() };
        if !self.caption.is_empty() {
            let caption = Caption::new(self.caption, [width, height], &metrics);
            if !caption.is_legible {
                return None;
            }
            panels.draw_caption(caption);
        }
        let legend = (self.legend)(&metrics);
        if !legend.is_within(panels.content.width(), &metrics) {
            return None;
        }
        panels.draw_legend(&legend);
        if panels.content.height() < height / 4.0 && !self.titles.is_empty() {
            return None;
        }
        let columns = panels.columns(self.titles.len(), self.shape, self.text_height * metrics.font_size);
        let cells = panels.titled_cells(self.titles, columns);
        cells.iter().all(|cell| (self.fits)(cell, &metrics)).then_some((panels, cells))
    }
}

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
    /// A part of a page, which is laid out like one.
    pub fn of_cell(cell: &Rect, metrics: &DrawingMetrics) -> Panels {
        Panels { metrics: *metrics, content: *cell, size: [1, 1], shapes: Vec::new() }
    }

    fn draw_caption(&mut self, caption: Caption) {
        let below = caption.additional_height();
        let strip = self.split_bottom(1.5 * self.metrics.font_size + below);
        let ink = self.metrics.palette.ink.into();
        caption.draw(strip.center().x, strip.far_corner().y - below, ink, &mut self.shapes);
    }

    fn draw_legend(&mut self, legend: &Legend) {
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

    /// Draws into a rectangle, which clips everything that `draw` adds.
    pub fn clip(&mut self, window: &Rect, draw: impl FnOnce(&mut Panels)) {
        let outer = std::mem::take(&mut self.shapes);
        draw(self);
        let shapes = std::mem::replace(&mut self.shapes, outer);
        self.shapes.push(Shape::Clip { window: *window, shapes });
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
        let width = cells.first().map_or(0.0, Rect::width);
        // All titles have one size: the largest in which each fits.
        let fits = |size: &f64| titles.iter().all(|title| Line::plain(title, *size).width <= width);
        let [.., smallest] = self.title_sizes();
        let size = self.title_sizes().into_iter().find(fits).unwrap_or(smallest);
        for (title, cell) in titles.iter().zip(&cells) {
            let line = fitted(title, [size; 3], cell.width());
            self.centered(line, Vector::new(cell.center().x, cell.origin.y + self.metrics.font_size), ink);
        }
        let below =
            |cell: Rect| Rect::new(cell.origin.add(Vector::new(0.0, above)), cell.width(), cell.height() - above);
        cells.into_iter().map(below).collect()
    }

    /// Font sizes tried for titles and the caption, px.
    fn title_sizes(&self) -> [f64; 3] {
        [1.0, 0.85, 0.7].map(|size| self.metrics.text(size))
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

    /// The number of columns that allows the largest contents of this shape for `count` cells, with `text_height` px of
    /// text above and below each content.
    pub fn columns(&self, count: usize, shape: Vector, text_height: f64) -> usize {
        let scale = |columns: usize| {
            let (column_count, rows) = (columns as f64, count.div_ceil(columns) as f64);
            let gap = self.metrics.font_size;
            let width = (self.content.width() + gap) / column_count - gap;
            let height = (self.content.height() + gap) / rows - gap - text_height;
            smaller(width / shape.x, height / shape.y)
        };
        let better = |best: usize, columns: usize| if scale(columns) > scale(best) { columns } else { best };
        (1..=count).reduce(better).unwrap_or(1)
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
        .within_reach()
    }
}

/// A plain line in the first of `sizes` (px) in which it is at most `width` px wide, or else in the last one, cut with
/// an ellipsis.
pub fn fitted(text: &str, sizes: [f64; 3], width: f64) -> Line {
    let line = Line::fitting(text, sizes, width);
    let counts = (1..text.chars().count().min(MAX_TITLE_CHARS)).rev();
    let cut = counts.map(|count| Line::plain(&truncated(text, count), sizes[2])).find(|line| line.width <= width);
    if line.width <= width { line } else { cut.unwrap_or(line) }
}

/// The largest number of characters of a title that is cut.
const MAX_TITLE_CHARS: usize = 200;

/// A formula in the first font size of several, down to `least` (px), in which the widest is at most `width` px wide.
pub fn fitted_math(markup: &str, size: f64, least: f64, width: f64) -> Line {
    let lines = [1.0, 0.85, 0.7].map(|part| Line::math(markup, larger(part * size, least)));
    let [first, second, third] = lines;
    [first, second].into_iter().find(|line| line.width <= width).unwrap_or(third)
}

/// Panels side by side or one above the other, whichever makes them larger; each with the space of a caption below.
pub fn captioned_panels(cell: &Rect, count: usize, metrics: &DrawingMetrics) -> Vec<Rect> {
    let panels = Panels::of_cell(cell, metrics);
    let columns = panels.columns(count, Vector::new(1.0, 1.0), 2.0 * metrics.font_size);
    panels.grid(count, columns).iter().map(|cell| above_caption(cell, metrics)).collect()
}

/// The part of a cell above its caption.
pub fn above_caption(cell: &Rect, metrics: &DrawingMetrics) -> Rect {
    Rect::new(cell.origin, cell.width(), cell.height() - 2.0 * metrics.font_size)
}

/// Draws the caption below a panel: the long one, or the short one if that is too wide.
pub fn caption(panel: &Rect, [long, short]: [&str; 2], panels: &mut Panels) {
    let font_size = panels.metrics.font_size;
    let line = fitted_math(long, font_size, MIN_TEXT, panel.width());
    let line = if line.width <= panel.width() { line } else { fitted_math(short, font_size, MIN_TEXT, panel.width()) };
    let at = Vector::new(panel.center().x, panel.far_corner().y + 1.5 * font_size);
    panels.centered(line, at, panels.metrics.palette.ink.into());
}

/// A hatched area in place of a state that a recording lacks, with the reason in `text`, in the largest font that fits.
pub fn missing_panel(area: &Rect, text: &str, metrics: &DrawingMetrics) -> Shape {
    let mut shapes = vec![Shape::Rect { rect: *area, ink: Ink { color: metrics.palette.muted, opacity: 40 } }];
    shapes.extend(hatched(area, 6.0 * metrics.line_width, metrics));
    for size in [0.85, 0.7, 0.6, 0.5].map(|part| metrics.text(part)) {
        let lines = wrapped(text, size, area.width() - 2.0 * size);
        let spacing = (1.3 * size).ceil();
        let width = lines.iter().map(|line| line.width).fold(0.0, larger) + size;
        let height = lines.len() as f64 * spacing + 0.6 * size;
        if width > area.width() || height > area.height() {
            continue;
        }
        let near = area.center().sub(Vector::new(width, height).mult(0.5));
        let ground = Rect::new(Vector::new(near.x.round(), near.y.round()), width.ceil(), height.ceil());
        shapes.push(Shape::Rect { rect: ground, ink: metrics.palette.background.into() });
        for (number, line) in (0_u32..).zip(lines) {
            let at = Vector::new(
                (area.center().x - line.width / 2.0).round(),
                (ground.origin.y + size + f64::from(number) * spacing).round(),
            );
            shapes.push(Shape::Text { line, at, ink: metrics.palette.ink.into() });
        }
        break;
    }
    Shape::Clip { window: *area, shapes }
}

/// The view of the camera target of a run, in the middle of `panel`, with a margin for the walls, px. The scale is that
/// at which `widest` (m), the extent of the largest camera target of a figure, fits into the panel. `frame` is the
/// instant at which the camera follows a body.
pub fn world_view(
    panel: &Rect,
    margin: f64,
    run: &FigureRun,
    widest: Vector,
    frame: Option<&Frame>,
    style: &Style,
) -> View {
    let world = Rect::new(Vector::ZERO, run.world.x, run.world.y);
    let area = match &style.look.camera_target {
        CameraTarget::World => world,
        CameraTarget::Window(area) => *area,
        CameraTarget::Follow { size, .. } => Rect::new(world.center().sub(size.mult(0.5)), size.x, size.y),
    };
    let is_widest = widest == Vector::new(area.width(), area.height());
    let fitted = Rect::new(area.center().sub(widest.mult(0.5)), widest.x, widest.y);
    let camera = Camera::fit(if is_widest { &area } else { &fitted }, style.look.size, *panel, margin);
    let viewport = camera.rect(&area).inset(-margin);
    let camera = Camera { viewport, world: run.world, ..camera };
    let follow = style.look.camera_target.followed_body().map(str::to_owned);
    let view = View { camera, follow, style: style.clone() };
    View { camera: frame.map_or(view.camera, |frame| view.camera_for(frame)), follow: None, ..view }
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

/// Values, as markup, in as many lines of at most `width` px as they need.
pub fn joined_lines(values: &[String], size: f64, width: f64) -> Vec<Line> {
    let line = |values: &[String]| Line::math(&values.join(",   "), size);
    let (mut lines, mut start) = (Vec::new(), 0);
    for end in 1..=values.len() {
        if end == values.len() || line(&values[start..=end]).width > width {
            lines.push(line(&values[start..end]));
            start = end;
        }
    }
    lines
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
