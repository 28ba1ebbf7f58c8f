//! Plain mode of the built program: pipes, scripts, rejections and exit codes.

use std::io::Write;
use std::path::Path;
use std::process::{Command, Output, Stdio};

use serde_json::Value;

fn program(runs: &Path) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_novamind"));
    command.env("NOVAMIND_RUNS", runs).env("NOVAMIND_CONFIG", runs.join("configuration"));
    command
}

/// Sends lines to plain mode, and returns standard output and the exit code.
fn play(runs: &Path, options: &[&str], lines: impl AsRef<[u8]>) -> (String, i32) {
    let mut child = program(runs)
        .args(["play", "--plain"])
        .args(options)
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .expect("the program starts");
    // Ignores errors, because a program that ends early does not read all input.
    let _ = child.stdin.take().expect("a pipe").write_all(lines.as_ref());
    let Output { status, stdout, stderr } = child.wait_with_output().expect("the program ends");
    let code = status.code().expect("it ends on its own");
    assert!(stderr.is_empty(), "standard error is silent: {}", String::from_utf8_lossy(&stderr));
    (String::from_utf8(stdout).expect("UTF-8"), code)
}

fn json_lines(text: &str) -> Vec<Value> {
    text.lines()
        .map(|line| serde_json::from_str(line).unwrap_or_else(|error| panic!("{line}: {error}")))
        .collect()
}

const EXAMPLE: &str = r#"
pricing.set_prices(A=12, B=25, C=55)
set_usage_quotas A=60000 B=250000 C=1200000      # units per day
set_prices A=0
set_targeted_ad_spend {"search_ads": {"S1": 80, "S3": 40}}
sql SELECT category, SUM(amount) AS total FROM ledger GROUP BY category;
next "first prices" 990000 980000 995000  960000 930000 980000  900000 800000 1000000  900000 500000 1500000
"#;

#[test]
fn piped_session_matches_the_example() {
    let runs = tempfile::tempdir().expect("a folder");
    let (text, code) = play(runs.path(), &["--seed", "7", "--days", "28", "--echo"], EXAMPLE);
    assert_eq!(code, 0);
    let expected = [
        "> pricing.set_prices(A=12, B=25, C=55)\nok set_prices\n  updated: {\"A\":12,\"B\":25,\"C\":55}\n  current: {\"A\":12,\"B\":25,\"C\":55}\n\n",
        "> set_usage_quotas A=60000 B=250000 C=1200000      # units per day\nok set_usage_quotas\n  quotas: {\"A\":60000,\"B\":250000,\"C\":1200000}\n\n",
        "> set_prices A=0\nrefused price_not_positive (A): ",
        "ok set_targeted_ad_spend\n  targeted_spend: {\"search_ads\":{\"S1\":80,\"S3\":40}}\n  total_per_day: 120\n\n",
        "category         total\ninitial_funding  1000000.0\n(1 row)\n\n",
        "=== Week 1 (day 7) ===",
        "\nweek 1 done · day 7 · cash $99",
    ];
    let mut rest = text.as_str();
    for part in expected {
        let at = rest.find(part).unwrap_or_else(|| panic!("{part} is missing or out of order in\n{text}"));
        rest = &rest[at + part.len()..];
    }
    assert!(
        text.starts_with("run ")
            && text.lines().next().is_some_and(|line| line.ends_with("seed 7 · day 0 of 28 · sandbox"))
    );
    assert!(
        text.ends_with(" · day 7\n")
            && text.lines().last().is_some_and(|line| line.starts_with("saved run "))
    );
}

#[test]
fn json_mode_prints_one_object_per_line() {
    let runs = tempfile::tempdir().expect("a folder");
    let (text, _) = play(runs.path(), &["--seed", "7", "--days", "28", "--json"], EXAMPLE);
    let values = json_lines(&text);
    let lines: Vec<u64> = values.iter().filter_map(|object| object["line"].as_u64()).collect();
    assert_eq!(lines, [2, 3, 4, 5, 6, 7]);
    assert_eq!((values[0]["event"].as_str(), values[0]["days"].as_u64()), (Some("start"), Some(28)));
    assert_eq!(
        (values[1]["ok"].as_bool(), values[1]["data"]["updated"]["B"].as_u64()),
        (Some(true), Some(25))
    );
    assert_eq!(
        (values[3]["code"].as_str(), values[3]["field"].as_str()),
        (Some("price_not_positive"), Some("A"))
    );
    assert_eq!(values[5]["data"]["rows"][0]["total"], 1_000_000.0);
    assert_eq!((values[6]["day"].as_u64(), values[6]["data"]["day"].as_u64()), (Some(0), Some(7)));
    assert_eq!(values[7]["reason"], "end_of_input");
}

