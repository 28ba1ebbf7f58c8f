//! Files that the console writes. Existing files are never overwritten.

use std::fs::File;
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::sync::mpsc::Sender;

use novamind_record::folder::configuration::Configuration;
use novamind_record::folder::query_library;
use novamind_record::folder::query_library::QueryLibrary;
use novamind_tools::Rejection;
use novamind_worker::answer_on_thread;
use novamind_worker::message::{Message, Response};

/// Writes files in the background and reports their paths.
pub fn write_in_background(files: Vec<(PathBuf, Vec<u8>)>, news: Sender<Message>) {
    let write = |(path, contents): (PathBuf, Vec<u8>)| {
        let refused = |error| Rejection::new("io_error", format!("{}: {error}", path.display()));
        write_to_free_name(&path, &contents).map_err(refused)
    };
    let work = move || files.into_iter().map(write).collect::<Result<Vec<PathBuf>, _>>().map(Some);
    answer_on_thread(news, work, |written| {
        Response::FilesWritten(
            written.map(|paths| format_paths(&paths)).map_err(|rejection| rejection.message),
        )
    });
}

/// Saves a user's query in the background and reports the new query library.
pub fn save_query_in_background(
    configuration: Configuration,
    [name, title, sql]: [String; 3],
    news: Sender<Message>,
) {
    let work = move || match query_library::save_query(&configuration, &name, &title, &sql) {
        Ok(path) => Ok(Some((format!("saved: {}", path.display()), QueryLibrary::load(&configuration)))),
        Err(error) => Err(Rejection::new("io_error", error.to_string())),
    };
    answer_on_thread(news, work, |saved| Response::QuerySaved(saved.map_err(|rejection| rejection.message)));
}

/// Formats the full path of the first file and the names of the other files.
fn format_paths(paths: &[PathBuf]) -> String {
    let name = |path: &PathBuf| path.file_name().unwrap_or_default().to_string_lossy().into_owned();
    let mut words: Vec<String> = paths.iter().map(name).collect();
    if let Some((first, path)) = words.first_mut().zip(paths.first()) {
        *first = path.display().to_string();
    }
    format!("written: {}", words.join(", "))
}

/// Writes a new file. If the name exists, the number in the name is increased until the name is free.
///
/// # Errors
/// The file cannot be written.
fn write_to_free_name(path: &Path, contents: &[u8]) -> io::Result<PathBuf> {
    let mut path = path.to_owned();
    loop {
        match File::options().write(true).create_new(true).open(&path) {
            Ok(mut file) => return file.write_all(contents).map(|()| path),
            Err(error) if error.kind() == io::ErrorKind::AlreadyExists => path = next_name(&path),
            Err(error) => return Err(error),
        }
    }
}

/// Returns the file name with the next number: `query-0007.csv` after `query-0006.csv`, `note-0002.txt` after
/// `note.txt`.
fn next_name(path: &Path) -> PathBuf {
    let stem = path.file_stem().map_or(String::new(), |stem| stem.to_string_lossy().into_owned());
    let numbered = stem.rsplit_once('-').and_then(|(name, number)| Some((name, number.parse::<u32>().ok()?)));
    let (name, number) = numbered.unwrap_or((stem.as_str(), 1));
    let next = format!("{name}-{:04}", number.saturating_add(1));
    let extension = path
        .extension()
        .map_or(String::new(), |extension_text| format!(".{}", extension_text.to_string_lossy()));
    path.with_file_name(next + &extension)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn writing_never_overwrites_a_file() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("query-0001.csv");
        for (number, text) in [(1, "a"), (2, "b"), (3, "c")] {
            let written = write_to_free_name(&path, text.as_bytes()).expect("written");
            assert_eq!(written, folder.path().join(format!("query-{number:04}.csv")));
            assert_eq!(std::fs::read_to_string(written).expect("text"), text);
        }
        assert_eq!(next_name(Path::new("/x/note.txt")), Path::new("/x/note-0002.txt"));
        assert_eq!(next_name(Path::new("/x/my-note")), Path::new("/x/my-note-0002"));
        assert!(write_to_free_name(Path::new("/nowhere/at/all.csv"), b"").is_err());
        assert_eq!(format_paths(&["/x/a.md".into(), "/x/a.html".into()]), "written: /x/a.md, a.html");
    }
}
