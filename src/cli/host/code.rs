//! `novamind host code`: sets the code for the experimenter's page.

use std::path::Path;

use super::open_folder;
use crate::cli::study::code::{new_salt, read_new_code};
use crate::cli::{Failure, print};
use novamind_study::CodeDigest;

pub fn run(study: &Path) -> Result<(), Failure> {
    let mut folder = open_folder(study)?;
    let code = read_new_code()?;
    folder.save_settings(None, Some(CodeDigest::from_code(&code, &new_salt())))?;
    print("saved the code for the experimenter's page. Restart the host if it is running\n")
}
