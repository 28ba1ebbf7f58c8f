//! Branches equal runs with the same decisions. Futures share their random draws. Hidden state stays hidden.

use std::ops::ControlFlow;
use std::path::Path;

use serde_json::json;

use super::*;
use crate::counterfactual::analysis_cache::AnalysisCache;
use crate::counterfactual::recorded_steps::RecordedCall;
use crate::counterfactual::test_kit::{play_weeks, play_weeks_with_offers};
use crate::inspection::inspector::Inspect;
use novamind_record::mode::Mode;
use novamind_record::trajectory::record::Via;
use novamind_record::trajectory::{Record, Trajectory};
use novamind_session::{Access, Session};
use novamind_tools::ToolId;
use novamind_world::identifiers::Group;

fn continue_progress(_: usize, _: usize) -> ControlFlow<()> {
    ControlFlow::Continue(())
}

fn parse_edits(all: &[&str]) -> Vec<DecisionEdit> {
    all.iter().map(|edit| edit.parse().expect(edit)).collect()
}

fn open_what_if(session: &Session) -> WhatIf {
    WhatIf::open(session.folder().expect("a folder")).expect("a what-if")
}

fn compare(session: &Session, week: u32, alternatives: &[&[&str]]) -> BranchComparison {
    let alternatives: Vec<_> = alternatives.iter().map(|texts| parse_edits(texts)).collect();
    let until = session.day() / 7;
    let compared = open_what_if(session).compare(week, Some(until), &alternatives, &continue_progress);
    compared.expect("an answer").expect("it is not stopped")
}

/// Plays a run with decisions in weeks 1, 5 and 8. The second attempt to start the same R&D project is rejected.
fn play_run(runs: &Path, mode: Mode) -> Session {
    let mut session = play_weeks(runs, mode, 3, Some(("set_prices", json!({"B": 30}))));
    session.call("start_research_project", &json!({"tier": 1}), Via::Plain).expect("a project");
    session.call("start_research_project", &json!({"tier": 1}), Via::Plain).expect_err("it is running");
    for _ in 0..2 {
        let forecasts = session.company().naive_forecasts();
        session.advance("on", &forecasts, Via::Plain, &mut |_| {}).expect("a week");
    }
    session
}

#[test]
fn unchanged_branch_equals_the_run() {
    let runs = tempfile::tempdir().expect("a folder");
    let session = play_run(runs.path(), Mode::Debug);
    let compared = compare(&session, 4, &[&["keep set_model_tiers"]]);
    let [was, same] = &compared.branches[..] else { panic!("{:?}", compared.branches) };
    let cash: Vec<f64> = session.weeks().iter().skip(3).map(|week| week.cash).collect();
    let curve = |branch: &BranchFigures| {
        branch.values_by_week(BranchFigure::Cash).map(|(_, cash)| cash).collect::<Vec<_>>()
    };
    assert_eq!(curve(was), cash);
    // No setting changes in these weeks, so keeping the settings has no effect.
    assert_eq!((curve(same), same.first_different_day, same.call_differences.len()), (cash, None, 0));
    let left = was.value(BranchFigure::Churn, session.day()).expect("a value");
    let days = session.weeks().len();
    assert!(left > 0.0 && left < 1.0 && days > 8, "{left}");
    let conversion = session.weeks()[3].conversion();
    assert_eq!(was.value(BranchFigure::Conversion, 28), Some(conversion));
    assert!(conversion > 0.0, "{conversion}");
}

#[test]
fn comparison_shows_the_first_week_that_differs() {
    let runs = tempfile::tempdir().expect("a folder");
    let session = play_run(runs.path(), Mode::Debug);
    let compared =
        compare(&session, 4, &[&["in 6 set_daily_spend operations=900"], &["keep set_model_tiers"]]);
    assert_eq!(compared.branches[1].first_different_day, Some(36));
    assert_eq!(compared.milestone_days(7), [42, 49, compared.until]);
    let same = compare(&session, 4, &[&["keep set_model_tiers"]]);
    assert_eq!(same.milestone_days(7), [49, same.until]);
}

