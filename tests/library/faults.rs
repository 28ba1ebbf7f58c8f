//! Seeded faults: each fault changes the simulation, is visible in a view of the x-ray, and is kept when its run is reopened.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use novamind::insight::{Inspect, LeadFactor, SatisfactionTerm, WriteSource, WriteTarget};
use novamind::record::error::RunError;
use novamind::record::folder::configuration::Configuration;
use novamind::record::folder::manifest_check::read_manifest;
use novamind::record::mode::Mode;
use novamind::record::trajectory::{Record, Trajectory};
use novamind::session::{Category, NewRun, ReputationCause, Session, Storage, verify};
use novamind::world::fault::Fault;
use novamind::world::identifiers::Group;
use serde_json::{Value, json};

use crate::support::company::{advance_weeks, apply_opening_decisions, call_tool, query_number};

fn new_run(folder: &Path, fault: Option<Fault>) -> NewRun {
    NewRun {
        seed: Some(7),
        days: Some(200),
        mode: Mode::Debug,
        fault,
        storage: Storage::Runs(folder.to_owned()),
        ..NewRun::default()
    }
}

fn advance_days(session: &mut Session, days: u32) {
    if days > 0 {
        session.inspect().run_until_breakpoint(days, &mut |_| {}).expect("days");
    }
}

/// Returns a company with subscribers of several groups and plans after a number of days.
fn create_company(folder: &Path, fault: Option<Fault>, days: u32) -> Session {
    let mut session = Session::create(new_run(folder, fault), &Configuration::bundled()).expect("it begins");
    apply_opening_decisions(&mut session);
    call_tool(&mut session, "set_capacity_tier", json!({"tier": 2}));
    let ads = json!({"content_marketing": {"S1": 750, "S2": 500}, "search_ads": {"S3": 500}});
    call_tool(&mut session, "set_targeted_ad_spend", json!({"targeted_spend": ads}));
    advance_days(&mut session, days.min(28));
    if days == STRESSED_DAYS {
        let key = "reputation.reputation_quality_cancel_damage";
        session
            .set_parameter(key, &json!(1), None)
            .expect("cancellations cost a thousand times as much reputation");
        call_tool(&mut session, "set_prices", json!({"A": 400, "B": 500, "C": 600}));
    }
    advance_days(&mut session, days.saturating_sub(28));
    session
}

/// Number of days of a run in which cancellations reduce reputation to its minimum.
const STRESSED_DAYS: u32 = 50;

fn group(id: &str) -> Group {
    Group::parse(id).expect("a group")
}

fn parameter_value(session: &Session, key: &str) -> f64 {
    session
        .company()
        .debug_parameters()
        .and_then(|debug_parameters| debug_parameters.value(key))
        .expect("a parameter")
        .as_f64()
        .expect("a number")
}

/// Symptom of a fault: the number of days after which it is visible, and a function that checks whether a view shows the fault.
struct FaultSymptom {
    days: u32,
    shows: fn(&mut Session) -> bool,
}

