//! Tests of hosted sessions. A shell script plays the part of the program.

use std::ffi::OsString;
use std::os::unix::fs::PermissionsExt;
use std::path::{Path, PathBuf};
use std::time::Duration;

use crate::attachment::{AttachError, Attachment, ClientKind, CloseReason, Notice, Output, WindowSize};
use crate::audit::{AUDIT_FILE, AuditLog};
use crate::folder::{HostFolder, ProgramVersion};
use crate::process::SessionProgram;
use crate::sessions::{ControlError, SessionState, Sessions};
use novamind_study::CodeDigest;

/// Echoes lines, and writes a file when the host asks it to save. `crash` ends it with an error, `leave` without one.
const SCRIPT: &str = r#"
trap 'echo saved > "$3/runs/saved"; exit 0' HUP
stty -echo
echo "ready $1 $(stty size)"
while true; do
  # A signal can interrupt the read. Without a terminal, the script must not run for ever.
  read -r line || { failures=$((failures + 1)); [ $failures -lt 20 ] || exit 4; sleep 0.1; continue; }
  case $line in
    crash) exit 3 ;;
    leave) exit 0 ;;
    size) stty size ;;
    console) printf '\033[?1049h\033[?1003h\033[?1004h' ;;
    *) echo "got $line" ;;
  esac
done
"#;

fn program(absence_limit: Duration) -> SessionProgram {
    let arguments = ["-c", SCRIPT, "script"].map(OsString::from).to_vec();
    SessionProgram { program: PathBuf::from("/bin/sh"), arguments, absence_limit }
}

fn version(version: &str) -> ProgramVersion {
    ProgramVersion { version: version.to_owned(), mechanics: 1 }
}

/// Creates a study of two participants.
fn study() -> tempfile::TempDir {
    let folder = tempfile::tempdir().expect("a folder");
    let write = |name: &str, text: &str| std::fs::write(folder.path().join(name), text).expect("written");
    write("study.toml", "name = \"pilot\"\ntitle = \"A company\"\n[seeds]\nplan = \"secret\"\ncount = 2\n");
    write("assignment.csv", "label,condition,seed,order\nP01,A,6412398461,1\nP02,B,7512398462,2\n");
    folder
}

fn open(study: &Path) -> HostFolder {
    HostFolder::open_or_create(study, &version("1")).expect("a host folder")
}

fn with_sessions<F: Future<Output = ()>>(absence_limit: Duration, test: impl FnOnce(Sessions) -> F) {
    with_study_sessions(absence_limit, None, test);
}

/// Runs a test with the sessions of a study. Then checks the audit log.
pub(crate) fn with_study_sessions<F: Future<Output = ()>>(
    absence_limit: Duration,
    admin_code: Option<CodeDigest>,
    test: impl FnOnce(Sessions) -> F,
) {
    let study = study();
    let mut folder = open(study.path());
    if admin_code.is_some() {
        folder.save_settings(None, admin_code).expect("saved");
    }
    let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build().expect("a runtime");
    runtime.block_on(async {
        let sessions = Sessions::new(folder, &program(absence_limit)).expect("sessions");
        test(sessions.clone()).await;
        sessions.shut_down().await;
    });
    // Tests without an event have no log.
    let log = std::fs::read_to_string(study.path().join("host").join(AUDIT_FILE)).unwrap_or_default();
    assert!(AuditLog::verify(&log).is_ok(), "{log}");
}

async fn attach(sessions: &Sessions, label: &str) -> Result<Attachment, AttachError> {
    let client = ClientKind::Terminal("tester".to_owned());
    sessions.attach(label, client, WindowSize::clamped(80, 24)).await
}

/// Reads output until it contains a text.
async fn read_until(attachment: &mut Attachment, part: &str) -> String {
    let mut text = String::new();
    while !text.contains(part) {
        match attachment.next_output().await {
            Output::Bytes(bytes) => text += &String::from_utf8_lossy(&bytes),
            other => panic!("{other:?} instead of {part:?} after {text:?}"),
        }
    }
    text
}

async fn read_close(attachment: &mut Attachment) -> CloseReason {
    loop {
        if let Output::Closed(reason) = attachment.next_output().await {
            return reason;
        }
    }
}

