//! Rebuilds the program when a file is added to an embedded folder, because the compiler only tracks existing files.

/// Folders that are embedded with all their contents.
const COMPILED_IN: [&str; 2] = ["assets", "configs"];

fn main() {
    for folder in COMPILED_IN {
        println!("cargo:rerun-if-changed=../../{folder}");
    }
}
