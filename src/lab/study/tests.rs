use std::fs;
use std::path::{Path, PathBuf};

use super::*;
use crate::experiment::test_kit;
use novamind_record::folder::configuration::Configuration;

fn write_study(folder: &Path, text: &str) -> PathBuf {
    let path = folder.join("study.toml");
    fs::write(&path, text).expect("a file");
    path
}

const VALID_STUDY: &str = r#"
name = "copying"
description = "effect of copying"
policies = ["P0", "mine.toml"]
scenarios = ["default", "competitor-hard"]
seeds = "1..3"
days = 14

[[overrides]]
name = "as shipped"

[[overrides]]
name = "no surges"
set = { "demand_surge.probability" = 0.0 }

[grid]
"leads.saturation_base" = [12.5, 14.5]
"#;

#[test]
fn study_expands_into_arms_in_file_order() {
    let folder = tempfile::tempdir().expect("a folder");
    fs::write(folder.path().join("mine.toml"), "name = \"mine\"\n[start]\ncash = 2e6\n").expect("a policy");
    let path = write_study(folder.path(), VALID_STUDY);
    let plan = StudyPlan::read(&path, false, &Configuration::bundled()).expect("a study");
    assert_eq!(plan.factors, ["policy", "scenario", "overrides", "leads.saturation_base"]);
    assert_eq!((plan.experiment.arms.len(), plan.experiment.seeds.len()), (16, 3));
    assert_eq!(plan.levels[0], ["P0", "default", "as shipped", "12.5"]);
    assert_eq!(plan.levels[3], ["P0", "default", "no surges", "14.5"]);
    assert_eq!(plan.levels[15], ["mine", "competitor-hard", "no surges", "14.5"]);
    assert_eq!(plan.experiment.arms[3].spec.overrides.len(), 2);
    let names = column_names(&plan);
    assert_eq!(names[..6], ["run", "policy", "scenario", "overrides", "leads.saturation_base", "seed"]);
    assert!(!plan.experiment.recorded.daily);
    assert!(
        StudyPlan::read(&path, true, &Configuration::bundled()).expect("a study").experiment.recorded.daily
    );
}

