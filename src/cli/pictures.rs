//! `novamind pictures`: the screens of a run as text or SVG, drawn by the console.

use std::path::{Path, PathBuf};

use clap::{Args, ValueEnum};

use super::{Context, Failure, print};
use crate::console::app::Settings;
use crate::console::context::ScreenId;
use crate::console::headless::Headless;
use crate::console::keys::Keys;
use crate::console::themes;
use crate::lab::play_opponents;
use crate::record::folder::runs::find_run_to_read;
use crate::session::Goal;
use crate::tui::glyphs::Glyphs;
use crate::tui::photograph::{self, Paper};
use crate::worker::request::Recorded;

#[derive(Debug, Args)]
pub struct Options {
    /// Run: its id or a prefix of it, or `latest` for the newest
    #[arg(default_value = "latest")]
    run: String,
    /// Only these screens, by name: overview, cash, customers, …
    #[arg(long, value_delimiter = ',', value_name = "NAMES")]
    screens: Vec<String>,
    /// Keys to press instead of showing screens, as in keys.toml, separated by spaces
    #[arg(long, conflicts_with = "screens")]
    keys: Option<String>,
    /// Replay the run, and show it as it was after this week
    #[arg(long, value_name = "WEEK")]
    replay: Option<u32>,
    /// Columns and rows of the window
    #[arg(long, default_value = "120x40", value_parser = size)]
    size: (u16, u16),
    /// Theme
    #[arg(long, default_value = "dark")]
    theme: String,
    /// Draw with ASCII characters only
    #[arg(long)]
    ascii: bool,
    /// Output format
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

/// Largest number of columns or rows; larger values are mistakes.
const LARGEST: u16 = 500;

pub(super) fn size(text: &str) -> Result<(u16, u16), String> {
    let parts = text.split_once(['x', '×']);
    let number = |part: &str| part.trim().parse::<u16>().ok().filter(|number| (1..=LARGEST).contains(number));
    parts
        .and_then(|(columns, rows)| Some((number(columns)?, number(rows)?)))
        .ok_or_else(|| format!("give columns and rows up to {LARGEST}, for example 120x40"))
}

pub fn run(options: &Options, context: &Context) -> Result<(), Failure> {
    let runs = context.runs()?;
    let folder = find_run_to_read(&runs, &options.run)?;
    context.look(&folder, "pictures", &options.keys.clone().unwrap_or_else(|| options.screens.join(" ")))?;
    let id = folder.file_name().map_or(String::new(), |name| name.to_string_lossy().into_owned());
    let settings = Settings {
        theme: themes::find(&options.theme, &context.configuration).map_err(Failure::usage)?,
        keys: Keys::of_user(&context.configuration).map_err(Failure::usage)?,
        glyphs: if options.ascii { Glyphs::Ascii } else { Glyphs::Braille },
        configuration: context.configuration.clone(),
        runs,
        again: context.again(),
        lists_everybody: false,
        opponents: play_opponents,
    };
    let places = places(options, &settings.keys)?;
    let mut console = Headless::new(settings, options.size);
    let taken = take_pictures(&mut console, &id, &places, options);
    console.finish();
    taken
}

/// Returns the names of the pictures and the keys to press for each.
fn places(options: &Options, keys: &Keys) -> Result<Vec<(String, String)>, Failure> {
    if let Some(keys) = &options.keys {
        return Ok(vec![("keys".to_owned(), keys.clone())]);
    }
    let known = ScreenId::ALL.map(ScreenId::id);
    if let Some(wrong) = options.screens.iter().find(|name| !known.contains(&name.as_str())) {
        return Err(Failure::usage(format!(
            "there is no screen {wrong}; the screens are {}",
            known.join(", ")
        )));
    }
    let wanted = |screen: &ScreenId| {
        options.screens.is_empty() || options.screens.iter().any(|name| name == screen.id())
    };
    // Letters and digits would be typed into a statement; esc leaves the editor first.
    let place = |screen: ScreenId| {
        let key = keys.label(screen.action()).unwrap_or_default();
        (screen.id().to_owned(), format!("esc {key}"))
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
        Some(week) => console.replay(Recorded::Run(run.to_owned()), Goal::Week(week), false),
        None => console.look_at(run),
    }
    .map_err(failed)?;
    for (name, keys) in places {
        console.press(keys).map_err(|error| Failure::usage(error.to_string()))?;
        let frame = console.draw();
        let paper = if options.theme == "light" { Paper::LIGHT } else { Paper::DARK };
        let (picture, ending) = match options.format {
            PictureFormat::Text => (photograph::text(&frame), "txt"),
            PictureFormat::Svg => (photograph::svg(&frame, paper), "svg"),
        };
        match &options.out {
            None => print(&picture)?,
            Some(folder) => write(&folder.join(format!("{name}.{ending}")), &picture)?,
        }
    }
    Ok(())
}

fn write(path: &Path, picture: &str) -> Result<(), Failure> {
    let written =
        path.parent().map_or(Ok(()), std::fs::create_dir_all).and_then(|()| std::fs::write(path, picture));
    written.map_err(|error| Failure::failed(format!("{}: {error}", path.display())))
}
