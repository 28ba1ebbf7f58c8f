//! `novamind study key`: creates the keys of a study.

use std::path::Path;

use crate::cli::{Failure, print};
use novamind_study::{LAB_KEY_FILE, LAB_PUBLIC_KEY_FILE, SEAL_KEY_FILE, Study, create_missing_keys};

/// Creates the missing keys and explains how to use each key.
pub fn run(folder: &Path) -> Result<(), Failure> {
    Study::load(folder)?;
    let (public, written) = create_missing_keys(folder)?;
    let mut text: String = written.iter().map(|path| format!("wrote {}\n", path.display())).collect();
    if written.is_empty() {
        text += "all keys exist; nothing was written\n";
    }
    print(&format!(
        "{text}\n{LAB_KEY_FILE} signs archives: keep it secret, keep a copy, and keep it off the machines of participants\n\
         {SEAL_KEY_FILE} seals snapshots: copy it to every machine before its first session\n\
         {LAB_PUBLIC_KEY_FILE} verifies signatures: give it to anyone who receives archives\n\nfingerprint {}\n",
        public.fingerprint()
    ))
}