#[test]
fn invalid_studies_name_line_and_key() {
    let folder = tempfile::tempdir().expect("a folder");
    let begin = "name = \"x\"\npolicies = [\"P0\"]\nseeds = 1\n";
    for (text, line, parts) in [
        ("name = \"x\"\npolicies = [\"P0\"]\nseed = 1\n".to_owned(), Some(3), ["seed", "unknown"]),
        ("name = \"x\"\npolicies = [\"P0\"]\n".to_owned(), Some(1), ["seeds", "missing"]),
        ("name = \"a/b\"\npolicies = [\"P0\"]\nseeds = 1\n".to_owned(), Some(1), ["name", "letters"]),
        ("name = \"x\"\npolicies = []\nseeds = 1\n".to_owned(), Some(2), ["policies", "at least one"]),
        (
            "name = \"x\"\npolicies = [\n \"P0\",\n \"P77\",\n]\nseeds = 1\n".to_owned(),
            Some(4),
            ["policies.1", "P77"],
        ),
        (
            "name = \"x\"\npolicies = [\"P0\", \"P0\"]\nseeds = 1\n".to_owned(),
            Some(2),
            ["policies.1", "two policies"],
        ),
        ("name = \"x\"\npolicies = [\"P0\"]\nseeds = \"3..1\"\n".to_owned(), Some(3), ["seeds", "smaller"]),
        (
            "name = \"x\"\npolicies = [\"P0\"]\nseeds = [1, 2, 1]\n".to_owned(),
            Some(3),
            ["seeds", "seed 1 appears twice"],
        ),
        ("name = \"x\"\npolicies = [\"P0\"]\nseeds = []\n".to_owned(), Some(3), ["seeds", "at least one"]),
        ("name = \"x\"\npolicies = [\"P0\"]\nseeds = -1\n".to_owned(), Some(3), ["seeds", "a number"]),
        (
            "name = \"x\"\npolicies = [\"P0\"]\nseeds = \"0..1000000\"\n".to_owned(),
            Some(3),
            ["seeds", "the maximum is 1,000,000"],
        ),
        (
            "name = \"x\"\npolicies = [\"P0\"]\nseeds = \"0..18446744073709551615\"\n".to_owned(),
            Some(3),
            ["seeds", "a seed must be at most"],
        ),
        (format!("{begin}days = 3\n"), Some(4), ["days", "between 7"]),
        (format!("{begin}days = \"long\"\n"), Some(4), ["days", "long"]),
        (format!("{begin}cash = -1.0\n"), Some(4), ["cash", "above 0"]),
        (format!("{begin}until = 0\n"), Some(4), ["until", "at least 1"]),
        (format!("{begin}days = 28\nuntil = 29\n"), Some(5), ["until", "end on day 28"]),
        (format!("{begin}until = 501\n"), Some(4), ["until", "end on day 500"]),
        (format!("{begin}scenarios = []\n"), Some(4), ["scenarios", "leave the key out"]),
        (
            format!(
                "{begin}\n[[overrides]]\nname = \"a\"\nset = {{ \"leads.saturation_base\" = 12 }}\n[grid]\nleads.saturation_base = [1, 2]\n"
            ),
            Some(9),
            ["leads.saturation_base", "set the parameter either there or in the grid"],
        ),
        (
            format!("{begin}\n[[overrides]]\nname = \"a\"\n[[overrides]]\nname = \"b\"\n"),
            Some(7),
            ["overrides.1", "b sets the same parameters as a"],
        ),
        (format!("{begin}scenarios = [\"default\", \"nowhere\"]\n"), Some(4), ["scenarios.1", "nowhere"]),
        (
            format!("{begin}\n[[overrides]]\nname = \"a\"\n[[overrides]]\nname = \"a\"\n"),
            Some(7),
            ["overrides.1", "unique name"],
        ),
        (
            format!("{begin}\n[[overrides]]\nname = \"a\"\nset = {{ \"leads.nothing\" = 1 }}\n"),
            Some(7),
            ["leads.nothing", "leads"],
        ),
        (
            format!("{begin}\n[grid]\n\"demand_surge.probability\" = [0.1, 7.0]\n"),
            Some(6),
            ["demand_surge.probability", "7"],
        ),
        (
            format!("{begin}\n[grid]\ndemand_surge.probability = 0.1\n"),
            Some(6),
            ["demand_surge.probability", "a list"],
        ),
        (
            format!("{begin}\n[grid]\n\"leads.saturation_base\" = []\n"),
            Some(6),
            ["leads", "the list is empty"],
        ),
        (
            format!("{begin}\n[grid]\n\"leads.saturation_base\" = [1, 1.0]\n"),
            Some(6),
            ["leads", "appears twice"],
        ),
        (
            format!("{begin}\n[grid]\n\"run.total_days\" = [100, 200]\n"),
            Some(6),
            ["run.total_days", "keys of the study"],
        ),
        (
            format!("{begin}scenarios = [\"default\", \"default\"]\n"),
            Some(4),
            ["scenarios.1", "appears twice"],
        ),
        ("name = \"x\"\npolicies = [\"P0\"\nseeds = 1\n".to_owned(), Some(3), ["", ""]),
    ] {
        let path = write_study(folder.path(), &text);
        let error = StudyPlan::read(&path, false, &Configuration::bundled()).expect_err(&text);
        assert_eq!(error.line, line, "{text}: {error}");
        for part in parts {
            assert!(error.to_string().contains(part), "{part}: {error}");
        }
    }
    let missing = StudyPlan::read(&folder.path().join("none.toml"), false, &Configuration::bundled());
    assert!(missing.expect_err("no file").to_string().contains("none.toml"));
}

#[test]
fn shards_parse_and_partition_the_runs() {
    assert_eq!(parse_shard("2/4"), Ok(Shard { shard: 2, of: 4 }));
    for wrong in ["0/4", "5/4", "4", "a/b", "1/0", "1/100001", ""] {
        assert!(parse_shard(wrong).is_err(), "{wrong}");
    }
    for runs in [0, 1, 7, 200] {
        for of in [1, 3, 4, 250] {
            let mut all: Vec<usize> =
                (1..=of).flat_map(|shard| Shard { shard, of }.run_numbers(runs)).collect();
            all.sort_unstable();
            assert_eq!(all, (0..runs).collect::<Vec<_>>(), "{runs} runs in {of} shards");
        }
    }
}

/// Writes the shards of a study. Each run has one row or, with `has_many`, as many rows as its number.
fn write_shards(folder: &Path, runs: usize, of: usize, has_many: bool) -> (String, Vec<PathBuf>) {
    let rows = |run: usize| -> String {
        let count = if has_many { run % 3 + 1 } else { 1 };
        (0..count).map(|row| format!("{run},row {row}\n")).collect()
    };
    let whole = format!("run,what\n{}", (1..=runs).map(rows).collect::<String>());
    let write = |shard| {
        let part = Shard { shard, of };
        let text: String = part.run_numbers(runs).into_iter().map(|number| rows(number + 1)).collect();
        let path = folder.join(ShardHeader::file_name("s", part));
        fs::write(&path, ShardHeader::with_checksum("s", "d", part, &format!("run,what\n{text}")))
            .expect("a file");
        path
    };
    (whole, (1..=of).map(write).collect())
}

fn merge(places: &[PathBuf]) -> Result<String, String> {
    let shards = ShardSet::find(places).map_err(|error| error.to_string())?;
    let mut out = Vec::new();
    shards.write(&mut out).map_err(|error| error.to_string())?;
    Ok(String::from_utf8(out).expect("UTF-8"))
}

