//! The curve explorer: who may see which values, and which lines an inspection records.

use novamind::insight::{CurveExplorer, CurveLook};
use novamind::record::mode::Mode;
use novamind::record::trajectory::Trajectory;
use novamind::session::lines_afterwards;
use novamind::world::identifiers::Group;

use crate::support::company::{begin_run, open_shop, week};
use crate::support::record::looks;

#[test]
fn unfinished_runs_are_told_of_studies_and_runs_that_are_over_of_the_truth() {
    let folder = tempfile::tempdir().expect("a folder");
    let s1 = Group::parse("S1").expect("a group");
    let unknown = Group::parse("D_S05").expect("a group");
    for mode in [Mode::Baseline, Mode::Sandbox, Mode::Lesson] {
        let mut session = begin_run(folder.path(), mode, 28);
        open_shop(&mut session);
        week(&mut session);
        let place = session.folder().expect("a folder").to_owned();
        let read = || Trajectory::read(&place.join("trajectory.jsonl")).expect("lines");
        let before = read().lines.len();
        assert!(!CurveExplorer::of(&mut session, s1).expect("estimates").is_truth());
        let refused = CurveExplorer::of(&mut session, unknown).expect_err("not found yet");
        assert_eq!(
            refused.to_string(),
            "group_not_discovered (group): group D_S05 is not known yet; the known groups are S1, S2, S3, E1, E2, E3"
        );
        assert_eq!(CurveLook::begin(&mut session, s1, 7).expect_err("hidden").code, "not_in_this_mode");
        assert_eq!(read().lines.len(), before, "no hidden value was shown, so no line is recorded");
        session.end().expect("it ends");
        assert!(CurveExplorer::of(&mut session, s1).expect("the truth").is_truth());
        assert!(CurveExplorer::of(&mut session, unknown).expect("the truth").is_truth());
        drop(session);
        let after = lines_afterwards(&place, &read()).expect("lines");
        assert_eq!(looks(&after), ["curve S1 7", "curve D_S05 7"]);
    }
}
