//! Invalid input and failures against the built program: wrong files, damaged runs, a full disk, no terminal.
//!
//! In each case, the message names the file and the next step, the exit code is as documented, and no confirmed action is lost.

#[cfg(unix)]
mod adoption;
mod full_disk;
mod lost_file;

use std::fs;
use std::io::Write;
use std::path::Path;
use std::process::{Command, Stdio};

use crate::support::home::{Home, ProgramOutput, read_bytes, run_id, run_with_input, split_lines};

const HEAD: &str = "title = \"Mine\"\ndescription = \"My own.\"\n";

#[test]
fn invalid_scenario_error_names_file_line_key_and_allowed_values() {
    let home = Home::new();
    for (text, parts) in [
        ("title = \"Mine\ndescription = \"x\"\n".to_owned(), &["line 1"][..]),
        (
            format!("{HEAD}[world.quality]\nbase_quality = 1.0\n"),
            &["line 4", "quality.base_quality", "base_product_quality"],
        ),
        (
            format!("{HEAD}[world.competitor]\n\ncompetitor_feedback_u_max = 2.5\n"),
            &["line 5", "competitor.competitor_feedback_u_max", "between 0 and 1"],
        ),
        (
            format!("{HEAD}[world.quality]\nbase_product_quality = \"good\"\n"),
            &["line 4", "base_product_quality", "expected a number"],
        ),
        (
            format!("{HEAD}[world.quality]\nbase_product_quality = nan\n"),
            &["line 4", "base_product_quality", "finite"],
        ),
        (
            format!("{HEAD}[world.limits]\nquery_row_limit = 1.5\n"),
            &["line 4", "query_row_limit", "expected a whole number"],
        ),
        (format!("{HEAD}world.quality.base_product_quality = -1\n"), &["line 3", "above 0 and at most 100"]),
        (format!("{HEAD}world = {{ quality = {{ base_product_quality = -1 }} }}\n"), &["line 3", "above 0"]),
        (format!("{HEAD}[ world . quality ]\nbase_product_quality = -1\n"), &["line 4", "above 0"]),
        (format!("{HEAD}[world]\n\nquality.base_product_quality = -1\n"), &["line 5", "above 0"]),
        (format!("{HEAD}days = 3\n"), &["line 3", "days", "between 7 and 100,000"]),
        (format!("{HEAD}\ncash = -1.0\n"), &["line 4", "cash", "above 0"]),
        (format!("{HEAD}size = 3\n"), &["line 3", "size", "`world`"]),
        ("title = \"Mine\"\n".to_owned(), &["description"]),
    ] {
        home.write("scenarios/mine.toml", &text);
        for arguments in [&["play", "--plain", "--scenario", "mine"][..], &["scenario", "show", "mine"]] {
            let program_output = home.run(arguments);
            program_output.assert_fails(3, &["scenarios/mine.toml"]);
            program_output.assert_fails(3, parts);
        }
    }
    home.write("scenarios/mine.toml", b"\xff\xfe");
    home.run(&["scenario", "show", "mine"]).assert_fails(3, &["mine.toml", "UTF-8"]);
    assert_eq!(
        fs::read_dir(home.runs()).expect("a folder").count(),
        0,
        "a run that cannot begin leaves nothing"
    );
}

#[test]
fn valid_scenario_is_accepted_in_every_notation() {
    let home = Home::new();
    for text in [
        "[world.quality]\nbase_product_quality = 0.75\n",
        "[ world . quality ]\nbase_product_quality = 0.75\n",
        "world = { quality = { base_product_quality = 0.75 } }\n",
        "[world]\nquality.base_product_quality = 0.75\n",
    ] {
        home.write("scenarios/mine.toml", format!("{HEAD}{text}"));
        let program_output = home.run(&["scenario", "show", "mine"]);
        assert!(
            program_output.exit_code == 0 && program_output.stdout.contains("base_product_quality = 0.75"),
            "{text}{}",
            program_output.stderr
        );
    }
}

#[test]
fn invalid_scenario_does_not_hide_other_scenarios() {
    let home = Home::new();
    home.write("scenarios/bad.toml", "title = \n");
    home.write("scenarios/good.toml", HEAD);
    let program_output = home.run(&["scenario", "list"]);
    program_output.assert_fails(3, &["bad.toml, line 1"]);
    assert!(
        program_output.stdout.contains("default") && program_output.stdout.contains("My own."),
        "{}",
        program_output.stdout
    );
}

