//! The console without a terminal: the real application and its threads, drawn into cells. Tests play it, the speed
//! table measures it, and the pictures of the documentation are taken of it.

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

/// An answer that takes longer than this does not come.
const PATIENCE: Duration = Duration::from_secs(120);

/// A console that nobody sees.
pub struct Headless {
    /// The application.
    pub app: App,
    /// Columns and rows of the window.
    pub size: (u16, u16),
    /// Exit code and last words, once it has left.
    pub left: Option<(u8, Option<String>)>,
    /// What was put into the clipboard.
    pub copied: Vec<String>,
    /// Where the cursor stood in the last frame.
    pub cursor: Option<Position>,
    workers: Workers,
    sender: Sender<Message>,
    messages: Receiver<Message>,
    /// Answers that are still to come.
    waiting: u32,
}

impl Headless {
    /// A console that has shown nothing yet.
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

    /// Opens a run, to go on with it, and waits until everything about it is known.
    ///
    /// # Errors
    /// It does not open.
    pub fn open(&mut self, run: &str) -> io::Result<()> {
        self.open_with(Effect::Request(Request::Open(run.to_owned(), Access::Write)))
    }

    /// Receives participants of a study, and waits for the first page.
    ///
    /// # Errors
    /// It does not come.
    pub fn lead(&mut self, study: Study) -> io::Result<()> {
        self.app.start_with(Effect::Receive(Box::new(study)));
        self.settle()
    }

    /// Asks for something as a screen would, and waits for what follows.
    ///
    /// # Errors
    /// An answer does not come.
    pub fn request(&mut self, request: Request) -> io::Result<()> {
        self.app.start_with(Effect::Request(request));
        self.settle()
    }

    /// Opens a run, to look at it, and waits until everything about it is known.
    ///
    /// # Errors
    /// It does not open.
    pub fn look_at(&mut self, run: &str) -> io::Result<()> {
        self.open_with(Effect::Request(Request::Open(run.to_owned(), Access::Read)))
    }

    /// Plays a recorded run again from a moment on, and waits until everything about it is known.
    ///
    /// # Errors
    /// It does not open.
    pub fn replay(&mut self, recorded: Recorded, goal: Goal, follow: bool) -> io::Result<()> {
        self.open_with(Effect::Request(Request::Replay { recorded, goal, follow }))
    }

    /// Goes somewhere in the replay.
    ///
    /// # Errors
    /// It does not get there.
    pub fn go(&mut self, goal: Goal) -> io::Result<()> {
        self.open_with(Effect::Go(goal))
    }

    /// Where the replay is; none where nothing is replayed.
    pub fn place(&self) -> Option<&PlaybackPosition> {
        self.app.run()?.viewer.as_ref().map(|viewer| &viewer.place)
    }

    /// Plays a recorded run again from a moment on, and shows its hidden state where it may.
    ///
    /// # Errors
    /// It does not open.
    pub fn replay_inside(&mut self, recorded: Recorded, goal: Goal) -> io::Result<()> {
        self.open_with(Effect::ReplayInside(recorded, goal))
    }

    /// Follows a run that somebody else plays, drawn to be read from far away.
    ///
    /// # Errors
    /// It does not open.
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

    /// Where input comes from while a week runs.
    pub fn sender(&self) -> Sender<Message> {
        self.sender.clone()
    }

    /// Presses keys, written as the key file writes them, one after the other; `_` is a blank, and a word in single
    /// quotes is typed letter by letter.
    ///
    /// # Errors
    /// A key that there is not; an answer does not come.
    pub fn press(&mut self, keys: &str) -> io::Result<()> {
        for word in keys.split(' ').filter(|word| !word.is_empty()) {
            match word.strip_prefix('\'').and_then(|rest| rest.strip_suffix('\'')) {
                Some(text) => text.chars().try_for_each(|letter| self.key(&letter.to_string()))?,
                None => self.key(word)?,
            }
        }
        Ok(())
    }

    /// Presses one key and waits for what follows.
    ///
    /// # Errors
    /// There is no such key; an answer does not come.
    pub fn key(&mut self, key: &str) -> io::Result<()> {
        let event = event(if key == "_" { "space" } else { key })?;
        self.send(event)
    }

    /// Lets something happen in the window as it is drawn now, and waits for what follows.
    ///
    /// # Errors
    /// An answer does not come.
    pub fn send(&mut self, event: Event) -> io::Result<()> {
        self.draw();
        self.app.update(Message::Input(event));
        self.settle()
    }

    /// Waits until nothing is left to do.
    ///
    /// # Errors
    /// An answer does not come.
    pub fn settle(&mut self) -> io::Result<()> {
        self.hand_over();
        while self.waiting > 0 && self.left.is_none() {
            let message = self.receive()?;
            self.app.update(message);
            self.hand_over();
        }
        Ok(())
    }

    /// Waits until what was handed over without a question is done, too: notes of what the person did.
    pub fn finish_notes(&self) {
        self.workers.settle(PATIENCE);
    }

    /// The next thing that arrives.
    ///
    /// # Errors
    /// Nothing arrives.
    pub fn receive(&mut self) -> io::Result<Message> {
        let message = self.messages.recv_timeout(PATIENCE).map_err(|_| io::Error::other("no answer came"))?;
        self.count(&message);
        Ok(message)
    }

    /// The next thing that has arrived already.
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

    /// Hands over what has to be done outside.
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

    /// Draws a frame; returns its cells.
    pub fn draw(&mut self) -> Buffer {
        let mut buffer = Buffer::empty(Rect::new(0, 0, self.size.0, self.size.1));
        self.draw_into(&mut buffer);
        buffer
    }

    /// Draws a frame into cells.
    pub fn draw_into(&mut self, buffer: &mut Buffer) {
        let drawn = frame::draw(&self.app, buffer);
        self.app.clicks = drawn.clicks;
        self.app.page = drawn.page;
        self.app.window = drawn.window;
        self.cursor = drawn.cursor;
    }

    /// Lets time pass without waiting for it, and what follows.
    ///
    /// # Errors
    /// An answer does not come.
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

/// The event of a key.
///
/// # Errors
/// There is no such key.
pub fn event(key: &str) -> io::Result<Event> {
    Chord::parse(key).map(|chord| Event::Key(chord.event())).map_err(io::Error::other)
}