#[test]
fn syntax_errors_name_column_and_suggestions() {
    let runs = tempfile::tempdir().expect("a folder");
    let lines = "set_pices A=3\nset_prices A=1 A=2\nset_prices A=\nnext \"x\" 1 2 3\nnext\nbranch\nstep 1\nset_prices X=3\ntables leger\nnext naive extra more\n";
    let (output, code) = play(runs.path(), &["--json", "--days", "28"], lines);
    assert_eq!(code, 0, "refusals are answers");
    let values = json_lines(&output);
    let codes: Vec<&str> = values.iter().filter_map(|object| object["code"].as_str()).collect();
    assert_eq!(
        codes,
        [
            "usage",
            "usage",
            "usage",
            "usage",
            "rationale_missing",
            "usage",
            "not_in_this_mode",
            "unknown_plan",
            "usage",
            "usage"
        ]
    );
    assert!(values[1]["error"].as_str().is_some_and(|text| text.contains("set_prices")));
    assert_eq!((values[2]["column"].as_u64(), values[3]["column"].as_u64()), (Some(16), Some(14)));
    assert!(values[9]["error"].as_str().is_some_and(|text| text.contains("ledger")));
}

/// A list of deals can be given without the argument name. The call is rejected only because there is no enterprise yet.
#[test]
fn deal_lists_need_no_argument_name() {
    let runs = tempfile::tempdir().expect("a folder");
    let lines = r#"send_enterprise_deal [[99, [["B", 31.5]]], [98, []]]
send_enterprise_deal deals=[[1, [["B", 31.5]]]]
enterprise.send_enterprise_deal {"customer_id": 7, "offerings": [{"plan": "C"}]}
reject_enterprise_deal 12
reject_enterprise_deal
inbox
"#;
    let (text, code) = play(runs.path(), &["--days", "28", "--json"], lines);
    assert_eq!(code, 0, "{text}");
    let answers: Vec<Value> =
        json_lines(&text).into_iter().filter(|object| object.get("command").is_some()).collect();
    let codes: Vec<&str> = answers.iter().filter_map(|answer| answer["code"].as_str()).collect();
    let expected =
        ["customer_not_found", "not_enterprise", "offering_no_price", "no_active_thread", "deals_missing"];
    assert_eq!(codes, expected, "{text}");
    assert_eq!(answers[0]["field"], "deals.0.customer_id");
}

#[test]
fn strict_mode_ends_at_the_first_rejection() {
    let runs = tempfile::tempdir().expect("a folder");
    let (text, code) = play(
        runs.path(),
        &["--strict", "--json", "--days", "28"],
        "set_prices A=12\nset_prices A=0\nset_prices B=9\n",
    );
    let values = json_lines(&text);
    assert_eq!((code, values.len(), values[3]["reason"].as_str()), (1, 4, Some("strict")));
}

#[test]
fn invalid_bytes_are_rejected() {
    let runs = tempfile::tempdir().expect("a folder");
    let mut bytes =
        b"\xef\xbb\xbfset_prices A=12\r\n\xff\xfe\n# comment\n\nset_prices \\\r\nB=25\r\n".to_vec();
    bytes.extend(std::iter::repeat_n(b'x', 1 << 21));
    bytes.extend(b"\nset_prices C=55");
    let (text, code) = play(runs.path(), &["--json", "--days", "28"], bytes);
    let values = json_lines(&text);
    let ok: Vec<Option<bool>> =
        values[1..values.len() - 1].iter().map(|object| object["ok"].as_bool()).collect();
    assert_eq!((code, ok), (0, vec![Some(true), Some(false), Some(true), Some(false), Some(true)]));
    assert_eq!(values[5]["data"]["current"], serde_json::json!({"A": 12.0, "B": 25.0, "C": 55}));
}

#[test]
fn run_is_left_resumed_finished_and_replayed() {
    let runs = tempfile::tempdir().expect("a folder");
    let (text, _) =
        play(runs.path(), &["--seed", "3", "--days", "17"], format!("{EXAMPLE}quit\nset_prices A=99\n"));
    let id = text.split_whitespace().nth(1).expect("the run").to_owned();
    assert!(text.ends_with(&format!("saved run {id} · day 7\n")));
    let lines = "set_capacity_tier 2\nundo\nnext naive\nnext \"the last three days\" naive\nnext naive\nsql SELECT COUNT(*) AS n FROM predictions\n";
    let (output, code) = play(runs.path(), &["--run", "latest"], lines);
    assert_eq!(code, 0);
    assert!(output.starts_with(&format!("run {id} · seed 3 · day 7 of 17")));
    assert!(output.contains("undone\n"));
    assert!(
        output.contains("week 3 done · day 17") && output.contains("run ended: horizon · day 17 · score $")
    );
    assert!(output.contains("refused run_over: ") && output.contains("\n12\n(1 row)"));
    let replay = program(runs.path()).args(["replay", &id, "--verify"]).output().expect("it runs");
    assert!(replay.status.success(), "{}", String::from_utf8_lossy(&replay.stderr));
}

