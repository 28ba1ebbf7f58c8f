//! Runs that were recorded by other builds replay to the same states.
//!
//! `tests/data/recorded` contains a run of a development build and a run of a release build, which every build
//! verifies. It also contains a run that uses every setting, and a run of a scenario that later received an additional
//! key. The runs pin the mechanics: a change that affects the results of decisions must increase `world::MECHANICS`
//! and record the runs again.
//!
//! `format2-*` are runs of format 2, one run of every kind. `tests/data/recorded/README.md` lists them.

use std::collections::BTreeSet;
use std::fs;
use std::path::Path;

use novamind::record::folder::configuration::Configuration;
use novamind::record::folder::manifest_check::read_manifest_text;
use novamind::record::trajectory::Trajectory;
use novamind::session::{Access, Session, read_afterwards, verify};
use novamind::tools::ToolId;
use serde_json::{Value, json};

use super::run::{copy_run, temporary_runs_folder};
use crate::support::forging::forge_lines;

fn recorded_run_folder(build: &str) -> std::path::PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/recorded").join(build)
}

#[test]
fn runs_of_earlier_builds_verify() {
    let mut hashes = Vec::new();
    for build in ["development", "release"] {
        let found = verify(&recorded_run_folder(build)).unwrap_or_else(|error| {
            panic!(
                "{error}\nIf the mechanics were changed on purpose, increase MECHANICS and record the runs again."
            )
        });
        assert_eq!((found.day, found.states), (70, 10), "{build}");
        hashes.push(found.state_hash);
    }
    assert_eq!(hashes[0], hashes[1], "both builds recorded the same decisions");
}

#[test]
fn recorded_run_with_every_setting_verifies() {
    let place = temporary_runs_folder();
    let folder = copy_run(&recorded_run_folder("everything"), place.path());
    let found = verify(&folder).unwrap_or_else(|error| panic!("{error}"));
    assert_eq!((found.day, found.states), (119, 17));
    // The run must contain every tool, because a missing tool would not be tested.
    let mut session = Session::open(&folder, Access::Read, true).expect("it opens");
    for (least, sql) in [
        (20, "SELECT count(*) FROM service_day WHERE downtime_minutes > 0"),
        (20, "SELECT count(*) FROM enterprise_turns WHERE close_reason = 'accepted'"),
        (100, "SELECT count(*) FROM ads_revenue WHERE revenue > 0"),
        (1, "SELECT count(*) FROM config_overrides WHERE tool_name = 'set_promotion'"),
        (1, "SELECT count(*) FROM config_overrides WHERE tool_name = 'set_lead_promotion'"),
        (1, "SELECT count(*) FROM config_overrides WHERE settings_json LIKE '%\"by_plan\": {\"B\"%'"),
        (
            1,
            "SELECT count(*) FROM config_overrides WHERE settings_json LIKE '%\"by_group_plan\": {\"S2\": {\"A\"%'",
        ),
        (1, "SELECT count(*) FROM research_projects WHERE status = 'completed'"),
        (1, "SELECT count(*) FROM agent_social_media_posts WHERE views > 0"),
        (1, "SELECT count(*) FROM segment_discovery"),
    ] {
        let rows = session.query(sql).unwrap_or_else(|refusal| panic!("{sql}: {refusal}"));
        let count = novamind::database::number_at(&rows.rows[0], 0);
        assert!(count >= f64::from(least), "{sql}: {count}");
    }
}

#[test]
fn run_recorded_before_a_new_scenario_key_verifies() {
    let place = temporary_runs_folder();
    let folder = copy_run(&recorded_run_folder("reference-seed42"), place.path());
    let found = verify(&folder).unwrap_or_else(|error| panic!("{error}"));
    assert_eq!((found.day, found.states), (14, 2), "its results are compared in any notation of numbers");
    let session = Session::open(&folder, Access::Read, true).expect("it opens");
    assert!(!session.company().observe().has_own_parameters, "parameters of the recording version");
}

/// Name, last day, number of states, and prefix of the last state hash of each run of format 2.
const FORMAT_2: [(&str, u32, usize, &str); 16] = [
    ("format2-adopted", 42, 6, "1dd30530ca85389a"),
    ("format2-baseline", 21, 3, "f8ff62b143bd28af"),
    ("format2-branch", 21, 3, "2521e4fbf13e0486"),
    ("format2-class", 21, 3, "11a7457abcc1d4dd"),
    ("format2-class-run", 35, 5, "fbf4882923f9cda0"),
    ("format2-console", 14, 2, "4fa3c2d61589ba28"),
    ("format2-debug", 28, 6, "da92ae3e2dc2334f"),
    ("format2-http", 14, 2, "a5006c9185d4e365"),
    ("format2-lesson", 21, 3, "ba049c147bd9f10e"),
    ("format2-mcp", 7, 1, "0b383245891d8956"),
    ("format2-planted", 14, 2, "f41d69d178810989"),
    ("format2-policy", 11, 2, "f7299c81d531e3cb"),
    ("format2-sandbox", 42, 6, "dcdaf5659213ff0a"),
    ("format2-scripts", 14, 2, "11b6cc3d38d77d01"),
    ("format2-study", 35, 5, "3df35b1f43f76ba5"),
    ("format2-voice", 28, 4, "eb5283ec254125c1"),
];

#[test]
fn runs_of_format_2_verify() {
    let folders = fs::read_dir(recorded_run_folder("")).expect("a folder").flatten();
    let names = folders.map(|entry| entry.file_name().to_string_lossy().into_owned());
    let names: BTreeSet<String> = names.filter(|name| name.starts_with("format2-")).collect();
    assert_eq!(names, FORMAT_2.map(|(name, ..)| name.to_owned()).into(), "each has its line in FORMAT_2");
    for (name, day, states, hash) in FORMAT_2 {
        let found = verify(&recorded_run_folder(name)).unwrap_or_else(|error| panic!("{name}: {error}"));
        assert_eq!((found.day, found.states), (day, states), "{name}");
        assert!(found.state_hash.starts_with(hash), "{name}: {}", found.state_hash);
    }
}

