//! The curve explorer line by line: who is told what, and what a look leaves behind.

use novamind::session::{
    Activity, Configuration, Mode, NewRun, Record, Session, Storage, Trajectory, lines_afterwards,
};
use novamind::world::identifiers::Group;

use crate::support::company::{open_shop, week};

fn run_in(folder: &std::path::Path, mode: Mode) -> Session {
    let new = NewRun {
        seed: Some(7),
        days: Some(28),
        mode,
        participant: (mode == Mode::Baseline).then(|| "P01".to_owned()),
        storage: Storage::Runs(folder.to_owned()),
        ..NewRun::default()
    };
    Session::create(new, &Configuration::shipped()).expect("the run begins")
}

fn looks(lines: &Trajectory) -> Vec<String> {
    let look = |record: &Record| match record {
        Record::Activity(Activity::Xray(look)) => {
            Some(format!("{} {} {}", look.what, look.which, look.shown_day))
        }
        _ => None,
    };
    lines.lines.iter().filter_map(|line| look(&line.record)).collect()
}

#[test]
fn unfinished_runs_are_told_of_studies_and_runs_that_are_over_of_the_truth() {
    let folder = tempfile::tempdir().expect("a folder");
    let s1 = Group::parse("S1").expect("a group");
    let unknown = Group::parse("D_S05").expect("a group");
    for mode in [Mode::Baseline, Mode::Sandbox, Mode::Lesson] {
        let mut session = run_in(folder.path(), mode);
        open_shop(&mut session);
        week(&mut session);
        let place = session.folder().expect("a folder").to_owned();
        let read = || Trajectory::read(&place.join("trajectory.jsonl")).expect("lines");
        let before = read().lines.len();
        assert!(!session.curve_explorer(s1).expect("estimates").is_truth());
        let refused = session.curve_explorer(unknown).expect_err("not found yet");
        assert_eq!(
            refused.to_string(),
            "group_not_discovered (group): group D_S05 is not known yet; the known groups are S1, S2, S3, E1, E2, E3"
        );
        assert_eq!(session.look_at_curve(s1, 7).expect_err("hidden").code, "not_in_this_mode");
        assert_eq!(read().lines.len(), before, "nothing hidden was shown, so nothing is recorded");
        session.end().expect("it ends");
        assert!(session.curve_explorer(s1).expect("the truth").is_truth());
        assert!(session.curve_explorer(unknown).expect("the truth").is_truth());
        drop(session);
        let after = lines_afterwards(&place, &read()).expect("lines");
        assert_eq!(looks(&after), ["curve S1 7", "curve D_S05 7"]);
    }
}
