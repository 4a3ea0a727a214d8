use super::{Error, Provenance, Source, draw};
use std::num::NonZero;

/// Draws a picture file again from its provenance and returns the new file, which has the same bytes.
///
/// `recordings` must contain the recordings of the picture, in any order, and may contain others.
///
/// # Errors
/// If the file has no provenance or one of its recordings is missing, or as for [`draw()`].
pub fn redraw(file: &[u8], recordings: &[Source]) -> Result<Vec<u8>, Error> {
    let (format, provenance) = Provenance::read(file)?;
    let sources = find(&provenance, recordings)?;
    let mut redrawn = Vec::new();
    draw(&provenance, &sources, format, NonZero::<usize>::MIN, &mut |_, _| (), &mut redrawn)?;
    Ok(redrawn)
}

/// The recordings of a picture, in the order of its provenance.
fn find(provenance: &Provenance, recordings: &[Source]) -> Result<Vec<Source>, Error> {
    let find = |identity: &String| {
        let found = recordings.iter().filter(|source| source.summary.identity.as_ref() == Some(identity));
        let usable = found.clone().find(|source| source.header.every <= provenance.recorded_every);
        match (usable, found.count()) {
            (Some(source), _) => Ok(source.clone()),
            (None, 0) => {
                Err(Error::CannotRedraw { reason: format!("recording {identity} is not among the given recordings") })
            }
            (None, _) => Err(Error::CannotRedraw {
                reason: format!("recording {identity} stores fewer full states than the one that was drawn"),
            }),
        }
    };
    provenance.recordings.iter().map(find).collect()
}