#[test]
fn runs_of_format_2_cover_all_line_kinds_and_tools() {
    let (mut kinds, mut tools) = (BTreeSet::new(), BTreeSet::new());
    for (name, ..) in FORMAT_2 {
        let folder = recorded_run_folder(name);
        let run = Trajectory::read(&folder.join("trajectory.jsonl")).expect("it reads");
        let after = read_afterwards(&folder, &run).expect("it reads");
        for line in run.lines.iter().chain(&after.lines) {
            kinds.insert(line.record.kind().to_owned());
            tools.extend(line.record_fields().get("tool").and_then(Value::as_str).map(str::to_owned));
        }
    }
    let schema: Value =
        serde_json::from_str(include_str!("../../../assets/trajectory.schema.json")).expect("JSON");
    let known = schema["$defs"].as_object().expect("definitions").iter();
    let known = known.filter(|(_, kind)| kind.pointer("/properties/kind").is_some());
    // `memo` is written in format 1 only.
    let known = known.map(|(kind, _)| kind.clone()).filter(|kind| kind != "memo");
    assert_eq!(kinds, known.collect());
    // The tool `query` is recorded in lines of a separate kind.
    let catalogue = ToolId::all().map(ToolId::name).filter(|tool| *tool != "query");
    assert_eq!(catalogue.filter(|tool| !tools.contains(*tool)).collect::<Vec<_>>(), [""; 0]);
}

/// Digests of the parameters of all scenarios, which are stored in recorded runs.
const DIGESTS: [(&str, &str); 14] = [
    ("default", "a9623642a136c0a4"),
    ("competitor-hard", "666f481a1d3f48e4"),
    ("competitor-off", "85152183ce68c06c"),
    ("competitor-stationary", "a04be5a00f7ed72c"),
    ("competitor-u10", "e0ccf495b6d8f8d8"),
    ("competitor-u20", "95b4e7a4758350d2"),
    ("competitor-u30", "202096f952d53db6"),
    ("corrected", "baf87cbd827fb0ac"),
    ("demand-surges", "0ee35becde75cba2"),
    ("paper", "aaad322fe79af0c7"),
    ("practice", "ba85d9d75a79f837"),
    ("reference-seed42", "bca7eb0607e77a56"),
    ("release-2", "72cfdc949fad48e3"),
    ("short", "a9623642a136c0a4"),
];

#[test]
fn parameters_of_scenarios_keep_the_digests_that_recorded_runs_name() {
    let bundled = Configuration::bundled();
    let digest = |name: String| {
        let scenario = bundled.load_scenario(&name).expect("a scenario");
        let params = bundled.load_parameters(&scenario, &[], false).expect("parameters");
        (name, params.digest())
    };
    let digests: Vec<(String, String)> = bundled.scenario_names().into_iter().map(digest).collect();
    assert_eq!(digests, DIGESTS.map(|(name, digest)| (name.to_owned(), digest.to_owned())));
}

#[test]
fn run_toml_of_format_2_is_rebuilt_to_the_same_bytes() {
    for (name, ..) in FORMAT_2 {
        let folder = recorded_run_folder(name);
        let file = fs::read_to_string(folder.join("run.toml")).expect("a manifest");
        assert_eq!(read_manifest_text(&folder).expect("it reads"), file, "{name}");
    }
}

#[test]
fn changed_answer_in_a_recorded_run_is_rejected() {
    for (tool, field) in
        [("get_cost_info", "/model_tiers/2/quality_multiplier"), ("set_prices", "/current/B")]
    {
        let place = temporary_runs_folder();
        let folder = copy_run(&recorded_run_folder("reference-seed42"), place.path());
        forge_lines(&folder, |_, line| {
            if line["tool"] == tool {
                *line["result"].pointer_mut(field).expect("a field") = json!(26);
            }
        });
        let error = verify(&folder).expect_err("it is refused").to_string();
        assert!(error.contains("has a different result"), "{error}");
    }
}

#[test]
fn runs_with_other_mechanics_or_parameters_are_rejected_with_the_required_version() {
    let place = temporary_runs_folder();
    let folder = copy_run(&recorded_run_folder("release"), place.path());
    let path = folder.join("trajectory.jsonl");
    let whole = fs::read_to_string(&path).expect("a trajectory");
    let (first, rest) = whole.split_once('\n').expect("lines");
    for (name, value, text) in [
        ("mechanics", json!(9), "mechanics 9"),
        ("parameters_digest", json!("0123"), "parameters 0123"),
        ("format", json!(7), "format 7"),
    ] {
        let mut line: Value = serde_json::from_str(first).expect("JSON");
        (line[name], line["version"]) = (value, json!("0.9.3"));
        line.as_object_mut().expect("an object").shift_remove("sum");
        let bare = line.to_string();
        let sum = blake3::hash(bare.as_bytes()).to_hex()[..16].to_owned();
        let changed = format!("{},\"sum\":\"{sum}\"}}\n{rest}", &bare[..bare.len() - 1]);
        fs::write(&path, changed).expect("written");
        let error = Session::open(&folder, Access::Write, true).err().expect("it is refused").to_string();
        assert!(error.contains(text) && error.contains("Nothing was changed"), "{error}");
        assert!(error.contains("0.9.3") || error.contains("newer version"), "{error}");
    }
    fs::write(&path, whole).expect("written");
    assert!(verify(&folder).is_ok(), "nothing was changed");
}
