//! The manifest of a run, derived from the first line of its trajectory. `run.toml` repeats the manifest and is
//! rebuilt if the two differ.

use std::collections::BTreeSet;
use std::io::{BufRead, BufReader};
use std::path::Path;

use toml::{Table, Value};

use super::manifest::Manifest;
use crate::error::RunError;
use crate::files::open_regular_file;
use crate::trajectory::Line;

/// The manifest of a run, and the defect of `run.toml`, if any.
pub struct ManifestCheck {
    /// Manifest from the first line of the trajectory, or from `run.toml` if the first line cannot be read.
    pub manifest: Manifest,
    /// Why `run.toml` has to be rebuilt; `None` if the file agrees with the first line.
    pub problem: Option<String>,
}

impl ManifestCheck {
    /// Reads the manifest of the run in a folder. If the first line cannot be read, uses `run.toml`. Opening the run
    /// then reports the damaged line.
    ///
    /// # Errors
    /// The run has another format or other mechanics, or neither file can be read.
    pub fn read(folder: &Path) -> Result<ManifestCheck, RunError> {
        let path = folder.join("trajectory.jsonl");
        let file_manifest = Manifest::read(folder);
        let Some(line) = read_first_line(&path) else {
            return file_manifest.map(|manifest| ManifestCheck { manifest, problem: None });
        };
        let line_manifest = Manifest::from_start_line(&path, Some(&line))?;
        let (manifest, problem) = match file_manifest {
            Err(error) => (line_manifest, Some(describe_manifest_error(&error))),
            // The files belong to different runs, and the folder name differs from the run id in the trajectory.
            Ok(file_manifest)
                if file_manifest.id != line_manifest.id && !folder.ends_with(&line_manifest.id) =>
            {
                (file_manifest, None)
            }
            Ok(file_manifest) => {
                let manifest = with_unrecorded_fields(line_manifest, &file_manifest);
                let problem = differing_field_names(&file_manifest, &manifest)
                    .map(|names| format!("run.toml differed ({names})"));
                (manifest, problem)
            }
        };
        Ok(ManifestCheck { manifest, problem })
    }

    /// Rebuilds `run.toml` if necessary. Returns a message for the user if the file was rebuilt.
    ///
    /// # Errors
    /// The folder cannot be written.
    pub fn repair_manifest(&self, folder: &Path) -> Result<Option<String>, RunError> {
        let Some(problem) = &self.problem else { return Ok(None) };
        self.manifest.write(folder)?;
        Ok(Some(format!("{problem} and was rebuilt from the first line of the trajectory.")))
    }
}

/// Returns the manifest of the run, derived from the first line of the trajectory.
///
/// # Errors
/// The same errors as [`read_manifest_text`].
pub fn read_manifest(folder: &Path) -> Result<Manifest, RunError> {
    ManifestCheck::read(folder).map(|derived| derived.manifest)
}

/// Returns the text of `run.toml`, derived from the first line of the trajectory.
///
/// # Errors
/// The run has another format or other mechanics, or neither file can be read.
pub fn read_manifest_text(folder: &Path) -> Result<String, RunError> {
    ManifestCheck::read(folder).map(|derived| derived.manifest.to_toml())
}

/// Reads the first line of a file, or returns `None` if the line is incomplete.
fn read_first_line(path: &Path) -> Option<Line> {
    let mut bytes = Vec::new();
    BufReader::new(open_regular_file(path).ok()?).read_until(b'\n', &mut bytes).ok()?;
    Line::parse_first(bytes.strip_suffix(b"\n")?)
}

/// Adds the fields that only `run.toml` contains.
fn with_unrecorded_fields(manifest: Manifest, file_manifest: &Manifest) -> Manifest {
    // The first line is written shortly after the run was created. In format 1, the line does not list earlier runs.
    let earlier_runs = if manifest.format == 1 { file_manifest.earlier_runs } else { manifest.earlier_runs };
    Manifest { created: file_manifest.created.clone(), earlier_runs, ..manifest }
}

fn describe_manifest_error(error: &RunError) -> String {
    match error {
        RunError::Io { error, .. } if error.kind() == std::io::ErrorKind::NotFound => {
            "run.toml was missing".to_owned()
        }
        RunError::Damaged { line, problem, .. } => {
            format!("run.toml was damaged (line {line}: {})", problem.trim())
        }
        RunError::OtherFormat { .. } => "run.toml had another format".to_owned(),
        RunError::OtherMechanics { .. } => "run.toml had other mechanics".to_owned(),
        error => format!("run.toml could not be read ({error})"),
    }
}

/// Checks that a manifest and the first line of a trajectory agree in all common fields.
///
/// # Errors
/// The line does not start a run, or a field differs. In both cases, one of the two files belongs to another run.
pub fn check_start(path: &Path, first: Option<&Line>, manifest: &Manifest) -> Result<(), RunError> {
    let line_manifest = Manifest::from_start_line(path, first)?;
    let Some(names) = differing_field_names(manifest, &with_unrecorded_fields(line_manifest, manifest))
    else {
        return Ok(());
    };
    Err(RunError::Damaged {
        path: path.to_owned(),
        line: 1,
        problem: format!("the start of the trajectory contradicts run.toml ({names})"),
        remedy: "Nothing was changed; restore run.toml or the trajectory from a copy".to_owned(),
    })
}

/// Returns one sentence for each field in which `run.toml` differs from `manifest`, the manifest of the first line.
pub fn manifest_differences(folder: &Path, manifest: &Manifest) -> Vec<String> {
    let file_manifest = match Manifest::read(folder) {
        Ok(file_manifest) => file_manifest,
        Err(error) => return vec![describe_manifest_error(&error)],
    };
    let shown = |value: Option<Value>| value.map_or("nothing".to_owned(), |value| value.to_string());
    let differ = differing_fields(&file_manifest, &with_unrecorded_fields(manifest.clone(), &file_manifest))
        .into_iter();
    let words = |(name, in_file, in_line): (String, Option<Value>, Option<Value>)| {
        format!("run.toml has {name} = {}, the first line has {}", shown(in_file), shown(in_line))
    };
    differ.map(words).collect()
}

/// Returns the names of the differing fields, separated by commas, or `None` if the manifests are equal.
fn differing_field_names(manifest: &Manifest, other: &Manifest) -> Option<String> {
    let names: Vec<String> = differing_fields(manifest, other).into_iter().map(|(name, ..)| name).collect();
    (!names.is_empty()).then(|| names.join(", "))
}

fn differing_fields(manifest: &Manifest, other: &Manifest) -> Vec<(String, Option<Value>, Option<Value>)> {
    if manifest == other {
        return Vec::new();
    }
    let fields = |manifest: &Manifest| match Value::try_from(manifest) {
        Ok(Value::Table(table)) => table,
        _ => Table::new(),
    };
    let (manifest, other) = (fields(manifest), fields(other));
    let names: BTreeSet<&String> = manifest.keys().chain(other.keys()).collect();
    let differ = names.into_iter().filter(|name| manifest.get(*name) != other.get(*name));
    differ.map(|name| (name.clone(), manifest.get(name).cloned(), other.get(name).cloned())).collect()
}