fn fault_symptom(fault: Fault) -> FaultSymptom {
    let at = |days, shows| FaultSymptom { days, shows };
    match fault {
        Fault::EconomyReversed => at(12, |session| {
            let leads = session.inspect().lead_equations(group("S1"), Some(12)).expect("a result");
            let factor = leads.last().expect("a day").factor(LeadFactor::Economy);
            let rows = session
                .inspect()
                .query_hidden_tables("SELECT pmi FROM hidden.pmi WHERE day = 12", None)
                .expect("a result");
            let pmi = novamind::database::number_at(&rows.rows[0], 0);
            let gap = pmi - parameter_value(session, "macro.neutral_pmi");
            assert!(gap.abs() > 0.1 && parameter_value(session, "group.S1.macro_beta.lead_generation") > 0.0);
            (factor - 1.0) * gap < 0.0
        }),
        Fault::QuotaInverted => at(12, |session| {
            let equation = session.inspect().satisfaction_equation(group("S1"), Some(12)).expect("a result");
            // Without the fault, this term is 0, because no demand is close to the quota.
            equation.term(SatisfactionTerm::Quota).expect("subscribers") != 0.0
        }),
        Fault::SmallerRivalMove => at(75, |session| {
            let moves = session.inspect().competitor_state(Some(75)).expect("a result").moves;
            assert!(!moves.is_empty());
            moves.iter().any(|(event, _)| event.boost < event.sampled)
        }),
        Fault::SpillOverReversed => at(30, |session| {
            let spilled: Vec<bool> = (10..=30)
                .flat_map(|day| {
                    let target = WriteTarget::Reputation(group("S3"));
                    session.inspect().figure_writes(target, Some(day)).expect("a result").writes
                })
                .filter_map(|write| match write.source {
                    WriteSource::Reputation(ReputationCause::Spillover(spill)) => {
                        Some(write.amount() * spill.change < 0.0)
                    }
                    _ => None,
                })
                .collect();
            assert!(!spilled.is_empty());
            spilled.contains(&true)
        }),
        Fault::TenureInDays => at(12, |session| {
            let equation = session.inspect().satisfaction_equation(group("S1"), Some(12)).expect("a result");
            let most = parameter_value(session, "quality.stickiness_log_scale")
                * libm::log(1.0 + 12.0 / parameter_value(session, "quality.stickiness_days_scale"));
            equation.term(SatisfactionTerm::Tenure).expect("subscribers") > most
        }),
        Fault::DriftTwice => at(91, |session| {
            let before = session.inspect().drift_state(Some(89)).expect("a result");
            let after = session.inspect().drift_state(Some(90)).expect("a result");
            assert_eq!(before.next_day, Some(90));
            before.groups.iter().zip(&after.groups).any(|(before, after)| {
                let moved = after.expectation.c_max - before.expectation.c_max;
                (moved - before.next_step.c_max).abs() > 1e-12
            })
        }),
        Fault::ReferralsSwapped => at(12, |session| {
            let mut from_s1 = |to: &str| {
                let leads = session.inspect().lead_equations(group(to), Some(12)).expect("a result");
                let word_of_mouth = &leads.last().expect("a day").word_of_mouth;
                word_of_mouth.iter().find(|(source, _)| *source == group("S1")).expect("S1 has subscribers").1
            };
            let shown = from_s1("S2") / from_s1("S1");
            let rate =
                |to: &str| parameter_value(session, &format!("referral_leads_per_subscriber_day.S1.{to}"));
            (shown / (rate("S2") / rate("S1")) - 1.0).abs() > 1e-9
        }),
        Fault::ComputeOfOnePlan => at(30, |session| {
            let writes =
                session.inspect().figure_writes(WriteTarget::Cash, Some(28)).expect("a result").writes;
            let compute = writes
                .iter()
                .find(|figure_write| figure_write.source == WriteSource::LedgerEntries(Category::Compute));
            let paid = -compute.expect("compute is booked").requested_change();
            let used = query_number(session, "SELECT sum(usage_units) FROM daily_usage WHERE day = 28");
            let unit = |tier: u32| parameter_value(session, &format!("model_tier.{tier}.unit_cost"));
            // Some subscribers use plan B or C, whose models are more expensive.
            paid <= used * unit(1) * (1.0 + 1e-9)
        }),
        Fault::ReputationWithoutFloor => at(STRESSED_DAYS, |session| {
            let floor = parameter_value(session, "reputation.reputation_floor");
            (29..=STRESSED_DAYS).any(|day| {
                let target = WriteTarget::Reputation(group("S1"));
                let writes = session.inspect().figure_writes(target, Some(day)).expect("a result").writes;
                writes.iter().any(|write| write.after < floor)
            })
        }),
        Fault::TargetedGainAsGeneral => at(7, |session| {
            let mut group_gain = |day| {
                session.inspect().quality_equation(group("S1"), Some(day)).expect("a result").group_gain
            };
            let grown = group_gain(5) - group_gain(4);
            let gain = parameter_value(session, "development.targeted_dev_improvement_coef")
                * libm::log(1.0 + 6000.0 / parameter_value(session, "development.targeted_dev_spend_scale"));
            (grown / gain - 1.0).abs() > 1e-9
        }),
    }
}

fn run_folder(session: &Session) -> PathBuf {
    session.folder().expect("a folder").to_owned()
}

#[test]
fn each_fault_changes_the_state_and_is_visible_in_its_view() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut correct_sessions = BTreeMap::new();
    for fault in Fault::ALL {
        let FaultSymptom { days, shows } = fault_symptom(fault);
        let correct_session =
            correct_sessions.entry(days).or_insert_with(|| create_company(folder.path(), None, days));
        let mut faulty = create_company(folder.path(), Some(fault), days);
        assert_ne!(correct_session.state_hash(), faulty.state_hash(), "{fault:?} changes nothing");
        assert!(!shows(correct_session), "{fault:?} shows in a run without it");
        assert!(shows(&mut faulty), "{fault:?} does not show");
        let first =
            correct_session.inspect().compare_with_run(&mut faulty, None).expect("a result").first_day;
        assert!(first.is_some_and(|day| day <= days), "{fault:?}");
    }
}

