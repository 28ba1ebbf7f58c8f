//! Integration tests of a run: playing, closing, continuing, verifying, rejections.

use std::path::Path;

use novamind::record::folder::configuration::Configuration;
use novamind::record::folder::runs::{find_run, find_run_to_read, list_runs};
use novamind::record::mode::Mode;
use novamind::record::trajectory::record::{Call, Outcome, RunEndReason, Via};
use novamind::record::trajectory::{Line, Record, Trajectory};
use novamind::session::{Access, Forecasts, NewRun, Session, SettingId, Storage, verify};
use serde_json::{Value, json};

use crate::support::company::{
    advance_week, advance_weeks, apply_opening_decisions, call_tool, query_number, query_text,
};

fn new_run(storage: Storage) -> NewRun {
    NewRun { seed: Some(7), days: Some(60), storage, ..NewRun::default() }
}

fn create(new: NewRun) -> Session {
    Session::create(new, &Configuration::bundled()).expect("the run begins")
}

fn runs_folder(folder: &tempfile::TempDir) -> Storage {
    Storage::Runs(folder.path().to_owned())
}

#[test]
fn database_matches_the_session() {
    let mut session = create(new_run(Storage::Memory));
    apply_opening_decisions(&mut session);
    advance_weeks(&mut session, 6);
    let observation = session.company().observe();
    assert!((query_number(&mut session, "SELECT sum(amount) FROM ledger") - observation.cash).abs() < 1e-6);
    let active = "SELECT count(*) FROM subscriptions WHERE status = 'subscribed'";
    assert_eq!(query_number(&mut session, active), f64::from(observation.subscribers));
    let last = observation.last_week.expect("a week");
    let leads = "SELECT count(*) FROM customers WHERE created_day > 35 AND customer_type = 'small'";
    assert_eq!(query_number(&mut session, leads), f64::from(last.new_individual_leads));
    let paid = "SELECT sum(amount) FROM ledger WHERE day > 35 AND category = 'subscription_payment'";
    assert!((query_number(&mut session, paid) - last.payments).abs() < 1e-6);
    assert_eq!(query_number(&mut session, "SELECT count(*) FROM config_overrides"), 2.0);
    assert_eq!(query_number(&mut session, "SELECT price_B FROM config_history"), 25.0);
    assert!(observation.dashboard.contains("=== Week 6 (day 42) ==="));
}

#[test]
fn rejected_calls_change_nothing_and_are_recorded() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut session = create(new_run(runs_folder(&folder)));
    let before = session.state_hash();
    let refusal = session.call("set_prices", &json!({"A": 0}), Via::Form).expect_err("a price of zero");
    assert_eq!((refusal.code, refusal.field.as_deref()), ("price_not_positive", Some("A")));
    assert_eq!(session.call("set_price", &json!({}), Via::Form).expect_err("no tool").code, "unknown_tool");
    let forecasts = session.company().naive_forecasts();
    let blank = session.advance(" ", &forecasts, Via::Form, &mut |_| {}).expect_err("no rationale");
    assert_eq!(blank.code, "rationale_missing");
    assert_eq!(session.state_hash(), before);
    let place = session.folder().expect("a folder").to_owned();
    drop(session);
    let lines = Trajectory::read(&place.join("trajectory.jsonl")).expect("it reads").lines;
    let refused = |line: &Line| match &line.record {
        Record::Call(Call { outcome: Outcome::Rejected(refusal), .. }) => Some(refusal.code.clone()),
        _ => None,
    };
    let recorded: Vec<Option<String>> = lines.iter().skip(1).map(refused).collect();
    let expected = ["price_not_positive", "unknown_tool", "rationale_missing"];
    assert_eq!(recorded, expected.map(|code| Some(code.to_owned())));
}