#[test]
fn play_with_invalid_options_has_documented_exit_codes() {
    let runs = tempfile::tempdir().expect("a folder");
    let failure = |options: &[&str]| {
        let output = program(runs.path()).args(["play", "--plain"]).args(options).output().expect("it runs");
        (output.status.code(), String::from_utf8_lossy(&output.stderr).into_owned())
    };
    let (code, text) = failure(&["--run", "nothere"]);
    assert!(code == Some(3) && text.contains("there is no run nothere"), "{code:?} {text}");
    let (code, text) = failure(&["--scenario", "nothere"]);
    assert!(code == Some(2) && text.contains("default"), "{code:?} {text}");
    assert_eq!(failure(&["--run", "latest", "--seed", "3"]).0, Some(2));
    assert_eq!(failure(&["--days", "3"]).0, Some(2));
}

#[cfg(unix)]
#[test]
fn termination_at_the_prompt_exits_immediately_and_saves_the_run() {
    use std::io::{BufRead, BufReader};
    let runs = tempfile::tempdir().expect("a folder");
    let mut child = program(runs.path())
        .args(["play", "--plain", "--days", "28"])
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .spawn()
        .expect("the program starts");
    let mut pipe = child.stdin.take().expect("a pipe");
    pipe.write_all(b"set_prices A=12\n").expect("written");
    let mut output = BufReader::new(child.stdout.take().expect("a pipe"));
    let mut line = String::new();
    while !line.contains("ok set_prices") {
        line.clear();
        assert!(output.read_line(&mut line).expect("readable") > 0, "it ended");
    }
    // The answer was printed, so the line is on disk. The program may not have printed the next prompt yet.
    let kill = Command::new("kill").args(["-TERM", &child.id().to_string()]).status().expect("kill runs");
    assert!(kill.success());
    let rest = std::io::read_to_string(output).expect("readable");
    assert_eq!(child.wait().expect("it ends").code(), Some(128 + 15));
    assert!(rest.contains("saved run"), "{rest}");
    let (output, _) = play(runs.path(), &["--run", "latest"], "get_vars\nchanges\n");
    assert!(output.contains("price A: 0 → 12"), "{output}");
}

#[test]
fn research_script_and_table_tools_are_commands() {
    let runs = tempfile::tempdir().expect("a folder");
    let lines = "market.research_market()\nresearch_group S1\nresearch_group(\"S1\", 3)\nget_market_overview\nget_group_insights E1\n\
                 register_daily_calculation name=money code=\"SELECT sum(amount) AS cash FROM ledger\"\n\
                 register_script(name=\"one\", code=\"SELECT 1 AS x\")\nrun_script one\nrun_script two\n\
                 python_exec \"SELECT count(*) AS n FROM customers\"\npython_exec \"DROP TABLE ledger\"\n\
                 list_scripts\ndescribe_tables predictions\nlist_all_tables\nget_tool_documentation tool_names=set_prices\n\
                 next naive\ndashboard\n";
    let (text, code) = play(runs.path(), &["--json", "--days", "28", "--seed", "7"], lines);
    assert_eq!(code, 0);
    let values = json_lines(&text);
    let by_line = |line: u64| {
        values
            .iter()
            .find(|object| object["line"].as_u64() == Some(line))
            .unwrap_or_else(|| panic!("{line}:\n{text}"))
    };
    assert_eq!(by_line(1)["command"], "research_market");
    assert_eq!(by_line(2)["data"]["expected_completion_day"], 3);
    assert_eq!(by_line(3)["code"], "usage");
    assert_eq!(by_line(4)["data"]["macroeconomic"], Value::Null);
    assert_eq!(by_line(5)["data"]["noise"], "\u{b1}65%");
    assert_eq!(by_line(6)["data"]["code_length"], 38);
    assert_eq!(by_line(8)["data"]["stdout"], "x\n1\n");
    assert_eq!(by_line(9)["code"], "script_not_found");
    assert_eq!(by_line(10)["data"]["stdout"], "n\n1\n");
    assert_eq!((&by_line(11)["code"], &by_line(11)["field"]), (&"script_failed".into(), &"code".into()));
    assert_eq!(by_line(12)["data"]["scripts"][0], "one");
    assert!(by_line(13)["data"]["tables"]["predictions"]["columns"]["submit_day"].is_string());
    assert_eq!(by_line(14)["data"]["count"], 19);
    assert_eq!(by_line(15)["data"]["set_prices"]["module"], "pricing");
    let dashboard = by_line(17)["data"]["dashboard"].as_str().expect("text");
    assert!(dashboard.contains("--- Weekly Calculations ---\nmoney:\n  cash\n  "), "{dashboard}");
    let notices = by_line(16)["data"]["notifications"].to_string();
    assert!(notices.contains("Study of group S1 complete: level 2"), "{notices}");
}

