//! The user's editor: the program that `VISUAL` or `EDITOR` names edits a text in a private file while the console
//! leaves the terminal.

use std::fs;
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, ExitStatus};
use std::sync::mpsc::Sender;

use super::Console;
use crate::context::EditorDocument;
use novamind_record::files::create_private_file;
use novamind_tui::terminal::TerminalSettings;
use novamind_tui::widgets::editor::MAX_BYTES;
use novamind_worker::message::Message;

/// A running external editor that occupies the terminal.
pub struct OpenEditor {
    process: u32,
    /// Settings of the terminal before the editor started.
    settings: TerminalSettings,
}

impl Console {
    /// Opens a text in the user's editor. If the editor cannot be opened, the application receives the reason in
    /// `Message::EditorClosed`, as if the editor had failed.
    pub(super) fn open_editor(&mut self, document: EditorDocument) -> io::Result<()> {
        if let Err(reason) = self.start_editor(document) {
            self.close_editor()?;
            let _ = self.sender.send(Message::EditorClosed(Err(reason)));
        }
        Ok(())
    }

    fn start_editor(&mut self, document: EditorDocument) -> Result<(), String> {
        let command = editor_command()?;
        let path = write_document(&document).map_err(|error| {
            format!("The file for your editor cannot be written: {error}. The draft is unchanged.")
        })?;
        // The signal for a new window size interrupts the thread that waits for a key.
        let wake = || drop(signal_hook::low_level::raise(signal_hook::consts::SIGWINCH));
        let started = self.gate.close(wake).and_then(|()| {
            let settings = self.screen.release();
            self.editor = Some(OpenEditor { process: 0, settings });
            spawn_editor(&command, &path)
        });
        match started {
            Ok(child) => {
                if let Some(editor) = &mut self.editor {
                    editor.process = child.id();
                }
                wait_in_background(child, path, document.text, self.sender.clone());
                Ok(())
            }
            Err(error) => {
                let _ = fs::remove_file(&path);
                Err(format!("Your editor cannot be started: {error}. The draft is unchanged."))
            }
        }
    }

    /// Takes the terminal back after the editor has ended.
    pub(super) fn close_editor(&mut self) -> io::Result<()> {
        let Some(editor) = self.editor.take() else { return Ok(()) };
        let reclaimed = self.screen.reclaim(&editor.settings, self.app.mouse);
        self.gate.open();
        reclaimed
    }

    /// Terminates the editor when the console exits. The file with the text is kept.
    pub(super) fn end_editor(&mut self) {
        if let Some(editor) = self.editor.take() {
            let _ = Command::new("kill").arg(editor.process.to_string()).status();
            editor.settings.restore();
        }
    }
}

/// Returns the command of the user's editor.
///
/// # Errors
/// No editor is set.
fn editor_command() -> Result<String, String> {
    let set = |name: &str| std::env::var(name).ok().filter(|command| !command.trim().is_empty());
    set("VISUAL").or_else(|| set("EDITOR")).ok_or_else(|| {
        "No editor is set. Set the environment variable VISUAL or EDITOR before you start the console, for example EDITOR=nano.".to_owned()
    })
}

/// Writes a text to a new private file in the folder for temporary files.
///
/// # Errors
/// The file cannot be written.
fn write_document(document: &EditorDocument) -> io::Result<PathBuf> {
    let folder = std::env::temp_dir();
    let mut number = 0;
    loop {
        let name = format!("novamind-{}-{number}.{}", std::process::id(), document.extension);
        let path = folder.join(name);
        // An existing file or link is never opened.
        match create_private_file(&path) {
            Ok(mut file) => {
                let end = if document.text.is_empty() || document.text.ends_with('\n') { "" } else { "\n" };
                file.write_all(document.text.as_bytes()).and_then(|()| file.write_all(end.as_bytes()))?;
                return Ok(path);
            }
            Err(error) if error.kind() == io::ErrorKind::AlreadyExists && number < 1000 => number += 1,
            Err(error) => return Err(error),
        }
    }
}

/// Starts the editor. The command is a shell command, so that it can contain arguments.
///
/// # Errors
/// The shell cannot be started.
fn spawn_editor(command: &str, path: &Path) -> io::Result<Child> {
    Command::new("sh").arg("-c").arg(format!("{command} \"$@\"")).arg(command).arg(path).spawn()
}

