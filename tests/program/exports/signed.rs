//! Archives signed by a lab: import reports the signer and rejects later changes.

use std::fs;

use novamind::session::{LabKey, Seal};

use super::{archive_contents, import_archive, played_run, text, write_forged_archive};
use crate::support::home::{Home, run_id};

/// A function that changes a file of an archive. If the function returns `None`, the file is removed.
type FileChange<'a> = &'a dyn Fn(&str, Vec<u8>) -> Option<Vec<u8>>;

#[test]
fn signature_names_the_signer_and_rejects_modifications() {
    let (home, other) = (Home::new(), Home::new());
    let run = played_run(&home, "P01");
    let key = LabKey::generate().expect("a key");
    let file = home.0.path().join("lab.key");
    key.write(&file).expect("written");
    let archive = home.0.path().join("signed.tar");
    let export = |out: &std::path::Path, key: &std::path::Path| {
        home.run(&["runs", "export", &run_id(&run), "--out", &text(out), "--lab-key", &text(key)])
    };
    assert_eq!(export(&archive, &file).exit_code, 0);
    let whole = archive_contents(&archive);
    let name = |file: &str| format!("{}/{file}", run_id(&run));
    assert!(whole.contains_key(&name("seal.sig")));
    let fingerprint = key.public_key().fingerprint();

    let bad = home.0.path().join("bad.tar");
    let files = |change: FileChange<'_>| {
        let changed =
            whole.iter().filter_map(|(name, bytes)| Some((name.clone(), change(name, bytes.clone())?)));
        write_forged_archive(&bad, &changed.collect::<Vec<_>>());
    };
    // The seal is consistent but differs from the signed seal.
    files(&|name, bytes| {
        if !name.ends_with("seal.toml") {
            return Some(bytes);
        }
        let seal: Seal = toml::from_str(&String::from_utf8(bytes).expect("text")).expect("a seal");
        Some(
            Seal { created: "2026-01-01T00:00:00Z".to_owned(), ..seal }
                .with_checksum()
                .to_toml()
                .into_bytes(),
        )
    });
    import_archive(&other, &bad).assert_fails(3, &["seal.sig does not belong to seal.toml"]);
    files(&|name, bytes| Some(if name.ends_with("seal.sig") { Vec::new() } else { bytes }));
    import_archive(&other, &bad).assert_fails(3, &["seal.sig cannot be read"]);
    files(&|name, bytes| Some(if name.ends_with("seal.sig") { vec![b'#'; 4096] } else { bytes }));
    import_archive(&other, &bad).assert_fails(3, &["seal.sig is too large"]);

    let program_output = import_archive(&other, &archive);
    assert!(
        program_output.exit_code == 0
            && program_output.stdout.contains(&format!("signed by the lab key {fingerprint}")),
        "{}",
        program_output.stdout
    );
    // Without its signature, the archive is a valid unsigned archive.
    files(&|name, bytes| (!name.ends_with("seal.sig")).then_some(bytes));
    let output = import_archive(&other, &bad);
    assert!(
        output.exit_code == 0 && output.stdout.contains("not signed"),
        "{}{}",
        output.stdout,
        output.stderr
    );
    // An invalid key is reported before the run is simulated, and no file is written.
    let nothing = home.0.path().join("nothing.tar");
    fs::write(&file, "no key").expect("written");
    let output = export(&nothing, &file);
    assert!(
        output.exit_code != 0
            && output.stderr.contains("is not a key file of this kind")
            && !nothing.exists(),
        "{}",
        output.stderr
    );
}
