//! Restrictions of the process of a session: it can read the system's programs and libraries and its own study, and
//! write only to its own folders. On Linux, Landlock enforces this for the process and everything that it starts.

use std::fmt;
use std::path::{Path, PathBuf};

use rustix::process::{Resource, Rlimit, setrlimit};

/// Largest number of files that a process of a session may open.
const MAX_OPEN_FILES: u64 = 512;
/// Size of the largest file that a process of a session may write, bytes.
const MAX_FILE_BYTES: u64 = 2 << 30;
/// Address space of a process of a session, bytes. Most of it is reserved and not used.
const MAX_ADDRESS_SPACE_BYTES: u64 = 16 << 30;

/// Files and folders of the system that a session may read or execute. Folders with accounts and keys are not among them.
#[cfg(target_os = "linux")]
const SYSTEM_READABLE: [&str; 16] = [
    "/bin",
    "/sbin",
    "/lib",
    "/lib64",
    "/usr",
    "/nix/store",
    "/run/current-system/sw",
    "/etc/ld.so.cache",
    "/etc/localtime",
    "/etc/machine-id",
    "/var/lib/dbus/machine-id",
    "/etc/hostname",
    "/proc/sys/kernel/random/boot_id",
    "/proc/uptime",
    "/proc/meminfo",
    "/proc/cpuinfo",
];
/// Devices that a session may read and write. `/dev/tty` is the terminal of the process itself.
#[cfg(target_os = "linux")]
const DEVICES: [&str; 5] = ["/dev/null", "/dev/zero", "/dev/urandom", "/dev/random", "/dev/tty"];

/// The reason why a process cannot be restricted.
#[derive(Debug)]
pub struct SandboxError(String);

impl fmt::Display for SandboxError {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        out.write_str(&self.0)
    }
}

impl std::error::Error for SandboxError {}

/// Sets the limits of the process of a session, and forbids core dumps, which would contain its memory.
///
/// # Errors
/// A limit cannot be set.
pub fn limit_session_resources() -> Result<(), SandboxError> {
    let limits = [
        (Resource::Core, 0),
        (Resource::Nofile, MAX_OPEN_FILES),
        (Resource::Fsize, MAX_FILE_BYTES),
        (Resource::As, MAX_ADDRESS_SPACE_BYTES),
    ];
    for (resource, limit) in limits {
        // A lower limit of the host stays.
        let limit = rustix::process::getrlimit(resource).maximum.map_or(limit, |maximum| maximum.min(limit));
        setrlimit(resource, Rlimit { current: Some(limit), maximum: Some(limit) })
            .map_err(|error| SandboxError(format!("the limit {resource:?} cannot be set: {error}")))?;
    }
    Ok(())
}

/// Restricts this process to the folder of its session. Call it before any thread is started.
///
/// # Errors
/// The system cannot restrict the process.
#[cfg(target_os = "linux")]
pub fn restrict_to_session(session: &Path) -> Result<(), SandboxError> {
    let writable = ["runs", "tmp"].map(|name| session.join(name));
    let readable = [session.join("study")];
    let program = std::env::current_exe().ok();
    linux::restrict(&writable, readable.iter().chain(program.iter()))
        .map_err(|error| SandboxError(format!("Landlock does not restrict the process: {error}")))
}

/// Restricts the calling thread, and the processes that it starts, to the programs and libraries of the system and the folder of
/// a script. Nothing can be written.
///
/// # Errors
/// The system cannot restrict the thread.
#[cfg(target_os = "linux")]
pub fn restrict_to_script(folder: &Path) -> Result<(), SandboxError> {
    linux::restrict(&[], [folder.to_owned()].iter())
        .map_err(|error| SandboxError(format!("Landlock does not restrict the script: {error}")))
}

/// Restricts this process to the folder of its session.
///
/// # Errors
/// This system has no Landlock.
#[cfg(not(target_os = "linux"))]
pub fn restrict_to_session(_session: &Path) -> Result<(), SandboxError> {
    Err(SandboxError("only Linux has Landlock".to_owned()))
}

/// Restricts the calling thread to the folder of a script.
///
/// # Errors
/// This system has no Landlock.
#[cfg(not(target_os = "linux"))]
pub fn restrict_to_script(_folder: &Path) -> Result<(), SandboxError> {
    Err(SandboxError("only Linux has Landlock".to_owned()))
}

/// Returns whether the system can restrict the processes of sessions completely.
///
/// # Errors
/// The error states what is missing.
pub fn check_sandbox_support() -> Result<(), SandboxError> {
    #[cfg(target_os = "linux")]
    return linux::check_support().map_err(SandboxError);
    #[cfg(not(target_os = "linux"))]
    Err(SandboxError("only Linux has Landlock".to_owned()))
}

