//! Writes output files of commands completely or leaves them unchanged. Devices and pipes are written to but
//! never replaced. An existing file with a different signature is never replaced, because it may be a run, a
//! policy or a study.

use std::fs::File;
use std::io::{self, BufWriter, Read, Write};
use std::path::Path;

use super::Failure;
use crate::record::files::parent_folder;

/// Number of leading bytes that identify the kind of a file.
const SIGNATURE_BYTES: u64 = 8;

const OTHER_FILE_MESSAGE: &str =
    "the file exists and was not written by this command: choose another name, or delete it";

/// Writes `text` to a file.
///
/// # Errors
/// The file cannot be written. An existing file stays unchanged.
pub fn write_text(place: &Path, text: &str) -> Result<(), Failure> {
    write_file(place, None, |out| out.write_all(text.as_bytes()))
}

/// Writes an output file. `safe` describes the data that is not lost, and is appended to the error message.
///
/// # Errors
/// The file cannot be written. An existing file stays unchanged.
pub fn write_file(
    place: &Path,
    safe: Option<&str>,
    write: impl FnOnce(&mut BufWriter<File>) -> io::Result<()>,
) -> Result<(), Failure> {
    let is_special = std::fs::metadata(place).is_ok_and(|found| !found.is_file());
    let written = if is_special {
        File::options().write(true).open(place).and_then(|file| write_and_sync(file, write).map(drop))
    } else {
        replace_file(place, write)
    };
    written.map_err(|error| {
        let safe = safe.map_or(String::new(), |safe| format!(", {safe}"));
        Failure::failed(format!("{}: {error}; the file was not written{safe}", place.display()))
    })
}

/// Writes a temporary file next to the target, and renames the complete file to the target.
fn replace_file(place: &Path, write: impl FnOnce(&mut BufWriter<File>) -> io::Result<()>) -> io::Result<()> {
    let name = place.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
    let draft = place.with_file_name(format!(".{name}.draft"));
    let written = File::create(&draft)
        .and_then(|file| write_and_sync(file, write)?.sync_all())
        .and_then(|()| check_same_kind(place, &draft))
        .and_then(|()| std::fs::rename(&draft, place));
    if written.is_err() {
        let _ = std::fs::remove_file(&draft);
    }
    written
}

/// Checks that an existing file begins with the first bytes of `expected`.
///
/// # Errors
/// The file begins with other bytes or cannot be read.
pub fn check_signature(place: &Path, expected: &str) -> Result<(), Failure> {
    let is_file = std::fs::metadata(place).is_ok_and(|found| found.is_file());
    let there = if is_file { read_signature(place) } else { Ok(Vec::new()) };
    let bytes: Vec<u8> = expected.bytes().take(SIGNATURE_BYTES as usize).collect();
    match there {
        Ok(there) if there.is_empty() || there == bytes => Ok(()),
        Ok(_) => Err(Failure::failed(format!("{}: {OTHER_FILE_MESSAGE}", place.display()))),
        Err(error) => Err(Failure::failed(format!("{}: {error}", place.display()))),
    }
}

fn read_signature(path: &Path) -> io::Result<Vec<u8>> {
    let mut first = Vec::new();
    File::open(path)?.take(SIGNATURE_BYTES).read_to_end(&mut first)?;
    Ok(first)
}

/// Returns an error if the existing file and the new file begin with different bytes.
fn check_same_kind(place: &Path, draft: &Path) -> io::Result<()> {
    match read_signature(place) {
        Ok(there) if !there.is_empty() && there != read_signature(draft)? => {
            Err(io::Error::other(OTHER_FILE_MESSAGE))
        }
        Err(error) if error.kind() != io::ErrorKind::NotFound => Err(error),
        _ => Ok(()),
    }
}

fn write_and_sync(
    file: File,
    write: impl FnOnce(&mut BufWriter<File>) -> io::Result<()>,
) -> io::Result<File> {
    let mut file = BufWriter::new(file);
    write(&mut file)?;
    Ok(file.into_inner()?)
}

/// Returns whether two paths name the same file. The file need not exist.
pub fn is_same_file(one: &Path, other: &Path) -> bool {
    let place = |path: &Path| {
        path.canonicalize()
            .ok()
            .or_else(|| Some(parent_folder(path).canonicalize().ok()?.join(path.file_name()?)))
    };
    place(one).is_some_and(|one| place(other) == Some(one))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn write_replaces_a_file_only_when_complete() {
        let folder = tempfile::tempdir().expect("a folder");
        let place = folder.path().join("report.md");
        write_text(&place, "# report one").expect("written");
        let half = write_file(&place, Some("the run is kept"), |out| {
            out.write_all(b"# report two")?;
            Err(io::Error::other("the disk is full"))
        });
        let text = half.expect_err("it fails").to_string();
        assert!(text.ends_with("the disk is full; the file was not written, the run is kept"), "{text}");
        assert_eq!(std::fs::read_to_string(&place).expect("a file"), "# report one");
        write_text(&place, "# report two").expect("written");
        assert_eq!(std::fs::read_to_string(&place).expect("a file"), "# report two");
        assert_eq!(std::fs::read_dir(folder.path()).expect("a folder").count(), 1, "no draft is left");
    }

    #[test]
    fn files_of_another_kind_are_not_replaced() {
        let folder = tempfile::tempdir().expect("a folder");
        let place = folder.path().join("trajectory.jsonl");
        for there in ["{\"seq\":0}\n", "name = \"mine\"\n", "run,policy\n"] {
            std::fs::write(&place, there).expect("a file");
            let text = write_text(&place, "<svg>").expect_err("refused").to_string();
            assert!(text.contains("was not written by this command"), "{text}");
            assert_eq!(std::fs::read_to_string(&place).expect("a file"), there);
        }
        std::fs::write(&place, "").expect("an empty file");
        write_text(&place, "<svg>").expect("nothing was there");
        assert_eq!(std::fs::read_dir(folder.path()).expect("a folder").count(), 1, "no draft is left");
    }

    #[test]
    #[cfg(unix)]
    fn devices_are_not_replaced() {
        use std::os::unix::fs::{FileTypeExt, symlink};
        let folder = tempfile::tempdir().expect("a folder");
        let link = folder.path().join("out");
        symlink("/dev/null", &link).expect("a link");
        write_text(&link, "text").expect("written");
        assert!(std::fs::symlink_metadata(&link).expect("a link").file_type().is_symlink());
        assert!(std::fs::metadata("/dev/null").expect("a device").file_type().is_char_device());
    }

    #[test]
    fn is_same_file_resolves_paths() {
        let folder = tempfile::tempdir().expect("a folder");
        let (there, not_yet) = (folder.path().join("a"), folder.path().join("b"));
        write_text(&there, "").expect("written");
        assert!(is_same_file(&there, &folder.path().join("./a")));
        assert!(is_same_file(&not_yet, &folder.path().join("./b")));
        assert!(!is_same_file(&there, &not_yet));
    }
}