/// Waits on a separate thread until the editor has ended, and sends the edited text.
fn wait_in_background(mut child: Child, path: PathBuf, original: String, sender: Sender<Message>) {
    std::thread::spawn(move || {
        let result = match child.wait() {
            Ok(status) => read_result(status, &path, &original),
            Err(error) => Err(format!("Your editor failed: {error}. The draft is unchanged.")),
        };
        let _ = sender.send(Message::EditorClosed(result));
    });
}

/// Returns the edited text and removes the file. If an error occurs, a changed file is kept, and the error names the
/// file.
fn read_result(status: ExitStatus, path: &Path, original: &str) -> Result<String, String> {
    let edited = fs::read(path);
    let text = match &edited {
        Ok(bytes) => std::str::from_utf8(bytes).ok().filter(|text| text.len() < MAX_BYTES),
        Err(_) => None,
    };
    let text = text.map(|text| text.strip_suffix('\n').unwrap_or(text));
    let kept = match text {
        Some(text) if text == original.strip_suffix('\n').unwrap_or(original) => {
            let _ = fs::remove_file(path);
            String::new()
        }
        _ if edited.is_ok() => format!(" The edited text is in {}.", path.display()),
        _ => String::new(),
    };
    if !status.success() {
        return Err(format!("Your editor ended with an error ({status}), so the draft is unchanged.{kept}"));
    }
    match (&edited, text) {
        (Ok(_), Some(text)) => {
            let _ = fs::remove_file(path);
            Ok(text.to_owned())
        }
        (Ok(bytes), None) if bytes.len() >= MAX_BYTES => {
            Err(format!("The text is longer than {} KB, so the draft is unchanged.{kept}", MAX_BYTES / 1024))
        }
        (Ok(_), None) => Err(format!("The text is not UTF-8, so the draft is unchanged.{kept}")),
        (Err(error), _) => Err(format!("The edited text cannot be read: {error}. The draft is unchanged.")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::os::unix::fs::PermissionsExt;
    use std::sync::mpsc::channel;

    fn document(text: &str) -> EditorDocument {
        EditorDocument { text: text.to_owned(), extension: "md" }
    }

    fn result_of(command: &str, text: &str) -> (Result<String, String>, PathBuf) {
        let path = write_document(&document(text)).expect("a file");
        let child = spawn_editor(command, &path).expect("a shell");
        let (sender, messages) = channel();
        wait_in_background(child, path.clone(), text.to_owned(), sender);
        let Ok(Message::EditorClosed(result)) = messages.recv() else { panic!("no result") };
        (result, path)
    }

    #[test]
    fn file_is_private_and_never_replaces_a_file() {
        let (first, second) = (write_document(&document("a")), write_document(&document("b")));
        let (first, second) = (first.expect("a file"), second.expect("a file"));
        assert_ne!(first, second);
        let mode = fs::metadata(&first).expect("metadata").permissions().mode();
        assert_eq!(mode & 0o777, 0o600);
        assert_eq!(fs::read_to_string(&first).expect("text"), "a\n");
        [first, second].iter().for_each(|path| fs::remove_file(path).expect("a file"));
    }

    #[test]
    fn edited_text_is_returned_and_the_file_removed() {
        // The command has arguments, as in EDITOR="code --wait".
        let (result, path) = result_of("sed -i -e s/one/two/", "one\nline");
        assert_eq!(result.as_deref(), Ok("two\nline"));
        assert!(!path.exists());
    }

    #[test]
    fn failed_editor_changes_nothing_and_keeps_edited_text() {
        let (result, path) = result_of("false", "one");
        let reason = result.expect_err("an error");
        assert!(reason.contains("the draft is unchanged") && !path.exists(), "{reason}");
        // `sh` passes the file as the first argument; the editor writes the file and is then killed.
        let (result, path) = result_of("kill_self() { echo new > \"$1\"; kill -9 $$; }; kill_self", "one");
        let reason = result.expect_err("an error");
        assert!(reason.contains(&path.display().to_string()), "{reason}");
        assert_eq!(fs::read_to_string(&path).expect("the edited text"), "new\n");
        fs::remove_file(path).expect("a file");
        let (result, _) = result_of("no-such-editor-of-novamind 2>&-", "one");
        assert!(result.expect_err("an error").contains("127"));
        let (result, path) = result_of("f() { printf '\\377' > \"$1\"; }; f", "one");
        assert!(result.expect_err("an error").contains("not UTF-8"));
        fs::remove_file(path).expect("a file");
    }
}
