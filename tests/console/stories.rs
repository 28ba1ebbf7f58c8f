//! Complete stories of users.

use novamind::record::folder::configuration::Configuration;
use novamind::record::folder::runs::list_runs;
use novamind::session::verify;

use super::harness::Console;

/// Sets initial prices, tiers, quotas and budgets in the forms.
fn open_shop(console: &mut Console) {
    console.press("8 enter enter '12' down '25' down '55' enter ctrl-s");
    console.press("down enter enter '1' down '2' down '4' enter ctrl-s");
    console.press("down enter enter '60k' down '250k' down '1.2M' enter ctrl-s");
    console.press("down down enter enter '200' down '200' enter ctrl-s");
    console.press("down enter down down down enter '750' enter ctrl-s");
}

#[test]
fn a_newcomer_plays_two_weeks_leaves_and_comes_back() {
    let runs = tempfile::tempdir().expect("a folder");
    let mut console = Console::start(runs.path(), (120, 40));
    console.shows("New run");
    console.press("n enter");
    console.shows("day 0/500");
    console.shows("no plan has a price: no one");
    open_shop(&mut console);
    console.shows("Tools ●11");
    console.press("c");
    for line in ["price A", "0 → 12", "quota C", "ads content_marketing S1", "0 → 750"] {
        console.shows(line);
    }
    console.press("esc");
    console.week();
    console.shows("Most unusual changes");
    console.press("esc");
    console.week();
    console.press("esc 1");
    console.shows("day 14/500");
    console.press("0");
    console.shows("test");
    console.press("q");
    assert_eq!(console.left.as_ref().map(|(code, _)| *code), Some(0));
    drop(console);
    let mut console = Console::start(runs.path(), (120, 40));
    console.shows("Continue");
    console.shows("day 14 of 500");
    console.press("c");
    console.shows("day 14/500");
    console.press("q");
    drop(console);
    let run = &list_runs(runs.path()).expect("a list")[0];
    assert_eq!(verify(&runs.path().join(&run.id)).expect("an intact run").day, 14);
}

#[test]
fn a_short_run_ends_on_the_final_page() {
    let runs = tempfile::tempdir().expect("a folder");
    let mut console = Console::start(runs.path(), (100, 30));
    console.press("n up up up '17' down down down enter");
    console.shows("day 0/17");
    for _ in 0..3 {
        console.week();
        console.press("esc");
    }
    console.press("n");
    console.shows("Day 17. You end with $998,555.");
    console.shows("not ranked");
    console.shows("planning words");
    console.press("r");
    let id = console.app.run().expect("a run").company.seen.run.clone();
    for (name, begins) in [("report.md", "# NovaMind · run "), ("report.html", "<!DOCTYPE html>")] {
        let report = std::fs::read_to_string(runs.path().join(&id).join(name)).expect("a report");
        assert!(report.starts_with(begins) && report.contains("You end with $998,555."), "{name}");
    }
    console.press("enter down enter");
    console.shows("finished");
}

#[test]
fn the_palette_writes_the_report_of_a_run_that_goes_on() {
    let runs = tempfile::tempdir().expect("a folder");
    let mut console = Console::in_new_run(runs.path(), (80, 24));
    console.week();
    console.press("esc : 'write_the_report'");
    console.shows("Write the report of the run");
    console.press("enter");
    let id = console.app.run().expect("a run").company.seen.run.clone();
    let report = std::fs::read_to_string(runs.path().join(id).join("report.md")).expect("a report");
    assert!(report.contains("**Day 7 of 500. Cash is $") && report.contains("“test”"), "{report}");
}

#[test]
fn a_week_is_not_filed_without_a_reason_and_four_forecasts() {
    let runs = tempfile::tempdir().expect("a folder");
    let mut console = Console::in_new_run(runs.path(), (100, 30));
    console.press("n enter enter");
    console.shows("a rationale is required");
    console.press("'why_not' enter enter");
    console.shows("1 week: enter a number");
    console.press("'5' tab '4' tab '9' enter ctrl-s");
    console.shows("the point is not between low and high");
    console.press("esc q");
    console.shows("unsent");
    console.press("esc n enter");
    console.shows("why not");
    console.press("enter '6' enter f enter");
    console.shows("Most unusual changes");
}