#[cfg(target_os = "linux")]
mod linux {
    use super::{DEVICES, Path, PathBuf, SYSTEM_READABLE};
    use landlock::{
        ABI, Access, AccessFs, AccessNet, BitFlags, CompatLevel, Compatible, PathBeneath, PathFd, Ruleset,
        RulesetAttr, RulesetCreated, RulesetCreatedAttr, RulesetError, RulesetStatus, Scope,
    };

    /// Files, folders and TCP: Linux 6.7. Newer versions also restrict signals and Unix sockets.
    const REQUIRED: ABI = ABI::V4;
    const WANTED: ABI = ABI::V9;

    fn ruleset() -> Result<RulesetCreated, RulesetError> {
        Ruleset::default()
            .set_compatibility(CompatLevel::HardRequirement)
            .handle_access(AccessFs::from_all(REQUIRED))?
            .handle_access(AccessNet::from_all(REQUIRED))?
            .set_compatibility(CompatLevel::BestEffort)
            .handle_access(AccessFs::from_all(WANTED))?
            .scope(Scope::from_all(WANTED))?
            .create()
    }

    pub fn check_support() -> Result<(), String> {
        let explain = |error: RulesetError| {
            format!(
                "this system cannot restrict programs with Landlock (Linux 6.7 or newer is needed): {error}"
            )
        };
        ruleset().map(drop).map_err(explain)
    }

    pub fn restrict<'a>(
        writable: &[PathBuf],
        readable: impl Iterator<Item = &'a PathBuf>,
    ) -> Result<(), RulesetError> {
        let mut rules = ruleset()?;
        let read = AccessFs::from_read(WANTED);
        for path in SYSTEM_READABLE.iter().map(Path::new).chain(readable.map(PathBuf::as_path)) {
            rules = allow(rules, path, read)?;
        }
        // Files in these folders cannot be executed.
        let write =
            AccessFs::from_all(WANTED) & !AccessFs::Execute & !AccessFs::MakeSock & !AccessFs::IoctlDev;
        for path in writable {
            rules = allow(rules, path, write)?;
        }
        for path in DEVICES.iter().map(Path::new) {
            rules = allow(rules, path, AccessFs::ReadFile | AccessFs::WriteFile | AccessFs::IoctlDev)?;
        }
        let status = rules.restrict_self()?;
        debug_assert!(status.ruleset != RulesetStatus::NotEnforced);
        Ok(())
    }

    /// Allows access to a path. Paths that do not exist on this system are skipped.
    fn allow(
        rules: RulesetCreated,
        path: &Path,
        access: BitFlags<AccessFs>,
    ) -> Result<RulesetCreated, RulesetError> {
        let Ok(opened) = PathFd::new(path) else { return Ok(rules) };
        let access = if path.is_dir() { access } else { access & AccessFs::from_file(WANTED) };
        rules.add_rule(PathBeneath::new(opened, access))
    }
}

#[cfg(all(test, target_os = "linux"))]
mod tests {
    use std::fs::{read, read_dir, write};
    use std::net::{TcpListener, TcpStream};

    use super::*;

    fn create_folders(session: &Path) {
        for name in ["study", "runs", "tmp/script"] {
            std::fs::create_dir_all(session.join(name)).expect("a folder");
        }
    }

    /// Runs a check in a restricted thread: Landlock restricts only the thread that calls it and those that it starts.
    fn in_session(session: &Path, check: impl FnOnce() + Send + 'static) {
        let session = session.to_owned();
        let restricted = std::thread::spawn(move || {
            restrict_to_session(&session).expect("restricted");
            check();
        });
        restricted.join().expect("the checks pass");
    }

    #[test]
    fn session_reads_its_study_and_writes_only_its_own_folders() {
        if check_sandbox_support().is_err() {
            return;
        }
        let host = tempfile::tempdir().expect("a folder");
        let [own, other] = ["P01", "P02"].map(|label| host.path().join(label));
        for folder in [&own, &other] {
            create_folders(folder);
            write(folder.join("study/study.toml"), "name").expect("written");
        }
        write(host.path().join("access.json"), "{}").expect("written");
        let (host, root) = (host.path().to_owned(), own.clone());
        in_session(&root, move || {
            assert!(read(own.join("study/study.toml")).is_ok());
            assert!(
                write(own.join("runs/line"), "line").is_ok() && write(own.join("tmp/line"), "line").is_ok()
            );
            assert!(write(own.join("study/assignment.csv"), "label").is_err());
            assert!(std::fs::rename(own.join("runs/line"), other.join("runs/line")).is_err());
            for path in [Path::new("/etc/passwd"), &other.join("study/study.toml"), &host.join("access.json")]
            {
                assert!(read(path).is_err(), "{}", path.display());
            }
            for path in [
                Path::new("/etc"),
                Path::new("/proc"),
                Path::new("/root"),
                &host,
                &other,
                &other.join("runs"),
            ] {
                assert!(read_dir(path).is_err(), "{}", path.display());
            }
            assert!(read("/proc/self/environ").is_err() && read("/proc/1/cmdline").is_err());
            // A program in a folder that the session can write cannot be started.
            std::fs::copy("/bin/true", own.join("tmp/true")).expect("copied");
            assert!(std::process::Command::new(own.join("tmp/true")).status().is_err());
            assert!(std::process::Command::new("/bin/true").status().is_ok());
        });
    }

