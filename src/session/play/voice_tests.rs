//! Tests of record, replay and remarks with a language model that works, is late, fails or is missing.

use std::path::Path;
use std::time::{Duration, Instant};

use serde_json::json;

use crate::create::{NewRun, Storage, StudyOptions};
use crate::model_voice::stub::{StubBehavior, StubModel};
use crate::play::Session;
use crate::play::open::Access;
use crate::resume::verify::verify;
use novamind_database::Cell;
use novamind_record::folder::configuration::Configuration;
use novamind_record::folder::manifest::Manifest;
use novamind_record::mode::Mode;
use novamind_record::rules::SessionRules;
use novamind_record::stamp::StudyStamp;
use novamind_record::trajectory::record::{ModelTask, RewordedPost, RewordedPosts, Via, VoiceAnswer};
use novamind_record::trajectory::{Record, Trajectory};

const POST: &str = "We doubled the quota of plan B today and cut its price by 20%.";

fn new_run(runs: &Path, mode: Mode) -> NewRun {
    let participant = (mode == Mode::Baseline).then(|| "P01".to_owned());
    let storage = Storage::Runs(runs.to_owned());
    NewRun { seed: Some(7), days: Some(60), mode, participant, storage, ..NewRun::default() }
}

fn start_company(runs: &Path, configuration: &Configuration) -> Session {
    let mut session = Session::create(new_run(runs, Mode::Sandbox), configuration).expect("a run");
    for (tool, arguments) in [
        ("set_prices", json!({"A": 12, "B": 25, "C": 55})),
        ("set_model_tiers", json!({"B": 2, "C": 4})),
        ("set_usage_quotas", json!({"A": 60_000, "B": 250_000, "C": 1_200_000})),
        ("set_daily_spend", json!({"operations": 200, "development": 200})),
        ("set_targeted_ad_spend", json!({"targeted_spend": {"content_marketing": {"S1": 2000}}})),
    ] {
        session.call(tool, &arguments, Via::Script).unwrap_or_else(|rejection| panic!("{tool}: {rejection}"));
    }
    session
}

fn publish_post(session: &mut Session) {
    session.call("post_social_media", &json!({ "content": POST }), Via::Script).expect("a post");
}

/// Simulates a week and returns the remark of its report.
fn advance_week(session: &mut Session) -> Option<String> {
    let forecasts = session.company().naive_forecasts();
    session.advance("on", &forecasts, Via::Script, &mut |_| {}).expect("a week").remark
}

/// Simulates three weeks and publishes a post before the second week.
fn play_three_weeks(runs: &Path, configuration: &Configuration) -> (Session, Vec<Option<String>>) {
    let mut session = start_company(runs, configuration);
    let mut texts = vec![advance_week(&mut session)];
    publish_post(&mut session);
    texts.extend([advance_week(&mut session), advance_week(&mut session)]);
    (session, texts)
}

fn voice_answers(folder: &Path) -> Vec<VoiceAnswer> {
    let lines = Trajectory::read(&folder.join("trajectory.jsonl")).expect("a trajectory").lines;
    let answers = lines.into_iter().filter_map(|line| match line.record {
        Record::Voice(voice_answer) => Some(voice_answer),
        _ => None,
    });
    answers.collect()
}

fn post_texts(session: &Session) -> Vec<String> {
    session.company().posts().iter().map(|post| post.content.clone()).collect()
}

fn queried_post_texts(session: &mut Session) -> Vec<String> {
    let rows = session.query("SELECT content FROM social_media_posts ORDER BY post_id").expect("rows").rows;
    let text = |row: Vec<Cell>| match row.into_iter().next() {
        Some(Cell::Text(text)) => text.to_string(),
        other => panic!("{other:?}"),
    };
    rows.into_iter().map(text).collect()
}

fn run_folder(session: &Session) -> std::path::PathBuf {
    session.folder().expect("a folder").to_owned()
}

