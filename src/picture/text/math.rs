use super::font::{Font, UNITS_PER_EM};
use crate::physics::larger;
use crate::picture::text::{Glyph, Line};
use std::iter::Peekable;
use std::str::Chars;

/// Font size of sub- and superscripts relative to their base.
const SCRIPT_SIZE: f64 = 0.72;

/// Distance of a subscript below the baseline, em.
const SUBSCRIPT_DROP: f64 = 0.2;

/// Distance of a superscript above the baseline, em.
const SUPERSCRIPT_RISE: f64 = 0.36;

/// Height of base letters up to which accents are not raised, 1/1000 em.
const LOW_LETTER_HEIGHT: f64 = 490.0;

impl Line {
    /// Lays out a formula with a font size of `size` px, in markup similar to LaTeX.
    ///
    /// Single letters are italic; words, numbers and text between `"` are upright. `_` and `^` set the next character
    /// or `{group}` as a sub- or superscript; consecutive ones are placed above each other. A combining arrow or hat
    /// (`v⃗`, `n̂`) is an accent on the letter before it, `′` is a superscript, and `-` is a minus sign.
    pub fn math(markup: &str, size: f64) -> Line {
        let mut typesetter =
            Typesetter { text: String::new(), glyphs: Vec::new(), x: 0.0, rightmost: 0.0, scripts_at: None };
        typesetter.typeset(&mut markup.chars().peekable(), Level { size, y: 0.0 });
        let Typesetter { text, glyphs, rightmost: width, .. } = typesetter;
        Line { text, glyphs, width, size }
    }
}

/// Lays out running text, such as a caption, in lines of at most `width` px. Line breaks of the text are kept.
///
/// Text between `$` is a formula in the markup of [`Line::math`]. So is, without `$`, a word with a sub- or superscript
/// after a single letter or a number (`v_c`, `10^{−7}`), with an accent (`v⃗`) or a Greek capital (`ΔE`), and a single
/// letter next to a relation (`e = 0.8`). Everything else is upright text.
pub fn wrapped(text: &str, size: f64, width: f64) -> Vec<Line> {
    let mut lines = Vec::new();
    for paragraph in text.lines() {
        let pieces: Vec<&str> = pieces(paragraph).into_iter().flat_map(|piece| broken(piece, size, width)).collect();
        let mut line: Option<Line> = None;
        for (at, piece) in pieces.iter().enumerate() {
            let neighbours = [at.checked_sub(1), Some(at + 1)].map(|at| at.and_then(|at| pieces.get(at)).copied());
            let word = set_piece(piece, neighbours, size);
            line = Some(match line {
                None => word,
                Some(line) => {
                    let joined = line.followed_by(&word);
                    if joined.width <= width {
                        joined
                    } else {
                        lines.push(line);
                        word
                    }
                }
            });
        }
        lines.push(line.unwrap_or_else(|| Line::plain("", size)));
    }
    lines
}

/// The words and formulas of a paragraph. A formula keeps its `$` and its blanks.
fn pieces(paragraph: &str) -> Vec<&str> {
    let (mut pieces, mut rest) = (Vec::new(), paragraph.trim());
    while !rest.is_empty() {
        let formula_end = rest.strip_prefix('$').and_then(|rest| rest.find('$')).map(|end| end + 2);
        let from = formula_end.unwrap_or(0);
        let end = rest[from..].find(char::is_whitespace).map_or(rest.len(), |end| from + end);
        pieces.push(&rest[..end]);
        rest = rest[end..].trim_start();
    }
    pieces
}

/// Breaks a word that is wider than a line between its characters.
fn broken(word: &str, size: f64, width: f64) -> Vec<&str> {
    if word.starts_with('$') {
        return vec![word];
    }
    let (mut parts, mut rest) = (Vec::new(), word);
    while !rest.is_empty() {
        let ends: Vec<usize> = rest.char_indices().map(|(at, character)| at + character.len_utf8()).collect();
        // A longer text is not narrower: kerning is less than the width of a glyph.
        let fits = |count: usize| Line::plain(&rest[..ends[count - 1]], size).width <= width;
        // A line has one character at least. Doubling keeps the texts that are laid out about as long as a line.
        let (mut most, mut count) = (1, 2);
        while count <= ends.len() && fits(count) {
            (most, count) = (count, 2 * count);
        }
        let mut too_many = count.min(ends.len() + 1);
        while too_many - most > 1 {
            let middle = (most + too_many) / 2;
            *(if fits(middle) { &mut most } else { &mut too_many }) = middle;
        }
        let (part, after) = rest.split_at(ends[most - 1]);
        parts.push(part);
        rest = after;
    }
    parts
}

