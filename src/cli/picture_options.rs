use super::picture_arguments::LookOptions;
use crate::picture::{PictureOptions, SubjectOptions};

/// Converts the flags that all pictures have in common.
pub fn from_look(look: &LookOptions, subject: SubjectOptions) -> PictureOptions {
    PictureOptions {
        size: look.size,
        theme: look.theme,
        show: look.show.as_ref().map(|show| show.0.clone()),
        color_by: look.color_by,
        window: look.window,
        follow: look.follow.clone(),
        caption: look.caption.clone().unwrap_or_default(),
        ..PictureOptions::new(subject)
    }
}
