use super::{Exit, arguments::InfoOptions, error::CommandError};
/// x
pub fn run(_: &InfoOptions) -> Result<Exit, CommandError> {
    todo!()
}