#[test]
fn voice_answers_replay_without_the_model() {
    let runs = tempfile::tempdir().expect("a folder");
    let stub = StubModel::start(StubBehavior::Correct);
    let (mut session, weekly_notices) = play_three_weeks(runs.path(), &stub.configuration(true, true, 30));
    assert_eq!(weekly_notices, [None, None, None]);
    let folder = run_folder(&session);
    let (hash, words) = (session.state_hash().0, post_texts(&session));
    let effects = session.simulation.world.market.social.own[0].effects.expect("it was judged");
    assert!(effects.iter().filter(|effect| **effect == 0.8).count() >= 6);
    assert!(
        session.simulation.feed.judgements[0]
            .iter()
            .all(|judgement| judgement.reason() == "It speaks to me.")
    );
    assert!(
        words.len() > 3 && words.iter().rev().take(3).all(|text| text.starts_with("Well: ")),
        "{words:?}"
    );
    assert_eq!(queried_post_texts(&mut session), words);
    let answers = voice_answers(&folder);
    let scored = answers
        .iter()
        .filter(|voice_answer| matches!(voice_answer, VoiceAnswer::Scores(judged) if judged.post == 1));
    assert_eq!(scored.count(), 1);
    let asked = stub.requests();
    assert_eq!(asked.len(), answers.len(), "one request for each answer");
    let all = serde_json::to_string(&asked).expect("JSON");
    assert!(asked.iter().all(|value| value["model"] == "stub") && !all.contains("satisfaction"), "{all}");
    session.save().expect("saved");
    drop((session, stub));

    let verified = verify(&folder).expect("it replays without the model");
    assert_eq!((verified.state_hash, verified.states), (hash.clone(), 3));
    assert_eq!(post_texts(&Session::open(&folder, Access::Read, false).expect("it opens")), words);
    for file in ["world.db", "snapshot.bin"] {
        let _ = std::fs::remove_file(folder.join(file));
    }
    let mut again = Session::open(&folder, Access::Write, true).expect("it opens");
    assert_eq!((again.state_hash().0, post_texts(&again)), (hash, words.clone()));
    assert_eq!(queried_post_texts(&mut again), words, "the database contains the recorded texts");
    again.connect_model(None);
    assert!(
        again.remarks().iter().any(|remark| remark.contains("stub at 127.0.0.1")),
        "{:?}",
        again.remarks()
    );
    assert_eq!(advance_week(&mut again), None, "the built-in voice continues");
    again.save().expect("saved");
    drop(again);
    verify(&folder).expect("it replays");
}

#[test]
fn branch_copies_reworded_posts() {
    let runs = tempfile::tempdir().expect("a folder");
    let stub = StubModel::start(StubBehavior::Correct);
    let (session, _) = play_three_weeks(runs.path(), &stub.configuration(true, true, 30));
    drop(stub);
    let branch = session.branch(3, Mode::Sandbox).expect("a branch");
    let so_far = post_texts(&branch);
    assert!(so_far.iter().any(|text| text.starts_with("Well: ")));
    assert_eq!(post_texts(&session)[..so_far.len()], so_far);
    assert_eq!(branch.manifest().voice, session.manifest().voice);
    verify(&run_folder(&branch)).expect("it replays");
    drop(branch);
}

#[test]
fn failing_model_changes_nothing_and_is_reported_once() {
    let runs = tempfile::tempdir().expect("a folder");
    let (plain, _) = play_three_weeks(runs.path(), &Configuration::bundled());
    assert_eq!(voice_answers(&run_folder(&plain)), []);
    for (manner, why) in [
        (StubBehavior::Late, "did not answer in time"),
        (StubBehavior::TooFew, "cannot be used"),
        (StubBehavior::NotJson, "not a JSON array"),
        (StubBehavior::ServerError, "status 500"),
    ] {
        let stub = StubModel::start(manner);
        let started = Instant::now();
        let (session, weekly_notices) = play_three_weeks(runs.path(), &stub.configuration(true, true, 1));
        assert!(started.elapsed() < Duration::from_secs(20), "a week waits one second at most");
        assert_eq!(session.state_hash(), plain.state_hash(), "{manner:?}");
        assert_eq!(post_texts(&session), post_texts(&plain), "{manner:?}");
        let notices: Vec<&String> = weekly_notices.iter().flatten().collect();
        assert!(notices.len() == 1 && notices[0].contains(why), "{manner:?}: {notices:?}");
        let failed = voice_answers(&run_folder(&session));
        let is_of = |what: ModelTask| {
            failed.iter().any(|voice_answer| matches!(voice_answer, VoiceAnswer::Failed(failed_answer) if failed_answer.asked == what))
        };
        assert!(is_of(ModelTask::Scores) && is_of(ModelTask::Words), "{failed:?}");
        verify(&run_folder(&session)).expect("it replays");
    }
    // The stub server is no longer running.
    let configuration = StubModel::start(StubBehavior::Correct).configuration(true, true, 1);
    let (session, weekly_notices) = play_three_weeks(runs.path(), &configuration);
    assert_eq!(session.state_hash(), plain.state_hash());
    assert_eq!(weekly_notices.iter().flatten().count(), 1, "{weekly_notices:?}");
}

