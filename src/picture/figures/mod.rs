//! Figures for lectures: one picture of a whole run or of a collision, for a slide or a page.
//!
//! Each figure is a pure function from states or collisions to a display list, which [`super::encode`] writes as PNG,
//! SVG or PDF. Figures do not use the engine. A figure of several runs shows them side by side on the same
//! scales, with one legend.

mod axes;
mod close_up;
mod collision;
mod diagram;
mod energy;
mod formula;
mod instants;
mod lines;
mod minkowski;
mod momenta;
mod pair;
pub(crate) mod panels;
mod pressure;
mod pressure_run;
mod spacetime;
mod speeds;
mod system_sums;
mod time_curve;
mod timeline;
mod velocity_space;

pub use crate::physics::Axis;
pub use crate::picture::ReferenceFrame;
pub use axes::Range;
pub use collision::collision;
pub use diagram::{Curve, Diagram, Point, diagrams};
pub use energy::{EnergyRun, EnergySample, energy};
pub use instants::{filmstrip, strobe};
pub use lines::{LineRun, LineSubject, lines};
pub use minkowski::minkowski;
pub use pressure::pressure;
pub use pressure_run::{MAX_BODIES as MAX_PRESSURE_BODIES, MAX_SIDES as MAX_PRESSURE_SIDES, PressureRun};
pub use spacetime::{SpacetimeRun, spacetime};
pub use speeds::{SpeedRun, speeds};
pub use system_sums::SystemSums;
pub use time_curve::TimeCurve;
pub use timeline::Timeline;
pub(crate) use timeline::{hatched, missing_area};
pub use velocity_space::{Velocities, VelocityPath, VelocityRun, velocity_space};

use crate::physics::{BodyId, Collision, Vector};
use crate::picture::ColorBy;
use crate::picture::layers::footer::{Entry, Legend, gap_entries, marks, quoted};
use crate::picture::{Appearance, CameraTarget, Color, DrawingMetrics, Frame, Palette, Sprite, Style, TraceGap, color};
use std::collections::BTreeMap;
use std::sync::Arc;

/// The frames of one recording for a figure. Figures of several runs show them side by side.
#[derive(Clone, Debug, PartialEq)]
pub struct FigureRun {
    /// Title, shown if there are several runs.
    pub title: String,
    /// Width and height of its world, m.
    pub world: Vector,
    /// The frames shown, in the order of time.
    pub frames: Vec<Frame>,
    /// The instants that the recording lacks, in the order of time.
    pub missing: Vec<MissingInstant>,
}

/// An instant of a figure that a recording lacks.
#[derive(Clone, Debug, PartialEq)]
pub struct MissingInstant {
    /// Simulated time, s.
    pub time: f64,
    /// The part of the run that is missing.
    pub gap: TraceGap,
}

/// A collision with the appearance of its two bodies.
#[derive(Clone, Debug, PartialEq)]
pub struct CollisionSubject {
    /// Title, shown if there are several collisions.
    pub title: String,
    /// The collision as recorded by the solver.
    pub collision: Collision,
    /// The bodies c and b of the collision.
    pub bodies: [Arc<Appearance>; 2],
}

/// Maximum number of bodies in a legend; more are counted.
const MAX_IN_LEGEND: usize = 12;

/// The common legend of all panels: the meaning of the colours or, if bodies are coloured individually and there are
/// several panels, the names of the visible bodies; and the lengths of arrows and other marks.
pub fn legend(runs: &[FigureRun], style: &Style, metrics: &DrawingMetrics) -> Legend {
    let sprites = runs.iter().flat_map(|run| &run.frames).flat_map(|frame| &frame.sprites);
    let visible = sprites.filter(|sprite| is_visible(sprite, &style.look.camera_target));
    let bodies = visible.map(|sprite| (&*sprite.appearance, color::body_color(sprite, style)));
    let mut legend = legend_of_bodies(bodies, runs.len(), style);
    legend.entries.extend(marks(style, metrics));
    legend
}

/// The legend of a figure of collisions: the meaning of the colours, and the parts before them that a recording lacks.
fn legend_of_collisions(style: &Style, metrics: &DrawingMetrics) -> Legend {
    let mut legend = Legend::of_colors(style);
    legend.entries.extend(gap_entries(&style.gaps, style.look.language, metrics.palette.muted));
    legend
}

/// The legend of [`legend`] for bodies in their colours.
fn legend_of_bodies<'a>(
    visible: impl Iterator<Item = (&'a Appearance, Color)>,
    run_count: usize,
    style: &Style,
) -> Legend {
    if style.look.color_by != ColorBy::Body || run_count < 2 {
        return Legend::of_colors(style);
    }
    let mut bodies: BTreeMap<(BodyId, &str), Entry> = BTreeMap::new();
    for (body, color) in visible.filter(|(body, _)| !body.is_wall) {
        bodies.entry((body.id, &body.name)).or_insert_with(|| Entry::new(color, &body.name));
    }
    match bodies.len() {
        ..=MAX_IN_LEGEND => Legend { entries: bodies.into_values().collect() },
        count => Legend { entries: vec![counted_bodies(count, style)] },
    }
}

/// The entry of a legend in place of the names of many bodies: their number.
fn counted_bodies(count: usize, style: &Style) -> Entry {
    let name = quoted(&format!("{count} {}", style.look.language.of("bodies", "corps")));
    Entry { name, colors: Vec::new(), ..Entry::new(Palette::of(style.look.theme).muted, "") }
}

/// Returns true if a body intersects the camera target.
fn is_visible(sprite: &Sprite, camera_target: &CameraTarget) -> bool {
    match camera_target {
        CameraTarget::World | CameraTarget::Follow { .. } => true,
        CameraTarget::Window(area) => sprite.rect.intersection(area).is_some(),
    }
}
