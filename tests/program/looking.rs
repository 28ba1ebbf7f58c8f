//! `novamind lab metrics` and `novamind lab diff`: what is hidden of runs that may be looked into, and of no others.

use crate::support::home::Home;

/// Runs of the policy P0, kept; the figures that were written meanwhile.
fn kept(home: &Home, seed: &str) -> String {
    let file = home.0.path().join(format!("{seed}.csv"));
    let path = file.to_str().expect("a path");
    let said =
        home.run(&["run", "--policy", "P0", "--seed", seed, "--days", "28", "--save", "--metrics", path]);
    assert_eq!(said.code, 0, "{}", said.err);
    std::fs::read_to_string(file).expect("figures")
}

#[test]
fn figures_of_a_kept_run_are_those_that_were_written_when_it_ran() {
    let home = Home::new();
    let live = kept(&home, "3");
    let said = home.run(&["lab", "metrics", "latest"]);
    assert_eq!((said.code, said.err.as_str()), (0, ""));
    assert!(said.out == live, "{} and {} bytes", said.out.len(), live.len());
    // Looking is recorded, and the run verifies.
    assert_eq!(home.run(&["replay", "latest", "--verify"]).code, 0);
}

#[test]
fn two_kept_runs_are_held_against_each_other() {
    let home = Home::new();
    kept(&home, "3");
    kept(&home, "4");
    let runs: Vec<String> = std::fs::read_dir(home.runs())
        .expect("a folder")
        .map(|entry| entry.expect("an entry").file_name().to_string_lossy().into_owned())
        .filter(|name| name.len() == 8)
        .collect();
    let [one, other] = &runs[..] else { panic!("{runs:?}") };
    let said = home.run(&["lab", "diff", one, other]);
    assert_eq!(said.code, 0, "{}", said.err);
    assert!(said.out.starts_with("the runs differ from day 1 on\nday 1\ndiffers: "), "{}", said.out);
    let said = home.run(&["lab", "diff", one, other, "28", "--json"]);
    let told: serde_json::Value = serde_json::from_str(&said.out).expect("JSON");
    assert_eq!((&told["first_day"], &told["day"]), (&1.into(), &28.into()));
    for arguments in
        [&["lab", "diff", one, one][..], &["lab", "diff", one, other, "29"], &["lab", "diff", one]]
    {
        assert_ne!(home.run(arguments).code, 0, "{arguments:?}");
    }
}

#[test]
fn an_unfinished_sandbox_is_not_looked_into() {
    let home = Home::new();
    home.two_weeks();
    for arguments in [&["lab", "metrics", "latest"][..], &["lab", "diff", "latest", "latest"]] {
        let said = home.run(arguments);
        assert_ne!(said.code, 0);
        assert!(said.err.contains("debug runs and in runs that are over"), "{}", said.err);
        assert_eq!(said.out, "");
    }
}
