//! The terminal application.
//!
//! Input triggers actions, actions change the state, and a view without side effects draws the state. The session and
//! the database run on separate threads and send their results through the same channel as the input. The screen never
//! blocks. All displayed data comes from tool results, the weekly dashboard or guarded queries.

mod action;
pub mod app;
mod attention;
pub mod benchmark;
mod consent;
pub mod context;
mod curve_chart;
mod dialogs;
pub mod effect;
#[cfg(unix)]
mod external_editor;
mod files;
mod forecast_fan;
mod frame;
pub mod headless;
mod hosted;
mod input_gate;
pub mod keys;
mod lesson;
pub mod manual;
pub mod own_commands;
mod playback;
mod projector;
pub mod screens;
mod study_pages;
#[cfg(test)]
mod test_kit;
pub mod themes;
mod tour;

use std::io;
use std::sync::Arc;
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, channel};
use std::time::Duration;

use app::{App, Order, Settings, Stage};
use effect::Effect;
#[cfg(unix)]
use external_editor::OpenEditor;
use input_gate::InputGate;
use novamind_tui::terminal::{TerminalScreen, set_panic_note};
use novamind_worker::Workers;
use novamind_worker::message::Message;

/// Frame interval while only the displayed elapsed time changes.
const BUSY_FRAME_INTERVAL: Duration = Duration::from_millis(500);
/// Timeout for a message while nothing on the screen depends on the time.
const IDLE_TIMEOUT: Duration = Duration::from_secs(3600);

/// Maximum time to wait until a suspension is recorded. The session may be busy with a week.
#[cfg(unix)]
const SUSPEND_TIMEOUT: Duration = Duration::from_millis(500);

/// Runs the console in the terminal. Returns the exit code and the text to print on exit.
///
/// # Errors
/// The terminal fails.
pub fn run_console(settings: Settings, start: Option<Effect>) -> io::Result<(u8, Option<String>)> {
    let (sender, messages) = channel();
    let workers = Workers::start(
        sender.clone(),
        settings.configuration.clone(),
        settings.runs.clone(),
        settings.lists_all_participants,
    );
    let again = settings.resume_command.clone();
    let mut app = App::new(settings);
    app.window = crossterm::terminal::size().unwrap_or_default();
    if let Some(effect) = start {
        app.start(effect);
    }
    let screen = TerminalScreen::open()?;
    let gate = Arc::new(InputGate::default());
    spawn_input_threads(sender.clone(), &gate);
    let mut console = Console {
        app,
        workers,
        screen,
        messages,
        sender,
        resume_command: again,
        gate,
        #[cfg(unix)]
        editor: None,
        #[cfg(unix)]
        has_resumed: false,
    };
    let end = console.run();
    let Console { screen, workers, .. } = console;
    drop(screen);
    workers.shut_down();
    end
}

struct Console {
    app: App,
    workers: Workers,
    screen: TerminalScreen,
    messages: Receiver<Message>,
    sender: Sender<Message>,
    resume_command: String,
    /// Pauses the thread that reads keys while the editor uses the terminal.
    gate: Arc<InputGate>,
    #[cfg(unix)]
    editor: Option<OpenEditor>,
    /// Whether the program has resumed but has not received the continue signal yet.
    #[cfg(unix)]
    has_resumed: bool,
}

impl Console {
    fn run(&mut self) -> io::Result<(u8, Option<String>)> {
        loop {
            if let Some(end) = self.execute_orders()? {
                return Ok(end);
            }
            if !self.is_editor_open() {
                self.screen.draw(|buffer| self.app.draw(buffer))?;
            }
            let patience = if self.app.is_waiting() { BUSY_FRAME_INTERVAL } else { IDLE_TIMEOUT };
            match self
                .messages
                .recv_timeout(self.app.time_until_wake().map_or(patience, |wake| wake.min(patience)))
            {
                Ok(message) => self.handle_message(message)?,
                Err(RecvTimeoutError::Timeout) => self.app.handle_message(Message::RedrawDue),
                Err(RecvTimeoutError::Disconnected) => return Ok((1, None)),
            }
            // Handle all messages that have arrived before drawing one frame.
            while let Ok(message) = self.messages.try_recv() {
                self.handle_message(message)?;
            }
        }
    }

    /// Returns whether the user's editor uses the terminal.
    fn is_editor_open(&self) -> bool {
        #[cfg(unix)]
        return self.editor.is_some();
        #[cfg(not(unix))]
        return false;
    }