#[test]
fn alternative_equals_a_played_branch() {
    let runs = tempfile::tempdir().expect("a folder");
    let session = play_run(runs.path(), Mode::Debug);
    for alternative in [
        &["set_prices * 0.9"][..],
        &["set_targeted_ad_spend * 0.5", "in 6 set_daily_spend operations=900"],
        &["keep set_prices", "capacity follows usage"],
        &["set_prices A=5 B=6 C=7"],
    ] {
        let compared = compare(&session, 5, &[alternative]);
        let branch_figures = &compared.branches[1];
        assert_eq!(branch_figures.rejected, []);
        let adopted =
            create_branch_with_decisions(&session, 5, &parse_edits(alternative), Mode::Debug, &mut |_| {
                ControlFlow::Continue(())
            });
        let adopted = adopted.expect("a branch");
        assert_eq!((adopted.rejected.len(), adopted.session.day()), (0, session.day()), "{alternative:?}");
        let weeks = adopted.session.weeks().iter().skip(4);
        let cash: Vec<f64> = weeks.map(|week| week.cash).collect();
        let curve: Vec<f64> =
            branch_figures.values_by_week(BranchFigure::Cash).map(|(_, cash)| cash).collect();
        assert_eq!(curve, cash, "{alternative:?}");
        assert_ne!(curve.last(), session.weeks().last().map(|week| &week.cash), "{alternative:?}");
        let first = if alternative[0].starts_with("keep") { 50 } else { 29 };
        assert!(
            branch_figures.first_different_day.is_some_and(|day| day <= first),
            "{alternative:?}: {:?}",
            branch_figures.first_different_day
        );
    }
}

#[test]
fn factor_scales_current_and_later_settings() {
    let runs = tempfile::tempdir().expect("a folder");
    let session = play_run(runs.path(), Mode::Debug);
    let compared = compare(&session, 5, &[&["set_prices * 0.5"]]);
    let changed_calls: Vec<_> = compared.branches[1]
        .call_differences
        .iter()
        .map(|call| (call.day, call.tool, call.recorded.clone(), call.edited.clone()))
        .collect();
    assert_eq!(
        changed_calls,
        [
            (28, ToolId::SetPrices, None, Some(json!({"A": 6, "B": 12.5, "C": 27.5}))),
            (49, ToolId::SetPrices, Some(json!({"B": 30})), Some(json!({"B": 15}))),
        ]
    );
}

#[test]
fn newly_rejected_and_newly_accepted_calls_are_reported() {
    let runs = tempfile::tempdir().expect("a folder");
    let session = play_run(runs.path(), Mode::Debug);
    let what_if = open_what_if(&session);
    let decided = what_if.decisions(8).expect("decisions");
    let calls = decided.iter().filter_map(RecordedDecision::call);
    let projects: Vec<_> = calls.filter(|call| call.tool == ToolId::StartResearchProject).collect();
    let [first, second] = projects[..] else { panic!("{decided:?}") };
    assert_eq!((first.accepted, second.accepted), (true, false));
    let drop = format!("drop {}", first.seq);
    let earlier = "in 7 start_research_project tier=1";
    let compared = compare(&session, 7, &[&[&drop], &[earlier]]);
    let [_, dropped, twice] = &compared.branches[..] else { panic!("{:?}", compared.branches) };
    assert_eq!(dropped.newly_accepted, [(second.seq, second.day, second.tool)]);
    assert_eq!(dropped.call_differences.len(), 1);
    let [RejectedDecision { seq, day: 56, name, rejection }] = &twice.rejected[..] else {
        panic!("{twice:?}")
    };
    assert_eq!((*seq, name.as_str()), (Some(first.seq), "start_research_project"));
    assert!(rejection.message.contains("running"), "{rejection}");
}

