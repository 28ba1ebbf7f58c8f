//! `novamind study new`: creates the folder of a study.

use std::path::{Path, PathBuf};

use clap::Args;
use include_dir::{Dir, include_dir};

use crate::cli::{Failure, print};
use crate::record::error::RunError;
use novamind_study::{STUDY_FILE, Study};

static TEMPLATE: Dir<'_> = include_dir!("$CARGO_MANIFEST_DIR/assets/study");

#[derive(Debug, Args)]
pub struct Options {
    /// Folder to create
    #[arg(value_name = "DIR")]
    folder: PathBuf,
    /// Name of the study: letters, digits and hyphens [default: the name of the folder]
    #[arg(long)]
    name: Option<String>,
}

pub fn run(options: &Options) -> Result<(), Failure> {
    let folder = &options.folder;
    if folder.join(STUDY_FILE).exists() {
        return Err(Failure::failed(format!("{} is already a study; nothing was changed", folder.display())));
    }
    let folder_name = || folder.file_name().map(|name| name.to_string_lossy().into_owned());
    let name = options.name.clone().or_else(folder_name).unwrap_or_else(|| "study".to_owned());
    let plain = |letter: char| if letter.is_ascii_alphanumeric() { letter } else { '-' };
    let name: String = name.chars().map(plain).collect();
    write_template(&TEMPLATE, folder, &name)?;
    let study = Study::load(folder)?;
    print(&format!(
        "{}: edit {STUDY_FILE}, consent.md and questions/, then run\n\n    novamind study check {0}\n    novamind study assign {0} \
         --participants N\n    novamind --study {0}\n\nProtocol {}\n",
        folder.display(),
        study.digest
    ))
}

fn write_template(from: &Dir<'_>, to: &Path, name: &str) -> Result<(), Failure> {
    for file in from.files() {
        let path = to.join(file.path());
        let parent = path.parent().unwrap_or(to);
        std::fs::create_dir_all(parent).map_err(RunError::io(parent))?;
        let text = file.contents_utf8().unwrap_or_default().replace("{name}", name);
        std::fs::write(&path, text).map_err(RunError::io(&path))?;
    }
    from.dirs().try_for_each(|inner| write_template(inner, to, name))
}
