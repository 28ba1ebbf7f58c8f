//! `novamind host attach`: connects this terminal to a session of a host. It only relays: it reads no file of the study.

use std::fmt;
use std::io::{self, Read, Write};
use std::path::Path;
use std::time::Duration;

use rustix::termios::{LocalModes, OptionalActions, Termios, isatty, tcgetattr, tcgetwinsize, tcsetattr};
use tokio::net::UnixStream;
use tokio::net::unix::{OwnedReadHalf, OwnedWriteHalf};
use tokio::signal::unix::{SignalKind, signal};
use tokio::sync::mpsc;
use tokio::time::{Instant, sleep_until};

use crate::attachment::WindowSize;
use crate::frames::{ClientMessage, HostMessage, receive, send};

/// Sequences that start with a blank alternate screen.
const ENTER_SCREEN: &str = "\x1b[?1049h\x1b[2J\x1b[H";
/// Sequences that undo everything that a session may have set: mouse, pasting, focus and key modes, colors, cursor.
const LEAVE_SCREEN: &str = "\x1b[?1000l\x1b[?1002l\x1b[?1003l\x1b[?1006l\x1b[?1015l\x1b[?1004l\x1b[?2004l\x1b[?2026l\x1b[?1l\
                            \x1b[<u\x1b>\x1b[r\x1b[0m\x1b[0 q\x1b[?7h\x1b[?25h\x1b[?1049l";
/// Time for which a message of the host is shown.
const NOTICE_TIME: Duration = Duration::from_secs(12);

/// The reason why a terminal is not or no longer attached.
#[derive(Debug)]
pub enum AttachFailure {
    /// The user has to do something else. The text says what.
    Refused(String),
    /// The connection or the terminal failed.
    Io(io::Error),
    /// A signal with this number ended the program.
    Signal(i32),
}

impl fmt::Display for AttachFailure {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            AttachFailure::Refused(problem) => out.write_str(problem),
            AttachFailure::Io(error) => {
                write!(
                    out,
                    "the connection to the host failed: {error}. Everything that you confirmed is saved; connect again"
                )
            }
            AttachFailure::Signal(_) => Ok(()),
        }
    }
}

impl std::error::Error for AttachFailure {}

impl From<io::Error> for AttachFailure {
    fn from(error: io::Error) -> AttachFailure {
        AttachFailure::Io(error)
    }
}

/// Attaches this terminal to a session. Returns the reason for which the session closed the connection.
///
/// # Errors
/// The host does not run or refuses the client, or the connection fails. The terminal is restored.
pub fn attach_terminal(socket: &Path, label: Option<String>) -> Result<String, AttachFailure> {
    let (input, output) = (io::stdin(), io::stdout());
    if !isatty(&input) || !isatty(&output) {
        let problem = "a session needs a terminal: with ssh, leave out the command, or add -t";
        return Err(AttachFailure::Refused(problem.to_owned()));
    }
    let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build()?;
    let result = runtime.block_on(run(socket, label));
    // A thread may still be waiting for a key.
    runtime.shutdown_background();
    result
}

async fn run(socket: &Path, label: Option<String>) -> Result<String, AttachFailure> {
    let stream = UnixStream::connect(socket).await.map_err(|error| {
        AttachFailure::Refused(format!(
            "the host cannot be reached at {} ({error}). It may not be running: try again later, or ask the experimenter",
            socket.display()
        ))
    })?;
    let (mut from, mut to) = stream.into_split();
    let (columns, rows) = window_size();
    send(&mut to, &ClientMessage::Hello { label, columns, rows }).await?;
    loop {
        match receive(&mut from).await? {
            HostMessage::AskForCode => {
                let (label, code) =
                    tokio::task::spawn_blocking(ask_for_code).await.map_err(io::Error::other)??;
                send(&mut to, &ClientMessage::Code { label, code }).await?;
            }
            HostMessage::Attached { .. } => break,
            HostMessage::Refused(reason) | HostMessage::Closed(reason) => {
                return Err(AttachFailure::Refused(reason));
            }
            HostMessage::Output(_) | HostMessage::Notice(_) => {}
        }
    }
    let _terminal = RawTerminal::enter()?;
    relay(from, to).await
}

/// Passes keys and output between the terminal and the host until one of them ends.
async fn relay(mut from: OwnedReadHalf, mut to: OwnedWriteHalf) -> Result<String, AttachFailure> {
    let mut keys = read_keys();
    // A separate task, because a message must not be read in parts.
    let (messages, mut received) = mpsc::channel(4);
    tokio::spawn(
        async move { while messages.send(receive::<HostMessage>(&mut from).await).await.is_ok() {} },
    );
    let mut resized = signal(SignalKind::window_change())?;
    let mut hung_up = signal(SignalKind::hangup())?;
    let mut terminated = signal(SignalKind::terminate())?;
    let mut view = View::default();
    view.check_size()?;
    loop {
        tokio::select! {
            message = received.recv() => match message {
                Some(Ok(HostMessage::Output(bytes))) => view.show_output(&bytes)?,
                Some(Ok(HostMessage::Notice(text))) => view.show_notice(text)?,
                Some(Ok(HostMessage::Closed(reason) | HostMessage::Refused(reason))) => return Ok(reason),
                Some(Ok(HostMessage::AskForCode | HostMessage::Attached { .. })) => {}
                Some(Err(error)) => return Err(error.into()),
                None => return Err(io::Error::from(io::ErrorKind::UnexpectedEof).into()),
            },
            bytes = keys.recv() => match bytes {
                Some(bytes) => send(&mut to, &ClientMessage::Input(bytes)).await?,
                None => return Err(AttachFailure::Signal(1)),
            },
            _ = resized.recv() => {
                view.check_size()?;
                let (columns, rows) = window_size();
                send(&mut to, &ClientMessage::Resize { columns, rows }).await?;
                send(&mut to, &ClientMessage::Redraw).await?;
            }
            () = view.notice_end() => {
                view.notice = None;
                send(&mut to, &ClientMessage::Redraw).await?;
            }
            _ = hung_up.recv() => return Err(AttachFailure::Signal(1)),
            _ = terminated.recv() => return Err(AttachFailure::Signal(15)),
        }
    }
}