#[test]
fn second_client_takes_over_with_the_current_screen() {
    with_sessions(SessionProgram::ABSENCE_LIMIT, async |sessions| {
        let mut first = attach(&sessions, "P01").await.expect("attached");
        read_until(&mut first, "ready P01 24 80").await;
        first.send_input(b"one\n");
        read_until(&mut first, "got one").await;
        let mut second = attach(&sessions, "P01").await.expect("attached");
        assert_eq!(read_close(&mut first).await, CloseReason::TakenOver);
        let screen = read_until(&mut second, "got one").await;
        assert!(screen.contains("ready P01"), "{screen:?}");
        first.send_input(b"two\n");
        second.send_input(b"three\n");
        let screen = read_until(&mut second, "got three").await;
        assert!(!screen.contains("got two"), "{screen:?}");
        assert_eq!(second.process_number(), 1);
    });
}

#[test]
fn new_client_gets_the_modes_of_the_console() {
    with_sessions(SessionProgram::ABSENCE_LIMIT, async |sessions| {
        let mut first = attach(&sessions, "P01").await.expect("attached");
        first.send_input(b"console\n");
        read_until(&mut first, "\x1b[?1004h").await;
        let mut second = attach(&sessions, "P01").await.expect("attached");
        let screen = read_until(&mut second, "\x1b[?1004h").await;
        assert!(screen.contains("\x1b[?1003h"), "{screen:?}");
    });
}

#[test]
fn sessions_are_separate_and_unknown_labels_are_refused() {
    with_sessions(SessionProgram::ABSENCE_LIMIT, async |sessions| {
        let mut one = attach(&sessions, "P01").await.expect("attached");
        let mut two = attach(&sessions, "P02").await.expect("attached");
        assert!(!read_until(&mut one, "ready").await.contains("P02"));
        assert!(read_until(&mut two, "ready").await.contains("P02"));
        for label in ["P03", "", "../P01", "p01"] {
            assert_eq!(attach(&sessions, label).await.err(), Some(AttachError::UnknownLabel));
        }
    });
}

#[test]
fn window_size_is_limited_and_reaches_the_process() {
    with_sessions(SessionProgram::ABSENCE_LIMIT, async |sessions| {
        let mut client = attach(&sessions, "P01").await.expect("attached");
        read_until(&mut client, "ready").await;
        client.resize(WindowSize::clamped(1000, 5));
        client.send_input(b"size\n");
        read_until(&mut client, "16 200").await;
    });
}

#[test]
fn failed_process_is_restarted_and_the_client_is_informed() {
    with_sessions(SessionProgram::ABSENCE_LIMIT, async |sessions| {
        let mut client = attach(&sessions, "P01").await.expect("attached");
        read_until(&mut client, "ready").await;
        client.send_input(b"crash\n");
        loop {
            match client.next_output().await {
                Output::Notice(notice) => break assert_eq!(notice, Notice::Restarted),
                Output::Bytes(_) => {}
                Output::Closed(reason) => panic!("{reason:?}"),
            }
        }
        read_until(&mut client, "ready").await;
        assert_eq!(client.process_number(), 2);
        client.send_input(b"leave\n");
        assert_eq!(read_close(&mut client).await, CloseReason::Ended);
    });
}

#[test]
fn process_that_always_fails_is_not_restarted_forever() {
    with_sessions(SessionProgram::ABSENCE_LIMIT, async |sessions| {
        let mut client = attach(&sessions, "P01").await.expect("attached");
        for _ in 0..6 {
            client.send_input(b"crash\n");
            while !matches!(client.next_output().await, Output::Notice(_) | Output::Closed(_)) {}
        }
        assert_eq!(read_close(&mut client).await, CloseReason::Failed);
    });
}

#[test]
fn paused_and_ended_sessions_refuse_clients() {
    with_sessions(SessionProgram::ABSENCE_LIMIT, async |sessions| {
        let mut client = attach(&sessions, "P01").await.expect("attached");
        read_until(&mut client, "ready").await;
        sessions.message("P01", "Five minutes left").expect("sent");
        sessions.pause("P01").await.expect("paused");
        assert_eq!(
            client.next_output().await,
            Output::Notice(Notice::Experimenter("Five minutes left".to_owned()))
        );
        assert_eq!(read_close(&mut client).await, CloseReason::Paused);
        assert!(sessions.folder().runs_folder("P01").join("saved").exists());
        assert_eq!(attach(&sessions, "P01").await.err(), Some(AttachError::Paused));
        assert!(matches!(sessions.message("P01", "text"), Err(ControlError::NotConnected)));
        sessions.resume("P01").await.expect("resumed");
        let mut client = attach(&sessions, "P01").await.expect("attached");
        read_until(&mut client, "ready").await;
        sessions.end("P01", "fire alarm").await.expect("ended");
        assert_eq!(attach(&sessions, "P01").await.err(), Some(AttachError::Ended("fire alarm".to_owned())));
        assert!(matches!(sessions.resume("P01").await, Err(ControlError::HasEnded)));
        // Another start of the host reads the state.
        let again = Sessions::new(sessions.folder().clone(), &program(Duration::ZERO)).expect("sessions");
        assert_eq!(again.state("P01"), SessionState::Ended("fire alarm".to_owned()));
    });
}

