//! The x-ray: permissions, recorded lines, and the correctness of the shown values.

use std::collections::BTreeMap;
use std::path::Path;

use novamind::database::Cell;
use novamind::insight::{CustomerView, IndividualView, Inspect, LeadFactor, SubscriberOutcome};
use novamind::record::folder::configuration::Configuration;
use novamind::record::mode::Mode;
use novamind::record::trajectory::record::{Activity, Via};
use novamind::record::trajectory::{Record, Trajectory};
use novamind::session::{
    Access, EndCause, NewRun, OfferResponse, Session, Storage, WaitingThread, read_afterwards, verify,
};
use novamind::world::identifiers::Group;
use serde_json::{Value, json};

use crate::support::company::{
    advance_week, advance_weeks, apply_opening_decisions, begin_run, query_column, query_rows,
};

fn group_s2() -> Group {
    Group::parse("S2").expect("a group")
}

fn inspections(lines: &Trajectory) -> Vec<(String, String)> {
    let inspection_parts = |record: &Record| match record {
        Record::Activity(Activity::Inspection(inspection)) => {
            Some((inspection.what.clone(), format!("{} {}", inspection.which, inspection.shown_day)))
        }
        _ => None,
    };
    lines.lines.iter().filter_map(|line| inspection_parts(&line.record)).collect()
}

#[test]
fn unfinished_non_debug_runs_cannot_be_inspected() {
    let folder = tempfile::tempdir().expect("a folder");
    for mode in [Mode::Baseline, Mode::Sandbox, Mode::Lesson] {
        let mut session = begin_run(folder.path(), mode, 28);
        apply_opening_decisions(&mut session);
        advance_week(&mut session);
        let place = session.folder().expect("a folder").to_owned();
        let lines = || Trajectory::read(&place.join("trajectory.jsonl")).expect("lines").lines.len();
        let before = lines();
        // The rejection is the same for a known group, an unknown group and a missing day.
        let texts: Vec<String> =
            [(group_s2(), None), (Group::at(25).expect("a group"), Some(3)), (group_s2(), Some(9000))]
                .into_iter()
                .map(|(group, day)| {
                    session.inspect().lead_equations(group, day).expect_err("hidden").to_string()
                })
                .collect();
        assert!(texts.iter().all(|one| *one == texts[0]), "{texts:?}");
        assert_eq!(
            texts[0],
            "not_in_this_mode: the x-ray is available in debug runs and in runs that have ended"
        );
        assert_eq!(lines(), before, "no inspection happened, so no line is recorded");
        // After the run is abandoned, the user can inspect it but cannot continue it.
        session.abandon().expect("it ends");
        assert_eq!(session.inspect().lead_equations(group_s2(), Some(3)).expect("a result").len(), 3);
        drop(session);
        let trajectory = Trajectory::read(&place.join("trajectory.jsonl")).expect("lines");
        assert_eq!(inspections(&trajectory), [], "the end is the last line");
        let after = read_afterwards(&place, &trajectory).expect("lines");
        assert_eq!(inspections(&after), [("leads".to_owned(), "S2 3".to_owned())]);
    }
}

