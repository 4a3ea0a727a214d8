//! The pages of an animation: of one recording, or of several side by side.

use super::clip::{Instant, Shot};
use super::figures::panels::{Panels, fitted, missing_panel, outline};
use super::layers::footer::{Footer, Legend, gap_text};
use super::layers::{self, LayoutContext, grid};
use super::text::Line;
use super::trace::{GapReason, TraceGap};
use super::view::{self, MIN_TEXT};
use super::visibility::Visibility;
use super::{
    Camera, CameraTarget, DisplayList, DrawingMetrics, Frame, Overlay, RenderError, Shape, Style, View, compose,
};
use crate::physics::{Rect, Vector, larger, smaller};

/// Lays out the instants of an animation.
#[derive(Clone, Debug, PartialEq)]
pub enum Stage {
    /// One recording, which fills the page.
    One(View),
    /// Several recordings, each in a panel.
    Several(SideBySide),
}

impl From<View> for Stage {
    fn from(view: View) -> Stage {
        Stage::One(view)
    }
}

impl Stage {
    /// Width and height of the page, px.
    pub fn size(&self) -> [u32; 2] {
        self.style().look.size
    }

    /// The style of the page.
    pub fn style(&self) -> &Style {
        match self {
            Stage::One(view) => &view.style,
            Stage::Several(page) => &page.page.style,
        }
    }

    /// The view of each recording with its metrics.
    pub(super) fn views_mut(&mut self) -> Vec<(&mut View, DrawingMetrics)> {
        match self {
            Stage::One(view) => {
                let metrics = DrawingMetrics::new(view.style.look.theme, view.style.look.language, view.camera.size);
                vec![(view, metrics)]
            }
            Stage::Several(SideBySide { panels, metrics, .. }) => {
                panels.iter_mut().map(|view| (view, *metrics)).collect()
            }
        }
    }

    /// Adds the bodies that the frames of an instant show.
    pub(super) fn add_to(&self, visibility: &mut Visibility, instant: &Instant) {
        let views = match self {
            Stage::One(view) => std::slice::from_ref(view),
            Stage::Several(page) => &page.panels,
        };
        for (panel, (view, shot)) in views.iter().zip(&instant.shots).enumerate() {
            if let Shot::Frame(frame) = shot {
                visibility.add(panel, frame, view);
            }
        }
    }

    /// Lays out an instant. A recording that lacks it is shown as a hatched area with the reason.
    pub fn compose(&self, instant: &Instant) -> DisplayList {
        match self {
            Stage::One(view) => match instant.shots.first() {
                Some(Shot::Frame(frame)) => compose(frame, view),
                Some(Shot::Missing { step }) => {
                    let mut list = compose(&empty_frame(instant), view);
                    let metrics =
                        DrawingMetrics::new(view.style.look.theme, view.style.look.language, view.camera.size);
                    list.shapes.insert(0, missing(*step, view, &metrics));
                    list
                }
                None => compose(&empty_frame(instant), view),
            },
            Stage::Several(page) => page.compose(instant),
        }
    }
}

/// A frame without bodies, for the clock alone.
fn empty_frame(instant: &Instant) -> Frame {
    Frame { step: instant.step, time: instant.time, sprites: Vec::new(), collisions: Vec::new() }
}

/// A hatched area in place of a state that a recording lacks, with the reason.
fn missing(step: u64, view: &View, metrics: &DrawingMetrics) -> Shape {
    let unknown = TraceGap { steps: step..=step, times: [0.0; 2], reason: GapReason::Unreadable };
    let gap = view.style.gaps.iter().find(|gap| gap.steps.contains(&step)).unwrap_or(&unknown);
    missing_panel(&view.camera.viewport, &gap_text(gap, view.style.look.language), metrics)
}

/// A page with a panel for each of several recordings, all on one scale, with one clock and one legend.
#[derive(Clone, Debug, PartialEq)]
pub struct SideBySide {
    /// The style of the page with the gaps of all recordings, and the camera of the scale bar.
    page: View,
    /// The metrics of the page around the panels.
    page_metrics: DrawingMetrics,
    /// The camera and style of each panel.
    panels: Vec<View>,
    /// The metrics of the panels.
    metrics: DrawingMetrics,
    titles: Vec<Shape>,
}

/// Height of the title above a panel, in font sizes.
const TITLE: f64 = 1.6;