#[test]
fn check_reports_cost_and_changes_without_effect() {
    let mut session = create(new_run(Storage::Memory));
    let before = session.state_hash();
    let preview = session.preview_call("set_capacity_tier", &json!({"tier": 2})).expect("it would work");
    assert_eq!((preview.cost_per_day, preview.effect_day), (445.0, Some(1)));
    assert_eq!(preview.changes[0].setting, SettingId::CapacityTier);
    let preview = session.preview_call("start_research_project", &json!({"tier": 1})).expect("it would work");
    assert_eq!(preview.cost_now, 166_667.0);
    assert_eq!(
        session.preview_call("set_prices", &json!({"A": -1})).expect_err("refused").code,
        "price_not_positive"
    );
    assert_eq!(session.state_hash(), before);
    let cash = session.company().observe().cash;
    call_tool(&mut session, "start_research_project", json!({"tier": 1}));
    assert_eq!(session.company().observe().cash, cash - preview.cost_now);
    assert_eq!(session.company().observe().running_research, 1);
}

#[test]
fn undo_restores_settings_of_the_week() {
    let mut session = create(new_run(Storage::Memory));
    assert_eq!(session.undo(Via::Form).expect_err("nothing yet").code, "nothing_to_undo");
    call_tool(&mut session, "set_prices", json!({"A": 12}));
    assert_eq!(session.undo(Via::Form).expect_err("price 0").code, "cannot_undo");
    call_tool(&mut session, "set_prices", json!({"A": 14}));
    call_tool(&mut session, "set_targeted_ad_spend", json!({"linkedin": {"E1": 200}}));
    let back = session.undo(Via::Form).expect("it is taken back");
    assert_eq!(
        (back[0].setting.to_string().as_str(), back[0].old, back[0].new),
        ("ads linkedin E1", 200.0, 0.0)
    );
    session.undo(Via::Form).expect("it is taken back");
    assert_eq!(session.company().current_arguments("set_prices")["A"], 12);
    assert_eq!(session.company().setting_changes().len(), 1);
    advance_week(&mut session);
    assert!(session.company().setting_changes().is_empty());
    assert_eq!(session.undo(Via::Form).expect_err("a week has passed").code, "nothing_to_undo");
}

#[test]
fn calls_that_changed_nothing_do_not_block_undo() {
    let mut session = create(new_run(Storage::Memory));
    for price in [10, 11, 11] {
        call_tool(&mut session, "set_prices", json!({"A": price}));
    }
    call_tool(&mut session, "set_daily_spend", json!({"operations": 0}));
    let back = session.undo(Via::Form).expect("11 is taken back");
    assert_eq!((back[0].setting.to_string().as_str(), back[0].old, back[0].new), ("price A", 11.0, 10.0));
    assert_eq!(session.company().current_arguments("set_prices")["A"], 10);
    assert_eq!(session.undo(Via::Form).expect_err("no price before").code, "cannot_undo");
}

#[test]
fn redo_reapplies_until_a_new_setting() {
    let mut session = create(new_run(Storage::Memory));
    assert_eq!(session.redo(Via::Form).expect_err("nothing undone").code, "nothing_to_redo");
    call_tool(&mut session, "set_prices", json!({"A": 10, "B": 20}));
    call_tool(&mut session, "set_prices", json!({"A": 12}));
    call_tool(&mut session, "set_targeted_dev_spend", json!({"targeted_spend": {"S2": 700}}));
    let there = session.state_hash().1["settings"].clone();
    session.undo(Via::Form).expect("undone");
    session.undo(Via::Form).expect("undone");
    assert_eq!(session.company().current_arguments("set_prices")["A"], 10);
    let setting_changes = session.redo(Via::Form).expect("redone");
    assert_eq!(
        (setting_changes[0].setting.to_string().as_str(), setting_changes[0].old, setting_changes[0].new),
        ("price A", 10.0, 12.0)
    );
    session.undo(Via::Form).expect("a redo can be undone");
    session.redo(Via::Form).expect("and redone");
    session.redo(Via::Form).expect("redone");
    assert_eq!(session.state_hash().1["settings"], there);
    assert_eq!(session.redo(Via::Form).expect_err("all is redone").code, "nothing_to_redo");
    session.undo(Via::Form).expect("undone");
    call_tool(&mut session, "set_capacity_tier", json!({"tier": 1}));
    assert_eq!(session.redo(Via::Form).expect_err("something new was set").code, "nothing_to_redo");
    session.undo(Via::Form).expect("undone");
    advance_week(&mut session);
    assert_eq!(session.redo(Via::Form).expect_err("a week has passed").code, "nothing_to_redo");
}

