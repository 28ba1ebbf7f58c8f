//! One example for each line of `docs/known-differences.md`, played through the program and its server.

use std::path::Path;

use serde_json::{Value, json};

use crate::interfaces::{NEW_RUN_OPTIONS, Server, predictions};
use crate::release_2::release_2_options;
use crate::support::home::Home;

/// Commands that play a company with individuals and enterprises.
const FIXTURE_COMMANDS: &str = r#"
set_prices A=12 B=22.5 C=40
set_model_tiers B=2 C=5
set_usage_quotas A=60000 B=250000 C=1200000
set_capacity_tier 3
set_daily_spend operations=200 development=200
set_targeted_dev_spend {"E1": 90000}
set_targeted_ad_spend {"content_marketing": {"S1": 300}, "linkedin": {"E1": 3000}}
register_daily_calculation name=cash code="SELECT sum(amount) AS cash FROM ledger"
next naive
post_social_media "Exports are twice as fast from today."
next naive
next naive
next naive
next naive
inbox
rules send offer where group = E1: C 30
next naive
next naive
set_prices A=13
undo
redo
status
fit
report week
changes
check start_research_project tier=1
get_social_posts limit=3
queries first-offers
queries forecast-record
glossary cohort
python_exec "SELECT 1 + 1"
sql SELECT message FROM notifications WHERE type = 'deal_won'
sql SELECT * FROM enterprise_turns LIMIT 1
"#;

/// The runs and responses that the examples check.
struct Fixture {
    home: Home,
    responses: Vec<Value>,
    server: Server,
    /// Folders of the server, which must exist until the end of the test.
    _served: Home,
}

impl Fixture {
    fn new() -> Fixture {
        let (home, served) = (Home::new(), Home::new());
        let options = ["--json", "--echo", "--seed", "7", "--days", "84", "--cash", "20000000"];
        let program_output = home.play(&options, FIXTURE_COMMANDS);
        assert_eq!(program_output.exit_code, 0, "{}{}", program_output.stdout, program_output.stderr);
        let responses = program_output.json_lines();
        let server = Server::start(&served, &NEW_RUN_OPTIONS);
        Fixture { home, responses, server, _served: served }
    }

    /// Returns the data of the last response to a command with this prefix.
    fn last_response_data(&self, line: &str) -> &Value {
        let is_it = |answer: &&Value| answer["input"].as_str().is_some_and(|input| input.starts_with(line));
        let answer =
            self.responses.iter().rev().find(is_it).unwrap_or_else(|| panic!("{line} was not played"));
        assert_eq!(answer["ok"], true, "{answer}");
        &answer["data"]
    }

    /// Plays a separate run in plain mode and returns its responses.
    fn play(&self, options: &[&str], lines: &str) -> Vec<Value> {
        let home = Home::new();
        home.play(&[&["--json"], options].concat(), lines).json_lines()
    }

    fn baseline(&self, lines: &str) -> Vec<Value> {
        self.play(&["--mode", "baseline", "--participant", "P01", "--seed", "3"], lines)
    }

    /// Continues the run of the fixture in plain mode and returns the printed text.
    fn play_after_fixture(&self, lines: &str) -> String {
        self.home.play(&["--run", "latest"], lines).stdout
    }

    fn call(&self, tool: &str, args: Value) -> Value {
        self.server.post("/call", &json!({ "tool": tool, "args": args })).1
    }

    fn data(&self, tool: &str, args: Value) -> Value {
        let answer = self.call(tool, args);
        assert_eq!(answer["success"], true, "{tool}: {answer}");
        answer["data"].clone()
    }

    #[track_caller]
    fn assert_rejected(&self, tool: &str, args: Value, code: &str) {
        let answer = self.call(tool, args);
        assert_eq!((&answer["success"], &answer["code"]), (&json!(false), &json!(code)), "{tool}: {answer}");
    }

    fn query(&self, sql: &str) -> Value {
        self.server.post("/query", &json!({ "sql": sql })).1
    }