#[test]
fn inspections_are_recorded_without_changing_the_state() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut watched = begin_run(folder.path(), Mode::Debug, 60);
    let mut alone = begin_run(folder.path(), Mode::Debug, 60);
    for session in [&mut watched, &mut alone] {
        apply_opening_decisions(session);
        advance_week(session);
    }
    watched.inspect().lead_equations(group_s2(), Some(2)).expect("a result");
    watched.step(3, &mut |_| {}).expect("days");
    alone.step(3, &mut |_| {}).expect("days");
    // Inspections are made within a week, after a call, and for an earlier day.
    for session in [&mut watched, &mut alone] {
        session.call("set_prices", &json!({"A": 13}), Via::Script).expect("a price");
    }
    assert_eq!(
        watched
            .inspect()
            .lead_equations(group_s2(), None)
            .expect("a result")
            .last()
            .map(|lead_equation| lead_equation.day),
        Some(10)
    );
    watched.inspect().lead_equations(group_s2(), Some(4)).expect("a result");
    advance_week(&mut watched);
    advance_week(&mut alone);
    assert_eq!(watched.state_hash(), alone.state_hash());
    let refused = watched.inspect().lead_equations(group_s2(), Some(15)).expect_err("not simulated");
    assert_eq!(refused.to_string(), "day_unknown (day): there is no day 15; choose a day from 1 to 14");
    let place = watched.folder().expect("a folder").to_owned();
    drop(watched);
    let trajectory = Trajectory::read(&place.join("trajectory.jsonl")).expect("lines");
    let texts: Vec<String> =
        inspections(&trajectory).into_iter().map(|(what, which)| format!("{what} {which}")).collect();
    assert_eq!(texts, ["leads S2 2", "leads S2 10", "leads S2 4"]);
    assert_eq!(verify(&place).expect("it verifies").day, 14);
    let mut again = Session::open(&place, Access::Write, false).expect("it opens");
    assert_eq!(again.inspect().lead_equations(group_s2(), Some(10)).expect("a result").len(), 10);
}

#[test]
fn lead_equation_equals_the_mean_of_the_lead_draw() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut session = begin_run(folder.path(), Mode::Debug, 60);
    apply_opening_decisions(&mut session);
    let mut recorded: BTreeMap<(u32, &str), (f64, u32)> = BTreeMap::new();
    for _ in 0..6 {
        let forecasts = session.company().naive_forecasts();
        let mut keep = |report: &novamind::session::DayReport<'_>| {
            let xray = report.xray.expect("a debug run");
            for group in Group::all() {
                let arrivals =
                    xray.facts().arrivals.iter().filter(|arrival| arrival.group == group).count() as u32;
                let expected = xray.lead_factors(group).expected();
                recorded.insert((report.figures.day, group.id()), (expected, arrivals));
            }
        };
        session.advance("wait", &forecasts, Via::Script, &mut keep).expect("a week");
    }
    let mut compared = 0;
    for group in Group::all() {
        for lead_equation in [20, 42]
            .into_iter()
            .flat_map(|day| session.inspect().lead_equations(group, Some(day)).expect("a result"))
        {
            let factors: f64 = LeadFactor::ALL.iter().map(|factor| lead_equation.factor(*factor)).product();
            let channels: f64 = lead_equation.channels().map(|(_, leads)| leads).sum();
            let mouths: f64 = lead_equation.word_of_mouth.iter().map(|(_, leads)| leads).sum();
            let shown = factors * (channels + mouths);
            let (expected, arrivals) = recorded[&(lead_equation.day, group.id())];
            assert!(
                (shown - expected).abs() <= 1e-12 * expected.max(1.0),
                "{group} {}: {shown} {expected}",
                lead_equation.day
            );
            assert_eq!((lead_equation.expected_leads(), lead_equation.actual_leads), (expected, arrivals));
            assert_eq!(lead_equation.is_known, group.is_initially_known());
            let held = lead_equation.expected_leads_with(&[(
                LeadFactor::Reputation,
                2.0 * lead_equation.factor(LeadFactor::Reputation),
            )]);
            assert!((held - 2.0 * expected).abs() <= 1e-12 * expected.max(1.0));
            compared += 1;
        }
    }
    assert!(compared > 26 * 40);
}

fn individual_view(session: &mut Session, customer: u32, day: Option<u32>) -> IndividualView {
    match session.inspect().customer_view(customer, day).expect("a result") {
        CustomerView::Individual(view) => *view,
        CustomerView::Enterprise(_) => panic!("customer {customer} is an enterprise"),
    }
}

