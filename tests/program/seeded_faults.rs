//! The documented answers to the seeded faults: the program shows every first difference and every figure of the page.

use crate::support::home::{Home, ProgramOutput};

const WALKTHROUGH_PAGE: &str = include_str!("../../docs/debugging-walkthrough.md");
const ANSWERS_PAGE: &str = include_str!("../../docs/debugging-answers.md");

/// A row of the page: the number of the fault, its first difference, the commands that show the fault, and their output.
struct AnswerRow {
    number: String,
    first: String,
    commands: Vec<String>,
    shown: String,
}

fn answer_rows() -> Vec<AnswerRow> {
    let of = |line: &str| {
        let cells: Vec<&str> = line.split('|').map(str::trim).collect();
        let [_, number, _, _, first, shows, _] = cells[..] else { panic!("{line}") };
        let (asked, shown) = shows.split_once(": ").unwrap_or_else(|| panic!("{line}"));
        AnswerRow {
            number: number.to_owned(),
            first: first.to_owned(),
            commands: asked.split('`').skip(1).step_by(2).map(str::to_owned).collect(),
            shown: shown.to_owned(),
        }
    };
    let is_row =
        |line: &&str| line.trim_start_matches("| ").starts_with(|first: char| first.is_ascii_digit());
    ANSWERS_PAGE.lines().filter(is_row).map(of).collect()
}

/// Returns the commands of the walkthrough in the documentation.
fn walkthrough_decisions() -> String {
    let from = WALKTHROUGH_PAGE.find("set_prices {").expect("decisions");
    WALKTHROUGH_PAGE[from..].split("```").next().expect("their end").to_owned()
}

/// Returns the decimal figures in a text.
fn figures(text: &str) -> Vec<&str> {
    let words = text.split(|letter: char| letter.is_whitespace() || ",;:`()".contains(letter));
    let clean = words.map(|word| word.trim_matches(|letter| "+-.$".contains(letter)));
    let is_figure = |word: &&str| {
        word.contains('.')
            && word.starts_with(|first: char| first.is_ascii_digit())
            && word.parse::<f64>().is_ok()
    };
    clean.filter(is_figure).collect()
}

fn play(home: &Home, planted: Option<&str>) -> String {
    let mut options = vec!["--seed", "7", "--mode", "debug", "--days", "200"];
    options.extend(planted.into_iter().flat_map(|number| ["--planted", number]));
    let program_output = home.play(&options, &walkthrough_decisions());
    assert_eq!(program_output.exit_code, 0, "{}", program_output.stderr);
    // The output starts with `run 02fe6680 · seed 7 · …`.
    program_output.stdout.split_whitespace().nth(1).expect("the name of the run").to_owned()
}

fn run_commands(home: &Home, run: &str, commands: &[String]) -> String {
    let ProgramOutput { stdout: out, stderr: err, .. } = home.play(&["--run", run], &commands.join("\n"));
    assert!(!err.contains("refused") && !out.contains("did you mean"), "{commands:?}: {out}{err}");
    out
}

#[test]
#[ignore = "slow: .ci/full runs it"]
fn debugging_answers_match_the_program() {
    let home = Home::new();
    let sound = play(&home, None);
    let all = answer_rows();
    assert_eq!(all.len(), 10);
    for row in all {
        let faulty = play(&home, Some(&row.number));
        let diff = home.run(&["lab", "diff", &sound, &faulty]).stdout;
        let (day, what) = row.first.split_once(',').unwrap_or((&row.first, ""));
        match day.strip_prefix("day ") {
            Some(day) => {
                assert!(
                    diff.starts_with(&format!("the runs differ from day {day}")),
                    "{}: {diff}",
                    row.number
                );
                let named = what.trim().split(' ').next().unwrap_or_default();
                assert!(diff.contains(named), "{}: {what}: {diff}", row.number);
            }
            None => assert!(diff.starts_with("the runs are identical"), "{}: {diff}", row.number),
        }
        let shown = run_commands(&home, &faulty, &row.commands);
        // The page also lists figures of the run without the fault. These figures are not compared if a command
        // simulates further days.
        let simulates_days = row.commands.iter().any(|line| line.starts_with("run "));
        let sound_output =
            if simulates_days { String::new() } else { run_commands(&home, &sound, &row.commands) };
        let texts = figures(&row.shown);
        assert!(!texts.is_empty(), "{}: {}", row.number, row.shown);
        for figure in texts {
            assert!(
                shown.contains(figure) || sound_output.contains(figure),
                "{}: {figure} in {shown}",
                row.number
            );
        }
    }
}