#[test]
fn undo_history_survives_reopening() {
    let folder = tempfile::tempdir().expect("a folder");
    for snapshot in [false, true] {
        let mut session = create(new_run(runs_folder(&folder)));
        call_tool(&mut session, "set_prices", json!({"A": 10}));
        call_tool(&mut session, "set_prices", json!({"A": 12}));
        call_tool(&mut session, "set_capacity_tier", json!({"tier": 2}));
        session.undo(Via::Form).expect("undone");
        let place = session.folder().expect("a folder").to_owned();
        if snapshot {
            session.save().expect("saved");
        }
        drop(session);
        assert_eq!(place.join("snapshot.bin").exists(), snapshot);
        let mut session = Session::open(&place, Access::Write, true).expect("it opens");
        session.redo(Via::Form).expect("redone");
        assert_eq!(session.company().current_arguments("set_capacity_tier")["tier"], 2);
        session.undo(Via::Form).expect("undone");
        session.undo(Via::Form).expect("undone");
        assert_eq!(session.company().current_arguments("set_prices")["A"], 10);
    }
}

#[test]
fn purchases_count_in_the_following_week() {
    let mut session = create(new_run(Storage::Memory));
    call_tool(&mut session, "research_market", json!({}));
    assert_eq!(
        (session.company().observe().cash_change, session.company().observe().cash),
        (0.0, 975_000.0),
        "no week yet"
    );
    advance_week(&mut session);
    let seen = session.company().observe();
    let week_figures = seen.last_week.expect("a week");
    assert_eq!(seen.cash_change, seen.cash - 1_000_000.0);
    assert_eq!(week_figures.cash_change, seen.cash_change);
    assert!(seen.dashboard.contains(&format!("{:.0}", -seen.cash_change)[..2]), "{}", seen.dashboard);
    call_tool(&mut session, "research_market", json!({}));
    assert_eq!(
        session.company().observe().cash_change,
        seen.cash_change,
        "a purchase does not change the last week"
    );
    let sql = format!(
        "SELECT sum(amount) FROM ledger WHERE {}",
        novamind::session::ledger_weeks_condition_sql(1, 1)
    );
    assert!((query_number(&mut session, &sql) - seen.cash_change).abs() < 1e-6);
    let sql = format!(
        "SELECT sum(amount) FROM ledger WHERE {}",
        novamind::session::ledger_weeks_condition_sql(2, 2)
    );
    assert_eq!(query_number(&mut session, &sql), -25_000.0);
}

#[test]
fn finished_run_rejects_calls() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut session = create(NewRun { days: Some(10), ..new_run(runs_folder(&folder)) });
    advance_week(&mut session);
    let forecasts = session.company().naive_forecasts();
    let last = session.advance("the end", &forecasts, Via::Script, &mut |_| {}).expect("three days");
    assert_eq!((last.figures.day, last.figures.days_run, last.ended), (10, 3, Some(RunEndReason::Horizon)));
    assert_eq!(session.score(), Some(session.company().observe().cash));
    for tool in ["set_prices", "start_research_project"] {
        assert_eq!(session.call(tool, &json!({"A": 5}), Via::Script).expect_err("over").code, "run_over");
    }
    let rejection = session.advance("more", &forecasts, Via::Script, &mut |_| {}).expect_err("over");
    assert_eq!(rejection.code, "run_over");
    assert!(session.call("get_cost_info", &json!({}), Via::Script).is_ok());
    assert_eq!(query_number(&mut session, "SELECT max(day) FROM service_day"), 10.0);
    let place = session.folder().expect("a folder").to_owned();
    drop(session);
    let kinds = |place: &Path| -> Vec<String> {
        let read = Trajectory::read(&place.join("trajectory.jsonl")).expect("it reads");
        read.lines.iter().map(|line| line.record.kind().to_owned()).collect()
    };
    assert_eq!(kinds(&place), ["start", "advance", "week", "advance", "week", "end"]);
    let opened = Session::open(&place, Access::Write, true).expect("it opens");
    assert_eq!(opened.ended(), Some(RunEndReason::Horizon));
}