impl SideBySide {
    /// A page of panels, each given by width and height of its world, m, and its style. The styles have a common look.
    ///
    /// # Errors
    /// If the page is too small, or if the visible part of a world is not finite and positive.
    pub fn new(panels: &[(Vector, Style)], titles: &[String]) -> Result<SideBySide, RenderError> {
        let size = panels.first().map_or([0, 0], |(_, style)| style.look.size);
        view::validate_size(size)?;
        for (world, style) in panels {
            view::validate(&shown_area(*world, style), size)?;
        }
        let attempt = |size: [u32; 2]| SideBySide::in_largest_font(size, panels, titles);
        attempt(size).ok_or_else(|| RenderError::too_small(size, |larger| attempt(larger).is_some()))
    }

    /// The page in the largest font in which it is legible.
    fn in_largest_font(size: [u32; 2], panels: &[(Vector, Style)], titles: &[String]) -> Option<SideBySide> {
        let style = page_style(size, panels)?;
        // A page is flat or tall because of its panels: it has the font of a page of 16 : 9, unless it is very flat.
        let [shorter, longer] = [size[0].min(size[1]), size[0].max(size[1])];
        let whole = DrawingMetrics::new(
            style.look.theme,
            style.look.language,
            [longer, shorter.max((longer * 9 / 16).min(2 * shorter))],
        );
        let smaller_font = |font: &f64| (*font > MIN_TEXT).then(|| larger((0.9 * font).floor(), MIN_TEXT));
        let mut fonts = std::iter::successors(Some(whole.font_size), smaller_font);
        fonts.find_map(|font| SideBySide::in_font(whole.with_font_size(font), &style, panels, titles))
    }

    /// The page in a font; `None` if something on it is illegible.
    fn in_font(
        page_metrics: DrawingMetrics,
        style: &Style,
        panels: &[(Vector, Style)],
        titles: &[String],
    ) -> Option<SideBySide> {
        let (size, count) = (style.look.size, panels.len());
        // A panel has a smaller font, but larger than in proportion to its sides.
        let part = 1.0 / (count as f64).sqrt().sqrt();
        let metrics = page_metrics.with_font_size(page_metrics.text(part).floor());
        let footer = footer(style, &page_metrics, &metrics);
        let [info, caption] = footer.heights(style);
        let [width, height] = size.map(f64::from);
        let margin = page_metrics.font_size.round();
        let [left, below] = if style.shows(Overlay::Axes) {
            [(3.2 * metrics.font_size).round(), (1.6 * metrics.font_size).round()]
        } else {
            [0.0, 0.0]
        };
        let above = (TITLE * page_metrics.font_size).round();
        let content = Rect::new(
            Vector::new(margin, (0.4 * margin).round()),
            width - 2.0 * margin,
            height - info - caption - margin - (0.4 * margin).round(),
        );
        let areas: Vec<Rect> = panels.iter().map(|(world, style)| shown_area(*world, style)).collect();
        let extent = areas.iter().map(|area| Vector::new(area.width(), area.height())).reduce(Vector::max)?;
        let grid = Panels::of_cell(&content, &metrics);
        let columns = grid.columns(count, extent, above + below);
        let cells: Vec<Rect> = grid.grid(count, columns);
        let room = |cell: &Rect| {
            Rect::new(
                Vector::new(cell.origin.x + left, cell.origin.y + above),
                cell.width() - left,
                cell.height() - above - below,
            )
        };
        let is_legible = |cell: &Rect| {
            room(cell).width() >= 5.0 * metrics.font_size && room(cell).height() >= 3.0 * metrics.font_size
        };
        if !footer.is_legible() || !cells.iter().all(is_legible) {
            return None;
        }
        // Lengths are the same in all panels.
        let walls = metrics.font_size.floor();
        let scale = |(cell, area): (&Rect, &Rect)| Camera::fit(area, size, room(cell), walls).scale;
        let scale = cells.iter().zip(&areas).map(scale).fold(f64::INFINITY, smaller);
        let view = |((cell, area), (world, style)): ((&Rect, &Rect), &(Vector, Style))| {
            panel_view(
                &room(cell),
                area,
                *world,
                scale,
                walls,
                &Style { look: style_of_size(style, size), ..style.clone() },
            )
        };
        let views: Vec<View> = cells.iter().zip(&areas).zip(panels).map(view).collect();
        let titles = titles_above(&views, titles, &cells, &page_metrics);
        let page = View { camera: views.first()?.camera, follow: None, style: style.clone() };
        Some(SideBySide { page, page_metrics, panels: views, metrics, titles })
    }