#[test]
fn user_parameters_are_checked_and_ignored_by_baseline_runs() {
    let home = Home::new();
    home.write("world/own.toml", "[quality]\n# far too good\nbase_product_quality = 7000\n");
    home.play(&["--days", "7"], "")
        .assert_fails(3, &["own.toml, line 3, quality.base_product_quality", "at most 100"]);
    assert_eq!(home.play(&["--mode", "baseline", "--participant", "P01"], "").exit_code, 0);
    let options = ["--days", "7", "--mode", "debug", "--set", "quality.base_product_quality=900"];
    fs::remove_file(home.0.path().join("configuration/world/own.toml")).expect("gone");
    home.play(&options, "").assert_fails(3, &["--set quality.base_product_quality=900", "at most 100"]);
}

#[test]
fn invalid_policy_error_names_file_line_and_allowed_values() {
    let home = Home::new();
    for (text, parts) in [
        ("name = = 1\n", &["mine.toml, line 1"][..]),
        ("name = \"x\"\n[rule_based]\nspends = \"heavy\"\n", &["line 3", "spends", "`spend`"]),
        ("name = \"x\"\n[rule_based]\nspend = \"lots\"\n", &["line 3", "light, medium, heavy"]),
        ("name = \"x\"\n[[call]]\nday = 1\ntool = \"set_prices\"\n", &["line 2", "decision day"]),
        ("name = \"x\"\n[[call]]\nday = 0\ntool = \"set_price\"\n", &["line 2", "did you mean set_prices"]),
    ] {
        home.write("policies/mine.toml", text);
        home.run(&["run", "--policy", "mine", "--days", "28"]).assert_fails(3, parts);
    }
    home.write(
        "policies/mine.toml",
        "name = \"x\"\n[[call]]\nday = 0\ntool = \"set_prices\"\nargs = { A = 0 }\n",
    );
    home.run(&["run", "--policy", "mine", "--days", "28"]).assert_fails(1, &["day 0", "price_not_positive"]);
    home.run(&["run", "--policy", "nothere", "--days", "28"]).assert_fails(2, &["nothere", "baseline"]);
}

/// A function that damages a trajectory of ten lines.
type Damage = fn(&mut Vec<u8>);

fn flip_byte_after(bytes: &mut [u8], line: usize, word: &str) {
    let start: usize = split_lines(bytes)[..line - 1].iter().map(Vec::len).sum();
    let at = bytes[start..].windows(word.len()).position(|part| part == word.as_bytes()).expect("the word");
    bytes[start + at + word.len()] ^= 1;
}

#[test]
fn damaged_trajectory_is_rejected_with_its_line_and_not_changed() {
    let home = Home::new();
    let folder = home.play_two_weeks();
    let (id, good) = (run_id(&folder), read_bytes(&folder, "trajectory.jsonl"));
    assert_eq!(split_lines(&good).len(), 10);
    let cases: [(Damage, &[&str]); 9] = [
        (|bytes| flip_byte_after(bytes, 4, "\"B\":"), &["line 4", "its checksum", "Lines 1 to 3 are valid"]),
        (|bytes| flip_byte_after(bytes, 1, "\"seed\":"), &["line 1", "its checksum"]),
        (|bytes| flip_byte_after(bytes, 9, "\"cash\":"), &["line 9", "changed", "Lines 1 to 8 are valid"]),
        (|bytes| flip_byte_after(bytes, 10, "\"at\":\"202"), &["line 10", "changed", "recover"]),
        (
            |bytes| *bytes = [split_lines(bytes)[..2].concat(), split_lines(bytes)[3..].concat()].concat(),
            &["line 3", "missing"],
        ),
        (|bytes| *bytes = split_lines(bytes)[..6].concat(), &["line 7", "missing", "recover"]),
        (|bytes| bytes.extend(split_lines(bytes)[9].clone()), &["line 11", "Lines 1 to 10 are valid"]),
        (|bytes| bytes.extend(b"\0\0\0\n"), &["line 11", "not a line of a trajectory"]),
        (Vec::clear, &["line 1", "does not begin with the start of a run"]),
    ];
    for (damage, parts) in cases {
        let mut bytes = good.clone();
        damage(&mut bytes);
        fs::write(folder.join("trajectory.jsonl"), &bytes).expect("written");
        let program_output = home.play(&["--run", &id], "set_prices A=1\n");
        program_output.assert_fails(3, &["trajectory.jsonl"]);
        program_output.assert_fails(3, parts);
        assert_eq!(read_bytes(&folder, "trajectory.jsonl"), bytes, "the file is left as it is");
        fs::write(folder.join("trajectory.jsonl"), &good).expect("written");
    }
    fs::remove_file(folder.join("trajectory.jsonl")).expect("gone");
    home.play(&["--run", &id], "").assert_fails(3, &["trajectory.jsonl"]);
    fs::write(folder.join("trajectory.jsonl"), &good).expect("written");
    let output = home.run(&["replay", &id, "--verify"]);
    assert!(
        output.exit_code == 0 && output.stdout.contains("2 states verified"),
        "{}{}",
        output.stdout,
        output.stderr
    );
}

