use std::ops::Range;

/// The text of a scene and what it is called.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SceneSource {
    /// As the user named it: what errors show.
    pub path: String,
    /// All of it.
    pub text: String,
}

impl SceneSource {
    /// The last part of the path: what a recording calls its attachment.
    pub fn file_name(&self) -> &str {
        self.path.rsplit(['/', '\\']).next().unwrap_or(&self.path)
    }
}

/// Where an input stands.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Place {
    /// In the scene: bytes of its text.
    Scene(Range<usize>),
    /// In a file or pipe of JSON Lines: the line, from 1.
    Line(u64),
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_name_holds_no_folder() {
        let named = |path: &str| SceneSource { path: path.into(), text: String::new() };
        assert_eq!(named("recordings/gas.toml").file_name(), "gas.toml");
        assert_eq!(named(r"C:\scenes\gas.toml").file_name(), "gas.toml");
        assert_eq!(named("gas.toml").file_name(), "gas.toml");
    }
}