#[test]
fn bankruptcy_ends_the_week_and_the_run() {
    let mut session = create(NewRun { cash: Some(30_000.0), ..new_run(Storage::Memory) });
    call_tool(&mut session, "set_daily_spend", json!({"operations": 3000, "development": 1500}));
    let forecasts = session.company().naive_forecasts();
    let broke = session.advance("spend", &forecasts, Via::Script, &mut |_| {}).expect("a week");
    assert_eq!(
        (broke.figures.day, broke.ended, session.score()),
        (7, Some(RunEndReason::Bankruptcy), Some(0.0))
    );
    assert!((broke.figures.cash - -2095.0).abs() < 1e-9);
    let mut session = create(new_run(Storage::Memory));
    call_tool(&mut session, "set_targeted_dev_spend", json!({"S1": 200000}));
    let forecasts = session.company().naive_forecasts();
    let broke = session.advance("spend", &forecasts, Via::Script, &mut |_| {}).expect("a week");
    assert_eq!((broke.figures.day, broke.figures.days_run), (5, 5));
    assert!((broke.figures.cash - -425.0).abs() < 1e-9);
}

#[test]
fn damaged_run_is_rejected() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut session = create(new_run(runs_folder(&folder)));
    apply_opening_decisions(&mut session);
    advance_week(&mut session);
    let place = session.folder().expect("a folder").to_owned();
    drop(session);
    let path = place.join("trajectory.jsonl");
    let text = std::fs::read_to_string(&path).expect("text");
    std::fs::write(&path, text.replacen("\"A\":12", "\"A\":13", 1)).expect("a change");
    let error = Session::open(&place, Access::Write, true).err().expect("damaged").to_string();
    assert!(error.contains("line 2") && error.contains("Lines 1 to 1 are valid"), "{error}");
    // The line is changed and all hashes are recomputed, so that only the re-simulated state reveals the change.
    let mut lines: Vec<String> = text.lines().map(str::to_owned).collect();
    lines[1] = lines[1].replace("\"A\":12", "\"A\":13");
    for at in 1..lines.len() {
        let hash = |text: &str| blake3::hash(text.as_bytes()).to_hex().to_string();
        let mut line: serde_json::Map<String, Value> = serde_json::from_str(&lines[at]).expect("a line");
        line.insert("prev".to_owned(), hash(&lines[at - 1]).into());
        line.shift_remove("sum");
        let sum = hash(&Value::Object(line.clone()).to_string())[..16].to_owned();
        line.insert("sum".to_owned(), sum.into());
        lines[at] = Value::Object(line).to_string();
    }
    std::fs::write(&path, lines.join("\n") + "\n").expect("a change");
    let error =
        Session::open(&place, Access::Write, true).err().expect("an error due to the database").to_string();
    assert!(error.contains("it was changed") && error.contains("world.db contains its result"), "{error}");
    std::fs::remove_file(place.join("world.db")).expect("it is there");
    let error = Session::open(&place, Access::Write, true).err().expect("another state").to_string();
    assert!(error.contains("different: customers"), "{error}");
    std::fs::write(&path, "").expect("nothing left");
    assert!(Session::open(&place, Access::Write, true).is_err());
}

#[test]
fn run_in_use_is_locked() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut session = create(new_run(runs_folder(&folder)));
    apply_opening_decisions(&mut session);
    advance_week(&mut session);
    let place = session.folder().expect("a folder").to_owned();
    let error = Session::open(&place, Access::Write, true).err().expect("in use").to_string();
    assert!(error.contains("another program") && error.contains("--watch"), "{error}");
    let mut reader = Session::open(&place, Access::Read, true).expect("reading is allowed");
    assert_eq!(reader.state_hash(), session.state_hash());
    assert_eq!(
        reader.call("set_prices", &json!({"A": 5}), Via::Script).expect_err("read only").code,
        "read_only"
    );
    assert_eq!(query_number(&mut reader, "SELECT max(day) FROM service_day"), 7.0);
    advance_week(&mut session);
}