#[test]
fn customer_view_matches_the_tables() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut session = begin_run(folder.path(), Mode::Debug, 90);
    apply_opening_decisions(&mut session);
    advance_weeks(&mut session, 8);
    session.call("set_prices", &json!({"A": 24, "B": 50}), Via::Script).expect("dearer");
    advance_weeks(&mut session, 4);
    let sql = "SELECT customer_id, plan, start_day, end_day, status FROM subscriptions JOIN customers USING (customer_id) \
               WHERE group_id IN ('S1', 'S2', 'S3') ORDER BY customer_id";
    let known: Vec<Vec<Cell>> = query_rows(&mut session, sql);
    let whole = |cell: &Cell| match cell {
        Cell::Integer(number) => Some(u32::try_from(*number).expect("a number")),
        _ => None,
    };
    let word = |cell: &Cell| match cell {
        Cell::Text(text) => text.clone(),
        other => panic!("{other:?}"),
    };
    let last_day = session.day();
    let mut seen = BTreeMap::new();
    for status in ["lost", "cancelled", "subscribed"] {
        for row in known.iter().filter(|row| word(&row[4]) == status).step_by(17).take(12) {
            let customer = whole(&row[0]).expect("a customer");
            let view = individual_view(&mut session, customer, None);
            assert_eq!(view.signup.signed_up, status != "lost", "customer {customer}");
            assert_eq!(Some(view.signup.day), whole(&row[2]), "customer {customer}");
            let left = view
                .days
                .iter()
                .find(|individual_day| matches!(individual_day.outcome, SubscriberOutcome::Cancels(_)));
            assert_eq!(
                left.map(|individual_day| individual_day.day),
                whole(&row[3]).filter(|_| status == "cancelled")
            );
            if status == "subscribed" {
                assert_eq!(
                    view.shown_state().map(|individual_day| individual_day.day),
                    Some(last_day).filter(|_| view.signup.day < last_day)
                );
            }
            for individual_day in view.days.iter().filter(|individual_day| individual_day.is_due) {
                let stays = !matches!(
                    individual_day.outcome,
                    SubscriberOutcome::Cancels(EndCause::Price | EndCause::Quality)
                );
                let failed = individual_day.outcome == SubscriberOutcome::Cancels(EndCause::Involuntary);
                assert!(
                    failed || individual_day.weighed_decision.choice.is_some() == stays,
                    "customer {customer} on day {}",
                    individual_day.day
                );
            }
            if let (Some(since), Some(shown)) = (view.issue_opened_on(), view.shown_state()) {
                let sql = format!(
                    "SELECT max(open_day) FROM issues WHERE customer_id = {customer} AND open_day <= {}",
                    shown.day
                );
                assert_eq!(query_column(&mut session, &sql), [f64::from(since)], "customer {customer}");
                *seen.entry("with an issue").or_insert(0) += 1;
            }
            // The view of an earlier day contains at most one day.
            let shown = view.signup.day + 1;
            if shown <= last_day {
                let earlier = individual_view(&mut session, customer, Some(shown));
                assert!(earlier.days.len() <= 1 && earlier.days.len() <= view.days.len());
            }
            *seen.entry(status).or_insert(0) += 1;
        }
    }
    assert!(
        ["lost", "cancelled", "subscribed", "with an issue"].iter().all(|status| seen.get(status) > Some(&2)),
        "{seen:?}"
    );
    let refused = |session: &mut Session, customer, day| {
        session.inspect().customer_view(customer, day).expect_err("no").code
    };
    assert_eq!(refused(&mut session, 0, None), "customer_not_found");
    assert_eq!(refused(&mut session, u32::MAX, None), "customer_not_found");
    let late = whole(&known.last().expect("a customer")[0]).expect("a customer");
    assert_eq!(refused(&mut session, late, Some(1)), "day_unknown");
    let mut sandbox = begin_run(folder.path(), Mode::Sandbox, 28);
    assert_eq!(refused(&mut sandbox, 2, None), "not_in_this_mode");
    assert_eq!(refused(&mut sandbox, u32::MAX, Some(3)), "not_in_this_mode");
}

