//! Complete usage scenarios, from the start of the program to its end.

use novamind::record::folder::configuration::Configuration;
use novamind::record::folder::runs::list_runs;
use novamind::session::verify;

use super::company::copy_played_run;
use super::harness::Console;

/// Sets initial prices, tiers, quotas and budgets in the forms.
fn enter_initial_settings(console: &mut Console) {
    console.press("8 enter enter '12' down '25' down '55' enter ctrl-s");
    console.press("down enter enter '1' down '2' down '4' enter ctrl-s");
    console.press("down enter enter '60k' down '250k' down '1.2M' enter ctrl-s");
    console.press("down down enter enter '200' down '200' enter ctrl-s");
    console.press("down enter down down down enter '750' enter ctrl-s");
}

#[test]
fn new_user_plays_two_weeks_and_resumes() {
    let runs = tempfile::tempdir().expect("a folder");
    let mut console = Console::start(runs.path(), (120, 40));
    console.assert_shows("New run");
    console.press("n enter");
    console.assert_shows("day 0/500");
    console.assert_shows("No plan has a price. A plan without");
    enter_initial_settings(&mut console);
    console.assert_shows("Tools ●11");
    console.press("c");
    for line in ["price A", "0 → 12", "quota C", "ads content_marketing S1", "0 → 750"] {
        console.assert_shows(line);
    }
    console.press("esc");
    console.advance_week();
    console.assert_shows("Most unusual changes");
    console.press("esc");
    console.advance_week();
    console.press("esc 1");
    console.assert_shows("day 14/500");
    console.press("0");
    console.assert_shows("test");
    console.press("q");
    assert_eq!(console.exit.as_ref().map(|(code, _)| *code), Some(0));
    drop(console);
    let mut console = Console::start(runs.path(), (120, 40));
    console.assert_shows("Continue");
    console.assert_shows("day 14 of 500");
    console.press("c");
    console.assert_shows("day 14/500");
    console.press("q");
    drop(console);
    let run = &list_runs(runs.path()).expect("a list")[0];
    assert_eq!(verify(&runs.path().join(&run.id)).expect("an intact run").day, 14);
}

#[test]
fn short_run_ends_on_the_final_page() {
    let runs = tempfile::tempdir().expect("a folder");
    let mut console = Console::start(runs.path(), (100, 30));
    console.press("n up up up '17' down down down enter");
    console.assert_shows("day 0/17");
    for _ in 0..3 {
        console.advance_week();
        console.press("esc");
    }
    console.press("n");
    console.assert_shows("Day 17. You end with $998,555.");
    console.assert_shows("not ranked");
    console.assert_shows("planning words");
    console.press("r");
    let id = console.app.run().expect("a run").company.observation.run.clone();
    for (name, begins) in [("report.md", "# NovaMind · run "), ("report.html", "<!DOCTYPE html>")] {
        let report = std::fs::read_to_string(runs.path().join(&id).join(name)).expect("a report");
        assert!(report.starts_with(begins) && report.contains("You end with $998,555."), "{name}");
    }
    console.press("enter down down enter");
    console.assert_shows("finished");
}

#[test]
fn palette_writes_a_report_of_an_unfinished_run() {
    let runs = tempfile::tempdir().expect("a folder");
    let mut console = Console::in_new_run(runs.path(), (80, 24));
    console.advance_week();
    console.press("esc : 'write_the_report'");
    console.assert_shows("Write the report of the run");
    console.press("enter");
    let id = console.app.run().expect("a run").company.observation.run.clone();
    let report = std::fs::read_to_string(runs.path().join(id).join("report.md")).expect("a report");
    assert!(report.contains("**Day 7 of 500. Cash is $") && report.contains("“test”"), "{report}");
}

#[test]
fn week_requires_a_rationale_and_four_forecasts() {
    let runs = tempfile::tempdir().expect("a folder");
    let mut console = Console::in_new_run(runs.path(), (100, 30));
    console.press("n enter enter");
    console.assert_shows("a rationale is required");
    console.press("'why_not' enter enter");
    console.assert_shows("1 week: enter a number");
    console.press("'5' tab '4' tab '9' enter ctrl-s");
    console.assert_shows("the point is not between low and high");
    console.press("esc q");
    console.assert_shows("Unsent");
    console.press("esc n enter");
    console.assert_shows("why not");
    console.press("enter '6' enter f enter");
    console.assert_shows("Most unusual changes");
}

