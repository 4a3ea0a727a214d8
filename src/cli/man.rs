use super::arguments::{Arguments, ManOptions};
use super::error::CommandError;
use super::{Exit, output::Folder};
use clap::CommandFactory;
use clap_mangen::Man;

/// Writes a page for the program and one for each command.
pub fn run(options: &ManOptions) -> Result<Exit, CommandError> {
    let mut program = Arguments::command();
    program.build();
    let mut folder = Folder::create(&options.folder, options.force)?;
    for command in std::iter::once(&program).chain(program.get_subcommands()) {
        let man = Man::new(command.clone());
        let mut page = Vec::new();
        man.render(&mut page).map_err(CommandError::unwritable(&options.folder))?;
        folder.write(man.get_filename(), &page)?;
    }
    folder.finish()?;
    Ok(Exit::Done)
}