    fn compose(&self, instant: &Instant) -> DisplayList {
        let palette = &self.page_metrics.palette;
        let (mut backdrop, mut shapes) = (Vec::new(), Vec::new());
        for (view, shot) in self.panels.iter().zip(&instant.shots) {
            let empty = empty_frame(instant);
            let frame = match shot {
                Shot::Frame(frame) => frame,
                Shot::Missing { .. } => &empty,
            };
            let context = LayoutContext { view, camera: view.camera_for(frame), metrics: self.metrics };
            backdrop.push(layers::backdrop(frame, &context));
            match shot {
                Shot::Frame(frame) => shapes.push(layers::foreground(frame, &context)),
                Shot::Missing { step } => shapes.push(missing(*step, view, &self.metrics)),
            }
            grid::draw_axes(&context, &mut shapes);
            let thin = (self.metrics.line_width / 2.0).ceil();
            if !view.style.shows(Overlay::Axes) {
                shapes.extend(outline(&view.camera.viewport, thin, palette.grid.into()));
            }
        }
        shapes.extend(self.titles.iter().cloned());
        let context = LayoutContext { view: &self.page, camera: self.page.camera, metrics: self.page_metrics };
        let footer = footer(&self.page.style, &self.page_metrics, &self.metrics);
        footer.draw(&empty_frame(instant), &context, &mut shapes);
        DisplayList { size: self.page.style.look.size, background: palette.background, backdrop, shapes }.within_reach()
    }
}

/// The style of the page: that of its panels, with the gaps of all.
fn page_style(size: [u32; 2], panels: &[(Vector, Style)]) -> Option<Style> {
    let (_, first) = panels.first()?;
    let gaps = panels.iter().flat_map(|(_, style)| style.gaps.clone()).collect();
    Some(Style { look: style_of_size(first, size), gaps, ..first.clone() })
}

fn style_of_size(style: &Style, size: [u32; 2]) -> super::Look {
    super::Look { size, ..style.look.clone() }
}

/// The strips below the panels, whose legend shows the arrows of the panels.
fn footer(style: &Style, page_metrics: &DrawingMetrics, metrics: &DrawingMetrics) -> Footer {
    Footer::with_legend(style, page_metrics, Legend::of(style, metrics))
}

/// The part of the plane that a panel shows, m.
fn shown_area(world: Vector, style: &Style) -> Rect {
    let whole = Rect::new(Vector::ZERO, world.x, world.y);
    match &style.look.camera_target {
        CameraTarget::World => whole,
        CameraTarget::Window(area) => *area,
        CameraTarget::Follow { size, .. } => Rect::new(whole.center().sub(size.mult(0.5)), size.x, size.y),
    }
}

/// The view of an area in the middle of a panel, with a margin for the walls, px.
fn panel_view(room: &Rect, area: &Rect, world: Vector, scale: f64, walls: f64, style: &Style) -> View {
    let margin = if style.look.camera_target == CameraTarget::World { walls } else { 0.0 };
    let origin = area.center().sub(room.center().mult(1.0 / scale));
    let camera = Camera { size: style.look.size, viewport: *room, scale, origin, world };
    let shown = camera.rect(area).inset(-margin);
    let [near, far] = [shown.origin, shown.far_corner()].map(|corner| Vector::new(corner.x.round(), corner.y.round()));
    let viewport = Rect::new(near, far.x - near.x, far.y - near.y);
    let follow = style.look.camera_target.followed_body().map(str::to_owned);
    View { camera: Camera { viewport, ..camera }, follow, style: style.clone() }
}

/// The titles above the panels, in one size: the largest in which each fits.
fn titles_above(views: &[View], titles: &[String], cells: &[Rect], metrics: &DrawingMetrics) -> Vec<Shape> {
    let width = cells.first().map_or(0.0, Rect::width);
    let sizes = [1.0, 0.85, 0.7].map(|part| metrics.text(part));
    let [.., smallest] = sizes;
    let fits = |size: &f64| titles.iter().all(|title| Line::plain(title, *size).width <= width);
    let size = sizes.into_iter().find(fits).unwrap_or(smallest);
    let title = |((view, title), cell): ((&View, &String), &Rect)| {
        let line = fitted(title, [size; 3], width);
        let viewport = view.camera.viewport;
        let left = (viewport.center().x - line.width / 2.0).round();
        let left = smaller(larger(left, cell.origin.x), cell.far_corner().x - line.width);
        let at = Vector::new(left, (viewport.origin.y - 0.45 * metrics.font_size).round());
        Shape::Text { line, at, ink: metrics.palette.ink.into() }
    };
    views.iter().zip(titles).zip(cells).map(title).collect()
}
