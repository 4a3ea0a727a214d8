use super::{Error, Evidence, Source, draw};
use std::num::NonZero;

/// Draws a picture once more from the evidence in its file and the recordings it is of, which may
/// be among others and in any order; it comes out byte for byte.
///
/// # Errors
/// When the file has no evidence, one of the recordings is not there, or as for [`draw()`].
pub fn again(file: &[u8], recordings: &[Source]) -> Result<Vec<u8>, Error> {
    let (format, evidence) = Evidence::read(file)?;
    let sources = find(&evidence, recordings)?;
    let mut drawn = Vec::new();
    draw(&evidence, &sources, format, NonZero::<usize>::MIN, &mut |_, _| (), &mut drawn)?;
    Ok(drawn)
}

/// The recordings a picture is of, in its order.
fn find(evidence: &Evidence, recordings: &[Source]) -> Result<Vec<Source>, Error> {
    let named = |identity: &String| {
        let found = recordings.iter().filter(|source| source.survey.identity.as_ref() == Some(identity));
        let fitting = found.clone().find(|source| source.header.every <= evidence.recorded_every);
        match (fitting, found.count()) {
            (Some(source), _) => Ok(source.clone()),
            (None, 0) => Err(Error::NotAgain { what: format!("recording {identity} is not among those given") }),
            (None, _) => Err(Error::NotAgain {
                what: format!("recording {identity} is thinned more than the one the picture was drawn of"),
            }),
        }
    };
    evidence.recordings.iter().map(named).collect()
}
