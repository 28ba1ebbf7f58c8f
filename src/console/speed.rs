//! How quickly the console answers: the real application and its threads, drawn into a terminal that nobody sees.

use std::io::{self, Sink};
use std::sync::mpsc::{Receiver, Sender, channel};
use std::time::{Duration, Instant};

use crossterm::event::Event;
use ratatui::backend::CrosstermBackend;
use ratatui::layout::Rect;
use ratatui::{Terminal, TerminalOptions, Viewport};

use super::app::{App, Order, Settings, Stage};
use super::effect::Effect;
use super::frame;
use super::keys::Chord;
use super::message::Message;
use super::worker::{Job, Workers};

/// Window that is drawn: columns, rows.
const WINDOW: (u16, u16) = (200, 60);
/// Keys that are pressed while a week runs: every screen, and moving about in it.
const KEYS: [&str; 12] = ["1", "down", "2", "up", "3", "down", "4", "tab", "8", "down", "0", "up"];
/// Between two of these keys: faster than anybody types, and about what a held key repeats.
const BETWEEN_KEYS: Duration = Duration::from_millis(12);
/// The dialog before a week: on to the reason, the reason, on, the naive forecasts, go.
const WEEK: [&str; 8] = ["n", "enter", "t", "r", "y", "enter", "f", "enter"];
/// An answer that takes longer than this does not come.
const PATIENCE: Duration = Duration::from_secs(120);

/// Seconds from the start of the console to its first frame.
///
/// # Errors
/// The settings cannot be made; the drawing fails.
pub fn first_frame<E: From<io::Error>>(settings: impl FnOnce() -> Result<Settings, E>) -> Result<f64, E> {
    let started = Instant::now();
    let mut rehearsal = Rehearsal::start(settings()?, None)?;
    rehearsal.draw()?;
    let seconds = started.elapsed().as_secs_f64();
    rehearsal.workers.finish();
    Ok(seconds)
}

/// Seconds from each key that is pressed while a week is simulated to the frame that shows what it did.
///
/// # Errors
/// The run does not open, a week does not pass, the drawing fails.
pub fn keys_during_weeks(settings: Settings, run: &str, weeks: usize) -> io::Result<Vec<f64>> {
    let mut rehearsal = Rehearsal::start(settings, Some(Effect::Open(run.to_owned())))?;
    rehearsal.until(|app| matches!(&app.stage, Stage::Run(_)) && app.busy.is_none())?;
    let mut seconds = Vec::new();
    for _ in 0..weeks {
        let week = rehearsal.weeks();
        for key in WEEK {
            rehearsal.press(key)?;
            rehearsal.draw()?;
        }
        seconds.extend(rehearsal.keys_until(|app| passed(app) > week)?);
        rehearsal.press("esc")?;
    }
    rehearsal.workers.finish();
    Ok(seconds)
}

/// Weeks that have passed in the run that is shown.
fn passed(app: &App) -> usize {
    app.run().map_or(0, |run| run.company.weeks.len())
}

struct Rehearsal {
    app: App,
    workers: Workers,
    sender: Sender<Message>,
    messages: Receiver<Message>,
    terminal: Terminal<CrosstermBackend<Sink>>,
}

impl Rehearsal {
    fn start(settings: Settings, effect: Option<Effect>) -> io::Result<Rehearsal> {
        let (sender, messages) = channel();
        let workers = Workers::start(sender.clone(), settings.configuration.clone());
        let mut app = App::new(settings);
        if let Some(effect) = effect {
            app.start_with(effect);
        }
        let window = Viewport::Fixed(Rect::new(0, 0, WINDOW.0, WINDOW.1));
        let terminal =
            Terminal::with_options(CrosstermBackend::new(io::sink()), TerminalOptions { viewport: window })?;
        Ok(Rehearsal { app, workers, sender, messages, terminal })
    }

    fn weeks(&self) -> usize {
        passed(&self.app)
    }

