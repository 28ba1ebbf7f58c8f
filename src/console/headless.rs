//! The console without a terminal: the real application and its threads draw into a buffer. Tests, the speed benchmark
//! and the pictures of the documentation use the console without a terminal.

use std::io;
use std::sync::mpsc::{Receiver, Sender, channel};
use std::time::Duration;

use crossterm::event::Event;
use ratatui::buffer::Buffer;
use ratatui::layout::{Position, Rect};

use super::app::{App, Order, Settings};
use super::context::EditorDocument;
use super::effect::Effect;
use super::files;
use super::own_commands;
use novamind_record::trajectory::record::DetachCause;
use novamind_session::{Access, PlaybackPosition, SeekTarget};
use novamind_study::Study;
use novamind_tui::chord::Chord;
use novamind_worker::message::{Message, Response, StudyResponse};
use novamind_worker::request::{RecordSource, Request, StudyRequest};
use novamind_worker::{Job, Workers};

const RESPONSE_TIMEOUT: Duration = Duration::from_secs(120);

/// A console without a terminal.
pub struct Headless {
    /// The application that draws into the buffer.
    pub app: App,
    /// Columns and rows of the window.
    pub size: (u16, u16),
    /// Exit code and final text, after the console has exited.
    pub exit: Option<(u8, Option<String>)>,
    /// Texts that were copied to the clipboard.
    pub clipboard: Vec<String>,
    /// The text that was opened last in the user's editor.
    pub editor_document: Option<EditorDocument>,
    /// Cursor position in the last frame.
    pub cursor: Option<Position>,
    workers: Workers,
    sender: Sender<Message>,
    messages: Receiver<Message>,
    /// Number of responses that have not arrived yet.
    pending_responses: u32,
}

impl Headless {
    /// Returns a console that has not drawn a frame yet.
    pub fn new(settings: Settings, size: (u16, u16)) -> Headless {
        let (sender, messages) = channel();
        let workers = Workers::start(
            sender.clone(),
            settings.configuration.clone(),
            settings.runs.clone(),
            settings.lists_all_participants,
        );
        let mut app = App::new(settings);
        app.window = size;
        Headless {
            app,
            size,
            exit: None,
            clipboard: Vec::new(),
            editor_document: None,
            cursor: None,
            workers,
            sender,
            messages,
            pending_responses: 0,
        }
    }

    /// Opens a run for play and waits until all its data has arrived.
    ///
    /// # Errors
    /// The run does not open.
    pub fn open(&mut self, run: &str) -> io::Result<()> {
        self.open_with(Effect::Request(Request::Open(run.to_owned(), Access::Write)))
    }

    /// Opens a study for participants and waits for the first page.
    ///
    /// # Errors
    /// The page does not arrive.
    pub fn start_study(&mut self, study: Study) -> io::Result<()> {
        self.app.start(Effect::StartStudy(Box::new(study)));
        self.wait_until_idle()
    }

    /// Starts the hosted session of the participant with a label and waits for the first page.
    ///
    /// # Errors
    /// The page does not arrive.
    pub fn start_hosted_session(&mut self, study: Study, label: &str) -> io::Result<()> {
        self.app.start(Effect::StartHostedSession(Box::new(study), label.to_owned()));
        self.wait_until_idle()
    }

    /// Sends a request as a screen would, and waits for all responses.
    ///
    /// # Errors
    /// A response does not arrive.
    pub fn request(&mut self, request: Request) -> io::Result<()> {
        self.app.start(Effect::Request(request));
        self.wait_until_idle()
    }

    /// Opens a run read-only and waits until all its data has arrived.
    ///
    /// # Errors
    /// The run does not open.
    pub fn open_read_only(&mut self, run: &str) -> io::Result<()> {
        self.open_with(Effect::Request(Request::Open(run.to_owned(), Access::Read)))
    }

    /// Replays a recorded run from a position and waits until all its data has arrived.
    ///
    /// # Errors
    /// The run does not open.
    pub fn replay(&mut self, recorded: RecordSource, goal: SeekTarget, follow: bool) -> io::Result<()> {
        self.open_with(Effect::Request(Request::Replay { recorded, goal, follow }))
    }

    /// Seeks in the playback.
    ///
    /// # Errors
    /// The position is not reached.
    pub fn seek(&mut self, goal: SeekTarget) -> io::Result<()> {
        self.open_with(Effect::Seek(goal))
    }

    /// Returns the position of the playback, or `None` if no playback is open.
    pub fn playback_position(&self) -> Option<&PlaybackPosition> {
        self.app.run()?.playback.as_ref().map(|viewer| &viewer.position)
    }

    /// Replays a recorded run from a position, with its hidden state if permitted.
    ///
    /// # Errors
    /// The run does not open.
    pub fn replay_with_xray(&mut self, recorded: RecordSource, goal: SeekTarget) -> io::Result<()> {
        self.open_with(Effect::ReplayWithXray(recorded, goal))
    }

    /// Follows a run that another program plays, drawn for a projector.
    ///
    /// # Errors
    /// The run does not open.
    pub fn open_projector(&mut self, recorded: RecordSource) -> io::Result<()> {
        self.open_with(Effect::OpenProjector(recorded))
    }

    fn open_with(&mut self, effect: Effect) -> io::Result<()> {
        self.app.start(effect);
        self.wait_until_idle()?;
        match (self.app.run(), &self.app.status) {
            (Some(_), _) => Ok(()),
            (None, Some(note)) => Err(io::Error::other(note.text.clone())),
            (None, None) => Err(io::Error::other("the run did not open")),
        }
    }

