//! Build script: rebuilds the crate when a file is added to an embedded folder. The compiler tracks only the files
//! that already exist.

/// Folders whose files are all embedded in the program.
const BUNDLED_FOLDERS: [&str; 2] = ["assets", "configs"];

fn main() {
    for folder in BUNDLED_FOLDERS {
        println!("cargo:rerun-if-changed=../../{folder}");
    }
}