#[test]
fn runs_are_listed_found_and_named() {
    let folder = tempfile::tempdir().expect("a folder");
    assert!(list_runs(&folder.path().join("nothing")).expect("an empty list").is_empty());
    let mut first = create(new_run(runs_folder(&folder)));
    advance_week(&mut first);
    let mut second = create(NewRun { days: Some(500), ..new_run(runs_folder(&folder)) });
    assert_eq!((first.manifest().earlier_runs, second.manifest().earlier_runs), (0, 1));
    let list = list_runs(folder.path()).expect("a list");
    assert_eq!(list.len(), 2);
    let run_summary = list.iter().find(|run| run.id == first.manifest().id).expect("the first");
    assert_eq!((run_summary.day, run_summary.cash), (7, first.company().observe().cash));
    assert!(find_run(folder.path(), &second.manifest().id[..6]).is_ok());
    assert!(find_run(folder.path(), "latest").is_ok());
    assert!(find_run(folder.path(), "zz").is_err());
    second.abandon().expect("given up");
    let open = find_run(folder.path(), "latest").expect("the unfinished one");
    assert!(open.ends_with(&first.manifest().id));
    assert!(find_run_to_read(folder.path(), "latest").is_ok());
    first.abandon().expect("given up");
    let ended = find_run(folder.path(), "latest").expect_err("nothing is left to play").to_string();
    assert!(ended.contains("have ended; start a new run with `novamind play`"), "{ended}");
    assert!(find_run_to_read(folder.path(), "latest").is_ok(), "something is left to read");
}

#[test]
fn invalid_new_runs_are_rejected() {
    let wrong = |new: NewRun| match Session::create(new, &Configuration::bundled()) {
        Ok(_) => panic!("it began"),
        Err(error) => error.to_string(),
    };
    let plain = || new_run(Storage::Memory);
    assert!(wrong(NewRun { days: Some(6), ..plain() }).contains("between 7 and"));
    assert!(wrong(NewRun { cash: Some(0.0), ..plain() }).contains("above 0"));
    assert!(wrong(NewRun { cash: Some(f64::NAN), ..plain() }).contains("above 0"));
    assert!(wrong(NewRun { scenario: "nothing".to_owned(), ..plain() }).contains("competitor-off"));
    let set = vec![("quality.base_product_quality".to_owned(), "0.3".to_owned())];
    assert!(wrong(NewRun { overrides: set.clone(), ..plain() }).contains("debug runs only"));
    assert!(
        Session::create(NewRun { overrides: set, mode: Mode::Debug, ..plain() }, &Configuration::bundled())
            .is_ok()
    );
    let nowhere = Storage::Runs("/dev/null/runs".into());
    assert!(wrong(new_run(nowhere)).contains("/dev/null/runs"));
}

#[test]
fn hidden_state_requires_a_debug_run() {
    let mut sandbox = create(new_run(Storage::Memory));
    assert_eq!(sandbox.debug_hidden_state().err().expect("hidden").code, "not_in_this_mode");
    assert_eq!(sandbox.step(1, &mut |_| {}).expect_err("weeks only").code, "not_in_this_mode");
    let mut debug = create(NewRun { mode: Mode::Debug, ..new_run(Storage::Memory) });
    apply_opening_decisions(&mut debug);
    apply_opening_decisions(&mut sandbox);
    for days in [1, 3, 9] {
        debug.step(days, &mut |day| assert!(day.xray.is_some())).expect("days");
    }
    assert_eq!(debug.day(), 7);
    debug.step(2, &mut |_| {}).expect("days");
    advance_week(&mut debug);
    let mut hidden = 0;
    for _ in 0..2 {
        let forecasts = sandbox.company().naive_forecasts();
        let mut watch = |day: &novamind::session::DayReport<'_>| hidden += u32::from(day.xray.is_some());
        sandbox.advance("a week", &forecasts, Via::Script, &mut watch).expect("a week");
    }
    assert_eq!((hidden, debug.day(), sandbox.day()), (0, 14, 14));
    assert_eq!(debug.company().observe().cash, sandbox.company().observe().cash);
}

