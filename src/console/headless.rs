//! The console without a terminal: the real application and its threads, drawn into a buffer. Used by tests, by the
//! speed benchmark and for the pictures of the documentation.

use std::io;
use std::sync::mpsc::{Receiver, Sender, channel};
use std::time::Duration;

use crossterm::event::Event;
use ratatui::buffer::Buffer;
use ratatui::layout::{Position, Rect};

use super::app::{App, Order, Settings};
use super::effect::Effect;
use super::files;
use super::frame;
use novamind_record::trajectory::record::LeavingCause;
use novamind_session::{Access, Goal, PlaybackPosition};
use novamind_study::Study;
use novamind_tui::chord::Chord;
use novamind_worker::message::{Message, News, VisitNews};
use novamind_worker::request::{Recorded, Request, VisitRequest};
use novamind_worker::{Job, Workers};

const PATIENCE: Duration = Duration::from_secs(120);

/// A console without a terminal.
pub struct Headless {
    /// The application.
    pub app: App,
    /// Columns and rows of the window.
    pub size: (u16, u16),
    /// Exit code and final text, after it has exited.
    pub left: Option<(u8, Option<String>)>,
    /// Texts that were copied to the clipboard.
    pub copied: Vec<String>,
    /// Cursor position in the last frame.
    pub cursor: Option<Position>,
    workers: Workers,
    sender: Sender<Message>,
    messages: Receiver<Message>,
    /// Number of awaited responses.
    waiting: u32,
}

impl Headless {
    /// Returns a console that has drawn nothing yet.
    pub fn new(settings: Settings, size: (u16, u16)) -> Headless {
        let (sender, messages) = channel();
        let workers = Workers::start(
            sender.clone(),
            settings.configuration.clone(),
            settings.runs.clone(),
            settings.lists_everybody,
        );
        let mut app = App::new(settings);
        app.window = size;
        Headless {
            app,
            size,
            left: None,
            copied: Vec::new(),
            cursor: None,
            workers,
            sender,
            messages,
            waiting: 0,
        }
    }

    /// Opens a run for play and waits until all its data has arrived.
    ///
    /// # Errors
    /// The run does not open.
    pub fn open(&mut self, run: &str) -> io::Result<()> {
        self.open_with(Effect::Request(Request::Open(run.to_owned(), Access::Write)))
    }

    /// Starts receiving participants of a study and waits for the first page.
    ///
    /// # Errors
    /// The page does not arrive.
    pub fn lead(&mut self, study: Study) -> io::Result<()> {
        self.app.start_with(Effect::Receive(Box::new(study)));
        self.settle()
    }

    /// Sends a request as a screen would, and waits for its consequences.
    ///
    /// # Errors
    /// A response does not arrive.
    pub fn request(&mut self, request: Request) -> io::Result<()> {
        self.app.start_with(Effect::Request(request));
        self.settle()
    }

    /// Opens a run read-only and waits until all its data has arrived.
    ///
    /// # Errors
    /// The run does not open.
    pub fn look_at(&mut self, run: &str) -> io::Result<()> {
        self.open_with(Effect::Request(Request::Open(run.to_owned(), Access::Read)))
    }

    /// Replays a recorded run from a position and waits until all its data has arrived.
    ///
    /// # Errors
    /// The run does not open.
    pub fn replay(&mut self, recorded: Recorded, goal: Goal, follow: bool) -> io::Result<()> {
        self.open_with(Effect::Request(Request::Replay { recorded, goal, follow }))
    }

    /// Seeks in the playback.
    ///
    /// # Errors
    /// The position is not reached.
    pub fn go(&mut self, goal: Goal) -> io::Result<()> {
        self.open_with(Effect::Go(goal))
    }

    /// Returns the position of the playback, or `None` if nothing is replayed.
    pub fn place(&self) -> Option<&PlaybackPosition> {
        self.app.run()?.viewer.as_ref().map(|viewer| &viewer.place)
    }

    /// Replays a recorded run from a position, with its hidden state if permitted.
    ///
    /// # Errors
    /// The run does not open.
    pub fn replay_inside(&mut self, recorded: Recorded, goal: Goal) -> io::Result<()> {
        self.open_with(Effect::ReplayInside(recorded, goal))
    }

    /// Follows a run that another program plays, drawn for a projector.
    ///
    /// # Errors
    /// The run does not open.
    pub fn project(&mut self, recorded: Recorded) -> io::Result<()> {
        self.open_with(Effect::Project(recorded))
    }

    fn open_with(&mut self, effect: Effect) -> io::Result<()> {
        self.app.start_with(effect);
        self.settle()?;
        match (self.app.run(), &self.app.note) {
            (Some(_), _) => Ok(()),
            (None, Some(note)) => Err(io::Error::other(note.text.clone())),
            (None, None) => Err(io::Error::other("the run did not open")),
        }
    }

    /// Returns the sender of messages, for input while a week runs.
    pub fn sender(&self) -> Sender<Message> {
        self.sender.clone()
    }

