//! Comparison of two days of a run, and of two runs on a day. Exactly the changed values differ, and inspections are recorded.

use std::path::Path;

use novamind::insight::{Inspect, open_for_inspection};
use novamind::record::mode::Mode;
use novamind::record::trajectory::Trajectory;
use novamind::record::trajectory::record::Via;
use novamind::session::{Session, read_afterwards, verify};
use serde_json::json;

use crate::support::company::{advance_week, advance_weeks, apply_opening_decisions, begin_run};

fn run_in(folder: &Path, mode: Mode) -> Session {
    let mut session = begin_run(folder, mode, 56);
    apply_opening_decisions(&mut session);
    session
}

#[test]
fn difference_starts_on_the_day_of_the_change() {
    let folder = tempfile::tempdir().expect("a folder");
    let [mut one, mut other] = [(); 2].map(|()| run_in(folder.path(), Mode::Debug));
    for session in [&mut one, &mut other] {
        advance_weeks(session, 2);
    }
    let equal_comparison = one.inspect().compare_with_run(&mut other, None).expect("a result");
    assert_eq!(
        (equal_comparison.last_day, equal_comparison.first_day, equal_comparison.difference),
        (14, None, None)
    );
    assert!(
        one.inspect()
            .compare_with_run(&mut other, Some(9))
            .expect("a result")
            .difference
            .expect("it was asked")
            .is_empty()
    );
    other.call("set_prices", &json!({"A": 40}), Via::Script).expect("a price");
    advance_weeks(&mut one, 2);
    advance_week(&mut other);
    let found = one.inspect().compare_with_run(&mut other, None).expect("a result");
    assert_eq!((found.last_day, found.first_day), (21, Some(15)));
    let first = found.difference.expect("they differ");
    assert_eq!(first.days, (15, 15));
    assert!(
        first.differing_parts.contains(&"settings") && first.equal_parts.contains(&"calendar"),
        "{first:?}"
    );
    assert!(first.equal_parts.contains(&"product"), "a price does not change the product");
    let last = one
        .inspect()
        .compare_with_run(&mut other, Some(21))
        .expect("a result")
        .difference
        .expect("it was asked");
    let cash = last.figures.iter().find(|(name, ..)| name == "cash").expect("cash differs");
    assert_eq!((cash.1, cash.2), (one.cash_by_day()[21], other.cash_by_day()[21]));
    let subscribers =
        |name: &str| last.figures.iter().find(|(text, ..)| text == name).map(|figure| (figure.1, figure.2));
    let (value, others) = subscribers("individual subscribers").expect("they differ");
    let (only_own, only_others) = last.only_in_one;
    assert_eq!(value - others, only_own as f64 - only_others as f64, "{last:?}");
    assert!(last.first_customers.len() <= 10 && last.differing_customers + only_own + only_others > 10);
    assert_eq!(
        one.inspect().compare_with_run(&mut other, Some(22)).expect_err("no such day").code,
        "day_unknown"
    );
    assert_eq!(
        one.inspect().compare_with_run(&mut other, Some(0)).expect_err("no such day").code,
        "day_unknown"
    );
}

#[test]
fn difference_of_two_days_lists_changes_without_side_effects() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut session = run_in(folder.path(), Mode::Debug);
    advance_weeks(&mut session, 3);
    let (place, hash) = (session.folder().expect("a folder").to_owned(), session.state_hash());
    let found = session.inspect().compare_days(11, 18).expect("a result");
    assert!(
        found.differing_parts.contains(&"calendar") && found.equal_parts.contains(&"settings"),
        "{found:?}"
    );
    let cash = found.figures.iter().find(|(name, ..)| name == "cash").expect("cash");
    assert_eq!((cash.1, cash.2), (session.cash_by_day()[11], session.cash_by_day()[18]));
    assert!(found.only_in_one.1 > 0, "new customers arrived");
    let customer = found
        .first_customers
        .iter()
        .find(|customer_difference| customer_difference.subscribes == (true, true))
        .expect("one");
    assert!(customer.columns.iter().any(|(name, ..)| *name == "satisfaction"), "{customer:?}");
    assert!(session.inspect().compare_days(9, 9).expect("a result").is_empty());
    assert_eq!(session.inspect().compare_days(9, 22).expect_err("no such day").code, "day_unknown");
    assert_eq!(session.state_hash(), hash);
    drop(session);
    let lines = Trajectory::read(&place.join("trajectory.jsonl")).expect("lines").lines;
    assert_eq!(lines.iter().filter(|line| line.record.kind() == "xray").count(), 2);
    verify(&place).expect("it verifies");
}

