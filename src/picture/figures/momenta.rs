use super::pair::{ARROW_WIDTH, Pair, ROLES};
use super::panels::Panels;
use crate::physics::{Rect, Vector, larger, smaller};
use crate::picture::layers::arrows::{LabeledArrow, key_entries};
use crate::picture::layers::footer::{Alignment, Legend};
use crate::picture::layers::labels::{Halo, LabelPlacer};
use crate::picture::layers::lanes::{Lanes, separate};
use crate::picture::number::Unit;
use crate::picture::text::Line;
use crate::picture::{Arrow, Color, DrawingMetrics, Language, Shape};

/// The momenta of a collision head to tail: their sum is the same before and after.
pub struct Momenta {
    /// The momenta before and after, kg·m/s, in the order of the bodies. If the two push other bodies, the momentum
    /// that goes to these is the last one.
    chains: [Vec<Momentum>; 2],
    /// Their sum before the collision, kg·m/s.
    total: Vector,
}

/// A momentum as an arrow.
struct Momentum {
    /// kg·m/s.
    vector: Vector,
    color: Color,
    /// As markup.
    label: String,
}

/// The symbol of the momentum that goes to the bodies that the two push.
pub const TO_OTHERS: &str = "Δp⃗";

impl Momenta {
    /// The momenta of the two bodies. An infinite mass has none; after the collision, the momentum that it has received
    /// takes its place.
    pub fn new(pair: &Pair, metrics: &DrawingMetrics) -> Momenta {
        let collision = &pair.collision;
        let momentum = |at: usize, velocities: &[Vector; 2], symbol: &str| Momentum {
            vector: velocities[at].mult(pair.masses[at]),
            color: pair.colors[at],
            label: format!("{symbol}_{}", ROLES[at]),
        };
        let received = |at: usize| Momentum {
            vector: collision.normal.mult([1.0, -1.0][at] * collision.impulse),
            color: pair.colors[at],
            label: ["j n̂", "-j n̂"][at].to_owned(),
        };
        let has_momentum = |at: usize| pair.masses[at].is_finite();
        let before = [0, 1].into_iter().filter(|at| has_momentum(*at)).map(|at| momentum(at, &collision.before, "p⃗"));
        let after = [0, 1].map(|at| if has_momentum(at) { momentum(at, &collision.after, "p⃗′") } else { received(at) });
        let sum =
            |chain: &[Momentum]| chain.iter().fold(Vector::ZERO, |sum: Vector, momentum| sum.add(momentum.vector));
        let (before, mut after) = (before.collect::<Vec<Momentum>>(), Vec::from(after));
        let total = sum(&before);
        if pair.pushes_others() {
            let (vector, color) = (total.sub(sum(&after)), metrics.palette.muted);
            after.push(Momentum { vector, color, label: TO_OTHERS.to_owned() });
        }
        Momenta { chains: [before, after], total }
    }

    /// The ends of the arrows of a chain that begins at the origin, kg·m/s.
    fn ends(chain: &[Momentum]) -> impl Iterator<Item = [Vector; 2]> {
        chain.iter().scan(Vector::ZERO, |end, momentum| {
            let start = *end;
            *end = start.add(momentum.vector);
            Some([start, *end])
        })
    }

    /// The area that a chain takes, kg·m/s.
    fn bounds(chain: &[Momentum]) -> Rect {
        let points = Momenta::ends(chain).flatten();
        points.fold(Rect::new(Vector::ZERO, 0.0, 0.0), |all, at| all.union(&Rect::new(at, 0.0, 0.0)))
    }