#[test]
fn every_edit_is_checked_before_the_simulation() {
    let runs = tempfile::tempdir().expect("a folder");
    let session = play_run(runs.path(), Mode::Debug);
    let mut what_if = open_what_if(&session);
    let decided = what_if.decisions(5).expect("decisions");
    let line = |tool: ToolId, accepted: bool| {
        let mut calls = decided.iter().filter_map(RecordedDecision::call);
        calls.find(|call| (call.tool, call.accepted) == (tool, accepted)).expect("a call").seq
    };
    let (price, rejected) = (line(ToolId::SetPrices, true), line(ToolId::StartResearchProject, false));
    let cases = [
        (format!("change {price} {{\"B\": 20}}"), None),
        (format!("change {price} {{\"B\": 0}}"), Some("edited_twice")),
        (format!("change {rejected} {{\"tier\": 99}}"), Some("out_of_range")),
        ("change 1 {\"B\": 20}".to_owned(), Some("line_unknown")),
        (format!("drop {rejected}"), Some("edited_twice")),
        ("set_prices B=-3".to_owned(), Some("price_not_positive")),
        ("set_prices Q=3".to_owned(), Some("unknown_plan")),
        ("set_daily_spend operations=1e12".to_owned(), Some("amount_too_large")),
        ("in 2 set_prices B=3".to_owned(), Some("week_unknown")),
        ("set_targeted_ad_spend {\"linkedin\": {\"E9\": 3}}".to_owned(), Some("unknown_group")),
        // The group can be discovered in the meantime.
        ("in 7 set_targeted_ad_spend {\"linkedin\": {\"E9\": 3}}".to_owned(), None),
        ("keep set_prices".to_owned(), None),
    ];
    let edits: Vec<DecisionEdit> = cases.iter().map(|(text, _)| text.parse().expect(text)).collect();
    let found = what_if.check(5, &edits, &continue_progress).expect("an answer").expect("it is not stopped");
    for ((text, expected), refusal) in cases.iter().zip(&found) {
        assert_eq!(refusal.as_ref().map(|refusal| refusal.code), *expected, "{text}: {refusal:?}");
    }
    let alone = |text: String| {
        let edits = [text.parse().expect("an edit")];
        open_what_if(&session).check(5, &edits, &continue_progress).expect("an answer").expect("not stopped")
    };
    let code = |text: String| alone(text)[0].as_ref().map(|refusal| refusal.code);
    assert_eq!(code(format!("change {price} {{\"B\": 0}}")), Some("price_not_positive"));
    assert_eq!(code(format!("drop {rejected}")), Some("no_effect"));
    assert_eq!(code(format!("drop {price}")), None);
}

#[test]
fn history_reproduces_the_settings_before_and_after_each_decision() {
    let runs = tempfile::tempdir().expect("a folder");
    let mut session = play_run(runs.path(), Mode::Debug);
    let calls = [
        ("set_targeted_ad_spend", json!({"linkedin": {"S1": 40}})),
        ("set_targeted_ad_spend", json!({"targeted_spend": {"search_ads": {"S1": 25}}})),
        ("set_promotion", json!({"by_group": {"S1": 2}})),
        ("set_promotion", json!({"global_promotion": 1})),
        ("set_daily_spend", json!({"development": 70})),
        ("set_prices", json!({"B": 33})),
    ];
    for (tool, args) in calls {
        session.call(tool, &args, Via::Plain).expect(tool);
    }
    session.undo(Via::Plain).expect("an undo");
    let history = open_what_if(&session).history().expect("decisions");
    let present = session.day() / 7 + 1;
    for tool in ToolId::all() {
        let now = session.company().current_arguments(tool.name());
        assert_eq!(history.values_in_week(tool, present), now, "{tool}");
    }
    let week: Vec<&RecordedCall> =
        history.decisions_of_week(present).filter_map(RecordedDecision::call).collect();
    assert_eq!(week.len(), 5, "the undone price change is omitted");
    assert_eq!(history.values_before(week[1])["targeted_spend"], json!({"linkedin": {"S1": 40}}));
    assert_eq!(history.values_in_week(ToolId::SetPrices, 1)["B"], json!(25));
}

#[test]
fn futures_share_draws_across_branches_and_calls() {
    let runs = tempfile::tempdir().expect("a folder");
    let session = play_run(runs.path(), Mode::Debug);
    let mut what_if = open_what_if(&session);
    let asked = |what_if: &mut WhatIf| {
        let alternatives = [parse_edits(&["set_prices * 0.8"]), parse_edits(&["keep set_prices"])];
        what_if
            .futures(10, Some(13), &alternatives, 5, &continue_progress)
            .expect("an answer")
            .expect("it is not stopped")
    };
    let futures = asked(&mut what_if);
    assert_eq!((futures.count, futures.redrawn_after), (5, session.day()));
    assert_eq!(asked(&mut what_if), futures);
    // No decisions follow the record, so keeping the settings has no effect.
    let difference = |branch, figure| futures.difference(branch, figure, 91).expect("pairs");
    let same = difference(2, BranchFigure::Cash);
    assert_eq!(
        (same.mean, same.interval, same.first_greater),
        (0.0, None, 0),
        "five are too few for an interval"
    );
    // Lower prices retain more subscribers in every future.
    let fewer = difference(1, BranchFigure::Cancellations);
    assert!(fewer.mean < 0.0 && fewer.first_greater == 0, "{fewer:?}");
    let band = futures.interval(0, BranchFigure::Leads, 91).expect("an interval");
    assert!(band.low < band.median && band.median < band.high, "{band:?}");
}