    fn handle_message(&mut self, message: Message) -> io::Result<()> {
        #[cfg(debug_assertions)]
        inject_panic(&message);
        match message {
            // A hosted session has no shell that could continue it.
            #[cfg(unix)]
            Message::Signal(signal_hook::consts::SIGTSTP) if self.app.is_hosted => {}
            #[cfg(unix)]
            Message::EditorClosed(_) => {
                self.close_editor()?;
                self.app.handle_message(message);
            }
            #[cfg(unix)]
            Message::Signal(signal_hook::consts::SIGTSTP) => {
                self.app.suspend();
                for job in self.app.take_jobs() {
                    self.workers.send(job);
                }
                self.workers.wait_for_jobs(SUSPEND_TIMEOUT);
                match self.is_editor_open() {
                    // The editor has restored the terminal. The shell stops and continues the editor together with the
                    // console.
                    true => signal_hook::low_level::emulate_default_handler(signal_hook::consts::SIGTSTP)?,
                    false => self.screen.suspend(self.app.mouse)?,
                }
                // The resume is recorded before the continue signal arrives, because a key that ends the program could
                // be handled first.
                self.app.resume();
                self.has_resumed = true;
            }
            #[cfg(unix)]
            Message::Signal(signal_hook::consts::SIGCONT) => {
                if !std::mem::take(&mut self.has_resumed) {
                    self.app.resume();
                }
                if !self.is_editor_open() {
                    self.screen.resume(self.app.mouse)?;
                }
            }
            message => self.app.handle_message(message),
        }
        Ok(())
    }

    fn execute_orders(&mut self) -> io::Result<Option<(u8, Option<String>)>> {
        for order in self.app.take_orders() {
            match order {
                Order::Job(job) => self.workers.send(job),
                Order::Ask(ask, is_busy) => self.workers.ask(&ask, is_busy),
                Order::CancelQuery => self.workers.stop_running_work(),
                Order::Copy(text) => self.screen.copy_to_clipboard(&text),
                Order::Write(files) => files::write_in_background(files, self.sender.clone()),
                Order::SaveQuery(configuration, query) => {
                    files::save_query_in_background(configuration, query, self.sender.clone());
                }
                Order::RunProgram(call) => own_commands::run_in_background(call, self.sender.clone()),
                #[cfg(unix)]
                Order::OpenEditor(document) => self.open_editor(document)?,
                #[cfg(not(unix))]
                Order::OpenEditor(_) => {
                    let reason = "your editor can be opened only on Unix systems".to_owned();
                    let _ = self.sender.send(Message::EditorClosed(Err(reason)));
                }
                Order::Redraw => self.screen.clear()?,
                Order::Mouse(taken) => self.screen.set_mouse_capture(taken),
                Order::Exit(code, text) => {
                    #[cfg(unix)]
                    self.end_editor();
                    return Ok(Some((code, text)));
                }
            }
        }
        let folder = match &self.app.stage {
            Stage::Run(_) if self.app.is_hosted => None,
            Stage::Run(run) => run.company.folder.as_ref().map(|folder| folder.display().to_string()),
            Stage::Menu(_) | Stage::Study(_) => None,
        };
        set_panic_note(folder.map(|folder| {
            format!(
                "novamind: all confirmed actions are saved in {folder}; resume with `{}`",
                self.resume_command
            )
        }));
        Ok(None)
    }
}

/// Panics when f12 is pressed, if the environment requests a panic to test recovery. Release builds do not contain
/// this function.
#[cfg(debug_assertions)]
fn inject_panic(message: &Message) {
    use crossterm::event::{Event, KeyCode};
    let pressed = matches!(message, Message::Input(Event::Key(key)) if key.code == KeyCode::F(12));
    if pressed && std::env::var("NOVAMIND_FAULT").is_ok_and(|fault| fault == "panic") {
        panic!("panic requested by NOVAMIND_FAULT");
    }
}

/// Receives keys and signals on two threads that end with the program.
///
/// While the user's editor is open, keys are not read. The terminal sends the signals of ctrl-c and ctrl-\\ to the
/// editor and to the console; the console ignores them.
fn spawn_input_threads(sender: Sender<Message>, gate: &Arc<InputGate>) {
    let (keys, key_gate) = (sender.clone(), gate.clone());
    std::thread::spawn(move || {
        while let Ok(event) = crossterm::event::read() {
            if key_gate.is_closed() && matches!(event, crossterm::event::Event::Resize(..)) {
                // This event was raised only to interrupt the read, so it is dropped.
                key_gate.pass();
                continue;
            }
            if keys.send(Message::Input(event)).is_err() {
                return;
            }
            key_gate.pass();
        }
        // The terminal was closed: report a hangup signal.
        let _ = keys.send(Message::Signal(1));
    });
    #[cfg(unix)]
    let gate = gate.clone();
    #[cfg(unix)]
    std::thread::spawn(move || {
        use signal_hook::consts::{SIGCONT, SIGHUP, SIGINT, SIGQUIT, SIGTERM, SIGTSTP};
        let all = [SIGINT, SIGTERM, SIGHUP, SIGTSTP, SIGCONT, SIGQUIT];
        let Ok(mut signals) = signal_hook::iterator::Signals::new(all) else { return };
        for signal in signals.forever() {
            if matches!(signal, SIGINT | SIGQUIT) && gate.is_closed() {
                continue;
            }
            if signal == SIGQUIT {
                novamind_tui::terminal::quit_with_core_dump();
            }
            if sender.send(Message::Signal(signal)).is_err() {
                return;
            }
        }
    });
}
