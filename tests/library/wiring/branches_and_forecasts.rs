//! Lines that branches copy, and the order of submitted forecasts.

use novamind::record::mode::Mode;
use novamind::record::trajectory::Trajectory;
use novamind::session::{Access, Session, Storage};
use serde_json::json;

use super::create;
use crate::support::company::{advance_week, call_tool, query_numbers};
use crate::support::home::Home;

#[test]
fn branch_excludes_decisions_of_its_first_day() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut parent = create(Storage::Runs(folder.path().to_owned()), &[]);
    let mut at_the_beginning = Vec::new();
    // Sets a different price on the first day of each week.
    for number in 1..=4 {
        at_the_beginning.push((
            number,
            parent.company().current_arguments("set_prices"),
            parent.state_hash().1,
        ));
        call_tool(&mut parent, "set_prices", json!({"A": 10 + number, "B": 30 - number}));
        call_tool(&mut parent, "set_capacity_tier", json!({"tier": number}));
        advance_week(&mut parent);
    }
    for (number, prices, parts) in at_the_beginning {
        let branch = parent.branch(number, Mode::Sandbox).expect("a branch");
        assert_eq!(branch.day(), 7 * (number - 1));
        assert_eq!(branch.company().current_arguments("set_prices"), prices, "week {number}");
        assert!(branch.company().setting_changes().is_empty(), "nothing is decided yet in week {number}");
        for (part, hash) in &branch.state_hash().1 {
            // The hash of the facts includes the calls of the week, which the branch does not contain.
            if *part != "facts" {
                assert_eq!(hash, &parts[part], "{part} at the beginning of week {number}");
            }
        }
        let path = branch.folder().expect("a folder").join("trajectory.jsonl");
        let lines = Trajectory::read(&path).expect("it reads").lines;
        let calls = lines.iter().filter(|line| line.record.accepted_call().is_some()).count();
        assert_eq!(calls, 2 * (number as usize - 1), "calls of the weeks before week {number}");
    }
}

const TWELVE_NUMBERS: [[f64; 3]; 4] = [
    [990_001.0, 980_002.0, 995_003.0],
    [960_004.0, 930_005.0, 985_006.0],
    [900_007.0, 800_008.0, 1_000_009.0],
    [890_010.0, 500_011.0, 1_500_012.0],
];

#[test]
fn plain_mode_forecast_numbers_are_in_order() {
    let home = Home::new();
    let list: Vec<String> = TWELVE_NUMBERS.iter().flatten().map(f64::to_string).collect();
    let program_output =
        home.play(&["--seed", "7", "--days", "28"], &format!("next \"why\" {}\n", list.join(" ")));
    assert_eq!(program_output.exit_code, 0, "{}{}", program_output.stdout, program_output.stderr);
    let mut session = Session::open(&home.only_run(), Access::Read, true).expect("it opens");
    let sql =
        "SELECT horizon_days, predicted_value, predicted_lower, predicted_upper FROM predictions ORDER BY 1";
    let expected: Vec<Vec<f64>> = [7.0, 28.0, 84.0, 182.0]
        .into_iter()
        .zip(TWELVE_NUMBERS)
        .map(|(days, [point, lower, upper])| vec![days, point, lower, upper])
        .collect();
    assert_eq!(query_numbers(&mut session, sql), expected);
}