#[test]
fn fault_persists_with_its_run_and_is_not_disclosed() {
    let folder = tempfile::tempdir().expect("a folder");
    for fault in [Fault::SpillOverReversed, Fault::QuotaInverted] {
        let mut session = create_company(folder.path(), Some(fault), 28);
        advance_weeks(&mut session, 1);
        assert!(session.company().observe().has_own_parameters, "a run with a fault is never ranked");
        assert_eq!(
            session
                .company()
                .debug_parameters()
                .and_then(|debug_parameters| debug_parameters.changes())
                .expect("a debug run")
                .in_force,
            [],
            "it is not a parameter"
        );
        let path = run_folder(&session);
        let branch = session.branch(3, Mode::Debug).expect("a branch");
        assert_eq!(branch.manifest().fault, Some(fault));
        let refused = session.branch(3, Mode::Sandbox).err().expect("no sandbox has a fault");
        assert_eq!(refused.code, "not_in_this_mode");
        let branch_place = run_folder(&branch);
        drop((session, branch));
        for place in [&path, &branch_place] {
            verify(place).expect("it verifies");
        }
        // The manifest is not required, because the first line of the trajectory contains the fault number. The line
        // contains no other data about the fault.
        let text = std::fs::read_to_string(path.join("run.toml")).expect("a manifest");
        assert!(text.contains(&format!("\nfault = {}\n", fault.number())), "{text}");
        std::fs::remove_file(path.join("run.toml")).expect("removed");
        assert_eq!(read_manifest(&path).expect("a manifest from the first line").fault, Some(fault));
        let lines = Trajectory::read(&path.join("trajectory.jsonl")).expect("lines").lines;
        assert!(matches!(&lines[0].record, Record::Start(start) if start.fault == Some(fault)));
        let text = std::fs::read_to_string(path.join("trajectory.jsonl")).expect("lines");
        assert!(!text.contains(&format!("{fault:?}")));
        // Parameters with a different fault number do not match the digest of the run.
        let other = Fault::ALL.into_iter().find(|other| *other != fault).expect("another");
        let mut forged = read_manifest(&path).expect("a manifest from the first line");
        forged.fault = Some(other);
        assert!(forged.load_params().is_err(), "the digests differ");
        forged.fault = None;
        assert!(forged.load_params().is_err());
    }
}

#[test]
fn faults_require_a_debug_run() {
    let folder = tempfile::tempdir().expect("a folder");
    for mode in [Mode::Baseline, Mode::Sandbox, Mode::Lesson] {
        let participant = (mode == Mode::Baseline).then(|| "P01".to_owned());
        for fault in Fault::ALL {
            let new =
                NewRun { mode, participant: participant.clone(), ..new_run(folder.path(), Some(fault)) };
            let refused = Session::create(new, &Configuration::bundled()).err().expect("refused").to_string();
            assert!(refused.contains("a fault can be seeded in debug runs only"), "{refused}");
        }
    }
    assert!(
        std::fs::read_dir(folder.path()).expect("a folder").all(|entry| entry.expect("one").path().is_file())
    );
    let new = |key: &str| NewRun {
        overrides: vec![(key.to_owned(), "3".to_owned())],
        ..new_run(folder.path(), None)
    };
    for key in ["fault", "run.fault", "fidelity.fault"] {
        assert!(Session::create(new(key), &Configuration::bundled()).is_err(), "{key}");
    }
    // A manifest with a fault in a mode other than debug is rejected.
    let session = create_company(folder.path(), Some(Fault::DriftTwice), 7);
    let path = run_folder(&session);
    drop(session);
    let text = std::fs::read_to_string(path.join("run.toml")).expect("a manifest");
    std::fs::write(path.join("run.toml"), text.replace("mode = \"debug\"", "mode = \"sandbox\""))
        .expect("a file");
    let read = novamind::record::folder::manifest::Manifest::read(&path);
    assert!(matches!(read, Err(RunError::InvalidRequest(_))), "{read:?}");
}

#[test]
fn setting_parameters_keeps_the_fault() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut session = create_company(folder.path(), Some(Fault::TargetedGainAsGeneral), 7);
    let set: Value = json!(0.3);
    session.set_parameter("quality.base_product_quality", &set, Some(10)).expect("from a later day on");
    advance_weeks(&mut session, 1);
    let mut group_gain =
        |day| session.inspect().quality_equation(group("S1"), Some(day)).expect("a result").group_gain;
    let grown = group_gain(13) - group_gain(12);
    assert!(grown < 0.005, "{grown}");
    let place = run_folder(&session);
    drop(session);
    verify(&place).expect("it verifies");
}