#[test]
fn futures_redraw_only_after_the_last_recorded_day() {
    let runs = tempfile::tempdir().expect("a folder");
    let session = play_run(runs.path(), Mode::Debug);
    let futures = open_what_if(&session)
        .futures(8, Some(12), &[], 4, &continue_progress)
        .expect("an answer")
        .expect("it is not stopped");
    let band = |week: u32| futures.interval(0, BranchFigure::Cash, 7 * week).expect("an interval");
    let recorded = session.weeks()[9 - 1].cash;
    assert_eq!((band(9).low, band(9).high), (recorded, recorded));
    assert!(band(11).low < band(11).high);
}

#[test]
fn unknown_weeks_lines_and_customers_are_rejected() {
    let runs = tempfile::tempdir().expect("a folder");
    let session = play_run(runs.path(), Mode::Debug);
    let mut what_if = open_what_if(&session);
    let mut code = |week, until, alternatives: &[Vec<DecisionEdit>]| {
        what_if.compare(week, until, alternatives, &continue_progress).expect_err("a rejection").code
    };
    assert_eq!(code(0, None, &[]), "week_unknown");
    assert_eq!(code(12, None, &[]), "week_unknown");
    assert_eq!(code(u32::MAX, None, &[]), "week_unknown");
    assert_eq!(code(5, Some(4), &[]), "week_unknown");
    assert_eq!(code(5, None, &[parse_edits(&["drop 1"])]), "line_unknown");
    assert_eq!(code(5, None, &[parse_edits(&["in 4 set_prices B=3"])]), "week_unknown");
    assert_eq!(code(5, None, &vec![parse_edits(&["set_prices * 2"]); 4]), "too_many_alternatives");
    assert_eq!(code(5, None, &[parse_edits(&["set_prices B=-3"])]), "price_not_positive");
    let refused =
        create_branch_with_decisions(&session, 5, &parse_edits(&["drop 1"]), Mode::Debug, &mut |_| {
            ControlFlow::Continue(())
        });
    assert_eq!(refused.err().map(|refusal| refusal.code), Some("line_unknown"));
    assert_eq!(std::fs::read_dir(runs.path()).expect("runs").count(), 1);
    assert!(what_if.compare(5, None, &[], &|_, _| ControlFlow::Break(())).expect("no rejection").is_none());
}

