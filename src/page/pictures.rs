use rebond::internals::picture::figures::{self, CollisionSubject};
use rebond::internals::picture::{Appearance, Metadata, PngEffort, ReferenceFrame, Style, TextAs};
use rebond::internals::table::{CollisionRows, Rows, Table, TableFormat};
use rebond::recordings::{BodyInfo, Playback, Recording};
use rebond::{
    ALL_STEPS, AnimationFormat, Collision, Language, PictureOptions, Replayer, Source, StillFormat, SubjectOptions,
    Theme, Vector, draw_to_vec,
};
use std::io::Cursor;
use std::sync::Arc;

/// Draws a picture of the recording `bytes`: the file that the command line gives with the same options. `format` is
/// png, svg, gif or apng; the first two show the state of `step`. `options` are the keys of
/// [`PictureOptions`] as JSON.
///
/// # Errors
/// The message of options that are not understood or of a picture that cannot be drawn.
pub fn draw(bytes: Arc<[u8]>, format: &str, step: u64, options: &str) -> Result<Vec<u8>, String> {
    let options: PictureOptions = serde_json::from_str(options).map_err(|error| error.to_string())?;
    let still = |format| SubjectOptions::State { step: step.into(), format };
    let subject = match format {
        "png" => still(StillFormat::Png),
        "svg" => still(StillFormat::Svg),
        "gif" => SubjectOptions::Animation { format: AnimationFormat::Gif },
        "apng" => SubjectOptions::Animation { format: AnimationFormat::Apng },
        other => return Err(format!("{other} is not a format of pictures")),
    };
    let source = Source::from_bytes("the recording", bytes).map_err(|error| error.to_string())?;
    draw_to_vec(&subject, &options, &[source]).map_err(|error| error.to_string())
}

/// Writes the states or collisions of the recording `bytes` as CSV, as `rebond export` does.
///
/// # Errors
/// The message of a recording that cannot be read or replayed.
pub fn table(bytes: Arc<[u8]>, table: Table) -> Result<Vec<u8>, String> {
    let recording = Recording::read(Cursor::new(bytes)).map_err(|error| error.to_string())?;
    let mut file = Vec::new();
    let (format, columns) = (TableFormat::Csv, table.columns());
    let mut rows = Rows { format, output: &mut file, columns, source: None, settings: Vec::new() };
    rows.header().map_err(|error| error.to_string())?;
    if table == Table::Collisions {
        let mut collisions = CollisionRows::new(ALL_STEPS, &mut rows);
        let mut replayer = Replayer::new(recording, ALL_STEPS).map_err(|error| error.to_string())?;
        while replayer.next_state(&mut collisions).map_err(|error| error.to_string())?.is_some() {
            replayer.engine().into_iter().for_each(|engine| collisions.update_names(engine));
        }
        if replayer.verdict().health().is_none() {
            return Err(replayer.verdict().to_string());
        }
    } else {
        for state in Playback::new(recording) {
            let state = state.map_err(|error| error.to_string())?;
            rows.state(&state).map_err(|error| error.to_string())?;
        }
    }
    Ok(file)
}

/// Draws the handout's Figure 1 or Figure 2 of a collision as SVG.
///
/// # Errors
/// The message of a figure that cannot be drawn.
pub fn collision_figure(
    collision: &Collision,
    infos: [&BodyInfo; 2],
    gravity: Option<Vector>,
    kind: FigureKind,
    theme: Theme,
    language: Language,
) -> Result<Vec<u8>, String> {
    let appearance = |info: &BodyInfo| Arc::new(Appearance::new(info, gravity));
    let bodies = infos.map(appearance);
    let subject = CollisionSubject { title: String::new(), collision: collision.clone(), bodies };
    let speeds = collision.before.iter().chain(&collision.after).map(|velocity| velocity.norm());
    let top_speed = speeds.fold(0.0, |top, speed| if speed > top { speed } else { top });
    let mut style = Style { top_speed, top_impulse: collision.impulse.abs(), body_count: 2, ..Style::default() };
    style.look.theme = theme;
    style.look.language = language;
    style.look.size = [960, 540];
    let list = match kind {
        FigureKind::Stages => figures::collision(&[subject], ReferenceFrame::Laboratory, &style),
        FigureKind::Minkowski => figures::minkowski(&[subject], &style),
    };
    let list = list.map_err(|error| error.to_string())?;
    let mut file = Vec::new();
    StillFormat::Svg
        .write(&list, &Metadata::default(), TextAs::Outlines, PngEffort::Small, &mut file)
        .map_err(|error| error.to_string())?;
    Ok(file)
}

/// A figure of the handout.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FigureKind {
    /// Figure 1: before, penetration, after.
    Stages,
    /// Figure 2: the Minkowski difference.
    Minkowski,
}
