use std::ops::Range;

/// The text of a scene and its name.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SceneSource {
    /// The path as given by the user; error messages show it.
    pub path: String,
    /// The complete text.
    pub text: String,
}

impl SceneSource {
    /// The last part of the path: the name of the attachment in a recording.
    pub fn file_name(&self) -> &str {
        self.path.rsplit(['/', '\\']).next().unwrap_or(&self.path)
    }
}

/// The text that an input comes from.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum InputLocation {
    /// A range of bytes of the scene.
    Scene(Range<usize>),
    /// A line of JSON Lines events, from 1.
    EventLine(u64),
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_name_contains_no_folder() {
        let named = |path: &str| SceneSource { path: path.into(), text: String::new() };
        assert_eq!(named("recordings/gas.toml").file_name(), "gas.toml");
        assert_eq!(named(r"C:\scenes\gas.toml").file_name(), "gas.toml");
        assert_eq!(named("gas.toml").file_name(), "gas.toml");
    }
}
