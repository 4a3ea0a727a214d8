//! Runs the program in a temporary folder, as users do.

use assert_cmd::Command;
use std::{
    fs,
    path::{Path, PathBuf},
    process::{Child, Stdio},
};
use tempfile::TempDir;

/// A temporary folder for running the program, removed on drop.
pub struct Workplace {
    folder: TempDir,
}

/// The result of a command.
#[derive(Debug)]
pub struct Outcome {
    /// The exit code.
    pub code: i32,
    /// The standard output.
    pub output: String,
    /// The standard error.
    pub errors: String,
}

impl Workplace {
    /// Creates an empty folder.
    pub fn new() -> Workplace {
        Workplace { folder: TempDir::new().expect("a temporary folder") }
    }

    /// Creates a folder with a scene, `scene.toml`.
    pub fn with_scene(text: &str) -> Workplace {
        let workplace = Workplace::new();
        workplace.write("scene.toml", text);
        workplace
    }

    /// Returns the path of a file in the folder.
    pub fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    /// Writes a file.
    pub fn write(&self, name: &str, text: &str) {
        fs::write(self.path(name), text).expect("a file in a temporary folder");
    }

    /// Reads a file.
    pub fn read(&self, name: &str) -> Vec<u8> {
        fs::read(self.path(name)).unwrap_or_else(|error| panic!("{name}: {error}"))
    }

    /// Returns the names in the folder, sorted.
    pub fn names(&self) -> Vec<String> {
        let entries = fs::read_dir(self.folder.path()).expect("the folder");
        let mut names: Vec<String> =
            entries.map(|entry| entry.unwrap().file_name().to_string_lossy().into_owned()).collect();
        names.sort();
        names
    }

    /// Runs `rebond` with the space-separated arguments of `line`.
    pub fn rebond(&self, line: &str) -> Outcome {
        self.rebond_with_input(line, "")
    }

    /// Runs `rebond` with `input` on standard input.
    pub fn rebond_with_input(&self, line: &str, input: &(impl AsRef<[u8]> + ?Sized)) -> Outcome {
        self.run(self.command(line).write_stdin(input.as_ref()))
    }

    /// Runs `rebond` with `PATH` set to one folder.
    pub fn rebond_on_path(&self, line: &str, path: &Path) -> Outcome {
        self.run(self.command(line).env("PATH", path))
    }

    /// Starts `rebond` without waiting for its end.
    pub fn start(&self, line: &str, stdin: Stdio, stdout: Stdio) -> Child {
        let mut command = std::process::Command::new(env!("CARGO_BIN_EXE_rebond"));
        command.args(line.split_whitespace()).current_dir(self.folder.path());
        command.env("NO_COLOR", "1").env("TMPDIR", self.folder.path());
        command.stdin(stdin).stdout(stdout).stderr(Stdio::piped()).spawn().expect("the program starts")
    }

    fn command(&self, line: &str) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_rebond"));
        command
            .args(line.split_whitespace())
            .current_dir(self.folder.path())
            .env("NO_COLOR", "1")
            .env("COLUMNS", "100");
        command
    }

    /// Runs a command to its end.
    pub fn run(&self, command: &mut Command) -> Outcome {
        let output = command.output().expect("the program runs");
        Outcome {
            code: output.status.code().unwrap_or(-1),
            output: String::from_utf8_lossy(&output.stdout).into_owned(),
            errors: String::from_utf8_lossy(&output.stderr).into_owned(),
        }
    }

    /// Runs `rebond` with a terminal width, and asserts that it succeeds.
    pub fn done_in(&self, columns: &str, line: &str) -> Outcome {
        let outcome = self.run(self.command(line).env("COLUMNS", columns));
        assert_eq!(outcome.code, 0, "rebond {line}: {outcome:?}");
        outcome
    }

    /// Runs `rebond` and asserts that it succeeds.
    pub fn done(&self, line: &str) -> Outcome {
        let outcome = self.rebond(line);
        assert_eq!(outcome.code, 0, "rebond {line}: {outcome:?}");
        outcome
    }
}

/// Returns the paths of the bundled scenes, sorted.
pub fn bundled_scenes() -> Vec<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("recordings");
    let entries = fs::read_dir(folder).expect("the folder of scenes");
    let mut scenes: Vec<PathBuf> = entries.map(|entry| entry.unwrap().path()).collect();
    scenes.retain(|path| path.extension().is_some_and(|extension| extension == "toml"));
    scenes.sort();
    scenes
}