/// The user's terminal: the session's screen, and over it a message of the host.
#[derive(Debug, Default)]
struct View {
    notice: Option<(String, Instant)>,
    is_too_small: bool,
}

impl View {
    fn show_output(&self, bytes: &[u8]) -> io::Result<()> {
        if self.is_too_small {
            return Ok(());
        }
        write_out(bytes)?;
        self.draw_notice()
    }

    fn show_notice(&mut self, text: String) -> io::Result<()> {
        self.notice = Some((text, Instant::now() + NOTICE_TIME));
        self.draw_notice()
    }

    /// Draws the message of the host in the last line of the session, without moving the cursor.
    fn draw_notice(&self) -> io::Result<()> {
        let Some((text, _)) = &self.notice else { return Ok(()) };
        let (columns, rows) = window_size();
        let (width, row) = (usize::from(columns).saturating_sub(2), rows.min(WindowSize::LARGEST.rows));
        let text: String = text.chars().filter(|letter| !letter.is_control()).take(width).collect();
        write_out(format!("\x1b7\x1b[{row};1H\x1b[0;7m {text:<width$} \x1b[0m\x1b8").as_bytes())
    }

    async fn notice_end(&self) {
        match &self.notice {
            Some((_, end)) => sleep_until(*end).await,
            None => std::future::pending().await,
        }
    }

    /// Clears the screen, and asks for a larger window if the window is too small.
    fn check_size(&mut self) -> io::Result<()> {
        let (columns, rows) = window_size();
        let least = WindowSize::SMALLEST;
        self.is_too_small = columns < least.columns || rows < least.rows;
        write_out(b"\x1b[0m\x1b[2J\x1b[H")?;
        if !self.is_too_small {
            return Ok(());
        }
        let WindowSize { columns: least_columns, rows: least_rows } = least;
        write_out(
            format!("Enlarge the window to {least_columns} x {least_rows} (now {columns} x {rows}).")
                .as_bytes(),
        )
    }
}

/// Changed modes of the terminal. Dropping the value restores the modes.
struct ChangedModes {
    original: Termios,
}

impl ChangedModes {
    fn start(change: impl FnOnce(&mut Termios)) -> io::Result<ChangedModes> {
        let original = tcgetattr(io::stdin())?;
        let mut changed = original.clone();
        change(&mut changed);
        tcsetattr(io::stdin(), OptionalActions::Flush, &changed)?;
        Ok(ChangedModes { original })
    }
}

impl Drop for ChangedModes {
    fn drop(&mut self) {
        // The terminal may have gone.
        let _ = tcsetattr(io::stdin(), OptionalActions::Flush, &self.original);
    }
}

/// The terminal without line editing, showing the screen of the session. Dropping the value restores the terminal.
struct RawTerminal {
    _modes: ChangedModes,
}

impl RawTerminal {
    fn enter() -> io::Result<RawTerminal> {
        let terminal = RawTerminal { _modes: ChangedModes::start(Termios::make_raw)? };
        write_out(ENTER_SCREEN.as_bytes())?;
        Ok(terminal)
    }
}

impl Drop for RawTerminal {
    fn drop(&mut self) {
        // The terminal may have gone.
        let _ = write_out(LEAVE_SCREEN.as_bytes());
    }
}

/// Reads keys on a separate thread, because a read of the terminal cannot be cancelled.
fn read_keys() -> mpsc::Receiver<Vec<u8>> {
    let (keys, received) = mpsc::channel(64);
    std::thread::spawn(move || {
        let mut buffer = [0; 4096];
        loop {
            match io::stdin().lock().read(&mut buffer) {
                Ok(count) if count > 0 => {
                    if keys.blocking_send(buffer[..count].to_vec()).is_err() {
                        return;
                    }
                }
                Err(error) if error.kind() == io::ErrorKind::Interrupted => {}
                _ => return,
            }
        }
    });
    received
}

fn write_out(bytes: &[u8]) -> io::Result<()> {
    let mut out = io::stdout().lock();
    out.write_all(bytes)?;
    out.flush()
}

fn window_size() -> (u16, u16) {
    match tcgetwinsize(io::stdout()) {
        Ok(size) if size.ws_col > 0 && size.ws_row > 0 => (size.ws_col, size.ws_row),
        _ => (80, 24),
    }
}

/// Asks for label and code. The code is not shown.
fn ask_for_code() -> io::Result<(String, String)> {
    let ask = |question: &str| {
        write_out(question.as_bytes())?;
        let mut line = String::new();
        match io::stdin().read_line(&mut line)? {
            0 => Err(io::Error::from(io::ErrorKind::UnexpectedEof)),
            _ => Ok(line.trim().to_owned()),
        }
    };
    let label = ask("Label: ")?;
    let hidden = ChangedModes::start(|modes| modes.local_modes.remove(LocalModes::ECHO))?;
    let code = ask("Code (not shown): ");
    drop(hidden);
    write_out(b"\n")?;
    Ok((label, code?))
}
