//! A temporary folder in which rebond runs, and the digests of everything that it writes.

use super::content;
use std::{
    collections::BTreeSet,
    fmt::Write,
    fs,
    path::{Path, PathBuf},
    process::Command,
};
use tempfile::TempDir;
use xxhash_rust::xxh3::xxh3_128;

/// The command that runs rebond: the program itself, or an emulator with the program as argument.
pub struct Program {
    /// The file to run.
    pub file: PathBuf,
    /// The arguments before those of rebond.
    pub arguments: Vec<String>,
}

/// A folder to run the program in, with the lines of digests so far.
pub struct Workspace {
    program: Program,
    folder: TempDir,
    known_files: BTreeSet<PathBuf>,
    /// One line per artefact: size (bytes), digest of the decoded content, digest of the file, name.
    pub lines: String,
}

impl Workspace {
    /// Creates an empty folder.
    pub fn new(program: &Program) -> Workspace {
        // The program runs in another folder, so a relative path would be wrong.
        let file = if program.file.components().count() > 1 {
            program.file.canonicalize().expect("the program exists")
        } else {
            program.file.clone()
        };
        let program = Program { file, arguments: program.arguments.clone() };
        let folder = TempDir::new().expect("a temporary folder");
        Workspace { program, folder, known_files: BTreeSet::new(), lines: String::new() }
    }

    /// Copies a file from the folder `recordings`, replacing a file of that name.
    pub fn copy_in(&mut self, name: &str) {
        self.write(name, &fs::read(recordings().join(name)).unwrap_or_else(|error| panic!("{name}: {error}")));
    }

    /// Writes a file, which is not an artefact.
    pub fn write(&mut self, name: &str, bytes: &[u8]) {
        let path = self.folder.path().join(name);
        fs::write(&path, bytes).unwrap_or_else(|error| panic!("{name}: {error}"));
        self.known_files.insert(path);
    }

    /// Reads a file.
    pub fn read(&self, name: &str) -> Vec<u8> {
        fs::read(self.folder.path().join(name)).unwrap_or_else(|error| panic!("{name}: {error}"))
    }

    /// Runs rebond, which must exit with 0.
    pub fn run(&mut self, line: &str) {
        self.run_with_code(0, line);
    }

    /// Runs rebond, which must exit with `code`, and adds the digests of its standard output and of new files.
    pub fn run_with_code(&mut self, code: i32, line: &str) {
        let Program { file, arguments } = &self.program;
        let output = Command::new(file)
            .args(arguments)
            .args(line.split_whitespace())
            .current_dir(self.folder.path())
            .env("NO_COLOR", "1")
            .output()
            .unwrap_or_else(|error| panic!("{}: {error}", file.display()));
        let errors = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(code), "rebond {line}: {errors}");
        if !output.stdout.is_empty() {
            self.add_line(&format!("rebond {line}"), Path::new(""), &output.stdout);
        }
        for path in files(self.folder.path()) {
            if self.known_files.insert(path.clone()) {
                let name = path.strip_prefix(self.folder.path()).expect("a file in the folder").to_owned();
                let bytes = fs::read(&path).expect("a file rebond wrote");
                self.add_line(&name.to_string_lossy(), &name, &bytes);
            }
        }
    }

    fn add_line(&mut self, name: &str, path: &Path, bytes: &[u8]) {
        let decoded = xxh3_128(&content::decode(path, bytes));
        let file = xxh3_128(bytes);
        writeln!(self.lines, "{:>8} {decoded:032x} {file:032x} {name}", bytes.len())
            .expect("writing to a string cannot fail");
    }
}

/// The names of the recordings in the folder `recordings`.
pub fn committed_recordings() -> Vec<String> {
    let recordings =
        files(&recordings()).into_iter().filter(|path| path.extension().is_some_and(|extension| extension == "mcap"));
    recordings.filter_map(|path| Some(path.file_name()?.to_str()?.to_owned())).collect()
}

fn recordings() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("recordings")
}

/// All files below a folder, sorted.
fn files(folder: &Path) -> Vec<PathBuf> {
    let entries = fs::read_dir(folder).expect("a folder").map(|entry| entry.expect("an entry").path());
    let mut files: Vec<PathBuf> =
        entries.flat_map(|path| if path.is_dir() { files(&path) } else { vec![path] }).collect();
    files.sort();
    files
}
