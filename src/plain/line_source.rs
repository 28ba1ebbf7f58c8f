//! Reads lines on a separate thread, so that a signal or a time limit can end the wait.

use std::io;
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, channel};
use std::time::Duration;

use super::end_reason::EndReason;
use super::input::{Input, InputLine};
use super::signals::{Phase, SignalWatch};
use novamind_record::clock::monotonic_time;
use novamind_session::{IdleWatch, Session};

/// An event that ends the wait for a line.
enum LineEvent {
    /// The number of a line, and the result of reading the line.
    Line(u32, io::Result<InputLine>),
    /// A signal that ends the session.
    Signal(i32),
}

/// A source of input lines. A separate thread reads each line on request.
pub struct LineSource {
    requests: Sender<()>,
    events: Receiver<LineEvent>,
    watch: SignalWatch,
    /// Whether a line has been requested and has not arrived yet.
    is_requested: bool,
    idle: IdleWatch,
    number: u32,
}

impl LineSource {
    /// Reads from standard input and starts watching for signals.
    pub fn from_stdin() -> LineSource {
        let (sender, events) = channel();
        let signals = sender.clone();
        let watch = SignalWatch::start(move |signal| drop(signals.send(LineEvent::Signal(signal))));
        let (wanted, wants) = channel();
        std::thread::spawn(move || {
            let mut input = Input::new(io::stdin().lock());
            while wants.recv().is_ok() {
                let (number, read) = (input.next_number(), input.read_line());
                if sender.send(LineEvent::Line(number, read)).is_err() {
                    return;
                }
            }
        });
        LineSource {
            requests: wanted,
            events,
            watch,
            is_requested: false,
            idle: IdleWatch::default(),
            number: 1,
        }
    }

    /// Returns the signal watch of the session.
    pub fn signal_watch(&self) -> SignalWatch {
        self.watch.clone()
    }

    /// Returns the reason why the session ends when no more lines are available.
    pub fn end_reason(&self) -> EndReason {
        self.watch.caught_signal().map_or(EndReason::EndOfInput, EndReason::Signal)
    }

    /// Returns the number of the last line that was read, counted from 1.
    pub fn line_number(&self) -> u32 {
        self.number
    }

    /// Returns whether a requested line has not arrived yet.
    pub fn is_waiting(&self) -> bool {
        self.is_requested
    }

    /// Waits for a line. After a signal, returns the end of input. The signal watch then returns the signal.
    ///
    /// # Errors
    /// Standard input cannot be read.
    pub fn read_line(&mut self) -> io::Result<InputLine> {
        loop {
            if let Some(read) = self.read_line_timeout(None)? {
                return Ok(read);
            }
        }
    }

    /// Waits for a line for at most this duration. Returns `None` if no line has arrived.
    ///
    /// # Errors
    /// Standard input cannot be read.
    pub fn read_line_timeout(&mut self, at_most: Option<Duration>) -> io::Result<Option<InputLine>> {
        if self.watch.caught_signal().is_some() {
            return Ok(Some(InputLine::End));
        }
        if !std::mem::replace(&mut self.is_requested, true) {
            // Sending cannot fail, because the reading thread runs until the program ends.
            let _ = self.requests.send(());
        }
        if !self.watch.enter_prompt() {
            return Ok(Some(InputLine::End));
        }
        let event = self.next_event(at_most);
        self.watch.set_phase(Phase::Working);
        match event {
            None => Ok(None),
            Some(LineEvent::Signal(number)) => {
                self.watch.record_signal(number);
                Ok(Some(InputLine::End))
            }
            Some(LineEvent::Line(number, read)) => {
                (self.is_requested, self.number) = (false, number);
                read.map(Some)
            }
        }
    }

    /// Waits for a line for at most this duration, and records when the player becomes idle and returns. Returns `None`
    /// if no line has arrived.
    ///
    /// # Errors
    /// Standard input cannot be read.
    pub fn read_watched_line(
        &mut self,
        session: &mut Session,
        at_most: Option<Duration>,
    ) -> io::Result<Option<InputLine>> {
        if !self.is_requested {
            // The program was busy until now, so the player was not idle.
            self.idle.start(monotonic_time());
        }
        let until_idle = self.idle.next_deadline().map(|due| due.saturating_sub(monotonic_time()));
        let at_most = [at_most, until_idle].into_iter().flatten().min();
        let read = self.read_line_timeout(at_most)?;
        let event = match &read {
            None => self.idle.check_time(monotonic_time()),
            Some(InputLine::End) => None,
            Some(_) => self.idle.handle_input(monotonic_time()),
        };
        if let Some((event, idle_ms)) = event.filter(|_| !session.log().is_clock_stopped()) {
            session.activity().record_presence(event, Some(idle_ms), None);
        }
        Ok(read)
    }

    /// Waits for a line, and records when the player becomes idle and returns.
    ///
    /// # Errors
    /// Standard input cannot be read.
    pub fn wait_for_line(&mut self, session: &mut Session) -> io::Result<InputLine> {
        loop {
            if let Some(read) = self.read_watched_line(session, None)? {
                return Ok(read);
            }
        }
    }

    fn next_event(&self, at_most: Option<Duration>) -> Option<LineEvent> {
        let end = || LineEvent::Line(self.number, Ok(InputLine::End));
        match at_most {
            None => Some(self.events.recv().unwrap_or_else(|_| end())),
            Some(time) => match self.events.recv_timeout(time) {
                Ok(event) => Some(event),
                Err(RecvTimeoutError::Timeout) => None,
                Err(RecvTimeoutError::Disconnected) => Some(end()),
            },
        }
    }
}