#[test]
fn merged_shards_equal_the_unsplit_study() {
    for (runs, of, has_many) in [(10, 4, false), (10, 4, true), (3, 5, false), (0, 2, false), (7, 1, true)] {
        let folder = tempfile::tempdir().expect("a folder");
        let (whole, mut files) = write_shards(folder.path(), runs, of, has_many);
        assert_eq!(merge(&[folder.path().to_owned()]), Ok(whole.clone()), "{runs} runs in {of} shards");
        files.reverse();
        assert_eq!(merge(&files), Ok(whole.clone()), "any order");
        files.push(folder.path().to_owned());
        assert_eq!(merge(&files), Ok(whole), "a file that is named twice counts once");
    }
}

#[test]
fn mismatched_shards_are_rejected_by_name() {
    let folder = tempfile::tempdir().expect("a folder");
    let (_, files) = write_shards(folder.path(), 10, 4, false);
    let fails = |places: &[PathBuf], parts: &[&str]| {
        let error = merge(places).expect_err("refused");
        assert!(error.ends_with("nothing was written"), "{error}");
        for part in parts {
            assert!(error.contains(part), "{part}: {error}");
        }
    };
    fails(&files[..3], &["missing: s.4-of-4.csv"]);
    let copy = folder.path().join("twin.csv");
    fs::copy(&files[1], &copy).expect("a copy");
    let mut with_copy = files.clone();
    with_copy.push(copy.clone());
    fails(&with_copy, &["twin.csv", "s.2-of-4.csv", "both shard 2 of 4"]);
    let foreign = ShardHeader::with_checksum("s", "other", Shard { shard: 4, of: 4 }, "run,what\n");
    fs::write(&copy, foreign).expect("a file");
    fails(
        &[files[..3].to_vec(), vec![copy.clone()]].concat(),
        &["twin.csv is from another version of s", "missing: s.4-of-4.csv"],
    );
    let other = ShardHeader::with_checksum("t", "d", Shard { shard: 4, of: 4 }, "run,what\n");
    fs::write(&copy, other).expect("a file");
    fails(&[files.clone(), vec![copy.clone()]].concat(), &["twin.csv belongs to the study t"]);
    fs::write(&copy, "run,what\n1,row 0\n").expect("a file");
    fails(&[files.clone(), vec![copy]].concat(), &["twin.csv", "not a shard"]);
    let bytes = fs::read(&files[2]).expect("a shard");
    for damaged in [&bytes[..bytes.len() - 1], &[bytes.as_slice(), b"9,9\n"].concat()] {
        fs::write(&files[2], damaged).expect("a file");
        fails(&files, &["s.3-of-4.csv is damaged: rerun shard 3 of 4"]);
        assert!(!merge(&files).expect_err("refused").contains("missing"), "it exists");
    }
    fs::write(&files[2], &bytes[..20]).expect("a file");
    fails(&files, &["s.3-of-4.csv: it is not a shard", "missing: s.3-of-4.csv"]);
    fails(&[folder.path().join("nowhere")], &["nowhere"]);
    let empty = tempfile::tempdir().expect("a folder");
    fails(&[empty.path().to_owned()], &["no shards found"]);
}

#[test]
fn study_in_the_guide_is_valid() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/laboratory/examples/copying.toml");
    let plan = StudyPlan::read(&path, false, &Configuration::bundled()).expect("a study");
    assert_eq!(plan.experiment.arms.len() * plan.experiment.seeds.len(), 144, "as stated in its first line");
}

#[test]
fn equal_arms_are_named() {
    let folder = tempfile::tempdir().expect("a folder");
    let text = "name = \"x\"\npolicies = [\"P0\"]\nseeds = \"1..2\"\ndays = 14\n\n[[overrides]]\nname = \"plain\"\n\n\
                [[overrides]]\nname = \"usual\"\nset = { \"drift.drift_grace_period_days\" = 60 }\n\n\
                [[overrides]]\nname = \"late\"\nset = { \"drift.drift_grace_period_days\" = 90 }\n";
    let plan = StudyPlan::read(&write_study(folder.path(), text), false, &Configuration::bundled())
        .expect("a study");
    let same = equal_arm_warnings(&plan, &Configuration::bundled()).expect("parameters");
    assert_eq!(same, ["these arms are identical: P0 / default / plain; P0 / default / usual"]);
    let played = test_kit::play_arms(plan.experiment.arms.clone(), 1..=2);
    let results: Vec<_> = played.by_arm.into_iter().flatten().collect();
    let alike = equal_outcome_warnings(&plan, &results);
    assert_eq!(alike.len(), 1, "{alike:?}");
    assert!(alike[0].ends_with("plain; P0 / default / usual; P0 / default / late."), "{alike:?}");
    assert!(study_summary(&plan, &results).notes.contains(&alike[0]));
}