/// Lays out a word or formula. Its neighbours decide if a single letter is a variable.
fn set_piece(piece: &str, neighbours: [Option<&str>; 2], size: f64) -> Line {
    let is_relation = |word: &str| matches!(word, "=" | "≠" | "<" | ">" | "≤" | "≥" | "≈" | "→" | "∝" | "×" | "·");
    let mut letters = piece.chars();
    let is_letter = letters.next().is_some_and(char::is_alphabetic) && letters.next().is_none();
    if let Some((formula, rest)) = piece.strip_prefix('$').and_then(|rest| rest.split_once('$')) {
        let (formula, rest) = (Line::math(formula, size), Line::plain(rest, size));
        return formula.joined(&rest);
    }
    let is_variable = is_letter && neighbours.into_iter().flatten().any(is_relation);
    if is_variable || is_formula(piece) { Line::math(piece, size) } else { Line::plain(&true_minus(piece), size) }
}

/// Returns true for a word that is typeset as a formula even without `$`.
fn is_formula(word: &str) -> bool {
    let characters: Vec<char> = word.chars().collect();
    let is_base = |at: usize| {
        let run = characters[..at].iter().rev().take_while(|character| character.is_alphanumeric()).count();
        let base = &characters[at - run..at];
        match base {
            [] => at > 0 && matches!(characters[at - 1], ')' | '}' | '\u{20d7}' | '\u{302}' | '′'),
            [_] => true,
            digits => digits.iter().all(char::is_ascii_digit),
        }
    };
    let has_script = |at: usize| at + 1 < characters.len() && is_base(at);
    let is_relation = |at: usize| at == 1 && characters[0].is_alphabetic() && characters.len() > 2;
    (0..characters.len()).any(|at| match characters[at] {
        '_' | '^' => has_script(at),
        '\u{20d7}' | '\u{302}' => true,
        'Δ' | 'Σ' | 'Ω' => characters.len() > 1,
        '=' | '<' | '>' | '≤' | '≥' | '≈' => is_relation(at),
        _ => false,
    })
}

/// Replaces the hyphen before a number by a minus sign.
fn true_minus(word: &str) -> String {
    match word.strip_prefix('-') {
        Some(number) if number.starts_with(|first: char| first.is_ascii_digit()) => format!("−{number}"),
        Some(_) | None => word.to_owned(),
    }
}

/// Font size and position of the baseline, px.
#[derive(Clone, Copy)]
struct Level {
    size: f64,
    y: f64,
}

impl Level {
    fn script(self, rise: f64) -> Level {
        Level { size: self.size * SCRIPT_SIZE, y: self.y - rise * self.size }
    }
}

struct Typesetter {
    text: String,
    glyphs: Vec<Glyph>,
    /// Position of the next glyph, px.
    x: f64,
    /// Right end of all glyphs so far, px.
    rightmost: f64,
    /// Start of the scripts of the last atom, as long as another script of it may follow.
    scripts_at: Option<f64>,
}

impl Typesetter {
    /// Typesets characters up to the end or a closing brace.
    fn typeset(&mut self, markup: &mut Peekable<Chars>, level: Level) {
        while let Some(character) = markup.next() {
            match character {
                '}' => return,
                '{' => self.typeset(markup, level),
                '"' => self.set_quoted(markup, level),
                '_' => {
                    self.text.push('_');
                    self.set_script(markup, level.script(-SUBSCRIPT_DROP));
                }
                '^' => {
                    self.text.push('^');
                    self.set_script(markup, level.script(SUPERSCRIPT_RISE));
                }
                '′' => self.set_prime(level),
                '\u{20d7}' | '\u{302}' => self.set_accent(character, level),
                letter if is_in_words(letter) => self.set_letters(letter, markup, level),
                '-' => self.set_upright("−", level),
                other => self.set_upright(other.encode_utf8(&mut [0; 4]), level),
            }
        }
    }

    fn set_quoted(&mut self, markup: &mut Peekable<Chars>, level: Level) {
        let text: String = markup.by_ref().take_while(|&character| character != '"').collect();
        self.set_upright(&text, level);
    }