#[test]
fn explain_command_explains_terms() {
    let runs = tempfile::tempdir().expect("a folder");
    let lines = "explain runway\nwhat delivered quality\nglossary churn\nhelp runway\nexplain set_prices.A\nexplain nonsens\nhelp explain\n";
    let (text, code) = play(runs.path(), &["--seed", "7"], lines);
    assert_eq!(code, 0);
    for part in [
        "Runway (money)\nThe number of weeks",
        "Delivered quality (product)\n",
        "\n  churn ",
        "set_prices.A (argument of set_prices)",
        "error usage: unknown term nonsens",
        "explain TERM ",
    ] {
        assert!(text.contains(part), "{part} is missing in\n{text}");
    }
    assert_eq!(text.matches("Runway (money)").count(), 2, "help also explains terms");
}

#[test]
fn named_queries_are_listed_and_answered() {
    let runs = tempfile::tempdir().expect("a folder");
    let path = runs.path().join("configuration/queries");
    std::fs::create_dir_all(&path).expect("a folder");
    std::fs::write(path.join("mine.sql"), "SELECT 42 AS answer").expect("a file");
    let lines = "queries\nqueries mine\nqueries cash-by-week\nqueries cash-by-wek\nhelp queries\n";
    let (text, code) = play(runs.path(), &["--json", "--days", "28", "--seed", "7"], lines);
    assert_eq!(code, 0);
    let values = json_lines(&text);
    let names = values[1]["data"]["queries"].as_array().expect("a list");
    assert!(names.len() > 24);
    assert_eq!((&names[0]["name"], &names[0]["title"]), (&"mine".into(), &"mine".into()));
    assert_eq!(values[2]["data"]["rows"][0]["answer"], 42);
    assert_eq!(values[3]["data"]["rows"][0]["cash"], 1_000_000.0);
    assert!(
        values[4]["error"].as_str().is_some_and(|error| error.contains("did you mean cash-by-week")),
        "{text}"
    );
    assert!(values[5]["data"]["command"].as_str().is_some_and(|line| line.starts_with("queries [NAME]")));
}

#[test]
fn report_describes_weeks_and_runs() {
    let runs = tempfile::tempdir().expect("a folder");
    let lines = "report\nset_prices A=12 B=25 C=55\nnext \"if it sells, more\" naive\nreport\nreport run\nreport never\n";
    let (output, _) = play(runs.path(), &["--seed", "7", "--days", "28", "--echo"], lines);
    for part in [
        "> report\nrefused no_week_yet: no week has run yet. To simulate a week, type: next\n",
        "> report\nweek to day 7: cash change -$",
        "capacity -$",
        "decisions before the week: price C: 0 → 55 $/month",
        "forecast from 1 week ago: inside the interval, point ",
        "new: ",
        "> report run\n# NovaMind · run ",
        "price A: 0 → 12 $/month",
        "“if it sells, more”",
        "error usage: at never: report takes week or run",
    ] {
        assert!(output.contains(part), "{part} is missing in\n{output}");
    }
    let (output, _) = play(runs.path(), &["--run", "latest", "--json"], "report week\nreport run\n");
    let values = json_lines(&output);
    assert_eq!(values[1]["data"]["day"], 7);
    assert!(values[1]["data"]["moves"].as_array().is_some_and(|moves| !moves.is_empty()));
    assert_eq!(values[2]["data"]["survival_days"], 7);
    assert_eq!(values[2]["data"]["planning_words_per_rationale"], 1.0);
}

