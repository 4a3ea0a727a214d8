//! Completions and manual pages, generated from the definitions of the arguments.

use super::arguments::{CompletionsOptions, ManOptions};
use super::error::CommandError;
use super::output;
use super::output_file::{OutputFolder, Overwrite};
use super::{Arguments, Exit};
use crate::picture::SOFTWARE;
use clap::CommandFactory;
use clap_mangen::Man;

/// Writes the completions for a shell to standard output.
pub fn completions(options: &CompletionsOptions) -> Result<Exit, CommandError> {
    let mut script = Vec::new();
    clap_complete::generate(options.shell, &mut Arguments::command(), "rebond", &mut script);
    output::print(&String::from_utf8_lossy(&script))?;
    Ok(Exit::Done)
}

/// Writes one manual page for the program and one for each command.
pub fn man(options: &ManOptions) -> Result<Exit, CommandError> {
    let mut program = Arguments::command().disable_help_subcommand(true);
    program.build();
    let mut folder = OutputFolder::create(&options.folder, Overwrite::from_force(options.force), &[])?;
    for command in std::iter::once(&program).chain(program.get_subcommands()) {
        let man = Man::new(command.clone()).source(SOFTWARE);
        let mut page = Vec::new();
        man.render(&mut page).map_err(CommandError::unwritable(&options.folder))?;
        folder.write(man.get_filename(), keep_line_breaks(&String::from_utf8_lossy(&page)).as_bytes())?;
    }
    folder.finish()?;
    Ok(Exit::Done)
}

/// Keeps the line breaks of notes and examples, as in `--help`; by default a manual page joins lines to paragraphs.
fn keep_line_breaks(page: &str) -> String {
    let Some((before, notes)) = page.split_once(".SH EXTRA\n") else { return page.to_owned() };
    let (notes, after) = notes.split_at(notes.find("\n.SH").map_or(notes.len(), |end| end + 1));
    format!("{before}.SH NOTES\n.nf\n{notes}\n.fi\n{after}")
}
