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

use super::app::App;
use super::frame;

/// The terminal while the console has it; given back when this is dropped.
pub struct TerminalScreen {
    terminal: Terminal<CrosstermBackend<Stdout>>,
}

/// What a panic prints besides its own words: where the run is safe.
static SAVED_AT: Mutex<Option<String>> = Mutex::new(None);

/// Says where the run is kept, for the words of a panic.
pub fn remember_run(folder: Option<String>) {
    *SAVED_AT.lock().unwrap_or_else(|poisoned| poisoned.into_inner()) = folder;
}

impl TerminalScreen {
    /// Takes the terminal. A failure of the program names the command that goes on with the newest run.
    ///
    /// # Errors
    /// It does not let itself be taken.
    pub fn take(again: String) -> io::Result<TerminalScreen> {
        let taken = prepare().and_then(|()| Terminal::new(CrosstermBackend::new(io::stdout())));
        let terminal = taken.inspect_err(|_| restore())?;
        let usual = std::panic::take_hook();
        std::panic::set_hook(Box::new(move |panic| {
            // Threads behind the screen report their panics as news; the console leaves in good order.
            if std::thread::current().name() == Some("main") {
                restore();
                usual(panic);
                let saved = SAVED_AT.lock().unwrap_or_else(|poisoned| poisoned.into_inner());
                if let Some(folder) = &*saved {
                    eprintln!("novamind: everything confirmed is safe in {folder}; `{again}` continues");
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

    /// Draws a frame.
    ///
    /// # Errors
    /// The terminal does not take it.
    pub fn draw(&mut self, app: &mut App) -> io::Result<()> {
        execute!(self.terminal.backend_mut(), BeginSynchronizedUpdate)?;
        let mut drawn = None;
        self.terminal.draw(|whole| {
            let result = frame::draw(app, whole.buffer_mut());
            if let Some(cursor) = result.cursor {
                whole.set_cursor_position(cursor);
            }
            drawn = Some(result);
        })?;
        execute!(self.terminal.backend_mut(), EndSynchronizedUpdate)?;
        if let Some(drawn) = drawn {
            app.clicks = drawn.clicks;
            app.page = drawn.page;
            app.window = drawn.window;
        }
        Ok(())
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