    /// Typesets one letter as a variable and several as a word.
    fn set_letters(&mut self, first: char, markup: &mut Peekable<Chars>, level: Level) {
        let mut word = String::from(first);
        while let Some(letter) = markup.next_if(|&next| is_in_words(next)) {
            word.push(letter);
        }
        let text = if word.chars().count() == 1 { italic(first).to_string() } else { word };
        self.set_upright(&text, level);
    }

    fn set_upright(&mut self, text: &str, level: Level) {
        let line = Line::plain(text, level.size);
        self.text.extend(text.chars().map(plain_letter));
        let shifted = |glyph: &Glyph| Glyph { x: self.x + glyph.x, y: level.y, ..*glyph };
        let glyphs: Vec<Glyph> = line.glyphs.iter().map(shifted).collect();
        self.glyphs.extend(glyphs);
        self.advance(line.width);
        self.scripts_at = None;
    }

    fn advance(&mut self, width: f64) {
        self.x += width;
        self.rightmost = larger(self.x, self.rightmost);
    }

    fn set_script(&mut self, markup: &mut Peekable<Chars>, level: Level) {
        let start = self.scripts_at.unwrap_or(self.x);
        self.x = start;
        match markup.next() {
            Some('{') => self.typeset(markup, level),
            Some(letter) => self.set_upright(&italic(letter).to_string(), level),
            None => {}
        }
        self.end_script(start);
    }

    fn set_prime(&mut self, level: Level) {
        let start = self.scripts_at.unwrap_or(self.x);
        self.x = start;
        self.set_upright("′", level);
        self.end_script(start);
    }

    /// Continues to the right of all scripts, unless another script of the same atom follows.
    fn end_script(&mut self, start: f64) {
        self.x = self.rightmost;
        self.scripts_at = Some(start);
    }

    /// Typesets an accent above the middle of the last glyph.
    fn set_accent(&mut self, accent: char, level: Level) {
        let font = Font::embedded();
        let Some(base) = self.glyphs.last().copied() else { return };
        let (base_bounds, id) = (font.bounds(base.id), font.glyph(accent));
        let unit = level.size / UNITS_PER_EM;
        let accent_bounds = font.bounds(id);
        let raise = if base_bounds.top > LOW_LETTER_HEIGHT { base_bounds.top - LOW_LETTER_HEIGHT } else { 0.0 };
        // Italic letters lean to the right in proportion to their height.
        let lean = 0.1 * base_bounds.top;
        let x = base.x
            + ((base_bounds.left + base_bounds.right - accent_bounds.left - accent_bounds.right) / 2.0 + lean) * unit;
        self.text.push(accent);
        self.glyphs.push(Glyph { id, character: accent, x, y: level.y - raise * unit, size: level.size });
    }
}

/// Returns true for letters that can be part of a word. Greek capitals are symbols: Δt is a Δ and a variable.
fn is_in_words(character: char) -> bool {
    character.is_alphabetic() && !('Α'..='Ω').contains(&character)
}

/// The mathematical italic of a letter; Greek capitals stay upright.
fn italic(letter: char) -> char {
    let shifted = |first: char, to: u32| char::from_u32(letter as u32 - first as u32 + to);
    let italic = match letter {
        'h' => Some('ℎ'),
        'A'..='Z' => shifted('A', 0x1d434),
        'a'..='z' => shifted('a', 0x1d44e),
        'α'..='ω' => shifted('α', 0x1d6fc),
        _ => None,
    };
    italic.unwrap_or(letter)
}