#[test]
fn baseline_run_has_a_model_only_if_its_study_names_one() {
    let runs = tempfile::tempdir().expect("a folder");
    let stub = StubModel::start(StubBehavior::Correct);
    let named = stub.configuration(false, true, 30);
    let new = || new_run(runs.path(), Mode::Baseline);
    let refused = Session::create(new(), &named).err().expect("it is rejected").to_string();
    assert!(refused.contains("study.toml") && refused.contains("Nothing was recorded"), "{refused}");
    assert_eq!(std::fs::read_dir(runs.path()).expect("a folder").count(), 0);

    let entry = |voice| StudyOptions {
        stamp: StudyStamp {
            name: "pilot".to_owned(),
            digest: "0".repeat(64),
            condition: None,
            order: None,
            practice: false,
            refused_labels: 0,
        },
        rules: SessionRules::for_mode(Mode::Baseline),
        consent: None,
        voice,
    };
    let of_study = |voice| NewRun { study: Some(entry(voice)), ..new() };
    let silent = Session::create(of_study(None), &named).expect("a run");
    assert_eq!(silent.manifest().voice, None, "a study without a model has none");
    let session = Session::create(of_study(named.voice.clone()), &Configuration::bundled()).expect("a run");
    let stamp = session.manifest().voice.clone().expect("the run records the model");
    assert_eq!((stamp.model.as_str(), stamp.judge, stamp.words), ("stub", false, true));
    let folder = run_folder(&session);
    assert_eq!(Manifest::read(&folder).expect("a manifest").voice, Some(stamp.clone()));
    let lines = Trajectory::read(&folder.join("trajectory.jsonl")).expect("a trajectory").lines;
    assert!(matches!(&lines[0].record, Record::Start(start) if start.voice == Some(stamp)));
}

#[test]
fn missing_key_is_rejected_and_other_model_is_not_connected() {
    let runs = tempfile::tempdir().expect("a folder");
    let stub = StubModel::start(StubBehavior::Correct);
    let mut named = stub.configuration(false, true, 30);
    let model_settings = named.voice.as_mut().expect("a model");
    model_settings.key_variable = Some("NOVAMIND_NO_SUCH_KEY".to_owned());
    let refused =
        Session::create(new_run(runs.path(), Mode::Sandbox), &named).err().expect("refused").to_string();
    assert!(
        refused.contains("NOVAMIND_NO_SUCH_KEY") && refused.contains("Nothing was recorded"),
        "{refused}"
    );
    let folder = run_folder(&start_company(runs.path(), &stub.configuration(false, true, 30)));
    let mut session = Session::open_to_play(&folder, &stub.configuration(true, true, 30)).expect("it opens");
    assert!(
        session.remarks().iter().any(|remark| remark.contains("names a different model")),
        "{:?}",
        session.remarks()
    );
    assert_eq!(session.model_settings(), None);
    session.connect_model(stub.configuration(false, true, 5).voice.as_ref());
    assert!(session.model_settings().is_some(), "the time limit may differ");
}

#[test]
fn replay_rejects_impossible_voice_lines() {
    let words = |post, text: &str| {
        let posts = vec![RewordedPost { post, text: text.to_owned() }];
        VoiceAnswer::Words(RewordedPosts { posts, took_ms: 1.0 })
    };
    let mut plain = Session::create(NewRun::default(), &Configuration::bundled()).expect("a run");
    assert!(plain.replay_voice(&words(1, "Hello.")).is_err(), "it has no model");
    let runs = tempfile::tempdir().expect("a folder");
    let stub = StubModel::start(StubBehavior::Correct);
    let (mut session, _) = play_three_weeks(runs.path(), &stub.configuration(false, true, 30));
    assert_eq!(session.replay_voice(&words(1, "Hello.")), Ok(()));
    for (post, text) in [(0, "Hello."), (9_999, "Hello."), (1, "\u{1b}[2J"), (1, "")] {
        assert!(session.replay_voice(&words(post, text)).is_err(), "{post} {text:?}");
    }
    let scores: VoiceAnswer = serde_json::from_value(json!({
        "what": "scores", "post": 1, "posted": 7, "content": POST, "scores": [], "took_ms": 1,
    }))
    .expect("scores");
    assert!(session.replay_voice(&scores).is_err(), "it does not judge");
}
