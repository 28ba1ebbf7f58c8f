//! `novamind replay RUN --cast FILE`: records the replay as an asciicast.

use std::path::Path;
use std::time::Duration;

use clap::Args;

use super::super::output_file::write_text;
use super::super::pictures::parse_size;
use super::super::{Context, Failure, print};
use super::record_view;
use crate::console::app::Settings;
use crate::console::headless::Headless;
use crate::console::keys::KeyBindings;
use crate::console::themes;
use crate::lab::play_opponents;
use crate::session::SeekTarget;
use crate::tui::asciicast::Asciicast;
use crate::tui::glyphs::Glyphs;
use crate::worker::request::RecordSource;

/// Display time of the frame after an action, at speed 1.
const ACTION_FRAME_TIME: Duration = Duration::from_millis(700);
const WEEK_FRAME_TIME: Duration = Duration::from_millis(2500);

/// Options of a recorded replay.
#[derive(Debug, Args)]
pub struct RecordingOptions {
    /// With --cast: speed factor from 0.1 to 100
    #[arg(long, default_value_t = 1.0, value_name = "X", requires = "cast", value_parser = parse_speed)]
    speed: f64,
    /// With --cast: columns and rows of the window
    #[arg(long, default_value = "120x40", requires = "cast", value_parser = parse_size)]
    size: (u16, u16),
    /// With --cast: theme
    #[arg(long, default_value = "dark", value_name = "NAME", requires = "cast")]
    theme: String,
}

fn parse_speed(text: &str) -> Result<f64, String> {
    let speed = text.parse().ok().filter(|speed: &f64| (0.1..=100.0).contains(speed));
    speed.ok_or_else(|| "the speed must be from 0.1 to 100".to_owned())
}

/// Records one week, a range of weeks, or all weeks of a replay to a file.
pub fn record_cast(
    file: &Path,
    recorded: RecordSource,
    weeks: Option<(u32, Option<u32>)>,
    options: &RecordingOptions,
    context: &Context,
) -> Result<(), Failure> {
    let (first, last) = match weeks {
        None => (1, u32::MAX),
        Some((first, last)) => (first.max(1), last.unwrap_or(first.max(1))),
    };
    record_view(&recorded, &format!("cast {first}"), context)?;
    let settings = Settings {
        theme: themes::find_theme(&options.theme, &context.configuration).map_err(Failure::usage)?,
        keys: KeyBindings::with_user_file(&context.configuration).map_err(Failure::usage)?,
        glyphs: Glyphs::Braille,
        configuration: context.configuration.clone(),
        runs: context.runs_folder()?,
        resume_command: context.resume_command(),
        lists_all_participants: false,
        hosted: false,
        opponents: play_opponents,
    };
    let mut console = Headless::new(settings, options.size);
    let recording = render_cast(&mut console, recorded, (first, last), options);
    console.finish();
    let (text, frames) = recording?;
    write_text(file, &text)?;
    print(&format!("{}: {frames} frames\n", file.display()))
}

/// Returns the recording and the number of frames in the recording.
fn render_cast(
    console: &mut Headless,
    recorded: RecordSource,
    (first, last): (u32, u32),
    options: &RecordingOptions,
) -> Result<(String, usize), Failure> {
    let failed = |error: std::io::Error| Failure::failed(error.to_string());
    let title = match &recorded {
        RecordSource::Run(id) => format!("NovaMind run {id}"),
        RecordSource::File(path) => format!("NovaMind {}", path.display()),
    };
    console.replay(recorded, SeekTarget::Week(first - 1), false).map_err(failed)?;
    let display_time = |pause: Duration| pause.div_f64(options.speed);
    let mut cast = Asciicast::new(options.size, &title);
    let mut frames = 0;
    loop {
        let place =
            console.playback_position().ok_or_else(|| Failure::failed("there is nothing to replay"))?;
        let (line, week, weeks, at_end) = (place.line, place.week, place.weeks, place.is_at_end);
        if first > weeks {
            return Err(Failure::usage(format!(
                "week {first} is not in the record, which has {weeks} weeks"
            )));
        }
        let is_over = at_end || week >= last;
        let is_new_week = frames == 0 || place.chapter.applied_entries == 0;
        let frame = console.draw();
        cast.add_frame(
            &frame,
            display_time(if is_over || is_new_week { WEEK_FRAME_TIME } else { ACTION_FRAME_TIME }),
        )
        .map_err(failed)?;
        frames += 1;
        if is_over {
            return Ok((cast.finish(), frames));
        }
        console.seek(SeekTarget::Lines(1)).map_err(failed)?;
        if console.playback_position().is_some_and(|place| place.line == line) {
            return Ok((cast.finish(), frames));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parse_speed_rejects_values_out_of_range() {
        assert_eq!((parse_speed("2"), parse_speed("0.1")), (Ok(2.0), Ok(0.1)));
        for wrong in ["0", "-1", "nan", "inf", "fast", "101"] {
            assert!(parse_speed(wrong).is_err(), "{wrong}");
        }
    }
}
