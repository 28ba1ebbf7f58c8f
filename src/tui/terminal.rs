//! The terminal: prepared once, restored whatever happens.

use std::io::{self, Stdout, Write};
use std::sync::Mutex;

use crossterm::clipboard::CopyToClipboard;
use crossterm::event::{
    DisableBracketedPaste, DisableFocusChange, DisableMouseCapture, EnableBracketedPaste, EnableFocusChange,
    EnableMouseCapture,
};
use crossterm::execute;
use crossterm::terminal::{
    BeginSynchronizedUpdate, EndSynchronizedUpdate, EnterAlternateScreen, LeaveAlternateScreen,
    disable_raw_mode, enable_raw_mode,
};
use ratatui::Terminal;
use ratatui::backend::CrosstermBackend;

use ratatui::buffer::Buffer;
use ratatui::layout::Position;

/// The terminal while the console has it; given back when this is dropped.
pub struct TerminalScreen {
    terminal: Terminal<CrosstermBackend<Stdout>>,
}

/// Line printed after the message of a panic.
static PANIC_NOTE: Mutex<Option<String>> = Mutex::new(None);

/// Sets the line printed after the message of a panic, for example where the user's work is saved.
pub fn set_panic_note(note: Option<String>) {
    *PANIC_NOTE.lock().unwrap_or_else(|poisoned| poisoned.into_inner()) = note;
}

impl TerminalScreen {
    /// Takes the terminal. If the main thread panics, the terminal is given back before the message is printed.
    ///
    /// # Errors
    /// It does not let itself be taken.
    pub fn take() -> io::Result<TerminalScreen> {
        let taken = prepare().and_then(|()| Terminal::new(CrosstermBackend::new(io::stdout())));
        let terminal = taken.inspect_err(|_| restore())?;
        let usual = std::panic::take_hook();
        std::panic::set_hook(Box::new(move |panic| {
            // The application handles panics of its other threads itself.
            if std::thread::current().name() == Some("main") {
                restore();
                usual(panic);
                let note = PANIC_NOTE.lock().unwrap_or_else(|poisoned| poisoned.into_inner());
                if let Some(note) = &*note {
                    eprintln!("{note}");
                }
            }
        }));
        Ok(TerminalScreen { terminal })
    }

    /// Gives the terminal back and stops the program until it is continued; then takes the terminal again.
    ///
    /// # Errors
    /// The terminal does not let itself be taken.
    #[cfg(unix)]
    pub fn suspend(&mut self, mouse: bool) -> io::Result<()> {
        restore();
        signal_hook::low_level::emulate_default_handler(signal_hook::consts::SIGTSTP)?;
        self.resume(mouse)
    }

    /// Takes the terminal again after the program was stopped: whoever stopped it may have changed the terminal.
    ///
    /// # Errors
    /// It does not let itself be taken.
    #[cfg(unix)]
    pub fn resume(&mut self, mouse: bool) -> io::Result<()> {
        // Raw mode that is believed to be on is not turned on again.
        let _ = disable_raw_mode();
        prepare()?;
        self.mouse(mouse);
        self.clear()
    }

    /// Draws a frame with `paint`, which returns where the cursor is shown.
    ///
    /// # Errors
    /// The terminal does not take it.
    pub fn draw(&mut self, paint: impl FnOnce(&mut Buffer) -> Option<Position>) -> io::Result<()> {
        execute!(self.terminal.backend_mut(), BeginSynchronizedUpdate)?;
        self.terminal.draw(|whole| {
            if let Some(cursor) = paint(whole.buffer_mut()) {
                whole.set_cursor_position(cursor);
            }
        })?;
        execute!(self.terminal.backend_mut(), EndSynchronizedUpdate)
    }

    /// Forgets what is on the screen, so that the next frame is drawn whole.
    ///
    /// # Errors
    /// The terminal does not take it.
    pub fn clear(&mut self) -> io::Result<()> {
        // Clearing it would ask the terminal where its cursor is, and the answer goes to the thread that reads keys.
        let size = self.terminal.size()?;
        self.terminal.resize(size.into())
    }

    /// Takes the mouse, or leaves it to the terminal, which then selects text with it.
    pub fn mouse(&mut self, taken: bool) {
        // A terminal without a mouse ignores it.
        let _ = match taken {
            true => execute!(self.terminal.backend_mut(), EnableMouseCapture),
            false => execute!(self.terminal.backend_mut(), DisableMouseCapture),
        };
    }

    /// Puts text into the clipboard, where the terminal lets programs do that.
    pub fn copy(&mut self, text: &str) {
        // A terminal without a clipboard ignores it; the text is on the screen anyway.
        let _ = execute!(self.terminal.backend_mut(), CopyToClipboard::to_clipboard_from(text));
    }
}

impl Drop for TerminalScreen {
    fn drop(&mut self) {
        restore();
    }
}

/// Raw mode, the alternate screen, pasted text as a whole, whether the window has the focus, the mouse.
fn prepare() -> io::Result<()> {
    enable_raw_mode()?;
    execute!(io::stdout(), EnterAlternateScreen, EnableBracketedPaste, EnableFocusChange, EnableMouseCapture)
}

/// Gives the terminal back. May be called more than once.
fn restore() {
    let mut out = io::stdout();
    // Nothing better can be done for a terminal that has gone away.
    let _ = execute!(
        out,
        DisableMouseCapture,
        DisableFocusChange,
        DisableBracketedPaste,
        LeaveAlternateScreen,
        crossterm::cursor::Show
    );
    let _ = disable_raw_mode();
    let _ = out.flush();
}