#[test]
fn xray_requires_a_debug_run() {
    let runs = tempfile::tempdir().expect("a folder");
    let lines = format!("{EXAMPLE}\nxray leads S1 R=1\nxray leads S9\nxray leads S1 8\nxray\n");
    let (text, _) = play(runs.path(), &["--seed", "7", "--days", "28", "--mode", "debug", "--json"], &lines);
    let values = json_lines(&text);
    let answer = |at: usize| &values[values.len() - 5 + at];
    let data = &answer(0)["data"];
    assert_eq!((&data["group"], &data["day"], &data["known"]), (&"S1".into(), &7.into(), &true.into()));
    let number = |name: &str| data[name].as_f64().expect("a number");
    let reputation = data["factors"]["R"].as_f64().expect("a number");
    assert!((number("held") * reputation - number("expected")).abs() < 1e-9);
    assert_eq!(answer(1)["error"], "there is no group S9; did you mean S1 or S2 or S3?");
    assert_eq!(answer(2)["code"], "day_unknown");
    assert_eq!(answer(3)["code"], "usage");
    let (output, _) = play(runs.path(), &["--seed", "7", "--days", "28", "--json"], &lines);
    let answers = json_lines(&output);
    for at in answers.len() - 5..answers.len() - 1 {
        assert_eq!(answers[at]["code"], "not_in_this_mode", "{}", answers[at]);
        assert_eq!(answers[at]["error"], answers[answers.len() - 2]["error"]);
    }
}

#[test]
fn xray_views_have_text_and_json_output() {
    let runs = tempfile::tempdir().expect("a folder");
    let views = [
        "xray quality S1",
        "xray satisfaction s1 7",
        "xray reputation S1 6",
        "xray spillover",
        "xray rivals 7",
        "xray drift",
        "xray streams service 3",
        "xray qualty S1",
        "xray quality S9",
        "xray quality S1 2 3",
        "xray drift soon",
        "xray streams servce",
        "xray streams leads 2000",
        "xray rivals 8",
        "xray spillover R=1",
        "xray reputation R=S1",
        "xray streams part=leads",
    ];
    let lines = format!("{EXAMPLE}\n{}\n", views.join("\n"));
    let debug = ["--seed", "7", "--days", "90", "--mode", "debug"];
    let (output, _) = play(runs.path(), &[&debug[..], &["--json"]].concat(), &lines);
    let answers = json_lines(&output);
    // The last line reports the end of the input.
    let answer = |at: usize| &answers[answers.len() - views.len() - 1 + at];
    let data = |at: usize| &answer(at)["data"];
    let number = |value: &serde_json::Value| value.as_f64().expect("a number");
    let quality = data(0);
    let sum = number(&quality["base"]) + number(&quality["shared"]) + number(&quality["own"]);
    for plan in quality["plans"].as_array().expect("plans") {
        assert_eq!(sum * number(&plan["multiplier"]), number(&plan["delivered"]));
    }
    let terms = data(1)["terms"].as_object().expect("terms");
    let felt: f64 = terms.values().map(number).sum();
    assert!((felt - number(&data(1)["felt"])).abs() < 1e-12 && terms.len() == 9);
    assert_eq!((&data(2)["group"], &data(2)["day"]), (&"S1".into(), &6.into()));
    assert_eq!(data(3)["own"]["S1"]["subscribers"], data(1)["felt_by"]);
    assert_eq!(
        (&data(4)["moves"], &data(5)["groups"][25]["group"]),
        (&serde_json::json!([]), &"D_E10".into())
    );
    assert_eq!(data(6)["streams"][0]["uniform"].as_array().map(Vec::len), Some(3));
    assert_eq!(data(6)["streams"][0]["key"], serde_json::json!({"day": 8}));
    for (at, expected) in [
        (7, "xray has no view qualty; did you mean quality?"),
        (8, "there is no group S9; did you mean S1 or S2 or S3?"),
        (9, "give a group and optionally a day: xray quality S2 84"),
        (10, "a whole number is expected"),
        (11, "there are no draws of servce; did you mean service or surge?"),
        (12, "choose a number of draws from 1 to 1000"),
        (13, "there is no day 8; choose a day from 1 to 7"),
        (14, "a whole number is expected"),
        (15, "give a group and optionally a day: xray reputation S2 84"),
    ] {
        assert_eq!(answer(at)["error"], expected, "{}", views[at]);
    }
    assert_eq!(answer(16)["code"], "usage");
    let (output, _) = play(runs.path(), &debug, &lines);
    for part in [
        "quality delivered to S1 on day 7",
        "= after ",
        "reputation of S1 on day 6",
        "rows are sources, columns are targets",
        "next move on day ",
        "next drift on day ",
        "next draws of service, day 8",
    ] {
        assert!(output.contains(part), "{part} is missing in\n{output}");
    }
    // In a sandbox run, the rejection does not depend on the command.
    let (output, _) = play(runs.path(), &["--seed", "7", "--days", "90", "--json"], &lines);
    let answers = json_lines(&output);
    let answers = &answers[answers.len() - views.len() - 1..answers.len() - 1];
    for answer in answers {
        assert_eq!((&answer["code"], &answer["error"]), (&"not_in_this_mode".into(), &answers[0]["error"]));
    }
}