#[test]
fn figures_of_past_days_are_reproduced() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut session = run_in(folder.path(), Mode::Debug);
    let mut live = Vec::new();
    for _ in 0..3 {
        let forecasts = session.company().naive_forecasts();
        let mut keep = |day: &novamind::session::DayReport<'_>| {
            live.push((
                day.figures.day,
                day.figures.cash,
                day.xray.expect("a debug run").facts().arrivals.len(),
            ));
        };
        session.advance("wait", &forecasts, Via::Script, &mut keep).expect("a week");
    }
    let mut again = Vec::new();
    let replayed = session.inspect().replay_days(&mut |day| {
        again.push((
            day.figures.day,
            day.figures.cash,
            day.xray.expect("hidden state").facts().arrivals.len(),
        ));
    });
    replayed.expect("a result");
    assert_eq!(again, live);
}

#[test]
fn difference_requires_permission_and_is_recorded() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut debug = run_in(folder.path(), Mode::Debug);
    advance_week(&mut debug);
    for mode in [Mode::Baseline, Mode::Sandbox, Mode::Lesson] {
        let mut session = run_in(folder.path(), mode);
        advance_week(&mut session);
        let place = session.folder().expect("a folder").to_owned();
        let mut inspector = session.inspect();
        let texts = [
            inspector.compare_days(1, 2).expect_err("hidden").to_string(),
            inspector.compare_days(0, 9000).expect_err("hidden").to_string(),
            inspector.compare_with_run(&mut debug, Some(9000)).expect_err("hidden").to_string(),
            inspector.replay_days(&mut |_| panic!("hidden")).expect_err("hidden").to_string(),
        ];
        drop(inspector);
        let from_debug =
            debug.inspect().compare_with_run(&mut session, None).expect_err("hidden").to_string();
        assert_eq!(from_debug, texts[0]);
        assert!(
            texts.iter().all(|one| one.starts_with("not_in_this_mode: the x-ray is available")),
            "{texts:?}"
        );
        drop(session);
        let refused = open_for_inspection(&place, Default::default()).err().expect("hidden").to_string();
        assert!(refused.contains("debug runs and in runs that have ended"), "{refused}");
        let lines = Trajectory::read(&place.join("trajectory.jsonl")).expect("lines").lines;
        assert!(lines.iter().all(|line| line.record.kind() != "xray"));
        let mut session =
            Session::open(&place, novamind::session::Access::Write, false).expect("it continues");
        session.abandon().expect("it ends");
        drop(session);
        let mut session = open_for_inspection(&place, Default::default()).expect("it is over");
        session.inspect().compare_days(1, 7).expect("a result");
        let mut days = 0;
        session.inspect().replay_days(&mut |day| days += u32::from(day.xray.is_some())).expect("a result");
        assert_eq!(days, 7);
        let trajectory = Trajectory::read(&place.join("trajectory.jsonl")).expect("lines");
        let after = read_afterwards(&place, &trajectory).expect("lines").lines;
        assert_eq!(after.iter().filter(|line| line.record.kind() == "xray").count(), 2);
    }
}

#[test]
fn differing_parameter_is_listed_first() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut session = run_in(folder.path(), Mode::Debug);
    advance_weeks(&mut session, 2);
    let key = "operations.base_outage_prob";
    let old = session.set_parameter(key, &json!(0.5), Some(17)).expect("it waits").old;
    advance_weeks(&mut session, 1);
    let parameters = |session: &mut Session, one, other| {
        session.inspect().compare_days(one, other).expect("a result").parameters
    };
    assert_eq!(parameters(&mut session, 14, 16), []);
    assert_eq!(parameters(&mut session, 16, 17), [(key.to_owned(), old, json!(0.5))]);
    // Leads of a day include individuals and enterprises.
    let found = session.inspect().compare_days(3, 20).expect("a result");
    let sum: f64 = found
        .figures
        .iter()
        .filter(|(name, ..)| name.ends_with("leads of the day"))
        .map(|figure| figure.2)
        .sum();
    let recorded = session
        .inspect()
        .query_hidden_tables("SELECT SUM(came) FROM hidden.factors WHERE day = 20", None)
        .expect("a result");
    assert_eq!(novamind::database::number_at(&recorded.rows[0], 0), sum);
}
