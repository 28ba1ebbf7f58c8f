//! Copied lines of branches, and submitted forecasts.

use novamind::record::mode::Mode;
use novamind::record::trajectory::Trajectory;
use novamind::session::{Access, Session, Storage};
use serde_json::json;

use super::create;
use crate::support::company::{call, numbers, week};
use crate::support::home::Home;

#[test]
fn a_branch_leaves_out_what_was_decided_on_the_day_it_begins() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut parent = create(Storage::Runs(folder.path().to_owned()), &[]);
    let mut at_the_beginning = Vec::new();
    // Another price on the first day of each week.
    for number in 1..=4 {
        at_the_beginning.push((number, parent.company().current("set_prices"), parent.state_hash().1));
        call(&mut parent, "set_prices", json!({"A": 10 + number, "B": 30 - number}));
        call(&mut parent, "set_capacity_tier", json!({"tier": number}));
        week(&mut parent);
    }
    for (number, prices, parts) in at_the_beginning {
        let branch = parent.branch(number, Mode::Sandbox).expect("a branch");
        assert_eq!(branch.day(), 7 * (number - 1));
        assert_eq!(branch.company().current("set_prices"), prices, "week {number}");
        assert!(branch.company().changes().is_empty(), "nothing is decided yet in week {number}");
        for (part, hash) in &branch.state_hash().1 {
            // The hash of the facts includes the calls of the week, which the branch does not have.
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

const TWELVE: [[f64; 3]; 4] = [
    [990_001.0, 980_002.0, 995_003.0],
    [960_004.0, 930_005.0, 985_006.0],
    [900_007.0, 800_008.0, 1_000_009.0],
    [890_010.0, 500_011.0, 1_500_012.0],
];

#[test]
fn twelve_numbers_of_plain_mode_stand_where_they_belong() {
    let home = Home::new();
    let list: Vec<String> = TWELVE.iter().flatten().map(f64::to_string).collect();
    let said = home.play(&["--seed", "7", "--days", "28"], &format!("next \"why\" {}\n", list.join(" ")));
    assert_eq!(said.code, 0, "{}{}", said.out, said.err);
    let mut session = Session::open(&home.only_run(), Access::Read, true).expect("it opens");
    let sql =
        "SELECT horizon_days, predicted_value, predicted_lower, predicted_upper FROM predictions ORDER BY 1";
    let expected: Vec<Vec<f64>> = [7.0, 28.0, 84.0, 182.0]
        .into_iter()
        .zip(TWELVE)
        .map(|(days, [point, lower, upper])| vec![days, point, lower, upper])
        .collect();
    assert_eq!(numbers(&mut session, sql), expected);
}
