//! Rebuilds the program when a file is added to an embedded folder, because the compiler only tracks existing files.

/// Folders that are embedded with all their contents.
const BUNDLED_FOLDERS: [&str; 2] = ["assets", "configs"];

fn main() {
    for folder in BUNDLED_FOLDERS {
        println!("cargo:rerun-if-changed=../../{folder}");
    }
}