#[test]
fn filed_forecasts_can_be_read() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut session = create(new_run(runs_folder(&folder)));
    let predictions = json!({
        "cash_1wk": {"point": 990000, "lower": 980000, "upper": 995000},
        "cash_4wk": {"point": 960000, "lower": 930000, "upper": 980000},
        "cash_12wk": {"point": 900000, "lower": 800000, "upper": 1000000},
        "cash_26wk": {"point": 900000, "lower": 500000, "upper": 1500000},
    });
    session
        .advance_with_json(&json!("why"), &predictions, [false; 4], Via::Http, &mut |_| {})
        .expect("a week");
    let sum = "SELECT sum(predicted_value + horizon_days) FROM predictions WHERE submit_day = 0 AND metric = 'cash'";
    let expected = 990_000.0 + 960_000.0 + 900_000.0 + 900_000.0 + 301.0;
    assert_eq!(query_number(&mut session, sum), expected);
    let filed = query_number(&mut session, "SELECT submitted_at FROM predictions");
    let place = session.folder().expect("a folder").to_owned();
    drop(session);
    std::fs::remove_file(place.join("world.db")).expect("it is there");
    let mut session = Session::open(&place, Access::Write, true).expect("it opens");
    assert_eq!(query_number(&mut session, sum), expected);
    assert_eq!(query_number(&mut session, "SELECT submitted_at FROM predictions"), filed);
    let naive: Forecasts = session.company().naive_forecasts();
    assert!(naive.filled_naively == [true; 4] && naive.all[0].lower < naive.all[0].point);
}

#[test]
fn branch_shares_history_and_then_differs() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut parent = create(new_run(runs_folder(&folder)));
    apply_opening_decisions(&mut parent);
    advance_weeks(&mut parent, 3);
    let at_week_3 = parent.cash_by_day()[..=14].to_vec();
    let mut branch = parent.branch(3, Mode::Debug).expect("a branch");
    assert_eq!((branch.day(), branch.manifest().mode), (14, Mode::Debug));
    assert_eq!(branch.cash_by_day(), at_week_3);
    assert_eq!(
        branch.manifest().parent.as_ref().map(|parent| parent.run.clone()),
        Some(parent.manifest().id.clone())
    );
    advance_week(&mut branch);
    assert_eq!(branch.state_hash(), parent.state_hash(), "the same decisions lead to the same world");
    call_tool(&mut branch, "set_prices", json!({"A": 99}));
    advance_week(&mut branch);
    advance_week(&mut parent);
    assert_ne!(branch.state_hash(), parent.state_hash());
    branch.save().expect("saved");
    assert_eq!(verify(branch.folder().expect("a folder")).expect("verified").day, branch.day());
    for (week, code) in [(0, "week_unknown"), (6, "week_unknown")] {
        assert_eq!(parent.branch(week, Mode::Sandbox).map(drop).expect_err("no such week").code, code);
    }
    assert_eq!(parent.branch(1, Mode::Baseline).map(drop).expect_err("baseline").code, "not_in_this_mode");
    assert_eq!(parent.branch(1, Mode::Sandbox).expect("from the start").day(), 0);
}

#[test]
fn baseline_run_cannot_be_branched_before_its_end() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut run = create(NewRun { mode: Mode::Baseline, ..new_run(runs_folder(&folder)) });
    advance_week(&mut run);
    assert_eq!(run.branch(1, Mode::Sandbox).map(drop).expect_err("unfinished").code, "not_in_this_mode");
    run.abandon().expect("given up");
    assert!(run.branch(2, Mode::Debug).is_ok());
}

#[test]
fn journal_lists_decisions_and_scores_forecasts() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut run = create(new_run(runs_folder(&folder)));
    apply_opening_decisions(&mut run);
    advance_weeks(&mut run, 5);
    run.set_notes("prices were a guess").expect("noted");
    let scores = run.company().forecast_scores();
    assert_eq!(
        scores.iter().map(|score| (score.horizon_days, score.scored)).collect::<Vec<_>>(),
        [(7, 5), (28, 2), (84, 0), (182, 0)]
    );
    let id = run.manifest().id.clone();
    let journal = run.journal().to_vec();
    drop(run);
    let session = Session::open(&folder.path().join(id), Access::Write, true).expect("opens");
    assert_eq!(session.journal(), journal);
    assert_eq!(session.company().forecast_scores(), scores);
    assert_eq!(session.notes().expect("readable"), "prices were a guess");
}

