//! A file that is added to a folder of `configs/` is compiled in at the next build.

fn main() {
    for folder in ["scenarios", "themes", "policies", "grids"] {
        println!("cargo:rerun-if-changed=configs/{folder}");
    }
}