/// Plays a debug run that offers each enterprise its requested price or slightly less.
pub fn debug_run_with_offers(folder: &Path, count: u32) -> Session {
    let new = NewRun {
        seed: Some(11),
        cash: Some(20_000_000.0),
        mode: Mode::Debug,
        storage: Storage::Runs(folder.to_owned()),
        ..NewRun::default()
    };
    let mut session = Session::create(new, &Configuration::bundled()).expect("the run begins");
    for (tool, arguments) in [
        ("set_prices", json!({"A": 14, "B": 32, "C": 55})),
        ("set_model_tiers", json!({"A": 4, "B": 4, "C": 4})),
        ("set_usage_quotas", json!({"A": 300, "B": 30_000, "C": 1_000_000})),
        ("set_targeted_dev_spend", json!({"E1": 9000, "E2": 9000, "E3": 9000})),
        ("set_targeted_ad_spend", json!({"linkedin": {"E1": 9000, "E2": 9000, "E3": 9000}})),
        ("set_capacity_tier", json!({"tier": 5})),
    ] {
        session.call(tool, &arguments, Via::Script).expect(tool);
    }
    for _ in 0..count {
        let offer = |thread: &WaitingThread| {
            let price =
                thread.asked.unwrap_or(40.0) * if thread.thread.is_multiple_of(2) { 0.98 } else { 1.1 };
            json!([thread.customer, [["C", price * 1.2], ["B", price]]])
        };
        let deals: Vec<Value> = session.company().observe().waiting.iter().map(offer).collect();
        if !deals.is_empty() {
            session.call("send_enterprise_deal", &json!({ "deals": deals }), Via::Script).expect("offers");
        }
        advance_week(&mut session);
    }
    session
}

#[test]
fn enterprise_view_predicts_recorded_answers() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut session = debug_run_with_offers(folder.path(), 10);
    // Replies are turns of enterprises that follow a turn of the player.
    let sql = "SELECT customer_id, thread_id, day, offer_json FROM enterprise_turns AS own \
               WHERE sender = 'customer' AND EXISTS (SELECT 1 FROM enterprise_turns AS other \
               WHERE other.thread_id = own.thread_id AND other.sender = 'agent' \
               AND other.message_id < own.message_id) ORDER BY message_id";
    let turns = query_rows(&mut session, sql);
    assert!(turns.len() > 40, "{}", turns.len());
    let whole = |cell: &Cell| match cell {
        Cell::Integer(number) => u32::try_from(*number).expect("a number"),
        other => panic!("{other:?}"),
    };
    let (mut accepted, mut named) = (0, 0);
    for turn in turns.iter().step_by(turns.len() / 40) {
        let [customer, thread, day] = [0, 1, 2].map(|at| whole(&turn[at]));
        let Cell::Text(text) = &turn[3] else { panic!("{turn:?}") };
        let value: Value = serde_json::from_str(text).expect("JSON");
        let CustomerView::Enterprise(view) =
            session.inspect().customer_view(customer, Some(day)).expect("a result")
        else {
            panic!("a company")
        };
        let thread_day = view
            .threads_on_shown_day()
            .find(|enterprise_thread_day| enterprise_thread_day.thread == thread)
            .expect("its thread");
        assert_eq!(thread_day.reply_day, Some(day));
        let price = match thread_day.answer.expect("an answer") {
            OfferResponse::Accept(at) => {
                accepted += 1;
                let offering = thread_day.offerings[at];
                let judged = thread_day.plans[offering.plan];
                assert!(judged.accepts_any_price || offering.price <= judged.accepts_below + 1e-9);
                offering.price
            }
            OfferResponse::Counter(at, price) => {
                named += 1;
                assert_eq!(thread_day.plans[thread_day.offerings[at].plan].counter, price);
                price
            }
            OfferResponse::Silence => panic!("customer {customer} answered on day {day}"),
        };
        assert_eq!(value["price"].as_f64(), Some(price), "customer {customer} on day {day}");
        assert!(thread_day.remaining_turns > 0);
    }
    assert!(accepted > 3 && named > 3, "{accepted} {named}");
}

