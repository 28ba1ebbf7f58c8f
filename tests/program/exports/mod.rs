//! Exported runs: archives, tables, session summaries, comparisons of runs, and the schema of trajectory lines.

mod collected;
mod handover;
mod schema;
mod signed;
mod tables;

use std::collections::BTreeMap;
use std::fs;
use std::io::Read;
use std::path::{Path, PathBuf};

use crate::support::home::{Home, ProgramOutput, read_bytes, run_id};
use rusqlite::Connection;
use serde_json::Value;

const PLAY: &str = "set_prices A=12 B=25 C=55
set_usage_quotas A=60000 B=250000 C=1200000
set_model_tiers B=2 C=4
set_targeted_ad_spend {\"content_marketing\": {\"S1\": 750}, \"linkedin\": {\"S1\": 100}}
set_prices A=0
sql SELECT count(*) FROM ledger
memo watch the costs
next \"If it goes well, we wait\" naive
set_ads_strength global_strength=0.5
next \"as planned\" naive
next \"as planned\" naive
";

/// Plays a baseline run of three weeks as a participant, and returns its folder.
fn played_run(home: &Home, participant: &str) -> PathBuf {
    let before: Vec<PathBuf> = run_folders(&home.runs());
    let options = ["--mode", "baseline", "--participant", participant, "--seed", "7"];
    let program_output = home.play(&options, PLAY);
    assert_eq!(program_output.exit_code, 0, "{}", program_output.stderr);
    run_folders(&home.runs()).into_iter().find(|folder| !before.contains(folder)).expect("a new run")
}

fn run_folders(runs: &Path) -> Vec<PathBuf> {
    fs::read_dir(runs).expect("a folder").flatten().map(|entry| entry.path()).collect()
}

fn text(path: &Path) -> String {
    path.to_string_lossy().into_owned()
}

fn export_run(home: &Home, run: &Path, name: &str) -> (PathBuf, ProgramOutput) {
    let archive = home.0.path().join(name);
    let program_output = home.run(&["runs", "export", &run_id(run), "--out", &text(&archive)]);
    (archive, program_output)
}

fn import_archive(home: &Home, archive: &Path) -> ProgramOutput {
    home.run(&["runs", "import", &text(archive)])
}

/// Returns the files of an uncompressed archive.
fn archive_contents(archive: &Path) -> BTreeMap<String, Vec<u8>> {
    let mut files = BTreeMap::new();
    for entry in tar::Archive::new(fs::File::open(archive).expect("a file")).entries().expect("entries") {
        let mut entry = entry.expect("an entry");
        let name = entry.path().expect("a path").to_string_lossy().into_owned();
        let mut bytes = Vec::new();
        entry.read_to_end(&mut bytes).expect("bytes");
        files.insert(name, bytes);
    }
    files
}

/// Writes an archive that contains the given files.
fn write_forged_archive(archive: &Path, files: &[(String, Vec<u8>)]) {
    let mut builder = tar::Builder::new(fs::File::create(archive).expect("a file"));
    for (name, bytes) in files {
        builder
            .append(&header(name, bytes.len() as u64, tar::EntryType::Regular), &bytes[..])
            .expect("an entry");
    }
    builder.finish().expect("an archive");
}

fn header(name: &str, size: u64, kind: tar::EntryType) -> tar::Header {
    let mut header = tar::Header::new_ustar();
    // Sets the name directly, because the `tar` crate refuses dangerous names.
    header.as_old_mut().name[..name.len()].copy_from_slice(name.as_bytes());
    header.set_size(size);
    header.set_mode(0o644);
    header.set_entry_type(kind);
    header.set_cksum();
    header
}

#[test]
fn exported_run_imports_unchanged() {
    let (home, other) = (Home::new(), Home::new());
    let run = played_run(&home, "P01");
    let before = read_bytes(&run, "trajectory.jsonl");
    for name in ["run.tar.gz", "run.tar"] {
        let (archive, program_output) = export_run(&home, &run, name);
        assert_eq!(program_output.exit_code, 0, "{}", program_output.stderr);
        let checksum = program_output.stdout.split("checksum ").nth(1).expect("a checksum").trim().to_owned();
        assert_eq!(checksum.len(), 64);
        let (_, output) = export_run(&home, &run, name);
        output.assert_fails(1, &["already exists"]);
        let imported = import_archive(&other, &archive);
        assert_eq!(imported.exit_code, 0, "{}", imported.stderr);
        assert!(imported.stdout.contains(&checksum), "{}", imported.stdout);
    }
    // The second archive found an existing run.
    let there = other.runs().join(run_id(&run));
    for file in ["run.toml", "trajectory.jsonl", "memo.md"] {
        assert_eq!(read_bytes(&there, file), read_bytes(&run, file), "{file}");
    }
    assert_eq!(run_folders(&other.runs()), [there], "nothing else is left behind");
    assert_eq!(other.run(&["replay", &run_id(&run), "--verify"]).exit_code, 0);
    let go_on = other.play(&["--run", &run_id(&run)], "next \"the end\" naive\n");
    assert_eq!(go_on.exit_code, 0, "{}", go_on.stderr);
    import_archive(&other, &home.0.path().join("run.tar"))
        .assert_fails(1, &["already exists", "was continued after the export"]);
    let (later, _) = export_run(&other, &run, "later.tar");
    import_archive(&home, &later).assert_fails(1, &["already exists", "later state"]);
    assert_eq!(read_bytes(&run, "trajectory.jsonl"), before, "nothing was overwritten");
}

#[test]
fn conflicting_record_is_imported_under_another_name() {
    let (home, other) = (Home::new(), Home::new());
    let run = played_run(&home, "P01");
    let (archive, _) = export_run(&home, &run, "run.tar");
    assert_eq!(import_archive(&other, &archive).exit_code, 0);
    // The original run and the imported run are continued differently.
    for (home, price) in [(&home, "A=11"), (&other, "A=19")] {
        let lines = format!("set_prices {price}\nnext \"on\" naive\n");
        assert_eq!(home.play(&["--run", &run_id(&run)], &lines).exit_code, 0);
    }
    let there = other.runs().join(run_id(&run));
    let before = read_bytes(&there, "trajectory.jsonl");
    let (second, _) = export_run(&home, &run, "second.tar");
    let parts = ["already exists", "differ from line", "the archive has", "lines up to day", "--under NAME"];
    import_archive(&other, &second).assert_fails(1, &parts);
    let path = text(&second);
    other.run(&["runs", "import", &path, "--under", "../out"]).assert_fails(1, &["is not a valid run name"]);
    other.run(&["runs", "import", &path, "--under", &run_id(&run)]).assert_fails(1, &["already exists in"]);
    other
        .run(&["runs", "import", &path, &path, "--under", "second"])
        .assert_fails(2, &["exactly one archive"]);
    let imported = other.run(&["runs", "import", &path, "--under", "second"]);
    assert!(
        imported.exit_code == 0 && imported.stdout.contains("as second: imported"),
        "{}{}",
        imported.stdout,
        imported.stderr
    );
    let imported_run = other.runs().join("second");
    assert_eq!(read_bytes(&imported_run, "trajectory.jsonl"), read_bytes(&run, "trajectory.jsonl"));
    assert_eq!(read_bytes(&there, "trajectory.jsonl"), before, "the existing record is unchanged");
    assert_eq!(other.run(&["replay", "second", "--verify"]).exit_code, 0);
    assert!(other.run(&["runs", "list"]).stdout.contains("second"));
}

#[test]
fn archive_database_opens_in_plain_sqlite() {
    let home = Home::new();
    let run = played_run(&home, "P01");
    fs::write(run.join("snapshot.bin"), "hidden").expect("a snapshot");
    let (archive, _) = export_run(&home, &run, "run.tar");
    let files = archive_contents(&archive);
    let names: Vec<&str> = files.keys().map(|name| name.split_once('/').expect("a folder").1).collect();
    assert_eq!(names, ["memo.md", "run.toml", "seal.toml", "trajectory.jsonl", "world.db"]);
    let file = home.0.path().join("copy.db");
    fs::write(&file, &files[&format!("{}/world.db", run_id(&run))]).expect("a copy");
    let database = Connection::open(&file).expect("it opens");
    let ask = |sql: &str| -> f64 {
        database.query_row(sql, [], |row| row.get(0)).unwrap_or_else(|e| panic!("{sql}: {e}"))
    };
    for table in novamind::database::tables(novamind::database::Interface::Release1) {
        let columns: Vec<&str> = table.columns.iter().map(|column| column.name.as_str()).collect();
        ask(&format!("SELECT 1.0 * count(*) FROM (SELECT {} FROM {})", columns.join(", "), table.name));
    }
    for sql in [
        "SELECT 1.0 * count(*) FROM daily_usage",
        "SELECT 1.0 * sum(usage_units * day + customer_id) FROM daily_usage",
        "SELECT 1.0 * count(*) FROM ads_revenue",
        "SELECT coalesce(sum(revenue), 0.0) FROM ads_revenue",
        "SELECT sum(amount) FROM ledger",
    ] {
        let program_output = home.run(&["query", &run_id(&run), sql, "--format", "csv"]);
        let expected: f64 = program_output.stdout.lines().nth(1).expect("a row").parse().expect("a number");
        assert!(
            (ask(sql) - expected).abs() <= 1e-9 * expected.abs(),
            "{sql}: {} is not {expected}",
            ask(sql)
        );
    }
    assert!(
        ask("SELECT 1.0 * count(*) FROM daily_usage") > 0.0
            && ask("SELECT 1.0 * count(*) FROM ads_revenue") > 0.0
    );
    let packed = "SELECT 1.0 * count(*) FROM sqlite_master WHERE name LIKE '%_blocks'";
    assert_eq!(ask(packed), 0.0, "there are no files that only the program can read");
    let typed = "SELECT 1.0 * count(*) FROM sqlite_master WHERE name = 'subscriptions' \
                 AND sql LIKE '%CAST(effective_price AS REAL) AS effective_price%'";
    assert_eq!(ask(typed), 1.0, "SQLite before 3.52 needs the type to sort whole rows");
    // The SQLite version of the installed Python is often older than the version of the program.
    let script = "import sqlite3, sys\n\
                  rows = sqlite3.connect(sys.argv[1]).execute('SELECT * FROM subscriptions ORDER BY status DESC')\n\
                  at = [column[0] for column in rows.description].index('effective_price')\n\
                  print({type(row[at]).__name__ for row in rows})";
    if let Ok(output) = std::process::Command::new("python3").args(["-c", script]).arg(&file).output()
        && output.status.success()
    {
        assert_eq!(String::from_utf8_lossy(&output.stdout).trim(), "{'float'}");
    }
}

#[test]
fn modified_archives_are_rejected() {
    let (home, other) = (Home::new(), Home::new());
    let run = played_run(&home, "P01");
    let (archive, _) = export_run(&home, &run, "run.tar");
    let files: Vec<(String, Vec<u8>)> = archive_contents(&archive).into_iter().collect();
    let bad = home.0.path().join("bad.tar");
    let refused = |files: &[(String, Vec<u8>)], parts: &[&str]| {
        write_forged_archive(&bad, files);
        import_archive(&other, &bad).assert_fails(3, &[parts, &["bad.tar", "Nothing was imported"]].concat());
        assert!(run_folders(&other.runs()).is_empty());
    };
    write_forged_archive(&bad, &files);
    assert_eq!(import_archive(&other, &bad).exit_code, 0, "the unchanged files are valid");
    fs::remove_dir_all(other.runs().join(run_id(&run))).expect("it was there");
    for (at, (name, bytes)) in files.iter().enumerate().filter(|(_, (name, _))| !name.ends_with("seal.toml"))
    {
        let file = name.split_once('/').expect("a folder").1;
        let mut changed = files.clone();
        changed[at].1[bytes.len() / 2] ^= 1;
        refused(&changed, &[file, "not the file that was sealed"]);
        let mut cut = files.clone();
        cut[at].1.pop();
        refused(&cut, &[file, "not the file that was sealed"]);
        let mut missing = files.clone();
        missing.remove(at);
        refused(&missing, &[file, "is missing"]);
    }
    let seal = files.iter().position(|(name, _)| name.ends_with("seal.toml")).expect("a seal");
    let mut changed = files.clone();
    let text = String::from_utf8(changed[seal].1.clone()).expect("text");
    changed[seal].1 = text.replace("last_seq = ", "last_seq = 1").into_bytes();
    refused(&changed, &["seal.toml", "checksum"]);
    let mut missing = files.clone();
    missing.remove(seal);
    refused(&missing, &["seal.toml is missing"]);
    let mut twice = files.clone();
    twice.push(files[0].clone());
    refused(&twice, &["twice"]);
    let mut stranger = files.clone();
    stranger.push((format!("{}/snapshot.bin", run_id(&run)), b"x".to_vec()));
    refused(&stranger, &["snapshot.bin", "is not a file of a run"]);
}

#[test]
fn archives_with_dangerous_or_foreign_files_are_rejected() {
    let home = Home::new();
    let bad = home.0.path().join("bad.tar");
    for name in ["../../evil", "/etc/evil", "0123abcd/../evil", "0123abcd/sub/run.toml", "latest/run.toml"] {
        write_forged_archive(&bad, &[(name.to_owned(), b"x".to_vec())]);
        import_archive(&home, &bad).assert_fails(3, &["is not a file of a run"]);
    }
    for kind in
        [tar::EntryType::Symlink, tar::EntryType::Link, tar::EntryType::XHeader, tar::EntryType::GNULongName]
    {
        let mut builder = tar::Builder::new(fs::File::create(&bad).expect("a file"));
        builder.append(&header("0123abcd/run.toml", 0, kind), &b""[..]).expect("an entry");
        builder.finish().expect("an archive");
        import_archive(&home, &bad).assert_fails(3, &["not a regular file"]);
    }
    // The contents of a damaged archive are reported in one line without terminal control sequences.
    write_forged_archive(&bad, &[("0123abcd/\u{1b}[2J\nrun.toml".to_owned(), b"x".to_vec())]);
    import_archive(&home, &bad).assert_fails(3, &["0123abcd/\\u{1b}[2J\\nrun.toml is not a file of a run"]);
    let mut torn = header("0123abcd/run.toml", 0, tar::EntryType::Regular);
    torn.as_old_mut().cksum = *b"FRO\nM\x1b[m";
    fs::write(&bad, torn.as_bytes()).expect("a header");
    import_archive(&home, &bad).assert_fails(3, &["not an archive of a run", "FRO\\nM\\u{1b}[m"]);
    // A file with a false size is not read, and no memory is reserved for it.
    fs::write(&bad, header("0123abcd/run.toml", 7 << 30, tar::EntryType::Regular).as_bytes())
        .expect("a header");
    import_archive(&home, &bad).assert_fails(3, &["run.toml is too large"]);
    fs::write(&bad, "this is a letter, not an archive").expect("a file");
    import_archive(&home, &bad).assert_fails(3, &["not an archive of a run"]);
    fs::write(&bad, "").expect("a file");
    import_archive(&home, &bad).assert_fails(3, &["seal.toml is missing"]);
    import_archive(&home, &home.0.path().join("nowhere.tar")).assert_fails(3, &["nowhere.tar"]);
    assert!(run_folders(&home.runs()).is_empty(), "nothing is left behind");
    assert!(!home.0.path().join("evil").exists());
}

#[test]
fn compressed_archive_with_any_truncation_or_bit_flip_is_rejected() {
    let (home, other) = (Home::new(), Home::new());
    let run = played_run(&home, "P01");
    let (archive, _) = export_run(&home, &run, "run.tar.gz");
    let whole = fs::read(&archive).expect("bytes");
    let bad = home.0.path().join("bad.tar.gz");
    for share in [0.1, 0.5, 0.9, 0.999] {
        let at = (whole.len() as f64 * share) as usize;
        fs::write(&bad, &whole[..at]).expect("a cut");
        import_archive(&other, &bad).assert_fails(3, &["bad.tar.gz"]);
        let mut flipped = whole.clone();
        flipped[at] ^= 0x10;
        fs::write(&bad, &flipped).expect("a flip");
        import_archive(&other, &bad).assert_fails(3, &["bad.tar.gz"]);
        assert!(run_folders(&other.runs()).is_empty());
    }
}

#[test]
fn export_rejects_damaged_runs_and_omits_incomplete_lines() {
    let home = Home::new();
    let run = played_run(&home, "P01");
    let good = read_bytes(&run, "trajectory.jsonl");
    let torn = [&good[..], b"{\"seq\":99,\"ki"].concat();
    fs::write(run.join("trajectory.jsonl"), &torn).expect("a torn line");
    let (archive, program_output) = export_run(&home, &run, "torn.tar");
    assert_eq!(program_output.exit_code, 0, "{}", program_output.stderr);
    assert_eq!(archive_contents(&archive)[&format!("{}/trajectory.jsonl", run_id(&run))], good);
    assert_eq!(read_bytes(&run, "trajectory.jsonl"), torn, "an export changes nothing");
    let text = String::from_utf8(good).expect("text");
    fs::write(run.join("trajectory.jsonl"), text.replacen("\"A\":12", "\"A\":13", 1)).expect("a change");
    let (archive, output) = export_run(&home, &run, "bad.tar");
    output.assert_fails(3, &["trajectory.jsonl, line 3", "its checksum", "Lines 1 to 2 are valid"]);
    assert!(!archive.exists());
    let hidden = |entry: &PathBuf| {
        entry.file_name().is_some_and(|name| name.to_string_lossy().starts_with(".novamind"))
    };
    assert!(!run_folders(home.0.path()).iter().any(hidden), "no drafts are left behind");
}

fn read_table(path: &Path) -> Vec<BTreeMap<String, String>> {
    let mut reader = csv::Reader::from_path(path).expect("a table");
    reader.deserialize().map(|row| row.expect("a row")).collect()
}

#[test]
fn export_all_writes_consistent_tables() {
    let home = Home::new();
    let (first, second) = (played_run(&home, "P01"), played_run(&home, "P, \"02\""));
    let out = home.0.path().join("study");
    let program_output = home.run(&["runs", "export", "--all", "--out", &text(&out)]);
    assert_eq!(program_output.exit_code, 0, "{}", program_output.stderr);
    let runs = read_table(&out.join("runs.csv"));
    assert_eq!(
        runs.iter().map(|row| row["run"].clone()).collect::<Vec<_>>(),
        [run_id(&first), run_id(&second)]
    );
    assert_eq!(runs[1]["participant"], "P, \"02\"");
    let row = &runs[0];
    let cell = |name: &str| row[name].as_str();
    assert_eq!([cell("mode"), cell("day"), cell("weeks"), cell("calls")], ["baseline", "21", "3", "5"]);
    assert_eq!([cell("refused"), cell("queries"), cell("if_words"), cell("memos")], ["1", "1", "1", "1"]);
    let weeks = read_table(&out.join("weeks.csv"));
    let run_weeks: Vec<_> = weeks.iter().filter(|row| row["run"] == run_id(&first)).collect();
    assert_eq!(run_weeks.iter().map(|row| row["day"].as_str()).collect::<Vec<_>>(), ["7", "14", "21"]);
    assert_eq!(run_weeks[2]["cash"], row["cash"]);
    assert_eq!(run_weeks[0]["forecast_7_outcome"], run_weeks[0]["cash"]);
    let trajectory = String::from_utf8(read_bytes(&first, "trajectory.jsonl")).expect("text");
    for (week, line) in
        run_weeks.iter().zip(trajectory.lines().filter(|line| line.contains("\"kind\":\"week\"")))
    {
        let line: Value = serde_json::from_str(line).expect("a line");
        assert_eq!(week["state_hash"], line["state_hash"].as_str().expect("a hash"));
        for (name, value) in line["figures"].as_object().expect("figures") {
            assert_eq!(week[name], value.to_string(), "{name}");
        }
    }
    // The codebook describes every column of every table.
    let columns = read_table(&out.join("columns.csv"));
    let all = ["forecasts", "queries", "events", "notes"]
        .map(|name| (name, read_table(&out.join(format!("{name}.csv")))));
    assert_eq!(read_table(&out.join("answers.csv")).len(), 0, "there were no questions");
    assert_eq!(all[2].1.len(), 2 * trajectory.lines().count(), "both runs had the same decisions");
    let others = all.iter().map(|(name, rows)| (*name, &rows[0]));
    for (name, first) in [("runs", &runs[0]), ("weeks", &weeks[0])].into_iter().chain(others) {
        let known: Vec<&str> =
            columns.iter().filter(|row| row["table"] == name).map(|row| row["column"].as_str()).collect();
        assert_eq!(known.len(), first.len());
        assert!(first.keys().all(|column| known.contains(&column.as_str())));
    }
    for run in [&first, &second] {
        let archive = out.join(format!("{}.tar.gz", run_id(run)));
        let there = Home::new();
        assert_eq!(import_archive(&there, &archive).exit_code, 0);
    }
    // The export is repeated for one participant. Existing archives are allowed.
    let one = home.run(&["runs", "export", "--all", "--participant", "P01", "--out", &text(&out)]);
    assert_eq!((one.exit_code, read_table(&out.join("runs.csv")).len()), (0, 1));
    let list = home.run(&["runs", "list", "--participant", "P01"]);
    assert_eq!(list.stdout.lines().count(), 1, "{}", list.stdout);
    // A damaged run is reported and does not prevent the export of the other runs.
    fs::write(first.join("trajectory.jsonl"), "nonsense\n").expect("damage");
    let output = home.run(&["runs", "export", "--all", "--out", &text(&out)]);
    output.assert_fails(3, &["1 of 2 runs"]);
    let damaged = read_table(&out.join("runs.csv"))
        .into_iter()
        .find(|row| row["run"] == run_id(&first))
        .expect("a row");
    assert!(damaged["problem"].contains("line 1") && damaged["cash"].is_empty(), "{damaged:?}");
}

#[test]
fn reports_summarize_sessions_and_compare_runs() {
    let home = Home::new();
    let (first, second) = (played_run(&home, "P01"), played_run(&home, "P02"));
    let ended = home.run(&["runs", "end", &run_id(&second)]);
    assert_eq!(ended.exit_code, 0, "{}", ended.stderr);
    let page = home.run(&["report", &run_id(&first), "--session"]);
    assert!(
        page.stdout.contains("P01 played 3 weeks") && page.stdout.contains("## Breaks"),
        "{}",
        page.stdout
    );
    let summary: Value =
        serde_json::from_str(&home.run(&["report", &run_id(&first), "--session", "--format", "json"]).stdout)
            .expect("JSON");
    assert_eq!(
        (&summary["total"]["calls"], &summary["weeks"][0]["queries"]),
        (&Value::from(5), &Value::from(1))
    );
    home.run(&["report", &run_id(&first), "--format", "json"]).assert_fails(2, &["--session"]);

    let names = [run_id(&first), run_id(&second)];
    let program_output = home.run(&["lab", "compare", &names[0], &names[1]]);
    for part in ["P01", "P02", "rule-based baseline", "cash on day 21", "day 0", "Claude Fable 5", "differ"] {
        // Both runs have the same decisions, so only the figures at their end differ.
        assert_eq!(
            program_output.stdout.contains(part),
            part != "differ",
            "{part}: {}",
            program_output.stdout
        );
    }
    let object = home.run(&["lab", "compare", &names[0], &names[1], "--json"]).stdout;
    let object: Value = serde_json::from_str(&object).expect("JSON");
    let figures = object["comparison"]["figures"].as_array().expect("figures");
    let figure = |name: &str| figures.iter().find(|row| row["figure"] == name).expect(name)["values"].clone();
    let share = figure("ad spend on the best channel, as measured");
    assert_eq!(share[0], share[1], "the same decisions");
    let truly = figure("ad spend on the truly best channel");
    assert!(truly[0].is_null() && truly[1].is_number(), "only a finished run shows this share: {truly}");
    let cash = object["comparison"]["cash"].as_array().expect("cash");
    assert_eq!(cash.last().expect("a row")["values"][0], object["runs"][0]["logbook"]["cash"]);
    let csv = home.run(&["lab", "compare", &names[0], &names[1], "--csv"]).stdout;
    assert!(
        csv.lines().next().expect("a head").starts_with(&format!("figure,of,unit,{},{}", names[0], names[1]))
    );
    home.run(&["lab", "compare", "zzzz"]).assert_fails(3, &["there is no run"]);
}

#[test]
fn documents_match_the_column_explanations() {
    let program_output = Home::new().run(&["runs", "columns"]);
    assert_eq!(
        program_output.stdout,
        include_str!("../../../assets/columns.md"),
        "write it again with: novamind runs columns"
    );
    let page = include_str!("../../../docs/formats/trajectory.md");
    let examples: Vec<Value> = page
        .lines()
        .filter_map(|line| line.strip_prefix("{\"seq\""))
        .map(|line| serde_json::from_str(&format!("{{\"seq\"{line}")).expect("JSON"))
        .collect();
    schema::check_examples(&examples);
}