    /// Returns the sender of messages, for input while a week runs.
    pub fn sender(&self) -> Sender<Message> {
        self.sender.clone()
    }

    /// Presses keys in the notation of the key file, separated by spaces. `_` is the space key. A word in single
    /// quotes is typed letter by letter.
    ///
    /// # Errors
    /// A key does not exist, or a response does not arrive.
    pub fn press_keys(&mut self, keys: &str) -> io::Result<()> {
        for word in keys.split(' ').filter(|word| !word.is_empty()) {
            match word.strip_prefix('\'').and_then(|rest| rest.strip_suffix('\'')) {
                Some(text) => text.chars().try_for_each(|letter| self.press_key(&letter.to_string()))?,
                None => self.press_key(word)?,
            }
        }
        Ok(())
    }

    /// Presses one key and waits for all responses.
    ///
    /// # Errors
    /// The key does not exist, or a response does not arrive.
    pub fn press_key(&mut self, key: &str) -> io::Result<()> {
        let event = key_event(if key == "_" { "space" } else { key })?;
        self.handle_event(event)
    }

    /// Draws a frame, handles an event, and waits for all responses.
    ///
    /// # Errors
    /// A response does not arrive.
    pub fn handle_event(&mut self, event: Event) -> io::Result<()> {
        self.draw();
        self.app.handle_message(Message::Input(event));
        self.wait_until_idle()
    }

    /// Waits until all responses have arrived.
    ///
    /// # Errors
    /// A response does not arrive.
    pub fn wait_until_idle(&mut self) -> io::Result<()> {
        self.dispatch_orders();
        while self.pending_responses > 0 && self.exit.is_none() {
            let message = self.receive()?;
            self.app.handle_message(message);
            self.dispatch_orders();
        }
        Ok(())
    }

    /// Waits until all jobs are done, including jobs without a response, such as recording activity.
    pub fn wait_for_jobs(&self) {
        self.workers.wait_for_jobs(RESPONSE_TIMEOUT);
    }

    /// Waits for the next message and returns the message.
    ///
    /// # Errors
    /// No message arrives.
    pub fn receive(&mut self) -> io::Result<Message> {
        let message = self
            .messages
            .recv_timeout(RESPONSE_TIMEOUT)
            .map_err(|_| io::Error::other("no response arrived"))?;
        self.count_response(&message);
        Ok(message)
    }

    /// Returns the next message if one has arrived.
    pub fn try_receive(&mut self) -> Option<Message> {
        let message = self.messages.try_recv().ok()?;
        self.count_response(&message);
        Some(message)
    }

    fn count_response(&mut self, message: &Message) {
        let is_answer = match message {
            Message::Delivered(delivery) => delivery.is_answer,
            Message::Response(news) => !matches!(
                news,
                Response::ClockStopped
                    | Response::HandoutOpened(_)
                    | Response::Drafts(_)
                    | Response::TimeLeft(_)
                    | Response::Limit(_)
                    | Response::DaySimulated(..)
                    | Response::PlaybackAdvanced(_)
                    | Response::RunChanged(_)
                    | Response::DatabaseBehind(_)
                    | Response::DatabaseCurrent
                    | Response::Study(StudyResponse::QuestionsDue(_))
            ),
            Message::Input(_) | Message::Signal(_) | Message::EditorClosed(_) | Message::RedrawDue => false,
        };
        self.pending_responses -= u32::from(is_answer).min(self.pending_responses);
    }

    /// Executes the collected orders of the application.
    pub fn dispatch_orders(&mut self) {
        for order in self.app.take_orders() {
            match order {
                Order::Job(job) => {
                    let silent = matches!(
                        job,
                        Job::RecordQuery(..)
                            | Job::RecordActivity(_)
                            | Job::Attach(_)
                            | Job::StartClock
                            | Job::ScheduleNextWeek(_)
                            | Job::CancelNextWeek
                            | Job::SavePreferences(_)
                            | Job::Execute(Request::Study(StudyRequest::RecordShownQuestion(_)))
                    );
                    self.pending_responses += u32::from(!silent);
                    self.workers.send(job);
                }
                Order::Ask(ask, is_busy) => {
                    self.pending_responses += 1;
                    self.workers.ask(&ask, is_busy);
                }
                Order::Write(written) => {
                    self.pending_responses += 1;
                    files::write_in_background(written, self.sender.clone());
                }
                Order::SaveQuery(configuration, query) => {
                    self.pending_responses += 1;
                    files::save_query_in_background(configuration, query, self.sender.clone());
                }
                Order::RunProgram(call) => {
                    self.pending_responses += 1;
                    own_commands::run_in_background(call, self.sender.clone());
                }
                Order::Copy(text) => self.clipboard.push(text),
                Order::Exit(code, text) => self.exit = Some((code, text)),
                Order::OpenEditor(document) => self.editor_document = Some(document),
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
        self.cursor = self.app.draw(buffer);
    }

    /// Advances the time and waits for all responses.
    ///
    /// # Errors
    /// A response does not arrive.
    pub fn advance_time(&mut self, time: Duration) -> io::Result<()> {
        self.app.stopwatch.advance(time);
        self.app.handle_message(Message::RedrawDue);
        self.wait_until_idle()
    }

    /// Saves the run and ends the threads.
    pub fn finish(self) {
        self.workers.send(Job::Close(DetachCause::Quit));
        self.workers.shut_down();
    }
}

/// Returns the event of a key.
///
/// # Errors
/// The key does not exist.
pub fn key_event(key: &str) -> io::Result<Event> {
    Chord::parse(key).map(|chord| Event::Key(chord.to_event())).map_err(io::Error::other)
}
