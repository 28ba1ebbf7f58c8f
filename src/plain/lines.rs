//! Reads lines on a separate thread, so that a signal or a time limit can end the wait.

use std::io;
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, channel};
use std::time::Duration;

use super::ending::End;
use super::input::{Input, Read};
use super::signals::{Phase, Watch};

/// An event that ends a wait.
enum Event {
    /// A line with its number.
    Line(u32, io::Result<Read>),
    /// A signal that asks to leave.
    Signal(i32),
}

/// Input lines, each read on request.
pub struct Lines {
    wanted: Sender<()>,
    events: Receiver<Event>,
    watch: Watch,
    /// A line was requested and has not arrived.
    asked: bool,
    number: u32,
}

impl Lines {
    /// Reads from standard input and starts watching for signals.
    pub fn of_standard_input() -> Lines {
        let (sender, events) = channel();
        let signals = sender.clone();
        let watch = Watch::start(move |signal| drop(signals.send(Event::Signal(signal))));
        let (wanted, wants) = channel();
        std::thread::spawn(move || {
            let mut input = Input::new(io::stdin().lock());
            while wants.recv().is_ok() {
                let (number, read) = (input.next_number(), input.read());
                if sender.send(Event::Line(number, read)).is_err() {
                    return;
                }
            }
        });
        Lines { wanted, events, watch, asked: false, number: 1 }
    }

    /// Returns the signal watch.
    pub fn watch(&self) -> Watch {
        self.watch.clone()
    }

    /// Returns how the session ends when there are no more lines.
    pub fn end(&self) -> End {
        self.watch.caught().map_or(End::InputOver, End::Signal)
    }

    /// Returns the number of the last line read, from 1.
    pub fn number(&self) -> u32 {
        self.number
    }

    /// Returns whether a requested line has not arrived yet.
    pub fn is_waiting(&self) -> bool {
        self.asked
    }

    /// Waits for a line. Returns the end of input after a signal, which the watch reports.
    ///
    /// # Errors
    /// The source fails.
    pub fn read(&mut self) -> io::Result<Read> {
        loop {
            if let Some(read) = self.wait(None)? {
                return Ok(read);
            }
        }
    }

    /// Waits for a line at most for a duration. Returns `None` if none arrived.
    ///
    /// # Errors
    /// The source fails.
    pub fn wait(&mut self, at_most: Option<Duration>) -> io::Result<Option<Read>> {
        if self.watch.caught().is_some() {
            return Ok(Some(Read::End));
        }
        if !std::mem::replace(&mut self.asked, true) {
            // The thread ends with the program.
            let _ = self.wanted.send(());
        }
        if !self.watch.enter_prompt() {
            return Ok(Some(Read::End));
        }
        let event = self.next(at_most);
        self.watch.enter(Phase::Working);
        match event {
            None => Ok(None),
            Some(Event::Signal(number)) => {
                self.watch.catch(number);
                Ok(Some(Read::End))
            }
            Some(Event::Line(number, read)) => {
                (self.asked, self.number) = (false, number);
                read.map(Some)
            }
        }
    }

    fn next(&self, at_most: Option<Duration>) -> Option<Event> {
        let end = || Event::Line(self.number, Ok(Read::End));
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