#[test]
fn breakpoints_require_a_debug_run() {
    let runs = tempfile::tempdir().expect("a folder");
    let asked = "\
break subscribers(S1) >= 20   # a group
break reputation(S3) falls
break chrun(S1) > 5%
break clear two
break
run 70
back 1
back 9
since churn(S1) > 5% over 7
find leads(S1) > 0
who reputation(S1)
who cash 3
who cash yesterday
break clear all
back
run soon
run 3 until cash <
run 3 until subscribers(S1) < 0   # never
";
    let count = asked.lines().count();
    let (output, _) = play(
        runs.path(),
        &["--seed", "7", "--days", "70", "--mode", "debug", "--json"],
        format!("{EXAMPLE}{asked}"),
    );
    let values = json_lines(&output);
    let answers = &values[values.len() - count - 1..];
    let data = |at: usize| &answers[at]["data"];
    assert_eq!(data(0)["condition"], "subscribers(S1) >= 20");
    assert_eq!(
        (&answers[2]["error"], &answers[2]["column"]),
        (&"chrun is not a figure; did you mean churn?".into(), &7.into())
    );
    assert_eq!(answers[3]["column"], 13);
    assert_eq!(data(4)["breakpoints"].as_array().map(Vec::len), Some(2));
    let day = data(5)["day"].as_u64().expect("a day");
    let stop = &data(5)["stopped_by"][0];
    assert_eq!(
        (&stop["day"], &stop["true"], &stop["true_before"]),
        (&day.into(), &true.into(), &false.into())
    );
    assert_eq!(data(6)["conditions"].as_array().map(Vec::len), Some(1));
    assert_eq!(answers[7]["code"], "breakpoint_unknown");
    assert_eq!(data(8)["conditions"][0]["condition"], "churn(S1) > 0.05 over 7");
    assert!(!data(9)["days"].as_array().expect("days").is_empty());
    let number = |value: &Value| value.as_f64().expect("a number");
    for at in [10, 11] {
        let writes = data(at)["writes"].as_array().expect("writes");
        let sum: f64 = writes.iter().map(|write| number(&write["amount"])).sum();
        assert!((number(&data(at)["first"]) + sum - number(&data(at)["last"])).abs() < 1e-9, "{}", data(at));
    }
    assert_eq!(answers[12]["error"], "a whole number is expected, not yesterday");
    assert_eq!(data(13)["removed"].as_array().map(Vec::len), Some(2));
    assert_eq!(answers[14]["code"], "usage");
    assert_eq!(answers[15]["error"], "run needs a number of days, for example run 28");
    assert_eq!((&answers[16]["error"], &answers[16]["column"]), (&"a number is missing".into(), &19.into()));
    assert_eq!((&data(17)["day"], &data(17)["stopped_by"]), (&(day + 3).into(), &serde_json::json!([])));
    // In a run without permission to inspect, all commands are rejected before their arguments are parsed.
    let (output, _) =
        play(runs.path(), &["--seed", "7", "--days", "28", "--json"], format!("{EXAMPLE}{asked}"));
    let answers = json_lines(&output);
    let rejections = &answers[answers.len() - count - 1..answers.len() - 1];
    for (one, line) in rejections.iter().zip(asked.lines()) {
        let error = match line.starts_with("run ") {
            true => "run simulates single days in debug runs only",
            false => "the x-ray is available in debug runs and in runs that have ended",
        };
        assert_eq!((&one["code"], &one["error"]), (&"not_in_this_mode".into(), &error.into()), "{one}");
    }
    let (text, _) = play(
        runs.path(),
        &["--seed", "7", "--days", "70", "--mode", "debug"],
        format!("{EXAMPLE}break subscribers(S1) >= 20\nrun 70\nwho reputation(S1)\nback 1\n"),
    );
    for part in [
        "breakpoint 1: subscribers(S1) >= 20; to simulate until then, type: run DAYS",
        "\nstopped on day ",
        " >= 20 (day before ",
        "satisfaction of ",
        "last false on day ",
    ] {
        assert!(text.contains(part), "{part} is missing in\n{text}");
    }
}

