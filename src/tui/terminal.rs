//! Setup of the terminal. The terminal is restored on exit, on suspension and after a panic.

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

/// The terminal in console mode. Dropping this value restores the terminal.
pub struct TerminalScreen {
    terminal: Terminal<CrosstermBackend<Stdout>>,
}

/// Settings of the terminal, such as echo and line mode, in the format of `stty -g`. `None` if `stty` cannot read them.
#[cfg(unix)]
pub struct TerminalSettings(Option<String>);

#[cfg(unix)]
impl TerminalSettings {
    fn read() -> TerminalSettings {
        use std::process::{Command, Stdio};
        let output = Command::new("stty").arg("-g").stdin(Stdio::inherit()).stderr(Stdio::null()).output();
        let output = output.ok().filter(|output| output.status.success());
        TerminalSettings(output.map(|output| String::from_utf8_lossy(&output.stdout).trim().to_owned()))
    }

    /// Restores the settings, because a killed program can leave the terminal without echo.
    pub fn restore(&self) {
        if let Some(settings) = &self.0 {
            // Errors are ignored, because the terminal may be closed already.
            let _ =
                std::process::Command::new("stty").arg(settings).stderr(std::process::Stdio::null()).status();
        }
    }
}

/// Line that is printed after the message of a panic.
static PANIC_NOTE: Mutex<Option<String>> = Mutex::new(None);

/// Sets the line that is printed after the message of a panic, such as the location of the user's saved work.
pub fn set_panic_note(note: Option<String>) {
    *PANIC_NOTE.lock().unwrap_or_else(|poisoned| poisoned.into_inner()) = note;
}

impl TerminalScreen {
    /// Prepares the terminal. If the main thread panics, the terminal is restored before the message is printed.
    ///
    /// # Errors
    /// The terminal cannot be prepared.
    pub fn open() -> io::Result<TerminalScreen> {
        let taken = enter_console_mode().and_then(|()| Terminal::new(CrosstermBackend::new(io::stdout())));
        let terminal = taken.inspect_err(|_| restore_terminal())?;
        let usual = std::panic::take_hook();
        std::panic::set_hook(Box::new(move |panic| {
            // The application handles panics of all other threads.
            if std::thread::current().name() == Some("main") {
                restore_terminal();
                usual(panic);
                let note = PANIC_NOTE.lock().unwrap_or_else(|poisoned| poisoned.into_inner());
                if let Some(note) = &*note {
                    eprintln!("{note}");
                }
            }
        }));
        Ok(TerminalScreen { terminal })
    }

    /// Restores the terminal, stops the program until it is continued, and prepares the terminal again.
    ///
    /// # Errors
    /// The terminal cannot be prepared.
    #[cfg(unix)]
    pub fn suspend(&mut self, mouse: bool) -> io::Result<()> {
        restore_terminal();
        signal_hook::low_level::emulate_default_handler(signal_hook::consts::SIGTSTP)?;
        self.resume(mouse)
    }

    /// Hands the terminal over to another program. Returns the settings for [`TerminalScreen::reclaim`].
    #[cfg(unix)]
    pub fn release(&mut self) -> TerminalSettings {
        restore_terminal();
        TerminalSettings::read()
    }

    /// Prepares the terminal again after another program has used it.
    ///
    /// # Errors
    /// The terminal cannot be prepared.
    #[cfg(unix)]
    pub fn reclaim(&mut self, settings: &TerminalSettings, mouse: bool) -> io::Result<()> {
        // Restore the settings first, so that they also apply after this program has ended.
        settings.restore();
        self.resume(mouse)
    }

    /// Prepares the terminal again after the program was stopped. Another program may have changed the terminal
    /// settings in the meantime.
    ///
    /// # Errors
    /// The terminal cannot be prepared.
    #[cfg(unix)]
    pub fn resume(&mut self, mouse: bool) -> io::Result<()> {
        // Disable raw mode first: while the library considers raw mode enabled, enabling it has no effect.
        let _ = disable_raw_mode();
        enter_console_mode()?;
        self.set_mouse_capture(mouse);
        self.clear()
    }

    /// Draws a frame. `paint` fills the buffer and returns the position of the cursor.
    ///
    /// # Errors
    /// Writing to the terminal fails.
    pub fn draw(&mut self, paint: impl FnOnce(&mut Buffer) -> Option<Position>) -> io::Result<()> {
        execute!(self.terminal.backend_mut(), BeginSynchronizedUpdate)?;
        self.terminal.draw(|frame| {
            if let Some(cursor) = paint(frame.buffer_mut()) {
                frame.set_cursor_position(cursor);
            }
        })?;
        execute!(self.terminal.backend_mut(), EndSynchronizedUpdate)
    }

    /// Clears the terminal, so that the next frame is drawn completely.
    ///
    /// # Errors
    /// Writing to the terminal fails.
    pub fn clear(&mut self) -> io::Result<()> {
        // The library's function for clearing would request the cursor position, and the thread that reads keys would
        // receive the answer.
        let size = self.terminal.size()?;
        self.terminal.resize(size.into())
    }

    /// Captures the mouse, or releases it so that the terminal can select text.
    pub fn set_mouse_capture(&mut self, taken: bool) {
        // Terminals without a mouse ignore the escape sequence.
        let _ = match taken {
            true => execute!(self.terminal.backend_mut(), EnableMouseCapture),
            false => execute!(self.terminal.backend_mut(), DisableMouseCapture),
        };
    }

    /// Copies text to the clipboard if the terminal permits this.
    pub fn copy_to_clipboard(&mut self, text: &str) {
        // Terminals without a clipboard ignore the escape sequence. Errors are ignored, because the text is also on the
        // screen.
        let _ = execute!(self.terminal.backend_mut(), CopyToClipboard::to_clipboard_from(text));
    }
}

impl Drop for TerminalScreen {
    fn drop(&mut self) {
        restore_terminal();
    }
}

/// Enables raw mode, the alternate screen, bracketed paste, focus events and the mouse.
fn enter_console_mode() -> io::Result<()> {
    enable_raw_mode()?;
    execute!(io::stdout(), EnterAlternateScreen, EnableBracketedPaste, EnableFocusChange, EnableMouseCapture)
}

/// Restores the terminal and ends the program with a core dump, as SIGQUIT does by default. Does not need the main
/// thread, so that it also ends a program that hangs.
#[cfg(unix)]
pub fn quit_with_core_dump() {
    restore_terminal();
    let _ = signal_hook::low_level::emulate_default_handler(signal_hook::consts::SIGQUIT);
}

/// Restores the terminal. This function may be called repeatedly.
fn restore_terminal() {
    let mut out = io::stdout();
    // Errors are ignored, because the terminal may be closed already.
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