/// The plain letter of a mathematical italic letter; any other character itself.
pub fn plain_letter(character: char) -> char {
    let shifted = |first: u32, to: char| char::from_u32(character as u32 - first + to as u32);
    let plain = match character as u32 {
        0x210e => Some('h'),
        0x1d434..=0x1d44d => shifted(0x1d434, 'A'),
        0x1d44e..=0x1d467 => shifted(0x1d44e, 'a'),
        0x1d6fc..=0x1d714 => shifted(0x1d6fc, 'α'),
        _ => None,
    };
    plain.unwrap_or(character)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The character, position in 1/1000 em (right, down) and size of each glyph.
    fn laid_out(markup: &str) -> Vec<(char, i32, i32, i32)> {
        let font = Font::embedded();
        let characters = "𝑣𝑐𝑏𝑁𝑡𝑚𝛼ℎ⃗̂′=−0123456789 sm/abchevyΔ";
        let name = |id| characters.chars().find(|&character| font.glyph(character) == id).unwrap();
        let rounded = |length: f64| length.round() as i32;
        let line = Line::math(markup, 1000.0);
        line.glyphs.iter().map(|g| (name(g.id), rounded(g.x), rounded(g.y), rounded(g.size))).collect()
    }

    #[test]
    fn letters_are_italic_and_words_upright() {
        let characters = |markup| laid_out(markup).iter().map(|glyph| glyph.0).collect::<String>();
        assert_eq!(characters("v=3 \"m/s\""), "𝑣=3 m/s");
        assert_eq!(characters("Δt-h"), "Δ𝑡−ℎ");
        assert_eq!(characters("α heavy"), "𝛼 heavy");
    }

    #[test]
    fn sub_and_superscript_begin_at_the_same_position() {
        assert_eq!(laid_out("v_c^2"), [('𝑣', 0, 0, 1000), ('𝑐', 504, 200, 720), ('2', 504, -360, 720)]);
        assert_eq!(laid_out("v′_c"), [('𝑣', 0, 0, 1000), ('′', 504, 0, 1000), ('𝑐', 504, 200, 720)]);
    }

    #[test]
    fn text_after_scripts_is_right_of_them() {
        let line = laid_out("N_{cb}t");
        assert_eq!(line.iter().map(|glyph| glyph.0).collect::<String>(), "𝑁cb𝑡");
        assert!(line[3].1 > line[2].1 && line[3].2 == 0);
    }

    #[test]
    fn accents_do_not_advance_the_line() {
        let line = laid_out("v⃗_b");
        let [letter, accent, script] = line[..] else { panic!("{line:?}") };
        assert_eq!((letter, script), (('𝑣', 0, 0, 1000), ('𝑏', 504, 200, 720)));
        assert_eq!((accent.0, accent.2), ('⃗', 0));
        let high = laid_out("N⃗")[1];
        assert!(high.2 < 0, "the accent is raised above a capital");
    }

    #[test]
    fn running_text_is_wrapped_and_keeps_its_line_breaks() {
        let texts =
            |text, width| -> Vec<String> { wrapped(text, 10.0, width).into_iter().map(|line| line.text).collect() };
        assert_eq!(texts("one two\nthree", 1000.0), ["one two", "three"]);
        assert_eq!(texts("one two three", Line::plain("one two", 10.0).width + 1.0), ["one two", "three"]);
        assert_eq!(texts("one\n\ntwo", 1000.0), ["one", "", "two"]);
        assert_eq!(texts("aaaaaa", 3.0 * Line::plain("a", 10.0).width + 0.1), ["aaa", "aaa"]);
        assert_eq!(texts("ab", 1.0), ["a", "b"]);
        for line in wrapped(&"a long caption of many words ".repeat(20), 10.0, 200.0) {
            assert!(line.width <= 200.0, "{line:?}");
        }
    }

    #[test]
    fn running_text_contains_formulas() {
        let font = Font::embedded();
        let glyphs =
            |text: &str| -> Vec<u16> { wrapped(text, 10.0, 1e6)[0].glyphs.iter().map(|glyph| glyph.id).collect() };
        let plain = |text: &str| -> Vec<u16> { text.chars().map(|character| font.glyph(character)).collect() };
        assert_eq!(glyphs("a box with e = 0.8"), plain("a box with 𝑒 = 0.8"));
        assert_eq!(glyphs("v_c of run_1.mcap"), plain("𝑣𝑐 of run_1.mcap"));
        assert_eq!(glyphs("$a b$, 10^{-7} and ΔE"), plain("𝑎 𝑏, 10−7 and Δ𝐸"));
        assert_eq!(glyphs("x=-3 or -3 or well-known \"so\""), plain("𝑥=−3 or −3 or well-known \"so\""));
        assert_eq!(glyphs("5 $"), plain("5 $"));
    }

    #[test]
    fn the_text_of_a_line_has_plain_letters_and_marks_scripts() {
        let text = |markup: &str| Line::math(markup, 10.0).text;
        assert_eq!(text("v⃗′_c = 2·10^{-7} \"m/s {x}\""), "v⃗′_c = 2·10^−7 m/s {x}");
        for letter in ('A'..='Z').chain('a'..='z').chain('α'..='ω') {
            assert_eq!(plain_letter(italic(letter)), letter);
        }
    }

    #[test]
    fn unfinished_markup_is_typeset_as_far_as_possible() {
        for markup in ["", "_", "v^", "{", "}", "\"m", "\u{20d7}", "v_{c", "′"] {
            assert!(Line::math(markup, 20.0).width >= 0.0);
        }
    }
}
