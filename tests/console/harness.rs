//! The console without a terminal: the real application and its threads, drawn into a buffer.

use std::path::Path;
use std::sync::mpsc::{Receiver, channel};
use std::time::Duration;

use crossterm::event::Event;
use novamind::console::app::{App, Order, Settings};
use novamind::console::frame;
use novamind::console::keys::{Chord, Keys};
use novamind::console::message::{Message, News};
use novamind::console::theme::Theme;
use novamind::console::worker::{Job, Workers};
use novamind::session::Configuration;
use ratatui::buffer::Buffer;
use ratatui::layout::Rect;

/// A console that is played by a test.
pub struct Console {
    /// The application.
    pub app: App,
    workers: Option<Workers>,
    messages: Receiver<Message>,
    /// Width and height of the window.
    pub size: (u16, u16),
    /// Answers that are still to come.
    waiting: u32,
    /// Exit code, once it has left.
    pub left: Option<u8>,
    /// What was put into the clipboard.
    pub copied: Vec<String>,
}

impl Console {
    /// A console in its start menu.
    pub fn start(runs: &Path, size: (u16, u16)) -> Console {
        let configuration = Configuration::shipped();
        let (sender, messages) = channel();
        let workers = Workers::start(sender, configuration.clone());
        let settings = Settings {
            theme: Theme::find("dark", &configuration).expect("a theme"),
            keys: Keys::shipped(),
            ascii: false,
            configuration,
            runs: runs.to_owned(),
        };
        let mut console = Console {
            app: App::new(settings),
            workers: Some(workers),
            messages,
            size,
            waiting: 0,
            left: None,
            copied: Vec::new(),
        };
        console.settle();
        console
    }

    /// A console in a new run.
    pub fn in_new_run(runs: &Path, size: (u16, u16)) -> Console {
        let mut console = Console::start(runs, size);
        console.press("n enter");
        console
    }

    /// Presses keys, written as the key file writes them; a word in quotes is typed letter by letter.
    pub fn press(&mut self, keys: &str) {
        for word in keys.split(' ').filter(|word| !word.is_empty()) {
            match word.strip_prefix('\'').and_then(|rest| rest.strip_suffix('\'')) {
                Some(text) => text.chars().for_each(|letter| self.key(&letter.to_string())),
                None => self.key(word),
            }
        }
    }

    /// Presses one key and waits for what follows.
    pub fn key(&mut self, key: &str) {
        let key = if key == "_" { "space" } else { key };
        let chord = Chord::parse(key).unwrap_or_else(|problem| panic!("{problem}"));
        self.send(Event::Key(chord.event()));
    }

    /// Lets an event happen and waits for what follows.
    pub fn send(&mut self, event: Event) {
        self.draw();
        self.app.update(Message::Input(event));
        self.settle();
    }

    fn settle(&mut self) {
        loop {
            for order in self.app.take_orders() {
                self.carry_out(order);
            }
            if self.waiting == 0 || self.left.is_some() {
                return;
            }
            let message =
                self.messages.recv_timeout(Duration::from_secs(60)).expect("an answer within a minute");
            if !matches!(&message, Message::News(News::Day(..))) {
                self.waiting -= 1;
            }
            self.app.update(message);
        }
    }

    fn carry_out(&mut self, order: Order) {
        let workers = self.workers.as_ref().expect("threads");
        match order {
            Order::Job(job) => {
                self.waiting += u32::from(!matches!(job, Job::NoteQuery(..) | Job::NoteView(..)));
                workers.send(job);
            }
            Order::AskNow(question) => {
                self.waiting += 1;
                workers.ask_now(question);
            }
            Order::ListRuns => {
                self.waiting += 1;
                workers.send(Job::List(self.app.runs_folder().to_owned()));
            }
            Order::Copy(text) => self.copied.push(text),
            Order::Write(files) => {
                for (path, contents) in files {
                    std::fs::write(path, contents).expect("written");
                }
            }
            Order::Exit(code, _) => self.left = Some(code),
            Order::CancelQuery | Order::Redraw => {}
        }
    }

    /// Draws a frame; returns its cells.
    pub fn draw(&mut self) -> Buffer {
        let mut buffer = Buffer::empty(Rect::new(0, 0, self.size.0, self.size.1));
        let drawn = frame::draw(&self.app, &mut buffer);
        self.app.clicks = drawn.clicks;
        self.app.page = drawn.page;
        if let Some(cursor) = drawn.cursor {
            assert!(buffer.area.contains(cursor), "the cursor is outside: {cursor:?}");
        }
        buffer
    }

    /// The screen as text.
    pub fn screen(&mut self) -> String {
        let buffer = self.draw();
        let row =
            |y| (0..self.size.0).map(|x| buffer[(x, y)].symbol()).collect::<String>().trim_end().to_owned();
        (0..self.size.1).map(|y| row(y) + "\n").collect()
    }

    /// Fails with the whole screen if it does not show some text.
    pub fn shows(&mut self, text: &str) {
        let screen = self.screen();
        assert!(screen.contains(text), "{text:?} is not on the screen:\n{screen}");
    }

    /// Lets a week pass with the naive forecasts.
    pub fn week(&mut self) {
        self.press("n enter 'test' enter f enter");
    }
}

impl Drop for Console {
    fn drop(&mut self) {
        if let Some(workers) = self.workers.take()
            && !std::thread::panicking()
        {
            workers.finish();
        }
    }
}