#[test]
fn modified_figure_is_detected_without_the_database() {
    let home = Home::new();
    let folder = home.play_two_weeks();
    let mut bytes = read_bytes(&folder, "trajectory.jsonl");
    flip_byte_after(&mut bytes, 9, "\"cash\":");
    fs::write(folder.join("trajectory.jsonl"), &bytes).expect("written");
    fs::remove_file(folder.join("world.db")).expect("gone");
    home.run(&["replay", &run_id(&folder), "--verify"]).assert_fails(3, &["line 9", "its checksum"]);
}

#[test]
fn incomplete_last_line_is_removed() {
    // The lines up to the end of the second week. Later lines were written when the session was closed.
    let played = || {
        let home = Home::new();
        let folder = home.play_two_weeks();
        let (id, good) =
            (run_id(&folder), split_lines(&read_bytes(&folder, "trajectory.jsonl"))[..9].concat());
        (home, folder, id, good)
    };
    for lost in [1, 5, 300] {
        let (home, folder, id, good) = played();
        fs::write(folder.join("trajectory.jsonl"), &good[..good.len() - lost]).expect("written");
        let program_output = home.play(&["--run", &id], "set_prices A=13\n");
        assert_eq!(program_output.exit_code, 0, "{}", program_output.stderr);
        // The incomplete line ended a confirmed week, which is simulated again.
        for part in [
            "day 14 of 28",
            "note: The last line of the trajectory was unfinished",
            "simulated again",
            "ok set_prices",
        ] {
            assert!(program_output.stdout.contains(part), "{part} is missing in {}", program_output.stdout);
        }
        assert_eq!(home.run(&["replay", &id, "--verify"]).exit_code, 0);
    }
    let (home, folder, id, good) = played();
    let unfinished = [&good[..], &good[..100]].concat();
    fs::write(folder.join("trajectory.jsonl"), unfinished).expect("written");
    let output = home.play(&["--run", &id], "");
    assert!(
        output.exit_code == 0 && output.stdout.contains("unfinished (100 bytes)"),
        "{}{}",
        output.stdout,
        output.stderr
    );
    let bytes = read_bytes(&folder, "trajectory.jsonl");
    assert!(
        bytes.starts_with(&good) && split_lines(&bytes).len() == 11,
        "only start and end lines were added"
    );
}