#[test]
fn settings_can_be_undone_to_their_initial_values() {
    let runs = tempfile::tempdir().expect("a folder");
    let mut console = Console::in_new_run(runs.path(), (120, 40));
    console.press("8 down down down down enter enter '300' enter ctrl-s");
    console.assert_shows("set_daily_spend: done");
    console.press("u");
    console.assert_shows("undone: operations");
    console.press("u");
    console.assert_shows("! ");
    console.press("esc home enter enter '12' enter ctrl-s u");
    console.assert_shows("a price cannot be set to 0");
}

#[test]
fn purchase_is_confirmed_once_and_rejection_is_shown_at_the_field() {
    let runs = tempfile::tempdir().expect("a folder");
    let mut console = Console::in_new_run(runs.path(), (120, 40));
    console.press(": 'start_res' enter enter '1' enter ctrl-s");
    console.assert_shows("cannot be undone");
    console.press("enter");
    console.assert_shows("$1,000,000");
    console.press("ctrl-s y");
    console.assert_shows("start_research_project: done");
    console.press("enter enter '1' enter");
    console.assert_shows("tier 1 is already running");
    console.press("y");
    assert_eq!(console.clipboard, [r#"research.start_research_project({"tier": 1})"#]);
}

#[test]
fn palette_finds_every_action() {
    let runs = tempfile::tempdir().expect("a folder");
    let mut console = Console::in_new_run(runs.path(), (120, 40));
    console.press(": 'ledger'");
    console.assert_shows("table");
    console.press("enter");
    console.assert_shows("SELECT * FROM ledger LIMIT 100");
    console.press("esc : 'prices' enter");
    console.assert_shows("set_prices · pricing");
    console.press(": 'zzzz'");
    console.assert_shows("no match");
    console.press("esc ?");
    console.assert_shows("Keys: Tools › set_prices");
}

#[test]
fn menu_explains_why_a_run_cannot_be_opened() {
    let runs = tempfile::tempdir().expect("a folder");
    std::fs::create_dir(runs.path().join("broken")).expect("a folder");
    std::fs::write(runs.path().join("broken/run.toml"), "seed = [").expect("written");
    let mut console = Console::start(runs.path(), (100, 30));
    console.assert_shows("Runs");
    console.press("down enter");
    console.assert_shows("broken");
    console.assert_shows("cannot be read");
    console.press("enter");
    console.assert_shows("run.toml");
    console.press("esc n enter");
    console.assert_shows("day 0/500");
}

#[test]
fn deleted_trajectory_stops_the_run_with_a_message() {
    let runs = tempfile::tempdir().expect("a folder");
    let mut console = Console::in_new_run(runs.path(), (120, 40));
    enter_initial_settings(&mut console);
    let folder =
        std::fs::read_dir(runs.path()).expect("runs").next().expect("a run").expect("a folder").path();
    let confirmed = std::fs::read(folder.join("trajectory.jsonl")).expect("a trajectory");
    std::fs::remove_file(folder.join("trajectory.jsonl")).expect("deleted");
    console.press("n enter 'test' enter f enter");
    let (code, words) = console.exit.clone().expect("the program has exited");
    let words = words.expect("an exit message");
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
fn feed_publishes_a_post_after_one_confirmation() {
    let runs = tempfile::tempdir().expect("a folder");
    let mut console = Console::in_new_run(runs.path(), (120, 40));
    enter_initial_settings(&mut console);
    console.advance_week();
    console.press("esc");
    console.assert_shows("5 Social ●");
    console.press("5 p 'Drafts_are_right_at_once.' ctrl-s");
    console.assert_shows("It costs nothing");
    console.press("esc ctrl-s y");
    console.assert_shows("post_social_media: done");
    console.assert_shows("our post 1 · 0 views, 0 comments");
    console.press("p 'Again' ctrl-s");
    console.assert_shows("already posted");
    console.press("esc q");
    console.assert_shows("is saved with the run");
    console.press("esc 1 5");
    console.assert_shows("Again");
}

#[test]
fn drafts_survive_quitting() {
    let runs = tempfile::tempdir().expect("a folder");
    let mut console = Console::in_new_run(runs.path(), (120, 40));
    console.press("8 enter enter '14' enter");
    console.assert_shows("draft, kept until sent or reset");
    console.press("esc 5 p 'Unsent' esc q");
    console.assert_shows("is saved with the run");
    console.press("y");
    assert!(matches!(console.exit, Some((0, _))), "the program ends: {:?}", console.exit);
    drop(console);
    let mut console = Console::in_latest_run(runs.path(), (120, 40));
    console.assert_shows("Unsent text");
    console.press("enter 5");
    console.assert_shows("Unsent");
    console.press("8");
    console.assert_shows("draft, kept until sent or reset: A 0 → 14");
}

#[test]
fn unsent_offers_survive_quitting() {
    let runs = tempfile::tempdir().expect("a folder");
    copy_played_run("companies.toml", 3, 35, runs.path());
    let offers = |console: &Console| {
        let run = console.app.run().expect("a run");
        run.screens.inbox.draft_offers(&run.company)
    };
    let mut console = Console::in_latest_run(runs.path(), (120, 40));
    console.press("6 b b e '31.5' enter");
    let unsent = offers(&console);
    assert!(unsent.values().any(|text| text.contains("31.5")), "{unsent:?}\n{}", console.screen());
    console.press("esc esc q");
    console.assert_shows("is saved with the run");
    console.press("y");
    assert!(matches!(console.exit, Some((0, _))), "the program ends: {:?}", console.exit);
    drop(console);
    let mut console = Console::in_latest_run(runs.path(), (120, 40));
    console.assert_shows("31.5");
    console.press("enter");
    assert_eq!(offers(&console), unsent);
}

#[test]
fn group_report_links_to_its_customers() {
    let runs = tempfile::tempdir().expect("a folder");
    let mut console = Console::in_new_run(runs.path(), (120, 40));
    console.press("7 down + r");
    console.assert_shows("A study of S2 to level 3.");
    console.press("n");
    console.assert_shows("level 3: $175,000");
    console.press("r y");
    console.assert_shows("due on day 5");
    console.press("enter");
    console.assert_shows("S2 · Quality-Focused");
    console.press("end up enter");
    console.assert_shows("study to level 3 due on day 5");
    console.press("backspace");
    console.assert_shows("S2 · Quality-Focused");
    console.press("7 m y");
    console.assert_shows("of 1 found · $25,000 · next");
}

#[test]
fn named_query_is_run_charted_and_saved_as_a_copy() {
    let runs = tempfile::tempdir().expect("a folder");
    let folder = runs.path().join("configuration");
    let configuration = Configuration { folder: Some(folder.clone()), voice: None };
    let mut console = Console::start_with(configuration, runs.path(), (120, 40));
    console.press("n enter");
    enter_initial_settings(&mut console);
    console.advance_week();
    console.press("esc 9 ctrl-o 'cashweek' enter");
    console.assert_shows("Query · Cash by week");
    console.assert_shows("Result · 2 rows");
    console.press("esc .");
    console.assert_shows("⎯ cash by week");
    console.press("b");
    console.assert_shows("█ cash by week");
    console.press("esc e t");
    assert!(
        console.clipboard[0].starts_with("week\tincome\tcost\tnet\tcash\n0\t"),
        "{:?}",
        console.clipboard
    );
    console.press("i ctrl-s 'Mine' enter");
    console.assert_shows("saved: ");
    let text = std::fs::read_to_string(folder.join("queries/mine.sql")).expect("a file");
    assert!(text.starts_with("-- title: Cash by week"));
    console.press("ctrl-n ctrl-o");
    console.assert_shows("own Cash by week");
    console.press("esc esc : 'economy' down");
    console.assert_shows("The economy");
    console.press("esc i ctrl-r");
    console.assert_shows("1 of 1");
}

#[test]
fn week_without_decisions_takes_three_keys() {
    let runs = tempfile::tempdir().expect("a folder");
    let mut console = Console::in_new_run(runs.path(), (120, 40));
    for week in 1..=3 {
        console.press("n f enter");
        console.assert_shows(&format!("day {}/500", 7 * week));
        console.assert_shows("Most unusual changes");
    }
}

#[test]
fn library_query_focuses_its_result() {
    let runs = tempfile::tempdir().expect("a folder");
    let mut console = Console::in_new_run(runs.path(), (120, 40));
    console.advance_week();
    console.press("esc 9 ctrl-o 'ledger' enter");
    console.assert_shows("Result ·");
    let before = console.screen();
    console.press(".");
    let after = console.screen();
    assert_ne!(before, after);
    assert!(
        after.contains("lines") || after.contains("bars") || after.contains("at least two points"),
        "{after}"
    );
}
