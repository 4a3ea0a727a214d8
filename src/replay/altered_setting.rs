use crate::recording::{Header, SceneText};
use crate::scene;

use super::{RecordOptions, header};

/// Returns a description of the setting in the metadata of a recording that contradicts the text of its scene. Both
/// copies of the metadata were altered if the recording does not match its identity although it replays the same.
pub fn altered_setting(recorded: &Header) -> Option<String> {
    let SceneText { file_name, text } = recorded.scene.as_ref()?;
    let scene = scene::parse(file_name, text).ok()?;
    let names = scene.image_names();
    let images = recorded.images.iter().filter(|image| names.contains(&image.name)).cloned().collect();
    // The text contains neither the versions nor the entries that recording adds.
    let expected = Header {
        versions: recorded.versions,
        images,
        overrides: recorded.overrides.clone(),
        has_live_events: recorded.has_live_events,
        gaps: recorded.gaps.clone(),
        ..header(&scene, RecordOptions::complete(&scene))
    };
    if let Some(difference) = recorded.settings_difference(&expected) {
        return Some(difference);
    }
    #[cfg(feature = "cli")]
    if !scene::are_applied(text, &recorded.overrides) {
        return Some("the text of the scene has other values than the key \"set\" of the metadata".into());
    }
    let others = "an event, or \"live_events\" or \"identity\" in the metadata, was altered";
    Some(format!("the text of the scene agrees with all settings; {others}"))
}