#[test]
fn hidden_tables_are_queried_in_plain_mode_and_on_the_command_line() {
    let runs = tempfile::tempdir().expect("a folder");
    let asked = "xray sql SELECT day, group_id, reputation FROM hidden.groups WHERE group_id = 'S1'\n\
                 xray sql 3 SELECT count(*) AS n FROM hidden.customers WHERE start_day > 3 # a\n\
                 xray sql 9 SELECT 1\nxray sql\nxray sql 99999999999 SELECT 1\n\
                 sql SELECT * FROM hidden.groups\nhelp xray\n";
    let (output, _) = play(
        runs.path(),
        &["--seed", "7", "--days", "28", "--mode", "debug", "--json"],
        format!("{EXAMPLE}\n{asked}"),
    );
    let values = json_lines(&output);
    let answer = |at: usize| &values[values.len() - 8 + at];
    assert_eq!(answer(0)["data"]["row_count"], 7, "{}", answer(0));
    assert_eq!(answer(0)["data"]["rows"][6]["group_id"], "S1");
    assert_eq!(answer(1)["code"], "sql_error", "a statement ends at the end of the line: {}", answer(1));
    assert_eq!(answer(2)["code"], "day_unknown");
    assert_eq!((&answer(3)["code"], &answer(4)["code"]), (&"usage".into(), &"usage".into()));
    let way = "hidden.groups is not a visible table; query hidden tables with novamind query --xray";
    assert!(answer(5)["error"].as_str().is_some_and(|text| text.starts_with(way)), "{}", answer(5));
    assert!(answer(6)["data"]["command"].as_str().is_some_and(|text| text.contains("xray sql [DAY]")));
    let query = |options: &[&str]| {
        let output = program(runs.path()).arg("query").args(options).output().expect("the program ends");
        let text = |bytes: Vec<u8>| String::from_utf8(bytes).expect("UTF-8");
        (text(output.stdout), text(output.stderr), output.status.code())
    };
    let sql = "SELECT max(day) AS day, count(*) AS n FROM hidden.groups, hidden.pmi USING (day)";
    let (out, err, code) = query(&["--xray", "latest", sql, "--format", "csv"]);
    assert_eq!((out.as_str(), code), ("day,n\n7,182\n", Some(0)), "{err}");
    let (out, err, _) =
        query(&["--xray", "--day", "3", "latest", "SELECT count(*) > 0 AS n FROM hidden.customers"]);
    assert!(out.contains("\n1\n"), "{out}{err}");
    let (_, err, code) = query(&["latest", sql]);
    assert!(err.contains(way) && code != Some(0), "{err}");
    let lines = std::fs::read_dir(runs.path())
        .expect("a folder")
        .flatten()
        .find_map(|entry| std::fs::read_to_string(entry.path().join("trajectory.jsonl")).ok());
    let lines = lines.expect("a run");
    assert_eq!(lines.matches("\"kind\":\"xray\"").count(), 4, "each accepted query has a line");
    // In other runs, the rejection does not depend on the query.
    let (output, _) =
        play(runs.path(), &["--seed", "7", "--days", "28", "--json"], format!("{EXAMPLE}\n{asked}"));
    let answers = json_lines(&output);
    for at in answers.len() - 8..answers.len() - 3 {
        assert_eq!(answers[at]["code"], "not_in_this_mode", "{}", answers[at]);
        assert_eq!(answers[at]["error"], answers[answers.len() - 4]["error"]);
    }
    for sql in [sql, "nonsense", "no-such-query"] {
        let (out, err, code) = query(&["--xray", "latest", sql]);
        assert!(out.is_empty() && code != Some(0), "{out}");
        assert!(err.contains("the x-ray is available in debug runs and in runs that have ended"), "{err}");
    }
}

#[test]
fn setting_parameters_requires_a_debug_run() {
    let runs = tempfile::tempdir().expect("a folder");
    let commands = [
        "set",
        "set group.S1.c_max_mean",
        "set group.S1.c_max_mean 300 from 10",
        "set capacity_tier.3.capacity_units=90000",
        "set group.S9.c_max_mean 3",
        "set operations.base_outage_prob 7",
        "set calendar.weekly [1,1,1,1,1,1,1]",
        "set a b c",
        "set 5 6",
        "set x 5 from never",
        "set",
        "diff 3 5",
        "diff 3",
        "diff 3 99",
    ];
    let lines = format!("{EXAMPLE}\n{}\n", commands.join("\n"));
    let (output, _) =
        play(runs.path(), &["--seed", "7", "--days", "28", "--mode", "debug", "--json"], &lines);
    let values = json_lines(&output);
    // The last line states where the run was saved.
    let first = values.len() - 1 - commands.len();
    let answer = |at: usize| &values[first + at];
    assert_eq!(answer(0)["data"]["in_force"], serde_json::json!([]));
    assert_eq!(answer(1)["data"]["value"], 50);
    assert_eq!(answer(2)["data"]["from_day"], 10);
    assert_eq!(answer(3)["data"]["new"], 90_000);
    assert_eq!(
        (&answer(4)["code"], &answer(4)["field"]),
        (&"parameter_unknown".into(), &"group.S9.c_max_mean".into())
    );
    assert!(
        answer(4)["error"].as_str().is_some_and(|text| text.contains("group.S1.c_max_mean")),
        "{}",
        answer(4)
    );
    assert_eq!(answer(5)["code"], "parameter_not_allowed");
    assert_eq!(answer(6)["ok"], true);
    assert_eq!([7, 8, 9].map(|at| answer(at)["code"].clone()), ["usage", "usage", "usage"]);
    let changed = &answer(10)["data"];
    assert_eq!(changed["scenario"], "default");
    assert!(changed["in_force"].as_array().is_some_and(|all| all.len() > 1), "{changed}");
    assert_eq!(changed["waiting"][0]["key"], "group.S1.c_max_mean");
    assert!(answer(11)["data"]["difference"]["differs"].as_array().is_some_and(|all| !all.is_empty()));
    assert_eq!([12, 13].map(|at| answer(at)["code"].clone()), ["usage", "day_unknown"]);
    let (output, _) = play(runs.path(), &["--seed", "7", "--days", "28", "--json"], &lines);
    let answers = json_lines(&output);
    for answer in &answers[first..answers.len() - 1] {
        assert_eq!(answer["code"], "not_in_this_mode", "{answer}");
    }
}

