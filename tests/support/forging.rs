//! Trajectories with deliberately forged chains.

use std::fs;
use std::path::Path;

use serde_json::Value;

/// Changes the lines of a trajectory and recomputes the checksums and the hash chain.
pub fn forge_lines(folder: &Path, change: impl Fn(usize, &mut Value)) {
    let path = folder.join("trajectory.jsonl");
    let text = fs::read_to_string(&path).expect("a trajectory");
    let mut previous = blake3::hash(b"").to_hex().to_string();
    let mut forged = String::new();
    for (at, line) in text.lines().enumerate() {
        let mut line: Value = serde_json::from_str(line).expect("JSON");
        change(at, &mut line);
        line["prev"] = previous.into();
        line.as_object_mut().expect("an object").shift_remove("sum");
        let bare = line.to_string();
        let sum = blake3::hash(bare.as_bytes()).to_hex()[..16].to_owned();
        let line = format!("{},\"sum\":\"{sum}\"}}", &bare[..bare.len() - 1]);
        previous = blake3::hash(line.as_bytes()).to_hex().to_string();
        forged.push_str(&line);
        forged.push('\n');
    }
    fs::write(path, forged).expect("written");
}
