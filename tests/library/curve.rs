//! The curve explorer: which values a run may show, and which lines an inspection records.

use novamind::insight::{CurveExplorer, CurveInspection};
use novamind::record::mode::Mode;
use novamind::record::trajectory::Trajectory;
use novamind::session::read_afterwards;
use novamind::world::identifiers::Group;

use crate::support::company::{advance_week, apply_opening_decisions, begin_run};
use crate::support::record::inspections;

#[test]
fn curve_uses_estimates_until_the_run_is_over() {
    let folder = tempfile::tempdir().expect("a folder");
    let s1 = Group::parse("S1").expect("a group");
    let unknown = Group::parse("D_S05").expect("a group");
    for mode in [Mode::Baseline, Mode::Sandbox, Mode::Lesson] {
        let mut session = begin_run(folder.path(), mode, 28);
        apply_opening_decisions(&mut session);
        advance_week(&mut session);
        let place = session.folder().expect("a folder").to_owned();
        let read = || Trajectory::read(&place.join("trajectory.jsonl")).expect("lines");
        let before = read().lines.len();
        assert!(!CurveExplorer::open(&mut session, s1).expect("estimates").shows_true_values());
        let refused = CurveExplorer::open(&mut session, unknown).expect_err("not found yet");
        assert_eq!(
            refused.to_string(),
            "group_not_discovered (group): group D_S05 is not known yet; the known groups are S1, S2, S3, E1, E2, E3"
        );
        assert_eq!(
            CurveInspection::record(&mut session, s1, 7).expect_err("hidden").code,
            "not_in_this_mode"
        );
        assert_eq!(read().lines.len(), before, "no hidden value was shown, so no line is recorded");
        session.abandon().expect("it ends");
        assert!(CurveExplorer::open(&mut session, s1).expect("the truth").shows_true_values());
        assert!(CurveExplorer::open(&mut session, unknown).expect("the truth").shows_true_values());
        drop(session);
        let after = read_afterwards(&place, &read()).expect("lines");
        assert_eq!(inspections(&after), ["curve S1 7", "curve D_S05 7"]);
    }
}
