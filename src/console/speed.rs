//! Response times of the console: the real application and its threads, drawn to a discarded terminal.

use std::io::{self, Sink};
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::time::{Duration, Instant};

use ratatui::backend::CrosstermBackend;
use ratatui::layout::Rect;
use ratatui::{Terminal, TerminalOptions, Viewport};

use super::app::Settings;
use super::headless::{Headless, event};
use novamind_worker::message::Message;

const WINDOW: (u16, u16) = (200, 60);
/// Keys pressed while a week runs: every screen, and navigation in it.
const KEYS: [&str; 12] = ["1", "down", "2", "up", "3", "down", "4", "tab", "8", "down", "0", "up"];
/// Interval between the keys: faster than typing, about the repeat rate of a held key.
const BETWEEN_KEYS: Duration = Duration::from_millis(12);
/// Keys of the next-week dialog: continue, a rationale, continue, fill in the forecasts, run.
const WEEK: [&str; 8] = ["n", "enter", "t", "r", "y", "enter", "f", "enter"];

/// Returns the seconds from the start of the console to its first frame.
///
/// # Errors
/// The settings cannot be created, or drawing fails.
pub fn first_frame<E: From<io::Error>>(settings: impl FnOnce() -> Result<Settings, E>) -> Result<f64, E> {
    let started = Instant::now();
    let mut console = Measured::start(settings()?)?;
    console.draw()?;
    let seconds = started.elapsed().as_secs_f64();
    console.headless.finish();
    Ok(seconds)
}

/// Returns the seconds from each key pressed during a simulated week to the frame that shows its effect.
///
/// # Errors
/// The run does not open, a week does not complete, or drawing fails.
pub fn keys_during_weeks(settings: Settings, run: &str, weeks: usize) -> io::Result<Vec<f64>> {
    let mut console = Measured::start(settings)?;
    console.headless.open(run)?;
    let mut seconds = Vec::new();
    for _ in 0..weeks {
        let week = console.weeks();
        for key in WEEK {
            console.headless.app.update(Message::Input(event(key)?));
            console.draw()?;
        }
        seconds.extend(console.keys_until_week(week + 1)?);
        console.headless.press("esc")?;
    }
    console.headless.finish();
    Ok(seconds)
}

/// A headless console whose frames are written to a discarded terminal, so that writing is part of the time.
struct Measured {
    headless: Headless,
    terminal: Terminal<CrosstermBackend<Sink>>,
}

impl Measured {
    fn start(settings: Settings) -> io::Result<Measured> {
        let window = Viewport::Fixed(Rect::new(0, 0, WINDOW.0, WINDOW.1));
        let terminal =
            Terminal::with_options(CrosstermBackend::new(io::sink()), TerminalOptions { viewport: window })?;
        Ok(Measured { headless: Headless::new(settings, WINDOW), terminal })
    }

    fn weeks(&self) -> usize {
        self.headless.app.run().map_or(0, |run| run.company.weeks.len())
    }

    fn draw(&mut self) -> io::Result<()> {
        self.headless.hand_over();
        if let Some((_, words)) = &self.headless.left {
            return Err(io::Error::other(words.clone().unwrap_or_else(|| "the console exited".to_owned())));
        }
        let headless = &mut self.headless;
        self.terminal.draw(|whole| headless.draw_into(whole.buffer_mut()))?;
        Ok(())
    }

    fn keys_until_week(&mut self, week: usize) -> io::Result<Vec<f64>> {
        let (stop, stopped) = channel::<()>();
        let (press, pressed) = channel();
        let input = self.headless.sender();
        let events = KEYS.iter().map(|key| event(key)).collect::<io::Result<Vec<_>>>()?;
        let typist = std::thread::spawn(move || {
            for event in events.iter().cycle() {
                if stopped.recv_timeout(BETWEEN_KEYS) != Err(RecvTimeoutError::Timeout)
                    || press.send(Instant::now()).is_err()
                    || input.send(Message::Input(event.clone())).is_err()
                {
                    return;
                }
            }
        });
        let mut seconds = Vec::new();
        while self.weeks() < week {
            let mut keys = 0;
            let mut next = Some(self.headless.receive()?);
            // Draws once after all messages that have arrived, as the console does.
            while let Some(message) = next {
                keys += usize::from(matches!(message, Message::Input(_)));
                self.headless.app.update(message);
                next = self.headless.received();
            }
            self.draw()?;
            let arrived: Vec<Instant> = pressed.iter().take(keys).collect();
            seconds.extend(arrived.iter().map(|at| at.elapsed().as_secs_f64()));
        }
        drop(stop);
        let _ = typist.join();
        while let Some(message) = self.headless.received() {
            if !matches!(message, Message::Input(_)) {
                self.headless.app.update(message);
            }
        }
        Ok(seconds)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::keys::Keys;
    use novamind_record::folder::configuration::Configuration;
    use novamind_session::{NewRun, Session, Storage};
    use novamind_tui::glyphs::Glyphs;
    use novamind_tui::theme::Theme;

    fn settings(runs: &std::path::Path) -> Settings {
        let configuration = Configuration::shipped();
        Settings {
            theme: Theme::bundled("dark").expect("a theme"),
            keys: Keys::shipped(),
            glyphs: Glyphs::Braille,
            configuration,
            runs: runs.to_owned(),
            again: String::new(),
            lists_everybody: false,
            opponents: |_, _, _| Ok(None),
        }
    }

    #[test]
    fn a_frame_and_weeks_are_measured() {
        let runs = tempfile::tempdir().expect("a folder");
        assert!(first_frame(|| io::Result::Ok(settings(runs.path()))).expect("a frame") > 0.0);
        let new = NewRun { storage: Storage::Runs(runs.path().to_owned()), ..NewRun::default() };
        let session = Session::create(new, &Configuration::shipped()).expect("a run");
        drop(session);
        keys_during_weeks(settings(runs.path()), "latest", 2).expect("two weeks");
        let session = Session::open(
            &novamind_record::folder::runs::find_run(runs.path(), "latest").expect("the run"),
            novamind_session::Access::Write,
            false,
        );
        assert_eq!(session.expect("the run").day(), 14);
    }
}