#[test]
fn damaged_manifest_is_rebuilt() {
    let home = Home::new();
    let folder = home.play_two_weeks();
    let (id, good) = (run_id(&folder), fs::read_to_string(folder.join("run.toml")).expect("text"));
    let trajectory = read_bytes(&folder, "trajectory.jsonl");
    let line = |name: &str| good.lines().position(|line| line.starts_with(name)).expect("a line") + 1;
    let cases = [
        (good.replace("seed = 42", "seed = 5"), "differed (seed)".to_owned()),
        (
            good.replace("seed = 42", "sed = 42"),
            format!("run.toml was damaged (line {}: unknown field `sed`", line("seed")),
        ),
        (good.replace("days = 28", "days = -3"), format!("run.toml was damaged (line {}", line("days"))),
        (good.replace("mode = \"sandbox\"", "mode = \"god\""), "`baseline`".to_owned()),
        (good.replace("format = 2", "format = 3"), "run.toml had another format".to_owned()),
        (
            good.replace("parameters_digest = \"", "parameters_digest = \"0"),
            "differed (parameters_digest)".to_owned(),
        ),
        (good.replace("format = 2", "format = "), "run.toml was damaged (line 1".to_owned()),
        (String::new(), "missing field `format`".to_owned()),
    ];
    for (text, part) in cases {
        assert_ne!(text, good, "nothing was damaged");
        fs::write(folder.join("run.toml"), text).expect("written");
        let list = home.run(&["runs"]);
        assert!(list.stdout.contains(&id) && !list.stdout.contains("cannot be read"), "{}", list.stdout);
        let program_output = home.play(&["--run", &id], "");
        assert!(
            program_output.exit_code == 0 && program_output.stdout.contains(&part),
            "{part}: {}{}",
            program_output.stdout,
            program_output.stderr
        );
        assert!(!home.play(&["--run", &id], "").stdout.contains("run.toml"), "it is reported once");
    }
    fs::remove_file(folder.join("run.toml")).expect("gone");
    assert!(!home.run(&["runs"]).stdout.contains("cannot be read"));
    let output = home.play(&["--run", &id], "");
    assert!(
        output.exit_code == 0 && output.stdout.contains("run.toml was missing"),
        "{}{}",
        output.stdout,
        output.stderr
    );
    let restored = fs::read_to_string(folder.join("run.toml")).expect("text");
    let without_moment = |text: &str| -> Vec<String> {
        text.lines().filter(|line| !line.starts_with("created")).map(str::to_owned).collect()
    };
    assert_eq!(without_moment(&restored), without_moment(&good));
    assert!(read_bytes(&folder, "trajectory.jsonl").starts_with(&trajectory), "lines are only added");
}

#[test]
fn damaged_database_is_rebuilt() {
    let home = Home::new();
    let folder = home.play_two_weeks();
    let question = "sql SELECT COUNT(*) AS n FROM ledger\n";
    let whole = home.play(&["--run", &run_id(&folder)], question).stdout;
    for bytes in [&b"no database at all"[..], b"", &read_bytes(&folder, "world.db")[..5000]] {
        fs::write(folder.join("world.db"), bytes).expect("written");
        let note = "note: world.db is damaged and was rebuilt from the trajectory.\n";
        let out = home.play(&["--run", &run_id(&folder)], question).stdout;
        assert!(out.contains(note), "{out}");
        assert_eq!(out.replace(note, ""), whole);
    }
}

#[test]
fn blocking_files_are_reported() {
    let home = Home::new();
    let folder = home.play_two_weeks();
    let id = run_id(&folder);
    // The root user ignores file permissions, so each file is replaced by a folder, which no user can write as a file.
    for file in ["lock", "world.db", "trajectory.jsonl"] {
        let (path, aside) = (folder.join(file), folder.join("aside"));
        fs::rename(&path, &aside).expect("moved");
        fs::create_dir(&path).expect("a folder");
        home.play(&["--run", &id], "").assert_fails(3, &[file]);
        fs::remove_dir(&path).expect("gone");
        fs::rename(&aside, &path).expect("moved");
    }
    fs::create_dir(folder.join("memo.md")).expect("a folder");
    let program_output = home.play(&["--run", &id], "memo remember\nset_prices A=14\n");
    assert!(
        program_output.stdout.contains("refused not_") && program_output.stdout.contains("memo.md"),
        "{}",
        program_output.stdout
    );
    assert!(program_output.stdout.contains("ok set_prices"), "the run continues: {}", program_output.stdout);

    let file = home.0.path().join("file");
    fs::write(&file, "in the way").expect("a file");
    for runs in [file.clone(), file.join("below")] {
        let mut program = home.program();
        run_with_runs_folder(&mut program, &runs).assert_fails(3, &["file"]);
    }
    assert_eq!(fs::read(&file).expect("bytes"), b"in the way");
}

fn run_with_runs_folder(program: &mut Command, runs: &Path) -> ProgramOutput {
    run_with_input(program.args(["play", "--plain", "--days", "7"]).env("NOVAMIND_RUNS", runs), "")
}