/// Lead counts follow a Poisson distribution around their expectations: Pearson's statistic over 1,000 days.
#[test]
fn lead_residuals_fit_a_poisson_distribution() {
    let folder = tempfile::tempdir().expect("a folder");
    let new = NewRun {
        cash: Some(1e9),
        seed: Some(7),
        days: Some(1000),
        mode: Mode::Debug,
        storage: Storage::Runs(folder.path().to_owned()),
        projection: false,
        ..NewRun::default()
    };
    let mut session = Session::create(new, &Configuration::bundled()).expect("the run begins");
    apply_opening_decisions(&mut session);
    let spend = json!({"targeted_spend": {"content_marketing": {"S1": 50, "S2": 50, "S3": 50}}});
    session.call("set_targeted_ad_spend", &spend, Via::Script).expect("ads");
    advance_weeks(&mut session, 143);
    assert_eq!(session.day(), 1000, "the company is not bankrupt");
    for id in ["S1", "S2", "S3"] {
        let group = Group::parse(id).expect("a group");
        let (mut statistic, mut freedom, mut spread, mut extreme) = (0.0, 0.0, 0.0, 0);
        for last in (28..=1000).step_by(28).chain([1000]) {
            let days = session.inspect().lead_equations(group, Some(last)).expect("a result");
            for lead_equation in days.iter().rev().take(if last == 1000 { 20 } else { 28 }) {
                let (expected, actual) =
                    (lead_equation.expected_leads(), f64::from(lead_equation.actual_leads));
                if expected > 0.0 {
                    statistic += (actual - expected) * (actual - expected) / expected;
                    // The variance of each term of the statistic is 2 + 1 / λ.
                    spread += 2.0 + 1.0 / expected;
                    freedom += 1.0;
                }
                extreme += u32::from(lead_equation.p_value() < 0.01);
            }
        }
        assert_eq!(freedom, 1000.0, "{id}");
        let deviation = (statistic - freedom) / spread.sqrt();
        assert!(
            deviation.abs() < 3.0,
            "{id}: {statistic} over {freedom} days, {deviation} standard deviations"
        );
        assert!(extreme <= 22, "{id}: {extreme} of 1,000 days are beyond 1 %");
    }
}

#[test]
fn read_only_run_cannot_be_inspected() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut session = begin_run(folder.path(), Mode::Debug, 28);
    apply_opening_decisions(&mut session);
    advance_weeks(&mut session, 2);
    session.save().expect("saved");
    let path = session.folder().expect("a folder").to_owned();
    drop(session);
    let before = std::fs::read(path.join("trajectory.jsonl")).expect("bytes");
    let mut read = Session::open(&path, Access::Read, true).expect("it opens");
    assert_eq!(read.inspect().lead_equations(group_s2(), None).expect_err("a refusal").code, "read_only");
    assert_eq!(
        read.inspect().query_hidden_tables("SELECT 1", None).expect_err("a refusal").code,
        "read_only"
    );
    assert_eq!(read.inspect().compare_days(3, 4).expect_err("a refusal").code, "read_only");
    // Error messages mention hidden tables only on connections that have these tables.
    let refused = read.query("SELECT * FROM hidden.customers").expect_err("no such table");
    assert!(refused.message.contains("query --xray"), "{refused}");
    drop(read);
    assert_eq!(std::fs::read(path.join("trajectory.jsonl")).expect("bytes"), before);
    let mut sandbox = begin_run(folder.path(), Mode::Sandbox, 28);
    let refused = sandbox.query("SELECT * FROM hidden.customers").expect_err("no such table");
    assert!(
        refused.message.contains("write customers alone") && !refused.message.contains("xray"),
        "{refused}"
    );
}
