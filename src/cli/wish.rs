use super::picture_arguments::LookOptions;
use crate::illustration::{Wish, WishedSubject};

/// What the flags that every picture has ask for.
pub fn of(look: &LookOptions, subject: WishedSubject) -> Wish {
    Wish {
        size: look.size,
        theme: look.theme,
        show: look.show.as_ref().map(|show| show.0.clone()),
        color_by: look.color_by,
        window: look.window,
        follow: look.follow.clone(),
        caption: look.caption.clone().unwrap_or_default(),
        ..Wish::new(subject)
    }
}
