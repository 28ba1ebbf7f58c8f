//! Sealed snapshots: the file alone reveals no data, and a snapshot that was sealed by a study can only be read with
//! the study's key.

use std::fs;

use novamind::record::folder::configuration::Configuration;
use novamind::session::{Access, NewRun, SealKey, Session, Storage};

use super::random_play::advance_week;
use super::run::{copy_run, create_run, open_run, session_view, temporary_runs_folder};
use crate::support::company::apply_opening_decisions;

const TITLE: &[u8] = b"novamind snapshot 6\n";

#[test]
fn snapshot_is_encrypted() {
    let runs_folder = temporary_runs_folder();
    let mut session = create_run(runs_folder.path(), 5, 60);
    apply_opening_decisions(&mut session);
    session.set_notes("content marketing").expect("notes");
    let folder = session.folder().expect("a folder").to_owned();
    let mut files = Vec::new();
    for _ in 0..2 {
        advance_week(&mut session);
        session.save().expect("saved");
        files.push(fs::read(folder.join("snapshot.bin")).expect("a snapshot"));
    }
    for file in &files {
        let sealed = file.strip_prefix(TITLE).expect("a title");
        let text = |byte: &u8| byte.is_ascii_graphic() || *byte == b' ';
        let longest = sealed.split(|byte| !text(byte)).map(<[u8]>::len).max().expect("bytes");
        // Random bytes of this length contain sequences of up to about twenty printable bytes by chance.
        assert!(longest < 32, "{longest} printable bytes in a row");
        let mut counts = [0usize; 256];
        sealed.iter().for_each(|byte| counts[usize::from(*byte)] += 1);
        let even = sealed.len() / 256;
        assert!(even > 200, "enough bytes to count: {}", sealed.len());
        assert!(
            counts.iter().all(|count| (even / 2..even * 2).contains(count)),
            "some bytes are more frequent"
        );
    }
    let shared =
        files[0].iter().zip(&files[1]).skip(TITLE.len() + 1).filter(|(one, other)| one == other).count();
    assert!(shared * 100 < files[0].len(), "two states share a key stream: {shared} equal bytes");
}

#[test]
fn study_snapshot_requires_its_seal_key() {
    let (runs_folder, other) = (temporary_runs_folder(), temporary_runs_folder());
    let key = SealKey::with_study_secret(&[3; 32]);
    let new = NewRun {
        seed: Some(5),
        days: Some(60),
        storage: Storage::Runs(runs_folder.path().to_owned()),
        seal_key: key.clone(),
        ..NewRun::default()
    };
    let mut session = Session::create(new, &Configuration::bundled()).expect("a run");
    apply_opening_decisions(&mut session);
    advance_week(&mut session);
    session.save().expect("saved");
    let expected = session_view(&mut session);
    let folder = session.folder().expect("a folder").to_owned();
    drop(session);
    let with = |name: &str, key: &SealKey| {
        let place = copy_run(&folder, &other.path().join(name));
        let mut session =
            Session::open_sealed(&place, Access::Write, true, key.clone()).expect("the run opens anyway");
        assert_eq!(session_view(&mut session), expected, "{name}");
        session.remarks().join(" ")
    };
    assert_eq!(with("the secret", &key), "");
    let remark = with("none", &SealKey::default());
    assert!(remark.contains("sealed with the key of a study and is not used"), "{remark}");
    let remark = with("another", &SealKey::with_study_secret(&[4; 32]));
    assert!(remark.contains("damaged or belongs to another run"), "{remark}");
    // A session that was opened with the key seals its snapshots with the key again.
    let mut session = Session::open_sealed(&folder, Access::Write, true, key.clone()).expect("it opens");
    advance_week(&mut session);
    session.save().expect("saved");
    drop(session);
    assert_eq!(fs::read(folder.join("snapshot.bin")).expect("a snapshot")[TITLE.len()], b's');
    // A run that was created outside of a study can also be opened with the key of a study.
    let mut plain = create_run(runs_folder.path(), 6, 60);
    plain.save().expect("saved");
    let folder = plain.folder().expect("a folder").to_owned();
    drop(plain);
    let session = Session::open_sealed(&folder, Access::Write, true, key).expect("it opens");
    assert_eq!(session.remarks(), [""; 0]);
    drop(session);
    assert_eq!(open_run(&folder).day(), 0);
}