    /// Draws the momenta before and after in two parts of a panel, one above the other or side by side, whichever makes
    /// them larger; below them, the key of the arrows.
    pub fn draw(&self, panel: &Rect, language: Language, panels: &mut Panels) {
        let metrics = panels.metrics;
        let mut content = Panels::of_cell(panel, &metrics);
        let strip = content.split_bottom(1.4 * metrics.font_size);
        let [stacked, beside] = [1, 2].map(|columns| content.grid(2, columns));
        let areas = if self.scale(&stacked[0], &metrics) > self.scale(&beside[0], &metrics) { stacked } else { beside };
        let scale = self.scale(&areas[0], &metrics);
        let titles = [language.of("before", "avant"), language.of("after", "après")];
        for ((chain, area), title) in self.chains.iter().zip(&areas).zip(titles) {
            self.draw_chain(chain, area, title, scale, panels);
        }
        let longest = self.longest();
        if scale.is_finite() && scale > 0.0 && longest > 0.0 {
            let top = smaller(longest, 0.35 * panel.width() / scale);
            let width = ARROW_WIDTH * metrics.line_width;
            let [key, _] = key_entries(scale, top, Unit::MOMENTUM, width, metrics.palette.ink, language);
            Legend { entries: vec![key] }.draw(&strip, Alignment::Center, &metrics, &mut panels.shapes);
        }
    }

    /// The norm of the longest momentum, kg·m/s.
    fn longest(&self) -> f64 {
        let all = self.chains.iter().flatten().map(|momentum| momentum.vector.norm());
        all.filter(|norm| norm.is_finite()).fold(0.0, larger)
    }

    /// Pixels per kg·m/s with which both chains fit into an area; 0 if they have no extent.
    fn scale(&self, area: &Rect, metrics: &DrawingMetrics) -> f64 {
        let inner = inner_area(area, metrics);
        let along = |length: f64, extent: f64| if extent > 0.0 { larger(length, 1.0) / extent } else { f64::INFINITY };
        let scales = self.chains.iter().map(|chain| {
            let bounds = Momenta::bounds(chain);
            smaller(along(inner.width(), bounds.width()), along(inner.height(), bounds.height()))
        });
        let scale = scales.fold(f64::INFINITY, smaller);
        if scale.is_finite() { scale } else { 0.0 }
    }

    /// The title of a chain, with the sum of the momenta if that is zero, so that no arrow shows it, and there is
    /// space.
    fn title(&self, title: &str, area: &Rect, metrics: &DrawingMetrics) -> Line {
        let [short, long] =
            [format!("\"{title}\""), format!("\"{title}\": P⃗ = 0")].map(|title| Line::math(&title, metrics.text(0.8)));
        let is_zero = self.total.norm() <= ROUNDING * self.longest();
        if is_zero && long.width <= area.width() { long } else { short }
    }

    /// Draws a chain in the colours of the bodies, and the sum of all momenta.
    fn draw_chain(&self, chain: &[Momentum], area: &Rect, title: &str, scale: f64, panels: &mut Panels) {
        let metrics = panels.metrics;
        let mut placer = LabelPlacer::within(*area);
        let title = self.title(title, area, &metrics);
        let at = Vector::new(area.origin.x.round(), (area.origin.y + metrics.font_size).round());
        placer.reserve(Rect::new(at.sub(Vector::new(0.0, title.height())), title.width, title.height()));
        panels.shapes.push(Shape::Text { line: title, at, ink: metrics.palette.muted.into() });
        let origin = inner_area(area, &metrics).center().sub(Momenta::bounds(chain).center().mult(scale));
        let (width, longest) = (ARROW_WIDTH * metrics.line_width, self.longest() * scale);
        let mut arrows: Vec<LabeledArrow> = Vec::new();
        let total = Momentum { vector: self.total, color: metrics.palette.ink, label: "P⃗".to_owned() };
        let from_origin = [([Vector::ZERO, self.total], &total)];
        for ([start, _], momentum) in Momenta::ends(chain).zip(chain).chain(from_origin) {
            let from = origin.add(start.mult(scale));
            let color = metrics.palette.line(momentum.color);
            let arrow = Arrow::of_vector(from, momentum.vector.mult(scale), width, color, longest);
            let label = momentum.label.clone();
            arrows.extend(arrow.map(|arrow| LabeledArrow { arrow, key: None, label }));
        }
        separate(&mut arrows, &Lanes::default());
        for LabeledArrow { arrow, .. } in &arrows {
            placer.avoid_line(arrow.from, arrow.to, 3.0);
            arrow.draw(&metrics, &mut panels.shapes);
        }
        for LabeledArrow { arrow, label, .. } in &arrows {
            let vector = arrow.to.sub(arrow.from);
            let anchors = [0.5, 0.35, 0.65, 0.2, 0.8].map(|part| arrow.from.add(vector.mult(part)));
            let beside = Vector::new(vector.y, -vector.x);
            let line = Line::math(label, metrics.font_size);
            let label = placer.place_along(line, &anchors, beside, 0.6 * metrics.font_size, arrow.color);
            label.into_iter().for_each(|label| label.draw_over(&[], Halo::Around, &metrics, &mut panels.shapes));
        }
    }
}

