use crate::physics::{Rect, Vector, larger};
use crate::picture::text::Line;
use crate::picture::{Ink, Shape};

/// A formula whose terms may contain fractions. It is broken into lines before terms.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Formula {
    /// From left to right.
    pub terms: Vec<Term>,
}

/// A part of a formula.
#[derive(Clone, Debug, PartialEq)]
pub struct Term {
    /// The part before the fraction, as markup for [`Line::math`].
    pub text: String,
    /// Numerator and denominator, if there is a fraction.
    pub fraction: Option<[String; 2]>,
}

/// A line of a formula in a font size.
pub struct FormulaLine {
    /// The lines of text, each with the start of its baseline relative to that of the formula, px.
    texts: Vec<(Line, Vector)>,
    /// The bars of fractions, relative to the start of the baseline, px.
    bars: Vec<Rect>,
    /// Its width, px.
    pub width: f64,
}

/// The height of a line with a fraction, in font sizes.
pub const FORMULA_HEIGHT: f64 = 2.7;

/// The baseline below the upper end of a line with a fraction, in font sizes.
pub const FORMULA_BASELINE: f64 = 1.65;

/// The height of the bar of a fraction above the baseline, in font sizes: that of a minus sign.
const BAR: f64 = 0.25;

/// The gap between a bar and the texts above and below it, in font sizes.
const BAR_GAP: f64 = 0.25;

/// The gap between the parts of a formula, in font sizes.
const GAP: f64 = 0.3;

impl Formula {
    /// The lines in a font of `size` px, each at most `width` px wide, unless a single term is wider.
    pub fn lines(&self, size: f64, width: f64) -> Vec<FormulaLine> {
        let (mut lines, mut start) = (Vec::new(), 0);
        for end in 1..=self.terms.len() {
            let is_full = end == self.terms.len() || FormulaLine::new(&self.terms[start..=end], size).width > width;
            if is_full {
                lines.push(FormulaLine::new(&self.terms[start..end], size));
                start = end;
            }
        }
        lines
    }
}

impl FormulaLine {
    fn new(terms: &[Term], size: f64) -> FormulaLine {
        let mut line = FormulaLine { texts: Vec::new(), bars: Vec::new(), width: 0.0 };
        for Term { text, fraction } in terms {
            if line.width > 0.0 {
                line.width += GAP * size;
            }
            let text = Line::math(text, size);
            let (start, width) = (line.width, text.width);
            line.texts.push((text, Vector::new(start, 0.0)));
            line.width += width;
            if let Some([numerator, denominator]) = fraction {
                line.add_fraction(Line::math(numerator, size), Line::math(denominator, size), size);
            }
        }
        line
    }

    /// Adds a fraction at the end of the line, with its bar at the height of a minus sign.
    fn add_fraction(&mut self, numerator: Line, denominator: Line, size: f64) {
        let start = self.width + GAP * size;
        let width = larger(numerator.width, denominator.width);
        let centered = |line: &Line| start + (width - line.width) / 2.0;
        let above = Vector::new(centered(&numerator), -(BAR + BAR_GAP) * size);
        let below = Vector::new(centered(&denominator), (BAR_GAP - BAR) * size + denominator.height());
        self.texts.push((numerator, above));
        self.texts.push((denominator, below));
        self.bars.push(Rect::new(Vector::new(start, -BAR * size), width, 0.0));
        self.width = start + width;
    }

    /// Draws the line with the start of its baseline at `at`, px, with bars `thickness` px thick.
    pub fn draw(self, at: Vector, thickness: f64, ink: Ink, shapes: &mut Vec<Shape>) {
        for bar in self.bars {
            let near = at.add(bar.origin);
            let near = Vector::new(near.x.round(), near.y.round());
            shapes.push(Shape::Rect { rect: Rect::new(near, bar.width().round(), thickness), ink });
        }
        for (line, offset) in self.texts {
            let at = at.add(offset);
            shapes.push(Shape::Text { line, at: Vector::new(at.x.round(), at.y.round()), ink });
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn formula() -> Formula {
        let term = |text: &str, fraction: Option<[&str; 2]>| Term {
            text: text.to_owned(),
            fraction: fraction.map(|parts| parts.map(str::to_owned)),
        };
        Formula {
            terms: vec![term("j =", Some(["a + b", "c"])), term("=", Some(["1", "2 + 3 + 4"])), term("= 5", None)],
        }
    }

    #[test]
    fn lines_are_broken_before_terms_and_keep_all_of_them() {
        let whole = formula().lines(20.0, 1e9);
        assert_eq!(whole.iter().map(|line| line.texts.len()).collect::<Vec<usize>>(), [7]);
        for width in (0..=20).map(|part| f64::from(part) / 20.0 * whole[0].width) {
            let lines = formula().lines(20.0, width);
            let is_narrow = |line: &FormulaLine| line.width <= width || line.bars.len() <= 1;
            assert!(lines.iter().all(is_narrow) && lines.len() <= 3, "{width}");
            assert_eq!(lines.iter().map(|line| line.texts.len()).sum::<usize>(), 7);
        }
        assert_eq!(formula().lines(20.0, 0.0).len(), 3);
    }

    #[test]
    fn a_bar_is_between_its_parts_and_as_wide_as_the_wider_one() {
        let lines = formula().lines(20.0, 0.0);
        for line in &lines[..2] {
            let ([bar], [_, (above, top), (below, bottom)]) = (&line.bars[..], &line.texts[..]) else { panic!() };
            assert_eq!(bar.width(), larger(above.width, below.width));
            assert!(top.y < bar.origin.y && bottom.y - below.height() > bar.origin.y, "{top:?} {bar:?} {bottom:?}");
            let [high, low] = [FORMULA_BASELINE, FORMULA_HEIGHT - FORMULA_BASELINE].map(|part| part * 20.0);
            assert!(top.y - above.height() > -high && bottom.y < low, "{top:?} {bottom:?}");
        }
    }
}
