//! `novamind pictures`: draws the console's screens of a run as text or SVG.

use std::path::{Path, PathBuf};

use clap::{Args, ValueEnum};

use super::{Context, Failure, print};
use crate::console::app::Settings;
use crate::console::context::ScreenId;
use crate::console::headless::Headless;
use crate::console::keys::KeyBindings;
use crate::console::themes;
use crate::lab::play_opponents;
use crate::record::folder::runs::find_run_to_read;
use crate::session::SeekTarget;
use crate::tui::frame_export::{self, TerminalColors};
use crate::tui::glyphs::Glyphs;
use crate::worker::request::RecordSource;

#[derive(Debug, Args)]
pub struct Options {
    /// ID of the run or a prefix of the id, or `latest` for the newest run
    #[arg(default_value = "latest")]
    run: String,
    /// Draw only these screens, by name: overview, cash, customers, …
    #[arg(long, value_delimiter = ',', value_name = "NAMES")]
    screens: Vec<String>,
    /// Keys to press instead of showing screens, as in keys.toml, separated by spaces
    #[arg(long, conflicts_with = "screens")]
    keys: Option<String>,
    /// Replay the run and draw its state after this week
    #[arg(long, value_name = "WEEK")]
    replay: Option<u32>,
    /// Columns and rows of the window
    #[arg(long, default_value = "120x40", value_parser = parse_size)]
    size: (u16, u16),
    /// Color theme
    #[arg(long, default_value = "dark")]
    theme: String,
    /// Draw with ASCII characters only
    #[arg(long)]
    ascii: bool,
    /// Output format of the pictures
    #[arg(long, value_enum, default_value_t = PictureFormat::Text)]
    format: PictureFormat,
    /// Folder for one file per screen [default: standard output]
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum PictureFormat {
    Text,
    Svg,
}

/// Maximum number of columns or rows. A larger value is probably a typing error.
const MAX_WINDOW_SIZE: u16 = 500;

pub(super) fn parse_size(text: &str) -> Result<(u16, u16), String> {
    let parts = text.split_once(['x', '×']);
    let number =
        |part: &str| part.trim().parse::<u16>().ok().filter(|number| (1..=MAX_WINDOW_SIZE).contains(number));
    parts
        .and_then(|(columns, rows)| Some((number(columns)?, number(rows)?)))
        .ok_or_else(|| format!("give columns and rows up to {MAX_WINDOW_SIZE}, for example 120x40"))
}

pub fn run(options: &Options, context: &Context) -> Result<(), Failure> {
    let runs = context.runs_folder()?;
    let folder = find_run_to_read(&runs, &options.run)?;
    context.authorize_view(
        &folder,
        "pictures",
        &options.keys.clone().unwrap_or_else(|| options.screens.join(" ")),
    )?;
    let id = folder.file_name().map_or(String::new(), |name| name.to_string_lossy().into_owned());
    let settings = Settings {
        theme: themes::find_theme(&options.theme, &context.configuration).map_err(Failure::usage)?,
        keys: KeyBindings::with_user_file(&context.configuration).map_err(Failure::usage)?,
        glyphs: if options.ascii { Glyphs::Ascii } else { Glyphs::Braille },
        configuration: context.configuration.clone(),
        runs,
        resume_command: context.resume_command(),
        lists_all_participants: false,
        hosted: false,
        opponents: play_opponents,
    };
    let places = picture_keys(options, &settings.keys)?;
    let mut console = Headless::new(settings, options.size);
    let taken = take_pictures(&mut console, &id, &places, options);
    console.finish();
    taken
}

/// Returns the name of each picture and the keys to press for the picture.
fn picture_keys(options: &Options, keys: &KeyBindings) -> Result<Vec<(String, String)>, Failure> {
    if let Some(keys) = &options.keys {
        return Ok(vec![("keys".to_owned(), keys.clone())]);
    }
    let known = ScreenId::ALL.map(ScreenId::record_name);
    if let Some(wrong) = options.screens.iter().find(|name| !known.contains(&name.as_str())) {
        return Err(Failure::usage(format!(
            "there is no screen {wrong}; the screens are {}",
            known.join(", ")
        )));
    }
    let wanted = |screen: &ScreenId| {
        options.screens.is_empty() || options.screens.iter().any(|name| name == screen.record_name())
    };
    // Esc leaves the SQL editor, in which the key of a screen would be typed as text.
    let place = |screen: ScreenId| {
        let key = keys.label(screen.action()).unwrap_or_default();
        (screen.record_name().to_owned(), format!("esc {key}"))
    };
    Ok(ScreenId::ALL.into_iter().filter(wanted).map(place).collect())
}

fn take_pictures(
    console: &mut Headless,
    run: &str,
    places: &[(String, String)],
    options: &Options,
) -> Result<(), Failure> {
    let failed = |error: std::io::Error| Failure::failed(error.to_string());
    match options.replay {
        Some(week) => console.replay(RecordSource::Run(run.to_owned()), SeekTarget::Week(week), false),
        None => console.open_read_only(run),
    }
    .map_err(failed)?;
    for (name, keys) in places {
        console.press_keys(keys).map_err(|error| Failure::usage(error.to_string()))?;
        let frame = console.draw();
        let paper = if options.theme == "light" { TerminalColors::LIGHT } else { TerminalColors::DARK };
        let (picture, ending) = match options.format {
            PictureFormat::Text => (frame_export::frame_text(&frame), "txt"),
            PictureFormat::Svg => (frame_export::frame_svg(&frame, paper), "svg"),
        };
        match &options.out {
            None => print(&picture)?,
            Some(folder) => write_picture(&folder.join(format!("{name}.{ending}")), &picture)?,
        }
    }
    Ok(())
}

fn write_picture(path: &Path, picture: &str) -> Result<(), Failure> {
    let written =
        path.parent().map_or(Ok(()), std::fs::create_dir_all).and_then(|()| std::fs::write(path, picture));
    written.map_err(|error| Failure::failed(format!("{}: {error}", path.display())))
}
