use super::Picture;

/// What of a picture differs from the one before it: the rectangle that holds all of it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Patch {
    /// Its upper-left corner in the picture, px.
    pub at: [u32; 2],
    /// Width and height, px.
    pub size: [u32; 2],
    /// Row by row; transparent where a pixel stays as it was.
    pub pixels: Vec<[u8; 4]>,
}

/// No pixel of a picture has this value: theirs are opaque.
pub const UNCHANGED: [u8; 4] = [0; 4];

impl Patch {
    /// All of `after`, or what of it differs from `before`; both have the same size.
    pub fn between(before: Option<&Picture>, after: &Picture) -> Patch {
        let Some(before) = before else {
            return Patch { at: [0, 0], size: after.size, pixels: after.pixels.clone() };
        };
        let Some(area) = changed_area(before, after) else { return Patch::nothing() };
        let width = after.size[0] as usize;
        let mut pixels = Vec::with_capacity((area.right - area.left) * (area.bottom - area.top));
        for row in area.top..area.bottom {
            let span = row * width + area.left..row * width + area.right;
            let both = before.pixels[span.clone()].iter().zip(&after.pixels[span]);
            pixels.extend(both.map(|(before, after)| if before == after { UNCHANGED } else { *after }));
        }
        let at = [area.left, area.top].map(|at| at as u32);
        let size = [area.right - area.left, area.bottom - area.top].map(|side| side as u32);
        Patch { at, size, pixels }
    }

    /// One pixel that leaves what was: every picture of an animation needs an image.
    fn nothing() -> Patch {
        Patch { at: [0, 0], size: [1, 1], pixels: vec![UNCHANGED] }
    }
}

/// Columns `left` to before `right`, rows `top` to before `bottom`.
struct Area {
    left: usize,
    top: usize,
    right: usize,
    bottom: usize,
}

/// The smallest area outside of which the two agree.
fn changed_area(before: &Picture, after: &Picture) -> Option<Area> {
    let mut changed: Option<Area> = None;
    for (row, (a, b)) in before.rows().zip(after.rows()).enumerate() {
        let Some([left, right]) = changed_columns(a, b) else { continue };
        let above = changed.unwrap_or(Area { left, top: row, right, bottom: row });
        changed = Some(Area { left: above.left.min(left), right: above.right.max(right), bottom: row + 1, ..above });
    }
    changed
}

/// The first column in which two rows differ, and the one after the last.
fn changed_columns(a: &[[u8; 4]], b: &[[u8; 4]]) -> Option<[usize; 2]> {
    if a == b {
        return None;
    }
    let first = a.iter().zip(b).position(|(a, b)| a != b)?;
    let last = a.iter().zip(b).rposition(|(a, b)| a != b)?;
    Some([first, last + 1])
}
