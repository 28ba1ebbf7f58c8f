//! Response times of the console, measured with the real application and its threads. The output of the terminal is
//! discarded.

use std::io::{self, Sink};
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::time::{Duration, Instant};

use ratatui::backend::CrosstermBackend;
use ratatui::layout::Rect;
use ratatui::{Terminal, TerminalOptions, Viewport};

use super::app::Settings;
use super::headless::{Headless, key_event};
use novamind_worker::message::Message;

const WINDOW_SIZE: (u16, u16) = (200, 60);
/// Keys pressed while a week runs: keys that show each screen and navigate in it.
const WEEK_KEYS: [&str; 12] = ["1", "down", "2", "up", "3", "down", "4", "tab", "8", "down", "0", "up"];
/// Interval between key presses, about the repeat rate of a held key.
const KEY_INTERVAL: Duration = Duration::from_millis(12);
/// Keys of the next-week dialog: continue, a rationale, continue, fill in the forecasts, run.
const NEXT_WEEK_KEYS: [&str; 8] = ["n", "enter", "t", "r", "y", "enter", "f", "enter"];

/// Returns the seconds from the start of the console to its first frame.
///
/// # Errors
/// The settings cannot be created, or drawing fails.
pub fn measure_first_frame<E: From<io::Error>>(
    settings: impl FnOnce() -> Result<Settings, E>,
) -> Result<f64, E> {
    let started = Instant::now();
    let mut console = MeasuredConsole::start(settings()?)?;
    console.draw()?;
    let seconds = started.elapsed().as_secs_f64();
    console.headless.finish();
    Ok(seconds)
}

/// Returns the seconds from each key pressed during a simulated week to the frame that shows its effect.
///
/// # Errors
/// The run does not open, a week does not complete, or drawing fails.
pub fn measure_keys_during_weeks(settings: Settings, run: &str, weeks: usize) -> io::Result<Vec<f64>> {
    let mut console = MeasuredConsole::start(settings)?;
    console.headless.open(run)?;
    let mut seconds = Vec::new();
    for _ in 0..weeks {
        let week = console.elapsed_weeks();
        for key in NEXT_WEEK_KEYS {
            console.headless.app.handle_message(Message::Input(key_event(key)?));
            console.draw()?;
        }
        seconds.extend(console.press_keys_until_week(week + 1)?);
        console.headless.press_keys("esc")?;
    }
    console.headless.finish();
    Ok(seconds)
}

/// A headless console whose frames are written to a terminal that discards its output, so that writing counts as
/// response time.
struct MeasuredConsole {
    headless: Headless,
    terminal: Terminal<CrosstermBackend<Sink>>,
}

impl MeasuredConsole {
    fn start(settings: Settings) -> io::Result<MeasuredConsole> {
        let window = Viewport::Fixed(Rect::new(0, 0, WINDOW_SIZE.0, WINDOW_SIZE.1));
        let terminal =
            Terminal::with_options(CrosstermBackend::new(io::sink()), TerminalOptions { viewport: window })?;
        Ok(MeasuredConsole { headless: Headless::new(settings, WINDOW_SIZE), terminal })
    }

    fn elapsed_weeks(&self) -> usize {
        self.headless.app.run().map_or(0, |run| run.company.weeks.len())
    }

    fn draw(&mut self) -> io::Result<()> {
        self.headless.dispatch_orders();
        if let Some((_, words)) = &self.headless.exit {
            return Err(io::Error::other(words.clone().unwrap_or_else(|| "the console exited".to_owned())));
        }
        let headless = &mut self.headless;
        self.terminal.draw(|frame| headless.draw_into(frame.buffer_mut()))?;
        Ok(())
    }

    fn press_keys_until_week(&mut self, week: usize) -> io::Result<Vec<f64>> {
        let (stop, stopped) = channel::<()>();
        let (press, pressed) = channel();
        let input = self.headless.sender();
        let events = WEEK_KEYS.iter().map(|key| key_event(key)).collect::<io::Result<Vec<_>>>()?;
        let typist = std::thread::spawn(move || {
            for event in events.iter().cycle() {
                if stopped.recv_timeout(KEY_INTERVAL) != Err(RecvTimeoutError::Timeout)
                    || press.send(Instant::now()).is_err()
                    || input.send(Message::Input(event.clone())).is_err()
                {
                    return;
                }
            }
        });
        let mut seconds = Vec::new();
        while self.elapsed_weeks() < week {
            let mut keys = 0;
            let mut next = Some(self.headless.receive()?);
            // Draws one frame after handling all messages that have arrived, as the console does.
            while let Some(message) = next {
                keys += usize::from(matches!(message, Message::Input(_)));
                self.headless.app.handle_message(message);
                next = self.headless.try_receive();
            }
            self.draw()?;
            let arrived: Vec<Instant> = pressed.iter().take(keys).collect();
            seconds.extend(arrived.iter().map(|at| at.elapsed().as_secs_f64()));
        }
        drop(stop);
        let _ = typist.join();
        while let Some(message) = self.headless.try_receive() {
            if !matches!(message, Message::Input(_)) {
                self.headless.app.handle_message(message);
            }
        }
        Ok(seconds)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::keys::KeyBindings;
    use novamind_record::folder::configuration::Configuration;
    use novamind_session::{NewRun, Session, Storage};
    use novamind_tui::glyphs::Glyphs;
    use novamind_tui::theme::Theme;

    fn settings(runs: &std::path::Path) -> Settings {
        let configuration = Configuration::bundled();
        Settings {
            theme: Theme::bundled("dark").expect("a theme"),
            keys: KeyBindings::bundled(),
            glyphs: Glyphs::Braille,
            configuration,
            runs: runs.to_owned(),
            resume_command: String::new(),
            lists_all_participants: false,
            hosted: false,
            opponents: |_, _, _| Ok(None),
        }
    }

    #[test]
    fn measurements_return_a_duration_for_each_frame() {
        let runs = tempfile::tempdir().expect("a folder");
        assert!(measure_first_frame(|| io::Result::Ok(settings(runs.path()))).expect("a frame") > 0.0);
        let new = NewRun { storage: Storage::Runs(runs.path().to_owned()), ..NewRun::default() };
        let session = Session::create(new, &Configuration::bundled()).expect("a run");
        drop(session);
        measure_keys_during_weeks(settings(runs.path()), "latest", 2).expect("two weeks");
        let session = Session::open(
            &novamind_record::folder::runs::find_run(runs.path(), "latest").expect("the run"),
            novamind_session::Access::Write,
            false,
        );
        assert_eq!(session.expect("the run").day(), 14);
    }
}