    /// Hands over what has to be done outside, then draws.
    fn draw(&mut self) -> io::Result<()> {
        for order in self.app.take_orders() {
            match order {
                Order::Job(job) => self.workers.send(job),
                Order::AskNow(question) => self.workers.ask_now(question),
                Order::ListRuns => self.workers.send(Job::List(self.app.runs_folder().to_owned())),
                Order::Exit(_, text) => {
                    return Err(io::Error::other(text.unwrap_or_else(|| "the console left".to_owned())));
                }
                Order::CancelQuery
                | Order::Copy(_)
                | Order::Write(..)
                | Order::SaveQuery(..)
                | Order::Redraw => {}
            }
        }
        let app = &self.app;
        let mut drawn = None;
        self.terminal.draw(|whole| drawn = Some(frame::draw(app, whole.buffer_mut())))?;
        if let Some(drawn) = drawn {
            self.app.clicks = drawn.clicks;
            self.app.page = drawn.page;
        }
        Ok(())
    }

    fn press(&mut self, key: &str) -> io::Result<()> {
        self.app.update(event(key)?);
        Ok(())
    }

    fn receive(&self) -> io::Result<Message> {
        self.messages.recv_timeout(PATIENCE).map_err(|_| io::Error::other("no answer came"))
    }

    fn until(&mut self, done: impl Fn(&App) -> bool) -> io::Result<()> {
        self.draw()?;
        while !done(&self.app) {
            let message = self.receive()?;
            self.app.update(message);
            self.draw()?;
        }
        Ok(())
    }

    /// Presses keys from another thread, as a person does, until something has happened.
    fn keys_until(&mut self, done: impl Fn(&App) -> bool) -> io::Result<Vec<f64>> {
        let (stop, stopped) = channel::<()>();
        let (press, pressed) = channel();
        let input = self.sender.clone();
        let events = KEYS.iter().map(|key| chord(key)).collect::<io::Result<Vec<_>>>()?;
        let typist = std::thread::spawn(move || {
            for key in events.iter().cycle() {
                if stopped.recv_timeout(BETWEEN_KEYS) != Err(std::sync::mpsc::RecvTimeoutError::Timeout)
                    || press.send(Instant::now()).is_err()
                    || input.send(Message::Input(Event::Key(key.event()))).is_err()
                {
                    return;
                }
            }
        });
        let mut seconds = Vec::new();
        while !done(&self.app) {
            let mut keys = 0;
            let mut next = Some(self.receive()?);
            // Everything that has arrived meanwhile is drawn once, as the console does.
            while let Some(message) = next {
                keys += usize::from(matches!(message, Message::Input(_)));
                self.app.update(message);
                next = self.messages.try_recv().ok();
            }
            self.draw()?;
            let arrived: Vec<Instant> = pressed.iter().take(keys).collect();
            seconds.extend(arrived.iter().map(|at| at.elapsed().as_secs_f64()));
        }
        drop(stop);
        let _ = typist.join();
        while let Ok(message) = self.messages.try_recv() {
            if !matches!(message, Message::Input(_)) {
                self.app.update(message);
            }
        }
        Ok(seconds)
    }
}

fn chord(key: &str) -> io::Result<Chord> {
    Chord::parse(key).map_err(io::Error::other)
}

fn event(key: &str) -> io::Result<Message> {
    Ok(Message::Input(Event::Key(chord(key)?.event())))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::console::keys::Keys;
    use crate::console::theme::Theme;
    use crate::session::{Configuration, NewRun, Session, Storage};

    fn settings(runs: &std::path::Path) -> Settings {
        let configuration = Configuration::shipped();
        Settings {
            theme: Theme::find("dark", &configuration).expect("a theme"),
            keys: Keys::shipped(),
            ascii: false,
            configuration,
            runs: runs.to_owned(),
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
            &crate::session::find_run(runs.path(), "latest").expect("the run"),
            crate::session::Access::Write,
            false,
        );
        assert_eq!(session.expect("the run").day(), 14);
    }
}
