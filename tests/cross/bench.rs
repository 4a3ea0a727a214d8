//! A folder in which rebond is run, and what it leaves there.

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

/// What `rebond` is run as: itself, or an emulator that is told of it.
pub struct Program {
    /// The file to run.
    pub file: PathBuf,
    /// What comes before rebond's own arguments.
    pub arguments: Vec<String>,
}

/// A folder to run the program in, and the lines so far.
pub struct Bench {
    program: Program,
    folder: TempDir,
    known: BTreeSet<PathBuf>,
    /// Size (bytes), digest of what is decoded, digest of the file, name.
    pub lines: String,
}

impl Bench {
    /// An empty folder.
    pub fn new(program: &Program) -> Bench {
        // The program runs in another folder than it was named in.
        let file = if program.file.components().count() > 1 {
            program.file.canonicalize().expect("the program is there")
        } else {
            program.file.clone()
        };
        let program = Program { file, arguments: program.arguments.clone() };
        let folder = TempDir::new().expect("a temporary folder");
        Bench { program, folder, known: BTreeSet::new(), lines: String::new() }
    }

    /// Copies a bundled file here, in place of any of that name.
    pub fn take(&mut self, name: &str) {
        self.put(name, &fs::read(recordings().join(name)).unwrap_or_else(|error| panic!("{name}: {error}")));
    }

    /// Puts a file here; it is no artefact.
    pub fn put(&mut self, name: &str, bytes: &[u8]) {
        let path = self.folder.path().join(name);
        fs::write(&path, bytes).unwrap_or_else(|error| panic!("{name}: {error}"));
        self.known.insert(path);
    }

    /// Reads a file.
    pub fn read(&self, name: &str) -> Vec<u8> {
        fs::read(self.folder.path().join(name)).unwrap_or_else(|error| panic!("{name}: {error}"))
    }

    /// Runs rebond, which is to exit with 0.
    pub fn done(&mut self, line: &str) {
        self.ends(0, line);
    }

    /// Runs rebond, which is to exit with `code`; notes its standard output and new files.
    pub fn ends(&mut self, code: i32, line: &str) {
        let Program { file, arguments } = &self.program;
        let output = Command::new(file)
            .args(arguments)
            .args(line.split_whitespace())
            .current_dir(self.folder.path())
            .env("NO_COLOR", "1")
            .output()
            .unwrap_or_else(|error| panic!("{}: {error}", file.display()));
        let told = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(code), "rebond {line}: {told}");
        if !output.stdout.is_empty() {
            self.note(&format!("rebond {line}"), Path::new(""), &output.stdout);
        }
        for path in files(self.folder.path()) {
            if self.known.insert(path.clone()) {
                let name = path.strip_prefix(self.folder.path()).expect("a file in the folder").to_owned();
                let bytes = fs::read(&path).expect("a file rebond wrote");
                self.note(&name.to_string_lossy(), &name, &bytes);
            }
        }
    }

    fn note(&mut self, name: &str, path: &Path, bytes: &[u8]) {
        let decoded = xxh3_128(&content::decode(path, bytes));
        let file = xxh3_128(bytes);
        writeln!(self.lines, "{:>8} {decoded:032x} {file:032x} {name}", bytes.len()).expect("a string takes all");
    }
}

/// The recordings that come with rebond, by name.
pub fn committed_recordings() -> Vec<String> {
    let recordings = files(&recordings()).into_iter().filter(|path| path.extension().is_some_and(|it| it == "mcap"));
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