#[test]
fn what_is_set_can_be_taken_back_and_the_zero_of_the_start_cannot() {
    let runs = tempfile::tempdir().expect("a folder");
    let mut console = Console::in_new_run(runs.path(), (120, 40));
    console.press("8 down down down down enter enter '300' enter ctrl-s");
    console.shows("set_daily_spend: done");
    console.press("u");
    console.shows("undone: operations");
    console.press("u");
    console.shows("! ");
    console.press("esc home enter enter '12' enter ctrl-s u");
    console.shows("a price cannot be set to 0");
}

#[test]
fn a_purchase_asks_once_and_a_refusal_stands_at_its_cell() {
    let runs = tempfile::tempdir().expect("a folder");
    let mut console = Console::in_new_run(runs.path(), (120, 40));
    console.press(": 'start_res' enter enter '1' enter ctrl-s");
    console.shows("cannot be undone");
    console.press("enter");
    console.shows("$1,000,000");
    console.press("ctrl-s y");
    console.shows("start_research_project: done");
    console.press("enter enter '1' enter");
    console.shows("tier 1 is already running");
    console.press("y");
    assert_eq!(console.copied, [r#"research.start_research_project({"tier": 1})"#]);
}

#[test]
fn everything_is_found_in_the_palette() {
    let runs = tempfile::tempdir().expect("a folder");
    let mut console = Console::in_new_run(runs.path(), (120, 40));
    console.press(": 'ledger'");
    console.shows("table");
    console.press("enter");
    console.shows("SELECT * FROM ledger LIMIT 100");
    console.press("esc : 'prices' enter");
    console.shows("set_prices · pricing");
    console.press(": 'zzzz'");
    console.shows("no match");
    console.press("esc ?");
    console.shows("Keys: Tools › set_prices");
}

#[test]
fn a_run_that_cannot_be_opened_is_explained_in_the_menu() {
    let runs = tempfile::tempdir().expect("a folder");
    std::fs::create_dir(runs.path().join("broken")).expect("a folder");
    std::fs::write(runs.path().join("broken/run.toml"), "seed = [").expect("written");
    let mut console = Console::start(runs.path(), (100, 30));
    console.shows("Runs");
    console.press("down enter");
    console.shows("broken");
    console.shows("cannot be read");
    console.press("enter");
    console.shows("run.toml");
    console.press("esc n enter");
    console.shows("day 0/500");
}

#[test]
fn a_run_whose_file_is_deleted_stops_and_says_where_everything_is() {
    let runs = tempfile::tempdir().expect("a folder");
    let mut console = Console::in_new_run(runs.path(), (120, 40));
    open_shop(&mut console);
    let folder =
        std::fs::read_dir(runs.path()).expect("runs").next().expect("a run").expect("a folder").path();
    let confirmed = std::fs::read(folder.join("trajectory.jsonl")).expect("a trajectory");
    std::fs::remove_file(folder.join("trajectory.jsonl")).expect("deleted");
    console.press("n enter 'test' enter f enter");
    let (code, words) = console.left.clone().expect("the program has left");
    let words = words.expect("last words");
    assert_eq!(code, 3);
    assert!(words.contains("your decisions are no longer on disk"), "{words}");
    let aside = std::fs::read_dir(&folder)
        .expect("a folder")
        .map(|entry| entry.expect("an entry").path())
        .find(|path| path.file_name().is_some_and(|name| name.to_string_lossy().contains("-unsaved-")));
    let aside = aside.expect("confirmed actions");
    assert!(words.contains(&aside.display().to_string()), "{words}");
    assert!(std::fs::read(aside).expect("a copy").starts_with(&confirmed));
}

#[test]
fn a_post_is_published_from_the_feed_after_one_question() {
    let runs = tempfile::tempdir().expect("a folder");
    let mut console = Console::in_new_run(runs.path(), (120, 40));
    open_shop(&mut console);
    console.week();
    console.press("esc");
    console.shows("5 Social ●");
    console.press("5 p 'Drafts_are_right_at_once.' ctrl-s");
    console.shows("It costs nothing");
    console.press("esc ctrl-s y");
    console.shows("post_social_media: done");
    console.shows("our post 1 · 0 views, 0 comments");
    console.press("p 'Again' ctrl-s");
    console.shows("already posted");
    console.press("esc q");
    console.shows("It is saved with the run");
    console.press("esc 1 5");
    console.shows("Again");
}

#[test]
fn quitting_keeps_drafts_of_forms_and_posts() {
    let runs = tempfile::tempdir().expect("a folder");
    let mut console = Console::in_new_run(runs.path(), (120, 40));
    console.press("8 enter enter '14' enter");
    console.shows("draft, kept until sent or reset");
    console.press("esc 5 p 'Unsent' esc q");
    console.shows("It is saved with the run");
    console.press("y");
    assert!(matches!(console.left, Some((0, _))), "the program ends: {:?}", console.left);
    drop(console);
    let mut console = Console::in_latest_run(runs.path(), (120, 40));
    console.shows("Unsent text");
    console.press("enter 5");
    console.shows("Unsent");
    console.press("8");
    console.shows("draft, kept until sent or reset: A 0 → 14");
}

#[test]
fn a_group_is_studied_and_one_walks_between_its_report_and_its_customers() {
    let runs = tempfile::tempdir().expect("a folder");
    let mut console = Console::in_new_run(runs.path(), (120, 40));
    console.press("7 down + r");
    console.shows("A study of S2 to level 3.");
    console.press("n");
    console.shows("level 3: $175,000");
    console.press("r y");
    console.shows("due on day 5");
    console.press("enter");
    console.shows("S2 · individual");
    console.press("end up enter");
    console.shows("study to level 3 due on day 5");
    console.press("backspace");
    console.shows("S2 · individual");
    console.press("7 m y");
    console.shows("of 1 found · $25,000 · next");
}

#[test]
fn a_named_query_is_run_drawn_taken_out_and_saved_as_ones_own() {
    let runs = tempfile::tempdir().expect("a folder");
    let folder = runs.path().join("configuration");
    let configuration = Configuration { folder: Some(folder.clone()), voice: None };
    let mut console = Console::start_with(configuration, runs.path(), (120, 40));
    console.press("n enter");
    open_shop(&mut console);
    console.week();
    console.press("esc 9 ctrl-o 'cashweek' enter");
    console.shows("Query · Cash by week");
    console.shows("Result · 2 rows");
    console.press("esc .");
    console.shows("⎯ cash by week");
    console.press("b");
    console.shows("█ cash by week");
    console.press("esc e t");
    assert!(console.copied[0].starts_with("week\tincome\tcost\tnet\tcash\n0\t"), "{:?}", console.copied);
    console.press("i ctrl-s 'Mine' enter");
    console.shows("saved: ");
    let text = std::fs::read_to_string(folder.join("queries/mine.sql")).expect("a file");
    assert!(text.starts_with("-- title: Cash by week"));
    console.press("ctrl-n ctrl-o");
    console.shows("own Cash by week");
    console.press("esc esc : 'economy' down");
    console.shows("The economy");
    console.press("esc i ctrl-r");
    console.shows("1 of 1");
}

#[test]
fn a_week_without_decisions_takes_three_keys() {
    let runs = tempfile::tempdir().expect("a folder");
    let mut console = Console::in_new_run(runs.path(), (120, 40));
    for week in 1..=3 {
        console.press("n f enter");
        console.shows(&format!("day {}/500", 7 * week));
        console.shows("Most unusual changes");
    }
}

#[test]
fn the_keys_after_a_query_of_the_library_are_those_of_its_result() {
    let runs = tempfile::tempdir().expect("a folder");
    let mut console = Console::in_new_run(runs.path(), (120, 40));
    console.week();
    console.press("esc 9 ctrl-o 'ledger' enter");
    console.shows("Result ·");
    let before = console.screen();
    console.press(".");
    let after = console.screen();
    assert_ne!(before, after);
    assert!(
        after.contains("lines") || after.contains("bars") || after.contains("at least two points"),
        "{after}"
    );
}
