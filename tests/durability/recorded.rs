//! Runs that other builds recorded are played again to the same states.
//!
//! `tests/data/recorded` holds a run recorded by a development build and one recorded by a release build, which are
//! both verified by whatever build runs the tests. They also pin the mechanics: whoever changes what decisions lead
//! to raises `world::MECHANICS` and records them anew.

use std::fs;
use std::path::Path;

use novamind::session::{Access, Session, verify};

use crate::run::{copy, runs};

fn recorded(build: &str) -> std::path::PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/recorded").join(build)
}

#[test]
fn runs_of_other_builds_reach_the_same_states() {
    let mut hashes = Vec::new();
    for build in ["development", "release"] {
        let found = verify(&recorded(build)).unwrap_or_else(|error| {
            panic!(
                "{error}\nIf the mechanics were changed on purpose, raise MECHANICS and record the runs anew."
            )
        });
        assert_eq!((found.day, found.states), (70, 10), "{build}");
        hashes.push(found.state_hash);
    }
    assert_eq!(hashes[0], hashes[1], "the same decisions were recorded by both builds");
}

#[test]
fn runs_of_other_mechanics_and_parameters_are_refused_with_the_version_that_can() {
    let place = runs();
    let folder = copy(&recorded("release"), place.path());
    let manifest = fs::read_to_string(folder.join("run.toml")).expect("a manifest");
    let digest = manifest.lines().find(|line| line.starts_with("parameters_digest")).expect("a digest");
    let mechanics = manifest.lines().find(|line| line.starts_with("mechanics")).expect("mechanics");
    for (old, new, told) in [
        (mechanics, "mechanics = 9", "mechanics 9"),
        (digest, "parameters_digest = \"0123\"", "parameters 0123"),
        ("format = 1", "format = 7", "format 7"),
    ] {
        let changed = manifest.replace(old, new).replace("version = \"0.1.0\"", "version = \"0.9.3\"");
        fs::write(folder.join("run.toml"), changed).expect("written");
        let error = Session::open(&folder, Access::Write, true).err().expect("it is refused").to_string();
        assert!(error.contains(told) && error.contains("nothing was changed"), "{error}");
        assert!(error.contains("0.9.3") || error.contains("newer version"), "{error}");
    }
    fs::write(folder.join("run.toml"), manifest).expect("written");
    assert!(verify(&folder).is_ok(), "nothing was changed");
}
