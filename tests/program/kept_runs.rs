//! `novamind lab metrics` and `novamind lab diff`: hidden figures of saved runs that may be inspected.

use crate::support::home::Home;

/// Plays and saves a run of the policy P0, and returns the figures that were written during play.
fn save_policy_run(home: &Home, seed: &str) -> String {
    let file = home.0.path().join(format!("{seed}.csv"));
    let path = file.to_str().expect("a path");
    let program_output =
        home.run(&["run", "--policy", "P0", "--seed", seed, "--days", "28", "--save", "--metrics", path]);
    assert_eq!(program_output.exit_code, 0, "{}", program_output.stderr);
    std::fs::read_to_string(file).expect("figures")
}

#[test]
fn metrics_of_a_saved_run_match_metrics_written_during_play() {
    let home = Home::new();
    let live = save_policy_run(&home, "3");
    let program_output = home.run(&["lab", "metrics", "latest"]);
    assert_eq!((program_output.exit_code, program_output.stderr.as_str()), (0, ""));
    assert!(program_output.stdout == live, "{} and {} bytes", program_output.stdout.len(), live.len());
    // The inspection is recorded, and the run can still be verified.
    assert_eq!(home.run(&["replay", "latest", "--verify"]).exit_code, 0);
}

#[test]
fn lab_diff_compares_two_saved_runs() {
    let home = Home::new();
    save_policy_run(&home, "3");
    save_policy_run(&home, "4");
    let runs: Vec<String> = std::fs::read_dir(home.runs())
        .expect("a folder")
        .map(|entry| entry.expect("an entry").file_name().to_string_lossy().into_owned())
        .filter(|name| name.len() == 8)
        .collect();
    let [one, other] = &runs[..] else { panic!("{runs:?}") };
    let program_output = home.run(&["lab", "diff", one, other]);
    assert_eq!(program_output.exit_code, 0, "{}", program_output.stderr);
    assert!(
        program_output.stdout.starts_with("the runs differ from day 1\nday 1\ndiffers: "),
        "{}",
        program_output.stdout
    );
    let output = home.run(&["lab", "diff", one, other, "28", "--json"]);
    let value: serde_json::Value = serde_json::from_str(&output.stdout).expect("JSON");
    assert_eq!((&value["first_day"], &value["day"]), (&1.into(), &28.into()));
    for arguments in
        [&["lab", "diff", one, one][..], &["lab", "diff", one, other, "29"], &["lab", "diff", one]]
    {
        assert_ne!(home.run(arguments).exit_code, 0, "{arguments:?}");
    }
}

#[test]
fn unfinished_sandbox_cannot_be_inspected() {
    let home = Home::new();
    home.play_two_weeks();
    for arguments in [
        &["lab", "metrics", "latest"][..],
        &["lab", "diff", "latest", "latest"],
        &["replay", "latest", "--xray"],
        &["replay", "latest", "--xray", "--week", "1"],
    ] {
        let program_output = home.run(arguments);
        assert_ne!(program_output.exit_code, 0);
        assert!(
            program_output.stderr.contains("debug runs and in runs that have ended"),
            "{}",
            program_output.stderr
        );
        assert_eq!(program_output.stdout, "");
    }
}

#[test]
fn why_shows_causes_without_hidden_state() {
    let lines = "set_prices A=12 B=25 C=55\nset_model_tiers A=2 B=3 C=4\nset_usage_quotas A=60000 B=250000 C=1200000\n\
                 set_targeted_ad_spend {\"search_ads\": {\"S1\": 9000}}\nnext \"on\" naive\nnext \"on\" naive\nset_prices A=40\nnext \"on\" naive\nreport\n\
                 why new_subscribers(S1) 3\nwhy reputation(S1)\nwhy chrun(S1)\nwhy\n";
    for mode in ["debug", "sandbox", "baseline"] {
        let home = Home::new();
        let mut options = vec!["--mode", mode, "--seed", "7", "--echo"];
        options.extend(if mode == "baseline" { &["--participant", "P01"][..] } else { &["--days", "84"] });
        let program_output = home.play(&options, lines);
        let [played, answers @ ..] = &program_output.stdout.split("> why ").collect::<Vec<_>>()[..] else {
            panic!("{}", program_output.stdout)
        };
        // The weekly report lists settings and changes without causes.
        let (_, report) = played.split_once("> report").expect("a report");
        assert!(report.contains("decisions before the week: price A: 12 → 40 $/month"), "{report}");
        for word in ["because", "due to", "cause", "may be", "led to", "thanks to", "blame"] {
            assert!(!report.contains(word), "{word}: {report}");
        }
        let trajectory = std::fs::read_to_string(home.only_run().join("trajectory.jsonl")).expect("lines");
        let looks: Vec<&str> = trajectory.lines().filter(|line| line.contains("\"kind\":\"xray\"")).collect();
        if mode == "baseline" {
            let refused = answers.iter().all(|answer| {
                answer.contains("refused not_in_this_mode: \"why\" and \"whatif\" are not available")
            });
            assert!(refused && looks.is_empty(), "{}", program_output.stdout);
            continue;
        }
        assert!(answers[0].contains("new subscribers of S1, week 3: "), "{}", program_output.stdout);
        assert!(answers[0].contains("price"), "{}", program_output.stdout);
        assert!(
            answers[2].contains("there is no figure chrun; did you mean churn"),
            "{}",
            program_output.stdout
        );
        assert!(
            program_output.stdout.contains("\"why\" needs a figure: cash_change"),
            "{}",
            program_output.stdout
        );
        let mood = answers[1];
        if mode == "debug" {
            assert!(mood.contains("reputation of S1, week 3: "), "{mood}");
            assert!(looks.len() == 1 && looks[0].contains("\"which\":\"reputation(S1)\""), "{looks:?}");
        } else {
            assert!(
                mood.contains(
                    "refused not_in_this_mode (figure): reputation of S1 is hidden in unfinished runs"
                ),
                "{mood}"
            );
            assert!(looks.is_empty(), "{looks:?}");
        }
    }
}

#[test]
fn replay_on_the_xray_screen_requires_a_terminal() {
    let home = Home::new();
    save_policy_run(&home, "3");
    let program_output = home.run(&["replay", "latest", "--xray"]);
    assert_eq!(program_output.exit_code, 2, "{}", program_output.stderr);
    assert!(program_output.stderr.contains("a replay needs a terminal"), "{}", program_output.stderr);
    assert_eq!(home.run(&["replay", "latest", "--xray", "--verify"]).exit_code, 2);
}