#[cfg(unix)]
#[test]
fn unwritable_folder_is_reported() {
    use std::os::unix::fs::PermissionsExt;
    let home = Home::new();
    let folder = home.play_two_weeks();
    let allow = |mode| fs::set_permissions(&folder, fs::Permissions::from_mode(mode)).expect("changed");
    allow(0o555);
    // The root user can write to the folder, so the test is skipped.
    if fs::write(folder.join("probe"), "").is_err() {
        fs::set_permissions(folder.join("trajectory.jsonl"), fs::Permissions::from_mode(0o444))
            .expect("changed");
        home.play(&["--run", &run_id(&folder)], "").assert_fails(3, &[&run_id(&folder)]);
    }
    allow(0o755);
}

#[test]
fn run_in_use_is_not_opened() {
    let home = Home::new();
    let mut owner = home.program().args(["play", "--plain", "--days", "28"]).spawn().expect("it starts");
    let mut pipe = owner.stdin.take().expect("a pipe");
    let mut answers = std::io::BufRead::lines(std::io::BufReader::new(owner.stdout.take().expect("a pipe")));
    let mut wait_for = |part: &str| {
        answers
            .by_ref()
            .map(|line| line.expect("readable"))
            .find(|line| line.contains(part))
            .expect("an answer")
    };
    pipe.write_all(b"set_prices A=12\n").expect("written");
    wait_for("ok set_prices");
    let id = run_id(&home.only_run());
    for arguments in [
        &["play", "--plain", "--run", &id][..],
        &["play", "--plain", "--run", "latest"],
        &["runs", "end", &id],
        &["runs", "delete", &id, "--yes"],
    ] {
        let holder = format!("(process {})", owner.id());
        home.run(arguments).assert_fails(1, &["open in another program", &holder, "--watch"]);
    }
    let watched = home.play(&["--run", &id, "--watch"], "set_prices A=14\nquit\n");
    assert!(watched.stdout.contains("open read-only"), "{}", watched.stdout);
    // Other programs can read the run, and the player can continue.
    let seen = home.run(&["query", &id, "SELECT MAX(day) AS day FROM config_history"]);
    assert_eq!(seen.exit_code, 0, "{}", seen.stderr);
    pipe.write_all(b"set_prices A=13\nquit\n").expect("written");
    wait_for("ok set_prices");
    assert_eq!(owner.wait().expect("it ends").code(), Some(0));
    assert_eq!(home.run(&["runs", "delete", &id, "--yes"]).exit_code, 0);
}

#[test]
fn recovery_creates_a_branch_of_the_undamaged_prefix() {
    let home = Home::new();
    let folder = home.play_two_weeks();
    home.run(&["runs", "recover", &run_id(&folder)]).assert_fails(2, &["not damaged"]);
    let path = folder.join("trajectory.jsonl");
    let mut bytes = fs::read(&path).expect("a trajectory");
    let second_price = bytes.windows(8).position(|part| part == b"\"C\":50.0" || part == b"{\"C\":50}");
    let at = second_price.expect("the call of the second week") + 6;
    bytes[at] ^= 0x01;
    fs::write(&path, &bytes).expect("written");
    home.play(&["--run", &run_id(&folder)], "").assert_fails(3, &["novamind runs recover"]);
    let rescued = home.run(&["runs", "recover", &run_id(&folder)]);
    assert_eq!(rescued.exit_code, 0, "{}", rescued.stderr);
    assert!(rescued.stdout.contains("is on day 7"), "{}", rescued.stdout);
    let text = rescued.stdout.split_whitespace().nth(1).expect("a name").to_owned();
    assert_eq!(home.run(&["replay", &text, "--verify"]).exit_code, 0);
    assert_eq!(fs::read(&path).expect("a trajectory"), bytes, "the damaged run was changed");
    home.run(&["replay", &text]).assert_fails(2, &["--verify"]);
}