#[test]
fn unfinished_baseline_rejects_what_if_and_sandbox_hides_satisfaction() {
    let runs = tempfile::tempdir().expect("a folder");
    let baseline = play_weeks(runs.path(), Mode::Baseline, 3, None);
    let refused = WhatIf::open(baseline.folder().expect("a folder")).err().map(|refusal| refusal.code);
    assert_eq!(refused, Some("not_in_this_mode"));
    let kept =
        create_branch_with_decisions(&baseline, 2, &[], Mode::Sandbox, &mut |_| ControlFlow::Continue(()));
    assert_eq!(kept.err().map(|refusal| refusal.code), Some("not_in_this_mode"));
    for (mode, shown) in [(Mode::Sandbox, false), (Mode::Debug, true)] {
        let mut session = play_weeks(runs.path(), mode, 3, None);
        let folder = session.folder().expect("a folder").to_owned();
        let mut what_if = WhatIf::open(&folder).expect("it is read");
        let mut tells = |is_recorded| {
            what_if.set_shows_hidden(is_recorded);
            let all = what_if.compare(4, None, &[], &|_, _| ControlFlow::Continue(())).expect("no rejection");
            all.expect("it was not stopped").figures.contains(&BranchFigure::Satisfaction)
        };
        assert!(!tells(false), "{mode}: satisfaction requires a recorded inspection");
        let is_recorded = record_what_if_inspection(&mut session, 4);
        assert_eq!((is_recorded, tells(is_recorded)), (shown, shown), "{mode}");
        drop(session);
        let text = std::fs::read_to_string(folder.join("trajectory.jsonl")).expect("a trajectory");
        assert_eq!(
            text.lines().filter(|line| line.contains(r#""what":"whatif""#)).count(),
            usize::from(shown)
        );
        let mut read = Session::open(&folder, Access::Read, false).expect("it opens");
        assert!(
            !record_what_if_inspection(&mut read, 4),
            "{mode}: a read-only session records no inspection"
        );
    }
}

#[test]
fn cache_includes_new_decisions_of_the_same_day() {
    let runs = tempfile::tempdir().expect("a folder");
    let mut session = play_run(runs.path(), Mode::Debug);
    let mut kept: AnalysisCache<WhatIf> = AnalysisCache::default();
    let present = session.day() / 7 + 1;
    let folder = session.folder().expect("a folder").to_owned();
    let decided = |kept: &mut AnalysisCache<WhatIf>| {
        kept.get_or_open(folder.clone()).expect("a record").decisions(present).expect("decisions").len()
    };
    assert_eq!(decided(&mut kept), 0);
    session.call("set_prices", &json!({"C": 70}), Via::Plain).expect("a price");
    assert_eq!(decided(&mut kept), 1);
    let forecasts = session.company().naive_forecasts();
    session.advance("on", &forecasts, Via::Plain, &mut |_| {}).expect("a week");
    let asked = kept.get_or_open(folder.clone()).expect("a record").compare(
        4,
        Some(present),
        &[],
        &continue_progress,
    );
    let branches = asked.expect("an answer").expect("it is not stopped").branches;
    let cash = session.weeks().last().map(|week| week.cash);
    assert_eq!(branches[0].value(BranchFigure::Cash, session.day()), cash);
}

#[test]
fn related_runs_name_branch_week_and_first_change() {
    let runs = tempfile::tempdir().expect("a folder");
    let session = play_run(runs.path(), Mode::Debug);
    let mut branch = session.branch(5, Mode::Debug).expect("a branch");
    branch.call("set_prices", &json!({"C": 70}), Via::Plain).expect("a price");
    let other =
        create_branch_with_decisions(&branch, 2, &[], Mode::Debug, &mut |_| ControlFlow::Continue(()));
    let other = other.expect("a branch").session;
    let origin = branch_origin(branch.folder().expect("a folder")).expect("it is a branch");
    let change = |day, what: &str, is_left_out| Some(FirstChange { day, what: what.to_owned(), is_left_out });
    let first_change = change(28, "set_prices", false);
    assert_eq!(origin, BranchOrigin { run: session.manifest().id.clone(), week: 5, first_change });
    let origin = branch_origin(other.folder().expect("a folder")).expect("it is a branch");
    assert_eq!((origin.week, origin.first_change), (2, None));
    assert_eq!(branch_origin(session.folder().expect("a folder")), None);
    for id in [&session.manifest().id, &branch.manifest().id, &other.manifest().id] {
        let tree = related_runs(runs.path(), id);
        let tree_rows: Vec<_> = tree
            .iter()
            .map(|related_run| {
                (
                    related_run.run.id.clone(),
                    related_run.depth,
                    related_run.branched_in_week,
                    related_run.first_change.clone(),
                )
            })
            .collect();
        assert_eq!(
            tree_rows,
            [
                (session.manifest().id.clone(), 0, None, None),
                (branch.manifest().id.clone(), 1, Some(5), change(28, "set_prices", false)),
                (other.manifest().id.clone(), 2, Some(2), None),
            ]
        );
    }
}

#[test]
fn related_runs_name_a_dropped_decision() {
    let runs = tempfile::tempdir().expect("a folder");
    let session = play_run(runs.path(), Mode::Debug);
    let decided = open_what_if(&session).decisions(5).expect("decisions");
    let call = decided[0].call().expect("a call");
    let branch = adopt(&session, 5, &[&format!("drop {}", call.seq)]);
    let origin = branch_origin(branch.folder().expect("a folder")).expect("it is a branch");
    let left_out = FirstChange { day: call.day, what: call.tool.name().to_owned(), is_left_out: true };
    assert_eq!(origin.first_change, Some(left_out));
}

fn adopt(session: &Session, week: u32, alternative: &[&str]) -> Session {
    let go_on = &mut |_| ControlFlow::Continue(());
    let adopted = create_branch_with_decisions(session, week, &parse_edits(alternative), Mode::Debug, go_on);
    let AdoptedBranch { session, rejected: refused } = adopted.expect("a branch");
    assert_eq!(refused, []);
    session
}

#[test]
fn edited_parameter_equals_a_parameter_set_in_a_run() {
    let runs = tempfile::tempdir().expect("a folder");
    let session = play_run(runs.path(), Mode::Debug);
    let alternative = &["set group.S1.c_max_mean 200", "in 7 set satisfaction.satisfaction_ema_alpha 0.9"];
    // Create a branch and set the same parameters manually.
    let mut by_hand = session.branch(5, Mode::Debug).expect("a branch");
    let recorded: Vec<_> = open_what_if(&session).decisions(5).expect("decisions");
    for week in 5..=session.day() / 7 {
        let today = by_hand.day();
        for call in recorded
            .iter()
            .filter_map(RecordedDecision::call)
            .filter(|call| call.day == today && call.accepted)
        {
            by_hand.call(call.tool.name(), &call.args, Via::Plain).expect("as in the run");
        }
        match week {
            5 => drop(by_hand.set_parameter("group.S1.c_max_mean", &json!(200), None).expect("set")),
            7 => {
                let key = "satisfaction.satisfaction_ema_alpha";
                by_hand.set_parameter(key, &json!(0.9), None).expect("set");
            }
            _ => {}
        }
        let forecasts = by_hand.company().naive_forecasts();
        by_hand.advance("on", &forecasts, Via::Plain, &mut |_| {}).expect("a week");
    }
    let compared = compare(&session, 5, &[alternative]);
    let cash = |session: &Session| session.weeks().iter().skip(4).map(|week| week.cash).collect::<Vec<_>>();
    let branch_figures = &compared.branches[1];
    let curve: Vec<f64> = branch_figures.values_by_week(BranchFigure::Cash).map(|(_, cash)| cash).collect();
    assert_eq!(curve, cash(&by_hand));
    assert_ne!(curve, cash(&session));
    let differences: Vec<_> = branch_figures
        .parameter_differences
        .iter()
        .map(|set| (set.day, set.key.as_str(), set.edited.clone()))
        .collect();
    assert_eq!(
        differences,
        [
            (28, "group.S1.c_max_mean", Some(json!(200))),
            (42, "satisfaction.satisfaction_ema_alpha", Some(json!(0.9))),
        ]
    );
    let adopted = adopt(&session, 5, alternative);
    assert_eq!(adopted.state_hash(), by_hand.state_hash());
    // A what-if of the branch can omit the parameter changes of the branch.
    let lines =
        Trajectory::read(&adopted.folder().expect("a folder").join("trajectory.jsonl")).expect("lines").lines;
    let set: Vec<String> = lines
        .iter()
        .filter(|line| matches!(line.record, Record::Override(_)))
        .map(|line| format!("drop {}", line.seq))
        .collect();
    let [first, second] = &set[..] else { panic!("{set:?}") };
    let undone = self::compare(&adopted, 5, &[&[first, second]]);
    let undone: Vec<f64> =
        undone.branches[1].values_by_week(BranchFigure::Cash).map(|(_, cash)| cash).collect();
    assert_eq!(undone, cash(&session));
}

#[test]
fn invalid_parameters_are_rejected() {
    let runs = tempfile::tempdir().expect("a folder");
    let code = |session: &Session, edit: &str| {
        open_what_if(session)
            .compare(3, None, &[parse_edits(&[edit])], &continue_progress)
            .expect_err("a rejection")
            .code
    };
    let debug = play_weeks(runs.path(), Mode::Debug, 3, None);
    assert_eq!(code(&debug, "set group.S1.c_max_men 20"), "parameter_unknown");
    assert_eq!(code(&debug, "set group.S1.c_max_mean much"), "parameter_not_allowed");
    assert_eq!(code(&debug, "set operations.base_outage_prob 2"), "parameter_not_allowed");
    assert_eq!(code(&debug, "set run.seed 2"), "parameter_not_allowed");
    assert_eq!(code(&debug, "in 2 set operations.base_outage_prob 0.5"), "week_unknown");
    assert_eq!(code(&debug, "set leads.ad_spend_unit 1e-9"), "too_many_leads");
    let sandbox = play_weeks(runs.path(), Mode::Sandbox, 3, None);
    assert_eq!(code(&sandbox, "set operations.base_outage_prob 0.5"), "not_in_this_mode");
    assert_eq!(code(&sandbox, "set no.such 1"), "not_in_this_mode");
}

#[test]
fn adoption_replays_single_days() {
    let runs = tempfile::tempdir().expect("a folder");
    let mut session = play_weeks(runs.path(), Mode::Debug, 3, None);
    session.step(2, &mut |_| {}).expect("days");
    session.call("set_prices", &json!({"B": 31}), Via::Plain).expect("a price");
    session.inspect().run_until_breakpoint(9, &mut |_| {}).expect("days");
    let same = adopt(&session, 2, &[]);
    assert_eq!((same.day(), same.state_hash()), (session.day(), session.state_hash()));
}

/// Returns the enterprises that received offers: day, group and number in the group, and the customer numbers.
fn sent_offers(session: &Session) -> (Vec<(u32, Group, u32)>, Vec<u32>) {
    let numbers = session.company().customer_numbers();
    let path = session.folder().expect("a folder").join("trajectory.jsonl");
    let lines = Trajectory::read(&path).expect("a trajectory").lines;
    let mut offers = (Vec::new(), Vec::new());
    for line in &lines {
        let Record::Call(call) = &line.record else { continue };
        if call.tool != ToolId::SendEnterpriseDeal {
            continue;
        }
        for deal in call.args["deals"].as_array().expect("deals") {
            let number = deal[0].as_u64().expect("a number") as u32;
            let (group, n) = numbers.find(number).expect("a customer");
            offers.0.push((line.day, group, n));
            offers.1.push(number);
        }
    }
    offers
}

#[test]
fn offers_reach_the_same_enterprises_when_lead_counts_change() {
    let runs = tempfile::tempdir().expect("a folder");
    let session = play_weeks_with_offers(runs.path());
    let (made, numbers) = sent_offers(&session);
    assert!(made.len() > 10, "{made:?}");
    for (alternative, all_come) in
        [("set_targeted_ad_spend * 1.5", true), ("set_targeted_ad_spend * 0.2", false)]
    {
        let compared = compare(&session, 9, &[&[alternative]]);
        let branch_figures = &compared.branches[1];
        let mut on = |_| ControlFlow::Continue(());
        let adopted =
            create_branch_with_decisions(&session, 9, &parse_edits(&[alternative]), Mode::Debug, &mut on);
        let AdoptedBranch { session: branch, rejected: refused } = adopted.expect("a branch");
        let (reached, under) = sent_offers(&branch);
        assert_ne!(under, numbers, "{alternative}");
        let is_absent = |refusal: &Rejection| refusal.message.contains("does not exist in this branch");
        let absent = refused.iter().filter(|(_, _, refusal)| is_absent(refusal)).count();
        let compared_absent =
            branch_figures.rejected.iter().filter(|refused| is_absent(&refused.rejection)).count();
        assert_eq!(compared_absent, absent, "{alternative}");
        assert_eq!(absent == 0, all_come, "{alternative}: {absent}");
        assert!(reached.iter().all(|offer| made.contains(offer)), "{alternative}");
        let rejected = refused.len() - absent;
        assert!(
            reached.len() + absent <= made.len() && reached.len() + absent + rejected > 10,
            "{alternative}"
        );
        let seats: Vec<f64> =
            branch.weeks().iter().skip(8).map(|week| week.enterprise_seats.into()).collect();
        let curve: Vec<f64> =
            branch_figures.values_by_week(BranchFigure::Seats).map(|(_, seats)| seats).collect();
        assert_eq!(curve, seats, "{alternative}");
    }
}

#[test]
fn partial_last_week_is_simulated_to_its_end() {
    let runs = tempfile::tempdir().expect("a folder");
    let mut session = play_run(runs.path(), Mode::Debug);
    for _ in 0..5 {
        let forecasts = session.company().naive_forecasts();
        session.advance("on", &forecasts, Via::Plain, &mut |_| {}).expect("a week");
    }
    session.step(3, &mut |_| {}).expect("days");
    let compared =
        open_what_if(&session).compare(2, None, &[parse_edits(&["set_prices * 0.9"])], &continue_progress);
    let compared = compared.expect("an answer").expect("it is not stopped");
    assert_eq!((compared.recorded_until, compared.until), (108, 112));
    for branch in &compared.branches {
        assert!(branch.value(BranchFigure::Cash, compared.until).is_some(), "{branch:?}");
    }
    let beyond = open_what_if(&session)
        .compare(2, Some(19), &[], &continue_progress)
        .expect_err("the run has 120 days");
    assert_eq!(beyond.code, "week_unknown");
}