/// A sum up to this part of the longest momentum is a rounding error of zero.
const ROUNDING: f64 = 1e-9;

/// The part of an area for arrows: below its title, with space for labels around it.
fn inner_area(area: &Rect, metrics: &DrawingMetrics) -> Rect {
    let (font_size, near) = (metrics.font_size, area.origin);
    let below = Rect::new(near.add(Vector::new(0.0, font_size)), area.width(), area.height() - font_size);
    let margin = smaller(1.3 * font_size, 0.3 * smaller(below.width(), below.height()));
    below.inset(larger(margin, 0.0))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::physics::{Axis, Collision, Spawn};
    use crate::picture::figures::CollisionSubject;
    use crate::picture::{Appearance, Style};
    use crate::recording::BodyInfo;
    use std::sync::Arc;

    /// The momenta of a box of 2 kg that falls with 6 m/s on one of 1 kg and rebounds with e = 0.5, if the lower box
    /// has this velocity afterwards, m/s.
    fn momenta(lower_after: f64) -> Momenta {
        let down = |speed: f64| Vector::new(0.0, speed);
        let rects = [0.0, 1.0].map(|y| Rect::new(down(y), 1.0, 1.0));
        let upper_after = lower_after - 3.0;
        let collision = Collision {
            bodies: [0, 1],
            axis: Axis::Y,
            rects,
            impulse: 2.0 * (6.0 - upper_after),
            step: 0,
            time: 0.0,
            instant: 0.0,
            normal: down(-1.0),
            penetration: Vector::ZERO,
            shares: [0.0; 2],
            restitution: 0.5,
            normal_velocity: [-6.0, 3.0],
            before: [down(6.0), Vector::ZERO],
            after: [down(upper_after), down(lower_after)],
        };
        let body = |id: u32| {
            let spawn = Spawn::new(id.to_string(), rects[id as usize], [2.0, 1.0][id as usize]);
            Arc::new(Appearance::new(&BodyInfo::new(id, spawn), None))
        };
        let subject = CollisionSubject { title: String::new(), collision, bodies: [body(0), body(1)] };
        let style = Style::default();
        let metrics = DrawingMetrics::new(style.look.theme, style.look.language, style.look.size);
        Momenta::new(&Pair::new(&subject, 0.0, &style), &metrics)
    }

    #[test]
    fn the_momentum_that_goes_to_other_bodies_completes_the_sum() {
        // Alone, and on a floor that holds the lower box.
        for (lower_after, labels, to_others) in [(6.0, 2, 0.0), (0.0, 3, 18.0)] {
            let Momenta { chains: [_, after], total } = momenta(lower_after);
            assert_eq!((after.len(), total), (labels, Vector::new(0.0, 12.0)));
            let sum = after.iter().fold(Vector::ZERO, |sum: Vector, momentum| sum.add(momentum.vector));
            assert_eq!(sum, total);
            let others = after.iter().find(|momentum| momentum.label == TO_OTHERS);
            assert_eq!(others.map_or(0.0, |momentum| momentum.vector.y), to_others);
        }
    }
}