    #[test]
    fn script_reads_no_file_of_its_session() {
        if check_sandbox_support().is_err() {
            return;
        }
        let session = tempfile::tempdir().expect("a folder");
        create_folders(session.path());
        let own = session.path().to_owned();
        write(own.join("runs/run.toml"), "seed = 7").expect("written");
        in_session(session.path(), move || {
            let script = own.join("tmp/script");
            let (folder, run) = (script.clone(), own.join("runs/run.toml"));
            let restricted = std::thread::spawn(move || {
                restrict_to_script(&folder).expect("restricted");
                assert!(read_dir(&folder).is_ok() && write(folder.join("file"), "text").is_err());
                assert!(read(&run).is_err() && read_dir(run.parent().expect("a folder")).is_err());
                let printed = std::process::Command::new("cat").arg(&run).output().expect("cat runs");
                assert!(!printed.status.success() && printed.stdout.is_empty());
            });
            restricted.join().expect("the checks pass");
            assert!(read(own.join("runs/run.toml")).is_ok(), "the session keeps its access");
        });
    }

    /// Python code that lists what it can access of the paths in its arguments, its parent and the network.
    const PROBE: &str = r#"
import os, socket, sys
def attempt(name, work):
    try:
        work()
    except OSError:
        return
    print(name)
for path in sys.argv[2:]:
    attempt(path, lambda: open(path, "rb").read(1))
    attempt(path, lambda: os.listdir(path))
parent = os.getppid()
for name in ("environ", "mem", "maps", "cmdline", "status"):
    attempt("parent " + name, lambda: open(f"/proc/{parent}/{name}", "rb").read(1))
attempt("parent fd", lambda: os.listdir(f"/proc/{parent}/fd"))
attempt("signal", lambda: os.kill(parent, 0))
attempt("tcp", lambda: socket.create_connection(("127.0.0.1", int(sys.argv[1])), 2))
print("end")
"#;

    #[test]
    fn script_reaches_neither_the_session_nor_its_parent_nor_the_network() {
        let python = Path::new("/usr/bin/python3");
        if check_sandbox_support().is_err() || !python.exists() {
            return;
        }
        let host = tempfile::tempdir().expect("a folder");
        let [own, other] = ["P01", "P02"].map(|label| host.path().join(label));
        let mut paths = vec![host.path().to_owned(), own.join("study"), own.join("runs"), own.join("tmp")];
        for session in [&own, &other] {
            for name in ["study", "runs", "tmp/script"] {
                std::fs::create_dir_all(session.join(name)).expect("a folder");
            }
            for file in ["run.toml", "trajectory.jsonl"] {
                write(session.join("runs").join(file), "seed").expect("written");
                paths.push(session.join("runs").join(file));
            }
        }
        let listener = TcpListener::bind("127.0.0.1:0").expect("a port");
        let port = listener.local_addr().expect("an address").port().to_string();
        let script = own.join("tmp/script");
        // The parent is restricted to the session, as the process of a session is.
        in_session(&own, move || {
            let start = || {
                restrict_to_script(&script).expect("restricted");
                let mut command = std::process::Command::new(python);
                command.args(["-I", "-c", PROBE, &port]).args(&paths).current_dir(&script);
                command.output().expect("python starts")
            };
            let output = std::thread::scope(|scope| scope.spawn(start).join().expect("no panic"));
            let texts =
                [output.stdout, output.stderr].map(|text| String::from_utf8_lossy(&text).into_owned());
            assert_eq!(texts, ["end\n".to_owned(), String::new()]);
            // The restriction ends with the thread: the session still reads its own run.
            assert!(read(script.join("../../runs/run.toml")).is_ok());
        });
    }

    #[test]
    fn session_cannot_use_tcp() {
        if check_sandbox_support().is_err() {
            return;
        }
        let listener = TcpListener::bind("127.0.0.1:0").expect("a port");
        let address = listener.local_addr().expect("an address");
        assert!(TcpStream::connect(address).is_ok());
        let session = tempfile::tempdir().expect("a folder");
        in_session(session.path(), move || {
            assert!(TcpStream::connect(address).is_err());
            assert!(TcpListener::bind("127.0.0.1:0").is_err());
        });
    }
}