#[test]
fn player_post_receives_reactions_comments_and_a_notification() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut session = create(NewRun { mode: Mode::Debug, ..new_run(runs_folder(&folder)) });
    apply_opening_decisions(&mut session);
    advance_weeks(&mut session, 2);
    let complaint =
        query_number(&mut session, "SELECT max(post_id) FROM social_media_posts WHERE day % 7 = 0");
    assert!(complaint > 0.0, "customers posted on the seventh day");
    // The post announces a real discount to a group that values discounts.
    call_tool(&mut session, "set_promotion", json!({"by_group": {"S1": 2}}));
    let content = "Every plan is $2 off from today: no tricks, cancel anytime. We cut the price because students asked for \
                   it, and the discount stays free of small print. Tell the community forum what you think.";
    let made = call_tool(&mut session, "post_social_media", json!({"content": content}));
    assert_eq!((&made["agent_post_id"], &made["day"]), (&json!(1), &json!(14)));
    let again = session.call("post_social_media", &json!({"content": "More."}), Via::Script);
    assert_eq!(again.expect_err("one a day").code, "already_posted");
    let text = "SELECT views FROM agent_social_media_posts";
    assert_eq!(query_number(&mut session, text), 0.0);
    let insult = |session: &mut Session| {
        call_tool(
            session,
            "post_social_media",
            json!({"content": "Read the docs, you idiots. Shut up.", "reply_to_post_id": 1}),
        )
    };

    advance_week(&mut session);
    assert!(
        session.company().dashboard().contains("--- Your posts ---\nDay 14: "),
        "{}",
        session.company().dashboard()
    );
    insult(&mut session);
    let views = query_number(&mut session, text);
    assert!(views >= 300.0, "six groups of at least 50: {views}");
    let notice = query_text(&mut session, "SELECT message FROM notifications WHERE type = 'social_media'");
    assert!(notice.contains("Every plan is $2 off") && notice.contains("S1 +"), "{notice}");
    let judged = session.debug_hidden_state().expect("a debug run").judgements(1).to_vec();
    assert_eq!(judged.len(), 6);
    assert!(
        judged[0].effect >= 0.6 && !judged[0].reason().is_empty(),
        "{}: {}",
        judged[0].effect,
        judged[0].reason()
    );
    let strong_reaction_count =
        judged.iter().filter(|judgement| judgement.effect.abs() >= 0.6).count() as f64;
    let comments = "SELECT count(*) FROM social_media_posts WHERE reply_to_agent_post_id = 1";
    assert_eq!(query_number(&mut session, comments), strong_reaction_count);
    let listed = query_text(
        &mut session,
        "SELECT comment_post_ids FROM agent_social_media_posts WHERE agent_post_id = 1",
    );
    let listed: Vec<u32> = serde_json::from_str(&listed).expect("a JSON list");
    assert_eq!(listed.len() as f64, strong_reaction_count);

    advance_week(&mut session);
    let answers = call_tool(&mut session, "get_social_posts", json!({"limit": -1}));
    let against = answers["posts"]
        .as_array()
        .expect("a list")
        .iter()
        .filter(|post| post["reply_to_agent_post_id"] == 2);
    assert!(against.count() >= 1);
    assert!(
        session
            .debug_hidden_state()
            .expect("a debug run")
            .judgements(2)
            .iter()
            .all(|judgement| judgement.effect < -0.3)
    );
    assert_eq!(
        session.company().posts().len() as f64,
        query_number(&mut session, "SELECT count(*) FROM social_media_posts")
    );

    let place = session.folder().expect("a folder").to_owned();
    let (hash, _) = session.state_hash();
    let words: Vec<String> = session.company().posts().iter().map(|post| post.content.clone()).collect();
    drop(session);
    let again = Session::open(&place, Access::Read, false).expect("it opens");
    assert_eq!(again.state_hash().0, hash);
    assert_eq!(again.company().posts().iter().map(|post| post.content.clone()).collect::<Vec<_>>(), words);
    verify(&place).expect("every state is reached again");
}