    /// Presses keys in the notation of the key file, separated by spaces; `_` is the space key, and a word in single
    /// quotes is typed letter by letter.
    ///
    /// # Errors
    /// A key does not exist, or a response does not arrive.
    pub fn press(&mut self, keys: &str) -> io::Result<()> {
        for word in keys.split(' ').filter(|word| !word.is_empty()) {
            match word.strip_prefix('\'').and_then(|rest| rest.strip_suffix('\'')) {
                Some(text) => text.chars().try_for_each(|letter| self.key(&letter.to_string()))?,
                None => self.key(word)?,
            }
        }
        Ok(())
    }

    /// Presses one key and waits for its consequences.
    ///
    /// # Errors
    /// The key does not exist, or a response does not arrive.
    pub fn key(&mut self, key: &str) -> io::Result<()> {
        let event = event(if key == "_" { "space" } else { key })?;
        self.send(event)
    }

    /// Draws a frame, handles an event in it, and waits for the consequences.
    ///
    /// # Errors
    /// A response does not arrive.
    pub fn send(&mut self, event: Event) -> io::Result<()> {
        self.draw();
        self.app.update(Message::Input(event));
        self.settle()
    }

    /// Waits until no response is awaited.
    ///
    /// # Errors
    /// A response does not arrive.
    pub fn settle(&mut self) -> io::Result<()> {
        self.hand_over();
        while self.waiting > 0 && self.left.is_none() {
            let message = self.receive()?;
            self.app.update(message);
            self.hand_over();
        }
        Ok(())
    }

    /// Waits until jobs without a response are done too, such as recorded activity.
    pub fn finish_notes(&self) {
        self.workers.settle(PATIENCE);
    }

    /// Returns the next message, waiting for it.
    ///
    /// # Errors
    /// No message arrives.
    pub fn receive(&mut self) -> io::Result<Message> {
        let message =
            self.messages.recv_timeout(PATIENCE).map_err(|_| io::Error::other("no response arrived"))?;
        self.count(&message);
        Ok(message)
    }

    /// Returns the next message if one has arrived.
    pub fn received(&mut self) -> Option<Message> {
        let message = self.messages.try_recv().ok()?;
        self.count(&message);
        Some(message)
    }

    fn count(&mut self, message: &Message) {
        let is_answer = match message {
            Message::Arrived(delivery) => delivery.is_answer,
            Message::News(news) => !matches!(
                news,
                News::Held
                    | News::HandedOut(_)
                    | News::Unsent(_)
                    | News::TimeLeft(_)
                    | News::Limit(_)
                    | News::Day(..)
                    | News::WentOn(_)
                    | News::Changed(_)
                    | News::DatabaseBehind(_)
                    | News::DatabaseWhole
                    | News::Visit(VisitNews::Due(_))
            ),
            Message::Input(_) | Message::Signal(_) | Message::Time => false,
        };
        self.waiting -= u32::from(is_answer).min(self.waiting);
    }

    /// Executes the orders of the application.
    pub fn hand_over(&mut self) {
        for order in self.app.take_orders() {
            match order {
                Order::Job(job) => {
                    let silent = matches!(
                        job,
                        Job::NoteQuery(..)
                            | Job::Note(_)
                            | Job::TakeUp(_)
                            | Job::StartClock
                            | Job::GoOn(_)
                            | Job::Hold
                            | Job::Remember(_)
                            | Job::Do(Request::Visit(VisitRequest::Ask(_)))
                    );
                    self.waiting += u32::from(!silent);
                    self.workers.send(job);
                }
                Order::Ask(ask, is_busy) => {
                    self.waiting += 1;
                    self.workers.ask(&ask, is_busy);
                }
                Order::Write(written) => {
                    self.waiting += 1;
                    files::write_behind(written, self.sender.clone());
                }
                Order::SaveQuery(configuration, query) => {
                    self.waiting += 1;
                    files::save_query_behind(configuration, query, self.sender.clone());
                }
                Order::Copy(text) => self.copied.push(text),
                Order::Exit(code, text) => self.left = Some((code, text)),
                Order::CancelQuery | Order::Redraw | Order::Mouse(_) => {}
            }
        }
    }

    /// Draws a frame into a new buffer.
    pub fn draw(&mut self) -> Buffer {
        let mut buffer = Buffer::empty(Rect::new(0, 0, self.size.0, self.size.1));
        self.draw_into(&mut buffer);
        buffer
    }

    /// Draws a frame into a buffer.
    pub fn draw_into(&mut self, buffer: &mut Buffer) {
        let drawn = frame::draw(&self.app, buffer);
        self.app.clicks = drawn.clicks;
        self.app.page = drawn.page;
        self.app.window = drawn.window;
        self.cursor = drawn.cursor;
    }

    /// Advances the time and waits for the consequences.
    ///
    /// # Errors
    /// A response does not arrive.
    pub fn pass(&mut self, time: Duration) -> io::Result<()> {
        self.app.stopwatch.turn_on(time);
        self.app.update(Message::Time);
        self.settle()
    }

    /// Saves the run and ends the threads.
    pub fn finish(self) {
        self.workers.send(Job::Close(LeavingCause::Quit));
        self.workers.finish();
    }
}

/// Returns the event of a key.
///
/// # Errors
/// The key does not exist.
pub fn event(key: &str) -> io::Result<Event> {
    Chord::parse(key).map(|chord| Event::Key(chord.event())).map_err(io::Error::other)
}
