//! The program is rebuilt when a file is added to the folders that are compiled in: the compiler only tracks files that were there.

/// Folders whose contents are compiled in, with everything below them.
const COMPILED_IN: [&str; 2] = ["assets", "configs"];

fn main() {
    for folder in COMPILED_IN {
        println!("cargo:rerun-if-changed=../../{folder}");
    }
}