#[test]
fn run_list_marks_runs_with_an_unreadable_trajectory() {
    let home = Home::new();
    let path = home.play_two_weeks().join("trajectory.jsonl");
    let whole = fs::read(&path).expect("a trajectory");
    for damaged in [Some(&b""[..]), Some(b"\0\0\0\0\n"), None] {
        match damaged {
            Some(bytes) => fs::write(&path, bytes).expect("written"),
            None => fs::remove_file(&path).expect("gone"),
        }
        let list = home.run(&["runs"]);
        assert!(list.exit_code == 0 && list.stdout.contains("cannot be read"), "{}", list.stdout);
        assert!(list.stdout.contains("trajectory.jsonl"), "{}", list.stdout);
        assert!(
            !list.stdout.contains("day ") && !list.stdout.contains('$'),
            "no false figures: {}",
            list.stdout
        );
    }
    fs::write(&path, whole).expect("written");
    assert!(home.run(&["runs"]).stdout.contains("day  14/28"));
}

#[test]
fn database_of_another_run_is_rebuilt() {
    let (home, other) = (Home::new(), Home::new());
    let (path, foreign) = (home.play_two_weeks(), other.play_two_weeks());
    let hash = |home: &Home| home.run(&["query", "latest", "SELECT sum(amount) FROM ledger"]).stdout;
    let before = hash(&home);
    for suffix in ["", "-wal", "-shm"] {
        let _ = fs::remove_file(path.join(format!("world.db{suffix}")));
    }
    fs::copy(foreign.join("world.db"), path.join("world.db")).expect("copied");
    for remark in [true, false] {
        let program_output = home.play(&["--run", &run_id(&path)], "status\n");
        assert_eq!(program_output.exit_code, 0, "{}", program_output.stderr);
        assert_eq!(
            program_output.stdout.contains("world.db belongs to another run"),
            remark,
            "{}",
            program_output.stdout
        );
    }
    assert_eq!(hash(&home), before);
    assert_eq!(home.run(&["replay", &run_id(&path), "--verify"]).exit_code, 0);
}

#[test]
fn misplaced_options_are_rejected() {
    let home = Home::new();
    for before in [&["--new", "--scenario", "short", "--seed", "1"][..], &["--ascii"], &["--plain"]] {
        for command in [&["play", "--plain"][..], &["runs"], &["scenario", "list"]] {
            home.run(&[before, command].concat())
                .assert_fails(2, &["have no effect before a command", command[0]]);
        }
    }
    assert_eq!(fs::read_dir(home.runs()).expect("a folder").count(), 0, "no other run was started");
    let runs = home.runs().to_string_lossy().into_owned();
    assert_eq!(
        home.run(&["--runs-dir", &runs, "--as", "P01", "runs"]).exit_code,
        0,
        "both are allowed there"
    );
    assert_eq!(home.run(&["play", "--plain", "--mode", "lesson"]).exit_code, 2, "there are no lessons yet");
}

#[test]
fn unknown_run_error_names_the_run_and_the_list_command() {
    let home = Home::new();
    home.play_two_weeks();
    for arguments in [
        &["play", "--plain", "--run", "nothere"][..],
        &["runs", "show", "nothere"],
        &["runs", "path", "nothere"],
        &["runs", "end", "nothere"],
        &["runs", "delete", "nothere", "--yes"],
        &["query", "nothere", "SELECT 1"],
        &["replay", "nothere", "--verify"],
        &["runs", "show", "../runs"],
        &["runs", "show", ""],
    ] {
        home.run(arguments).assert_fails(3, &["there is no run", "`novamind runs`"]);
    }
    assert_eq!(home.run(&["play", "--plain", "--run", "latest"]).exit_code, 0);
    let empty = Home::new();
    empty
        .run(&["play", "--plain", "--run", "latest"])
        .assert_fails(3, &["there are no runs", "`novamind play`"]);
}

#[test]
fn plain_mode_is_used_without_a_terminal() {
    let home = Home::new();
    let program_output =
        run_with_input(home.program().args(["--seed", "7", "--days", "28"]), "set_prices A=12\n");
    assert_eq!((program_output.exit_code, program_output.stderr.as_str()), (0, ""));
    assert!(
        program_output.stdout.contains("seed 7 · day 0 of 28")
            && program_output.stdout.contains("ok set_prices"),
        "{}",
        program_output.stdout
    );
    let nothing =
        home.program().args(["play", "--days", "28"]).stdin(Stdio::null()).output().expect("it runs");
    assert!(nothing.status.success() && String::from_utf8_lossy(&nothing.stdout).contains("saved run"));
}
