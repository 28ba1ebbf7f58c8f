//! The console without a terminal, for tests. Every failure reports the whole screen.

use std::ops::{Deref, DerefMut};
use std::path::Path;

use crossterm::event::Event;
use novamind::console::app::Settings;
use novamind::console::headless::Headless;
use novamind::console::keys::KeyBindings;
use novamind::console::themes;
use novamind::record::folder::configuration::Configuration;
use novamind::tui::glyphs::Glyphs;
use ratatui::buffer::Buffer;

/// A console that a test controls.
pub struct Console {
    headless: Option<Headless>,
}

impl Deref for Console {
    type Target = Headless;

    fn deref(&self) -> &Headless {
        self.headless.as_ref().expect("it is there until it is dropped")
    }
}

impl DerefMut for Console {
    fn deref_mut(&mut self) -> &mut Headless {
        self.headless.as_mut().expect("it is there until it is dropped")
    }
}

impl Console {
    /// Starts a console in the start menu.
    pub fn start(runs: &Path, size: (u16, u16)) -> Console {
        Console::start_with(Configuration::bundled(), runs, size)
    }

    /// Starts a console in the start menu with a configuration.
    pub fn start_with(configuration: Configuration, runs: &Path, size: (u16, u16)) -> Console {
        Console::with_settings(Console::settings(configuration, runs), size)
    }

    /// Returns the settings of test consoles.
    pub fn settings(configuration: Configuration, runs: &Path) -> Settings {
        Settings {
            theme: themes::find_theme("dark", &configuration).expect("a theme"),
            keys: KeyBindings::bundled(),
            glyphs: Glyphs::Braille,
            configuration,
            runs: runs.to_owned(),
            resume_command: "novamind --run latest".to_owned(),
            lists_all_participants: false,
            hosted: false,
            opponents: novamind::lab::play_opponents,
        }
    }

    /// Starts a console in the start menu with settings.
    pub fn with_settings(settings: Settings, size: (u16, u16)) -> Console {
        let mut console = Console { headless: Some(Headless::new(settings, size)) };
        console.wait_until_idle().expect("the menu");
        console
    }

    /// Returns a console in a new run.
    pub fn in_new_run(runs: &Path, size: (u16, u16)) -> Console {
        let mut console = Console::start(runs, size);
        console.press("n enter");
        console
    }

    /// Returns a console in the latest run of a folder.
    pub fn in_latest_run(runs: &Path, size: (u16, u16)) -> Console {
        let mut console = Console::start(runs, size);
        console.open("latest").expect("the run opens");
        console
    }

    /// Presses keys in the notation of the key file; a word in quotes is typed letter by letter.
    pub fn press(&mut self, keys: &str) {
        let pressed = self.deref_mut().press_keys(keys);
        pressed.unwrap_or_else(|problem| panic!("{keys}: {problem}"));
    }

    /// Presses one key and waits until the console has processed it.
    pub fn press_key(&mut self, key: &str) {
        let pressed = self.deref_mut().press_key(key);
        pressed.unwrap_or_else(|problem| panic!("{key}: {problem}"));
    }

    /// Sends an event and waits until the console has processed it.
    pub fn send(&mut self, event: Event) {
        self.deref_mut().handle_event(event).expect("an answer");
    }

    /// Draws a frame and returns its cells.
    pub fn draw(&mut self) -> Buffer {
        let buffer = self.deref_mut().draw();
        if let Some(cursor) = self.cursor {
            assert!(buffer.area.contains(cursor), "the cursor is outside: {cursor:?}");
        }
        buffer
    }

    /// Returns the screen as text.
    pub fn screen(&mut self) -> String {
        let buffer = self.draw();
        let width = buffer.area.width;
        let row = |y| (0..width).map(|x| buffer[(x, y)].symbol()).collect::<String>().trim_end().to_owned();
        (0..buffer.area.height).map(|y| row(y) + "\n").collect()
    }

    /// Asserts that the screen contains a text.
    pub fn assert_shows(&mut self, text: &str) {
        let screen = self.screen();
        assert!(screen.contains(text), "{text:?} is not on the screen:\n{screen}");
    }

    /// Asserts that the screen does not contain a text.
    pub fn assert_hides(&mut self, text: &str) {
        let screen = self.screen();
        assert!(!screen.contains(text), "{text:?} is on the screen:\n{screen}");
    }

    /// Runs a week with the naive forecasts.
    pub fn advance_week(&mut self) {
        self.press("n enter 'test' enter f enter");
    }
}

impl Drop for Console {
    fn drop(&mut self) {
        if let Some(headless) = self.headless.take() {
            headless.finish();
        }
    }
}