    #[track_caller]
    fn assert_manual_contains(&self, tool: &str, parts: &[&str]) {
        assert_contains(&self.home.run(&["tools", tool]).stdout, parts);
    }

    #[track_caller]
    fn assert_term_contains(&self, term: &str, parts: &[&str]) {
        assert_contains(&self.play_after_fixture(&format!("explain {term}\n")), parts);
    }

    /// Returns the dashboard of the last week.
    fn dashboard(&self) -> &str {
        self.last_response_data("next")["dashboard"].as_str().expect("a dashboard")
    }
}

#[track_caller]
fn assert_contains(text: &str, parts: &[&str]) {
    for part in parts {
        assert!(text.contains(part), "{part} is missing in: {text}");
    }
}

fn list(value: &Value) -> &Vec<Value> {
    value.as_array().unwrap_or_else(|| panic!("{value} is not a list"))
}

fn columns(answer: &Value) -> Vec<&str> {
    list(&answer["columns"]).iter().filter_map(Value::as_str).collect()
}

/// The start of a line of the page, and the example that checks it.
type Example = (&'static str, fn(&Fixture));

const INSTRUCTION_EXAMPLES: [Example; 6] = [
    ("the probability of an outage", |stage| {
        stage.assert_manual_contains("set_daily_spend", &["probability", "solve open issues"]);
        stage.assert_manual_contains("set_targeted_ops_spend", &["per day and dollar"]);
        stage.assert_term_contains("outage", &["probability"]);
        stage.assert_term_contains("operations", &["per dollar"]);
    }),
    ("the effect of development", |stage| {
        stage.assert_manual_contains("set_daily_spend", &["development adds", "ln(1 + spend"]);
        stage.assert_manual_contains("set_targeted_dev_spend", &["ln(1 + spend"]);
        stage.assert_term_contains("development", &["ln(1 + spend"]);
    }),
    ("the increase in perceived quality", |stage| {
        stage.assert_term_contains("perceived quality", &["days as a subscriber"]);
    }),
    ("the ranges of the economy's index", |stage| {
        stage.assert_term_contains("PMI", &["expansion from", "neutral from", "contraction from"]);
    }),
    ("the cost of every lead,", |stage| {
        stage.assert_manual_contains("set_targeted_ad_spend", &["for every lead"]);
        stage.assert_term_contains("lead acquisition cost", &["per lead"]);
    }),
    ("the cost of a late reply to an", |stage| {
        stage.assert_manual_contains("send_enterprise_deal", &["of the relationship", "the thread ends"]);
        stage.assert_term_contains("turn", &["of the relationship"]);
    }),
];

const PLAYER_INFORMATION_EXAMPLES: [Example; 15] = [
    ("problems that need action", |stage| {
        let needs = stage.play(&["--seed", "3"], "needs\n");
        let needs = list(&needs[1]["data"]["needs"]);
        assert!(needs.iter().any(|need| !need["call"].is_null()), "{needs:?}");
        let facts = stage.baseline("needs\n");
        let facts = list(&facts[1]["data"]["needs"]);
        assert!(!facts.is_empty() && facts.iter().all(|need| need["call"].is_null()), "{facts:?}");
    }),
    ("the fact that an enterprise that", |stage| {
        stage.assert_term_contains("retention thread", &["pays nothing"]);
        assert!(stage.last_response_data("inbox")["threads"][0]["days_left"].is_u64());
    }),
    ("the number and group of the enterprise", |stage| {
        let rows = list(&stage.last_response_data("sql SELECT message")["rows"]);
        assert_contains(rows[0]["message"].as_str().expect("a message"), &["Customer ", "(E1, "]);
    }),
    ("a name for every enterprise,", |stage| {
        let shown = &stage.last_response_data("inbox")["threads"][0]["company"];
        assert!(shown.as_str().is_some_and(|name| !name.is_empty()), "{shown}");
        assert!(
            !stage.last_response_data("sql SELECT * FROM enterprise_turns").to_string().contains("company")
        );
    }),
    ("the delivered quality next to", |stage| {
        let group = &stage.last_response_data("fit")["groups"][0];
        assert!(group["floor"]["least"].is_f64() && group["plans"][0]["quality"].is_f64(), "{group}");
    }),
    ("the numbers of leads,", |stage| {
        assert!(stage.last_response_data("fit")["groups"][0]["last_4_weeks"]["leads"].is_u64());
        let funnel = &stage.last_response_data("inbox")["funnels"][0];
        assert!(["came", "no_plan_good_enough", "asked", "signed"].iter().all(|name| funnel[name].is_u64()));
    }),
    ("for each thread, all offers,", |stage| {
        let thread = &stage.last_response_data("inbox")["threads"][0];
        let names = ["offers_so_far", "last_offer", "asked", "asked_plan", "needed_quota"];
        assert!(names.iter().all(|name| thread.get(name).is_some()), "{thread}");
    }),
    ("the outcome of new leads", |stage| {
        assert!(
            list(&stage.last_response_data("queries first-offers")["rows"])[0]["signed_percent"].is_number()
        );
    }),
    ("the change in cash over the last week", |stage| {
        let report = stage.last_response_data("report week");
        assert!(list(&report["parts"]).iter().any(|part| part["part"] == "payments"), "{report}");
        assert!(report["decided"].is_array());
    }),
    ("the runway", |stage| {
        assert!(stage.last_response_data("status").get("runway_weeks").is_some());
        assert!(stage.last_response_data("changes")["committed_per_day"].is_number());
        let filled = stage.play(&["--days", "28"], "next naive\nsql SELECT count(*) AS n FROM predictions\n");
        assert_eq!(filled[2]["data"]["rows"][0]["n"], 4);
    }),
    ("the gross margin", |stage| {
        assert_contains(&stage.play_after_fixture("check set_prices C=20\n"), &["gross margins", "plan C"]);
        assert!(stage.last_response_data("changes")["alike_plans"].is_array());
    }),
    ("next week's peak usage at", |stage| {
        assert!(stage.last_response_data("status")["next_peak_at_last_growth"].is_number());
    }),
    ("the distributions of duration", |stage| {
        assert!(stage.last_response_data("check start_research")["research"]["spread"].is_object());
        let check = stage.baseline("check start_research_project tier=1\n");
        assert!(check[1]["data"]["research"]["spread"].is_null(), "{}", check[1]);
    }),
    ("the errors of earlier forecasts", |stage| {
        assert!(list(&stage.last_response_data("queries forecast-record")["rows"])[0]["inside"].is_number());
    }),
    ("the meaning of a term, figure,", |stage| {
        stage.assert_term_contains("daily_usage", &["daily_usage"]);
        assert!(!stage.last_response_data("glossary cohort")["terms"][0]["text"].is_null());
    }),
];

const PLAYER_ACTION_EXAMPLES: [Example; 5] = [
    ("A person writes a rationale and four forecasts", |stage| {
        let answers = stage.baseline("next\nnext naive\n");
        assert!(answers[1..3].iter().all(|answer| answer["code"] == "rationale_missing"), "{answers:?}");
    }),
    ("A person can undo and redo settings", |stage| {
        let file = stage.home.only_run().join("trajectory.jsonl");
        let text = std::fs::read_to_string(file).expect("a trajectory");
        assert_contains(&text, &["\"undoes\":", "\"redoes\":"]);
        let tables = stage.home.0.path().join("tables");
        let exported = stage.home.run(&["runs", "export", "--all", "--out", &tables.to_string_lossy()]);
        assert_eq!(exported.exit_code, 0, "{}", exported.stderr);
        assert_contains(&std::fs::read_to_string(tables.join("weeks.csv")).expect("weeks"), &["undone"]);
    }),
    ("A person can answer waiting enterprises", |stage| {
        let sent = stage.last_response_data("rules send");
        assert!(sent["rules"][0]["companies"].as_u64() > Some(0), "{sent}");
        assert_eq!(sent["calls"][0]["tool"], "send_enterprise_deal");
    }),
    ("A sandbox run can use [a", |stage| {
        assert_contains(&stage.home.run(&["play", "--help"]).stdout, &["--voice"]);
    }),
    ("A person sees charts", |stage| {
        assert!(
            stage.last_response_data("glossary cohort")["picture"]
                .as_str()
                .is_some_and(|picture| picture.contains('*'))
        );
    }),
];

const AGENT_ACTION_EXAMPLES: [Example; 1] = [("Agents run Python in", |stage| {
    assert_contains(&stage.last_response_data("python_exec").to_string(), &["2"]);
    stage.assert_manual_contains("python_exec", &["#", "Python"]);
})];

const CALL_EXAMPLES: [Example; 15] = [
    ("ignores unknown arguments", |stage| {
        let args = json!({ "A": 1, "B": 1, "C": 1, "D": 1 });
        stage.assert_rejected("set_usage_quotas", args, "unknown_argument");
    }),
    ("accepts `true` and `false`", |stage| {
        stage.assert_rejected("set_capacity_tier", json!({ "tier": true }), "capacity_out_of_range");
        stage.assert_rejected("set_prices", json!({ "A": true }), "wrong_type");
    }),
    ("answers a value of the wrong", |stage| {
        let (status, answer) = stage.server.post("/call", &json!({"tool": "set_prices", "args": {"A": "x"}}));
        assert_eq!((status, &answer["code"], &answer["field"]), (200, &json!("wrong_type"), &json!("A")));
    }),
    ("treats *set_capacity_tier* without", |stage| {
        stage.assert_rejected("set_capacity_tier", json!({}), "argument_missing");
    }),
    ("treats *set_targeted_ad_spend*", |stage| {
        stage.assert_rejected("set_targeted_ad_spend", json!({}), "argument_missing");
        stage.assert_rejected("set_targeted_dev_spend", json!({}), "argument_missing");
    }),
    ("accepts texts and Booleans as", |stage| {
        for point in [json!("1000000"), json!(true)] {
            let mut week = json!({ "rationale": "on", "predictions": predictions() });
            week["predictions"]["cash_1wk"]["point"] = point;
            let (status, answer) = stage.server.post("/next-week", &week);
            assert_eq!((status, &answer["code"]), (400, &json!("prediction_not_number")), "{answer}");
        }
    }),
    ("accepts amounts of any size", |stage| {
        stage.assert_rejected("set_prices", json!({ "A": 1e10 }), "amount_too_large");
    }),
    ("returns a tier that was sent", |stage| {
        assert_eq!(stage.data("set_capacity_tier", json!({ "tier": 3.0 }))["tier"].to_string(), "3");
    }),
    ("applies scopes one by one", |stage| {
        let args = json!({ "by_group": {"S2": 9}, "by_plan": {"D": 1} });
        stage.assert_rejected("set_targeted_ops_spend", args, "unknown_plan");
        assert_eq!(stage.data("set_targeted_ops_spend", json!({ "by_plan": {} }))["by_group"], json!({}));
    }),
    ("accepts the scope of *set_targeted_ops_spend*", |stage| {
        let set = stage.data("set_targeted_ops_spend", json!({ "by_plan": {"A": 10} }));
        assert_eq!(set["by_plan"].to_string(), r#"{"A":10.0}"#);
    }),
    ("offers a plan that does not exist", |stage| {
        stage.assert_rejected(
            "send_enterprise_deal",
            json!({ "deals": [[9, [["D", 8]]]] }),
            "offering_malformed",
        );
        stage.assert_rejected(
            "send_enterprise_deal",
            json!({ "deals": [[9, [["A", -8]]]] }),
            "offering_malformed",
        );
    }),
    ("documents tools 24 to 34", |stage| {
        assert_eq!(stage.data("list_scripts", json!({}))["scripts"], json!([]));
    }),
    ("has its own texts in `error`", |stage| {
        let answer = stage.call("reject_enterprise_deal", json!({ "deals": [5, 6] }));
        assert_eq!(
            (&answer["code"], &answer["data"]),
            (&json!("no_active_thread"), &Value::Null),
            "{answer}"
        );
        assert_eq!(list(&answer["results"]).len(), 2);
        assert_eq!(answer["error"].as_str().expect("a text").lines().count(), 2, "{answer}");
    }),
    ("returns no end of the run", |stage| {
        let status = stage.server.get("/game-status");
        assert_eq!((&status["total_days"], &status["ended"]), (&json!(28), &Value::Null), "{status}");
    }),
    ("restarts the engine", |stage| {
        assert_eq!(stage.server.post("/reinitialize", &json!({})).0, 404);
    }),
];

/// Starts a server of a new run with the interface of release 2, and calls `example` with its folders.
fn with_release_2_server(example: impl FnOnce(&Home, Server)) {
    let home = Home::new();
    let server = Server::start(&home, &release_2_options());
    example(&home, server);
}

/// Returns a request for a week with an id.
fn week_with_id(rationale: &str, id: &str) -> Value {
    json!({ "rationale": rationale, "predictions": predictions(), "request_id": id })
}

const RELEASE_2_EXAMPLES: [Example; 5] = [
    ("loses the game if its server ends", |_| {
        with_release_2_server(|home, server| {
            let week = week_with_id("on", "w");
            let first = server.post("/next-week", &week);
            drop(server);
            // The server is killed directly after it recorded the request.
            let file = home.only_run().join("trajectory.jsonl");
            let text = std::fs::read_to_string(&file).expect("a trajectory");
            let at = text.find("\"kind\":\"advance\"").expect("a week");
            let end = at + text[at..].find('\n').expect("its end") + 1;
            std::fs::write(&file, &text[..end]).expect("a file");
            let _ = std::fs::remove_file(home.only_run().join("snapshot.bin"));
            std::fs::remove_file(home.only_run().join("world.db")).expect("a database");
            let server = Server::start(home, &["--run", "latest"]);
            assert_eq!(server.get("/requests/w")["status"], "completed");
            assert_eq!(server.post("/next-week", &week), first);
        });
    }),
    ("shows no dashboard after", |_| {
        with_release_2_server(|home, server| {
            let (_, week) = server.post("/next-week", &week_with_id("on", "w"));
            drop(server);
            let server = Server::start(home, &["--run", "latest"]);
            assert_eq!(server.get("/dashboard"), json!({ "dashboard": week["dashboard"], "day": 7 }));
        });
    }),
    ("answers a body that is not JSON", |_| {
        with_release_2_server(|_, server| {
            let (status, answer) = server.request_with_head("POST", "/call", "host: localhost\r\n", "{");
            assert_eq!((status, &answer["error"]), (400, &json!("invalid_request_payload")), "{answer}");
        });
    }),
    ("checks the rationale and the forecasts", |_| {
        with_release_2_server(|_, server| {
            let (status, answer) = server.post("/next-week", &json!({}));
            assert_eq!((status, &answer["error"]), (200, &json!("request_id_required")), "{answer}");
            let (status, answer) = server.post("/next-week", &week_with_id("", "w"));
            assert_eq!((status, &answer["code"]), (400, &json!("rationale_missing")), "{answer}");
        });
    }),
    ("lists the changing requests", |_| {
        with_release_2_server(|home, server| {
            server.post("/next-week", &week_with_id("on", "first-week"));
            let file = home.only_run().join("trajectory.jsonl");
            let text = std::fs::read_to_string(file).expect("a trajectory");
            assert_contains(&text, &["\"request_id\":\"first-week\""]);
        });
    }),
];

const TIME_EXAMPLES: [Example; 2] = [
    ("continues after its last day", |stage| {
        let answers = stage.play(&["--days", "8"], "next naive\nnext naive\nset_prices A=5\nnext naive\n");
        assert_eq!((&answers[2]["data"]["day"], &answers[2]["data"]["days_run"]), (&json!(8), &json!(1)));
        assert!(answers[3..5].iter().all(|answer| answer["code"] == "run_over"), "{answers:?}");
    }),
    ("forgets discounts", |_| {
        let home = Home::new();
        assert_eq!(
            home.play(&["--days", "28"], "set_promotion global_promotion=3\nnext naive\n").exit_code,
            0
        );
        let again = home.play(&["--json", "--run", "latest"], "set_promotion\n").json_lines();
        assert_eq!(again[1]["data"]["global"], 3.0, "{}", again[1]);
    }),
];

const QUERY_EXAMPLES: [Example; 9] = [
    ("removes hidden columns", |stage| {
        for sql in ["SELECT c_max AS x FROM customers", "SELECT AVG(c_max) FROM customers"] {
            assert_eq!(stage.query(sql)["code"], "sql_error", "{sql}");
        }
    }),
    ("rejects a statement that has", |stage| {
        assert_eq!(stage.query("SELECT 'events' AS x")["rows"], json!([{ "x": "events" }]));
        assert_eq!(stage.query("SELECT 'pragma' AS x")["rows"], json!([{ "x": "pragma" }]));
    }),
    ("runs statements that write", |stage| {
        let with = "WITH x AS (SELECT 1) DELETE FROM predictions";
        for sql in ["REPLACE INTO predictions (submit_day) VALUES (1)", with, "ATTACH 'x.db' AS x"] {
            assert_eq!(stage.query(sql)["code"], "sql_write", "{sql}");
        }
    }),
    ("shows seven tables", |stage| {
        let tables = [
            "_hidden_quality_snapshot",
            "_hidden_group_params_history",
            "_hidden_satisfaction_snapshot",
            "_hidden_lead_multiplier_snapshot",
            "group_insight_snapshots",
            "global_drift_state",
            "_rng_states",
        ];
        for table in tables {
            assert_eq!(stage.query(&format!("SELECT * FROM {table}"))["code"], "sql_hidden_table", "{table}");
        }
    }),
    ("drops `seat_count`", |stage| {
        let joined = "SELECT s.seat_count FROM subscriptions s JOIN customers c USING (customer_id)";
        assert_eq!(columns(&stage.query(joined)), ["seat_count"]);
    }),
    ("shows `effect_by_group`", |stage| {
        let shown = stage.query("SELECT * FROM agent_social_media_posts");
        let hidden = ["effect_by_group", "views_by_group", "reasoning_by_group"];
        assert!(columns(&shown).iter().all(|column| !hidden.contains(column)), "{shown}");
    }),
    ("shows `source_group_id`", |stage| {
        let shown = stage.query("SELECT * FROM social_media_posts");
        assert!(!columns(&shown).contains(&"source_group_id"), "{shown}");
        assert!(stage.last_response_data("get_social_posts")["posts"][0].get("source_group_id").is_some());
    }),
    ("reports `plan = 'A'` in", |stage| {
        let of_plan = stage.query("SELECT * FROM subscriptions WHERE plan = 'A'");
        assert_eq!((&of_plan["row_count"], &of_plan["hint"]), (&json!(0), &Value::Null), "{of_plan}");
        assert!(stage.query("SELECT * FROM subscriptions WHERE plan = 'D'")["hint"].is_string());
    }),
    ("returns the first of two columns", |stage| {
        assert_eq!(stage.query("SELECT 1 AS x, 2 AS x")["rows"], json!([{ "x": 1, "x:2": 2 }]));
    }),
];

const DASHBOARD_EXAMPLES: [Example; 5] = [
    ("has its own layout", |stage| {
        let shown = ["Cash Change:", "Recurring Revenue:", "Payments:", "Running Costs:", "Enterprise Lost:"];
        assert_contains(stage.dashboard(), &shown);
    }),
    ("rounds prices to dollars", |stage| {
        assert_contains(
            stage.dashboard(),
            &["Prices: A $12 | B $22.50 | C $40", "dev $90,000/day, ads $3,300/day"],
        );
    }),
    ("counts only threads", |stage| {
        let weeks = stage.responses.iter().filter(|answer| answer["command"] == "next");
        let first = weeks.map(|week| week["data"]["dashboard"].as_str().expect("a dashboard")).next();
        assert_contains(first.expect("a week"), &["1 awaiting your response; the first is lost in"]);
    }),
    ("never lists posts of the company", |stage| {
        let weeks = stage.responses.iter().filter(|answer| answer["command"] == "next");
        let listed = weeks.filter(|week| week["data"]["dashboard"].to_string().contains("Your posts"));
        assert_eq!(listed.count(), 1);
    }),
    ("lists daily calculations", |stage| {
        assert_contains(stage.dashboard(), &["--- Weekly Calculations ---\ncash:\n"])
    }),
];

const DOCUMENT_EXAMPLES: [Example; 4] = [
    ("has tool documents", |stage| {
        let manual = stage.data("get_tool_documentation", json!({ "tool_names": ["all"] }));
        let (support, development) = (&manual["set_targeted_ops_spend"], &manual["set_targeted_dev_spend"]);
        assert_contains(&support.to_string(), &["0.6 per day and dollar", "0.1 for enterprises"]);
        assert_contains(&development.to_string(), &["0.0225 ln(1 + spend / 5000)"]);
    }),
    ("has posts, messages and notifications", |stage| {
        assert!(
            stage.last_response_data("get_social_posts")["posts"][0]["content"]
                .as_str()
                .is_some_and(|text| text.len() > 9)
        );
    }),
    ("draws from PCG64 streams", |stage| {
        let attempts = || stage.play(&["--seed", "3"], &"research_market\n".repeat(9));
        let found =
            |answers: &[Value]| answers[1..10].iter().map(|one| one["data"].clone()).collect::<Vec<_>>();
        assert_eq!(found(&attempts()), found(&attempts()));
    }),
    ("takes the [errors of insights]", |stage| {
        let budget = |scenario: &str, seed: &str| {
            let answers = stage.play(&["--scenario", scenario, "--seed", seed], "get_group_insights S1\n");
            answers[1]["data"]["estimates"]["willingness_to_pay"].as_f64().expect("a number")
        };
        assert_eq!([budget("reference-seed42", "1"), budget("reference-seed42", "2")], [25.87; 2]);
        assert_ne!(budget("default", "1"), budget("default", "2"));
    }),
];

/// Returns the rows and bullets of the page: the text of the first cell or of the bullet.
fn documented_differences() -> Vec<String> {
    let page = Path::new(env!("CARGO_MANIFEST_DIR")).join("docs/known-differences.md");
    let page = std::fs::read_to_string(page).expect("the page");
    let line = |line: &str| {
        let row = line.strip_prefix("| ").map(|row| row.split(" | ").next().unwrap_or_default());
        let text = row.or_else(|| line.strip_prefix("- "))?;
        (!["what", "the release"].contains(&text)).then(|| text.to_owned())
    };
    page.lines().filter_map(line).collect()
}

#[test]
fn every_known_difference_has_a_passing_example() {
    let examples = [
        &INSTRUCTION_EXAMPLES[..],
        &PLAYER_INFORMATION_EXAMPLES,
        &PLAYER_ACTION_EXAMPLES,
        &AGENT_ACTION_EXAMPLES,
        &CALL_EXAMPLES,
        &RELEASE_2_EXAMPLES,
        &TIME_EXAMPLES,
        &QUERY_EXAMPLES,
        &DASHBOARD_EXAMPLES,
        &DOCUMENT_EXAMPLES,
    ];
    let examples: Vec<&Example> = examples.into_iter().flatten().collect();
    let lines = documented_differences();
    for line in &lines {
        let matching = examples.iter().filter(|(beginning, _)| line.starts_with(beginning));
        assert_eq!(matching.count(), 1, "a line of the page has no example, or several: {line}");
    }
    assert_eq!(lines.len(), examples.len(), "an example has no line on the page");
    let stage = Fixture::new();
    for (beginning, example) in examples {
        println!("{beginning}");
        example(&stage);
    }
}

#[test]
fn responses_have_the_released_form() {
    let stage = Fixture::new();
    let prices = stage.data("set_prices", json!({ "A": 12 }));
    assert_eq!(prices.to_string(), r#"{"updated":{"A":12},"current":{"A":12,"B":0.0,"C":0.0}}"#);
    let quotas = stage.data("set_usage_quotas", json!({ "A": 60.0, "B": 70, "C": 0.5 }));
    assert_eq!(quotas.to_string(), r#"{"quotas":{"A":60.0,"B":70,"C":0.5}}"#);
    let discounts = stage.data("set_promotion", json!({ "by_group": {"S2": 4}, "by_customer": {"7": 1} }));
    let form = r#"{"global":0.0,"by_group":{"S2":4.0},"by_customer":{"7":1.0},"by_group_plan":{}}"#;
    assert_eq!(discounts.to_string(), form);
    let spend = stage.data("set_daily_spend", json!({ "operations": 350 }));
    assert_eq!(spend["current"].to_string(), r#"{"operations":350,"development":0.0}"#);
    let ads = stage.data("set_targeted_ad_spend", json!({ "search_ads": {"S1": 80, "S3": 40} }));
    assert_eq!(ads["total_per_day"].to_string(), "120");
    assert_contains(
        stage.data("get_cost_info", json!({}))["note"].as_str().expect("a note"),
        &["1 unit = 1K", "tier 4 = 1.0×"],
    );
    for tool in ["describe_tables", "get_tool_documentation"] {
        let name = if tool == "describe_tables" { "table_names" } else { "tool_names" };
        assert_eq!(stage.data(tool, json!({ name: ["all"] })), stage.data(tool, json!({})), "{tool}");
    }
    // Arguments of targeted operations without a name are the map by group.
    stage.data("set_targeted_ops_spend", json!({ "by_group": {"S1": 5}, "by_plan": {"A": 10} }));
    let cleared = stage.data("set_targeted_ops_spend", json!({}));
    assert_eq!((&cleared["by_group"], &cleared["by_plan"]["A"]), (&json!({}), &json!(10.0)));
    // Keys are checked before values. Maps by customer are checked entry by entry.
    stage.assert_rejected("set_promotion", json!({ "by_group": {"S1": -1, "S9": 5} }), "unknown_group");
    stage.assert_rejected("set_promotion", json!({ "by_customer": {"1": -1, "x": 5} }), "promotion_negative");
    let refused = stage.call("reject_enterprise_deal", json!({ "deals": [5, 6] }));
    assert_eq!(refused["error"], "customer 5: no active thread\ncustomer 6: no active thread");
    let one = stage.call("reject_enterprise_deal", json!({ "deals": [5] }));
    assert_ne!(one["error"], "customer 5: no active thread", "a single deal has the full message");
}

#[test]
fn game_status_counts_every_active_subscription() {
    let home = Fixture::new().home;
    let server = Server::start(&home, &["--run", "latest"]);
    let count = |rest: &str| {
        let sql = format!("SELECT count(*) AS n FROM subscriptions WHERE status = 'subscribed' {rest}");
        server.post("/query", &json!({ "sql": sql })).1["rows"][0]["n"].as_u64().expect("a number")
    };
    let companies = "AND customer_id IN (SELECT customer_id FROM customers WHERE customer_type = 'large')";
    assert!(count(companies) > 0, "the run has enterprises");
    assert_eq!(server.get("/game-status")["subscribers"], count(""));
}