#[test]
fn curve_shows_expected_lead_decisions() {
    let runs = tempfile::tempdir().expect("a folder");
    let lines =
        "curve S1\ncurve s1 20 0.4\ncurve\ncurve S9\ncurve S1 20\ncurve S1 -1 0.4\ncurve D_S05\nhelp curve\n";
    let (output, code) = play(runs.path(), &["--seed", "7", "--days", "28", "--json"], lines);
    assert_eq!(code, 0);
    let answers = &json_lines(&output)[1..];
    let data = |at: usize| &answers[at]["data"];
    assert_eq!(
        (&answers[0]["command"], &data(0)["basis"]["kind"]),
        (&"curve".into(), &"estimates".into()),
        "{output}"
    );
    assert_eq!(data(0)["curve"].as_array().map(Vec::len), Some(61));
    let conversion = |end: &str| data(1)["conversion"][end].as_f64().expect("a share");
    assert!(conversion("least") < conversion("likely") && conversion("likely") < conversion("most"));
    for (at, words) in [
        (2, "give a group, and optionally a price and a quality"),
        (3, "there is no group S9; did you mean"),
        (4, "give a group, and optionally a price and a quality"),
        (5, "numbers from 0"),
        (6, "group_not_discovered"),
        (7, "curve GROUP PRICE QUALITY"),
    ] {
        assert!(answers[at].to_string().contains(words), "{words}: {}", answers[at]);
    }
    // In a debug run, the same commands are recorded as inspections.
    let (output, _) =
        play(runs.path(), &["--seed", "7", "--days", "28", "--mode", "debug"], "curve S1\ncurve D_S05\n");
    assert!(
        output.contains("by true values of day 0") && output.contains("D_S05: quality that leads require"),
        "{output}"
    );
}

/// The answer to an offer compares the price with list price and compute cost. A lost thread shows what the record says.
#[test]
fn offers_and_lost_threads_state_their_facts() {
    let runs = tempfile::tempdir().expect("a folder");
    let week = "next \"x\" naive\n";
    let setup = r#"set_prices A=16 B=34 C=70
set_usage_quotas A=150 B=100000 C=900000
set_model_tiers A=2 B=3 C=4
set_targeted_ad_spend {"targeted_spend": {"linkedin": {"E1": 2000}}}
set_targeted_dev_spend {"targeted_spend": {"E1": 2000}}
"#;
    let offer =
        "check send_enterprise_deal [[8, [[\"B\", 10.2]]]]\nsend_enterprise_deal [[8, [[\"B\", 34]]]]\n";
    let other = "send_enterprise_deal [[9, [[\"B\", 60]]]]\n";
    let lines =
        [setup, &week.repeat(6), offer, &week.repeat(4), other, &week.repeat(3), "thread 1\nthread 2\n"]
            .concat();
    let (text, code) = play(runs.path(), &["--seed", "7", "--days", "140"], &lines);
    assert_eq!(code, 0, "{text}");
    for part in [
        "plan B at $10.20 per seat: 30% of the list price $34.00, $898 a month, estimated margin after compute 22%",
        "\nnote: Clearbrook Lockstone #8, plan B at $34.00 per seat: 100% of the list price $34.00",
        "received no answer from you to its message of day 49: the thread ended on day 56.\nIt asked for a price of $2.56 for plan B",
        "declined your offer B $60.00 of day 70 on day 77, without a message.\nIt named no price in this thread.",
        "An enterprise has at least 2 turns, so its turns were not used up: no price of plan B was acceptable to it",
    ] {
        assert!(text.contains(part), "{part} in\n{text}");
    }
}