#[test]
fn process_ends_after_its_client_is_gone() {
    with_sessions(Duration::from_millis(1), async |sessions| {
        let mut client = attach(&sessions, "P01").await.expect("attached");
        read_until(&mut client, "ready").await;
        drop(client);
        while sessions.statuses()[0].is_running {
            tokio::time::sleep(Duration::from_millis(5)).await;
        }
        assert!(sessions.folder().runs_folder("P01").join("saved").exists());
        let mut client = attach(&sessions, "P01").await.expect("attached");
        read_until(&mut client, "ready").await;
        assert_eq!(client.process_number(), 2);
    });
}

#[test]
fn shutdown_saves_all_sessions() {
    with_sessions(SessionProgram::ABSENCE_LIMIT, async |sessions| {
        let mut client = attach(&sessions, "P02").await.expect("attached");
        read_until(&mut client, "ready").await;
        sessions.shut_down().await;
        assert_eq!(read_close(&mut client).await, CloseReason::Shutdown);
        assert!(sessions.folder().runs_folder("P02").join("saved").exists());
        assert_eq!(attach(&sessions, "P02").await.err(), Some(AttachError::Shutdown));
    });
}

#[test]
fn slow_client_gets_the_current_screen() {
    with_sessions(SessionProgram::ABSENCE_LIMIT, async |sessions| {
        let mut client = attach(&sessions, "P01").await.expect("attached");
        read_until(&mut client, "ready").await;
        // Fewer messages than may wait for the process, and more output than may wait for the client.
        let line = format!("{}\n", "x".repeat(200));
        for _ in 0..900 {
            client.send_input(line.as_bytes());
            tokio::task::yield_now().await;
        }
        client.send_input(b"last\n");
        let text = read_until(&mut client, "got last").await;
        assert!(text.len() < 200_000, "{} bytes", text.len());
    });
}

#[test]
fn host_folder_contains_only_the_participants_own_row() {
    let study = study();
    let folder = open(study.path());
    let copy = folder.session_folder("P01").join("study");
    let row = std::fs::read_to_string(copy.join("assignment.csv")).expect("a file");
    assert_eq!(row, "label,condition,seed,order\nP01,A,6412398461,1\n");
    let copied = novamind_study::Study::load(&copy).expect("a study");
    assert_eq!(copied.digest, folder.study().digest);
    for path in [folder.path(), &folder.session_folder("P01"), &copy] {
        let mode = std::fs::metadata(path).expect("a folder").permissions().mode();
        assert_eq!(mode & 0o777, 0o700, "{}", path.display());
    }
}

#[test]
fn host_folder_of_another_version_or_protocol_is_refused_after_a_start() {
    let study = study();
    let folder = open(study.path());
    // No session has started, so another version may continue.
    HostFolder::open_or_create(study.path(), &version("2")).expect("a host folder");
    std::fs::create_dir(folder.runs_folder("P02").join("participants")).expect("a run");
    let problem = HostFolder::open_or_create(study.path(), &version("3")).expect_err("refused").to_string();
    assert!(problem.contains("novamind 2 (mechanics 1)") && problem.contains("novamind 3"), "{problem}");
    HostFolder::open_or_create(study.path(), &version("2")).expect("a host folder");
    let protocol = study.path().join("study.toml");
    let text = std::fs::read_to_string(&protocol).expect("a file");
    std::fs::write(&protocol, text.replace("A company", "Another company")).expect("written");
    let problem = HostFolder::open_or_create(study.path(), &version("2")).expect_err("refused").to_string();
    assert!(problem.contains("the protocol was changed"), "{problem}");
}

#[test]
fn added_participants_get_sessions_and_changed_rows_are_refused() {
    let study = study();
    let folder = open(study.path());
    let assignment = study.path().join("assignment.csv");
    let text = std::fs::read_to_string(&assignment).expect("a file");
    std::fs::write(&assignment, format!("{text}P03,A,6412398461,3\n")).expect("written");
    let folder_again = open(study.path());
    assert!(folder_again.session_folder("P03").join("study/study.toml").exists());
    std::fs::create_dir(folder.runs_folder("P02").join("participants")).expect("a run");
    std::fs::write(&assignment, text.replace("7512398462", "7512398463")).expect("written");
    let problem = HostFolder::open_or_create(study.path(), &version("1")).expect_err("refused").to_string();
    assert!(problem.contains("the row of P02"), "{problem}");
}
