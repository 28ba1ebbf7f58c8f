//! Tests of the start menu.

use crossterm::event::{KeyCode, KeyEvent, KeyModifiers};

use super::*;
use crate::test_kit::{only_question, render_rows};
use novamind_record::mode::Mode;
use novamind_record::trajectory::record::RunEndReason;
use novamind_session::{Access, Generation, HorizonRule, SeekTarget};
use novamind_worker::request::{RecordSource, Request};

pub(crate) fn summary(id: &str) -> RunSummary {
    RunSummary {
        id: id.to_owned(),
        created: "2026-11-20T10:00:00Z".to_owned(),
        played: "2026-11-21T10:42:07Z".to_owned(),
        mode: Some(Mode::Sandbox),
        seed: 42,
        scenario: "default".to_owned(),
        horizon_rule: HorizonRule::Exact,
        generation: Generation::Release1,
        has_own_parameters: false,
        judged_by_model: false,
        is_branch: false,
        policy: None,
        participant: None,
        day: 84,
        days: 500,
        starting_cash: 1_000_000.0,
        cash: 1_234_567.0,
        ended: None,
        is_served: false,
        copy_of: None,
        problem: None,
    }
}

#[test]
fn runs_played_by_programs_are_labelled() {
    let mut menu = menu(vec![RunSummary { is_served: true, ..summary("aaaa0001") }, summary("bbbb0002")]);
    menu.page = MenuPage::Runs;
    let rows = menu_text(&menu, 120, 30);
    let row = |id: &str| rows.lines().find(|line| line.contains(id)).expect(id).to_owned();
    assert!(row("aaaa0001").contains("played by a program"), "{rows}");
    assert!(!row("bbbb0002").contains("played by"), "{rows}");
}

fn menu(runs: Vec<RunSummary>) -> StartMenu {
    let mut menu = StartMenu::new(&Configuration::bundled());
    menu.set_runs(Ok(runs));
    menu
}

fn preview() -> RunPreview {
    let cash = (0..=12).map(|week| (week * 7, 1e6 + f64::from(week * week) * 2e4)).collect();
    RunPreview { cash, subscribers: 41_950, seats: 1_240, recurring_revenue: 812_345.0 }
}

fn menu_with_three_runs() -> StartMenu {
    let mut menu = menu(vec![
        summary("aaaa0001"),
        RunSummary { ended: Some(RunEndReason::Horizon), day: 500, ..summary("bbbb0002") },
        RunSummary { problem: Some("run.toml is missing".to_owned()), ..summary("cccc0003") },
    ]);
    for id in ["aaaa0001", "bbbb0002"] {
        menu.previews.insert(id.to_owned(), Some(Ok(preview())));
    }
    menu
}

fn menu_text(menu: &StartMenu, width: u16, height: u16) -> String {
    render_rows(width, height, |canvas, area| menu.draw(canvas, area)).join("\n")
}

fn type_text(menu: &mut StartMenu, text: &str) {
    for letter in text.chars() {
        menu.handle_key(&KeyEvent::new(KeyCode::Char(letter), KeyModifiers::NONE));
    }
}

#[test]
fn first_entry_without_runs_is_the_tour() {
    let mut menu = menu(Vec::new());
    let screen = menu_text(&menu, 80, 23);
    assert!(
        screen.contains("› Tour") && screen.contains("New here?") && screen.contains("About"),
        "{screen}"
    );
    assert!(screen.contains("the run ends."), "the rules are shown completely: {screen}");
    assert!(!screen.contains("Continue") && !screen.contains("Runs"), "{screen}");
    assert!(matches!(menu.handle_action(Action::Open)[..], [Effect::StartTour]));
}

#[test]
fn last_run_is_shown_next_to_the_entries() {
    let mut menu = menu_with_three_runs();
    let screen = menu_text(&menu, 120, 39);
    for part in [
        "› Continue",
        "day 84 of 500 · $1,234,567",
        "Compare runs",
        "Last run",
        "41,950 · 1,240 seats",
        "$812,345 a month",
    ] {
        assert!(screen.contains(part), "{part} is missing in\n{screen}");
    }
    assert!(
        matches!(&menu.handle_action(Action::Open)[..], [Effect::Request(Request::Open(id, Access::Write))] if id == "aaaa0001")
    );
}

#[test]
fn previews_are_requested_once() {
    let mut menu = StartMenu::new(&Configuration::bundled());
    let effects = menu.set_runs(Ok(vec![summary("aaaa0001"), summary("bbbb0002")]));
    assert_eq!(only_question::<PreviewQuestion>(&effects).id, "aaaa0001");
    menu.page = MenuPage::Runs;
    assert!(menu.request_selected_preview().is_empty());
    assert_eq!(only_question::<PreviewQuestion>(&menu.handle_action(Action::Down)).id, "bbbb0002");
    assert!(menu.handle_action(Action::Up).is_empty());
}

#[test]
fn actions_wait_until_the_runs_are_listed() {
    let hurried = |keys: &[Action], runs: Vec<RunSummary>| {
        let mut menu = StartMenu::new(&Configuration::bundled());
        let screen = menu_text(&menu, 80, 23);
        assert!(screen.contains("looking for runs") && !screen.contains("New run"), "{screen}");
        for key in keys {
            assert!(menu.handle_action(*key).is_empty(), "actions are delayed");
        }
        let effects = menu.set_runs(Ok(runs));
        (menu, effects)
    };
    let (_, effects) = hurried(&[Action::Open], vec![summary("aaaa0001")]);
    assert!(
        matches!(&effects[..], [Effect::Ask(_), Effect::Request(Request::Open(id, Access::Write))] if id == "aaaa0001")
    );
    let (_, effects) = hurried(&[Action::ContinueRun], vec![summary("aaaa0001")]);
    assert!(
        matches!(&effects[..], [Effect::Ask(_), Effect::Request(Request::Open(id, Access::Write))] if id == "aaaa0001")
    );
    let (_, effects) = hurried(&[Action::Open], Vec::new());
    assert!(matches!(effects[..], [Effect::StartTour]));
    let (menu, _) = hurried(&[Action::Down, Action::Open], vec![summary("aaaa0001")]);
    assert!(menu.page == MenuPage::NewRun);
    let (menu, effects) = hurried(&[Action::Open, Action::NewRun], vec![summary("aaaa0001")]);
    assert!(menu.page == MenuPage::NewRun && effects.len() == 1, "the last action counts");
}

#[test]
fn new_run_list_keeps_the_selection() {
    let mut menu = menu(Vec::new());
    menu.handle_action(Action::Last);
    menu.set_runs(Ok(vec![summary("aaaa0001"), summary("bbbb0002")]));
    assert!(matches!(menu.handle_action(Action::Open)[..], [Effect::Execute(Action::Quit)]));
}

#[test]
fn ending_and_deleting_runs_requires_confirmation() {
    let mut menu = menu_with_three_runs();
    menu.page = MenuPage::Runs;
    for (action, words) in [(Action::EndRun, "Giving up"), (Action::DeleteRun, "Deleting")] {
        assert!(menu.handle_action(action).is_empty());
        let screen = menu_text(&menu, 80, 23).replace("\n", " ");
        let words_apart: Vec<&str> = words.split(' ').collect();
        assert!(words_apart.iter().all(|word| screen.contains(word)), "{screen}");
        assert_eq!(menu.scopes(), [Scope::Dialog]);
        assert!(menu.handle_action(Action::Cancel).is_empty() && menu.question.is_none());
    }
    menu.handle_action(Action::DeleteRun);
    assert!(
        menu.handle_action(Action::Down).is_empty() && menu.question.is_some(),
        "only an answer is accepted"
    );
    assert!(
        matches!(&menu.handle_action(Action::Confirm)[..], [Effect::Request(Request::DeleteRun(id))] if id == "aaaa0001")
    );
    menu.handle_action(Action::EndRun);
    assert!(
        matches!(&menu.handle_action(Action::Confirm)[..], [Effect::Request(Request::EndRun(id))] if id == "aaaa0001")
    );
    menu.handle_action(Action::Down);
    assert!(
        matches!(&menu.handle_action(Action::EndRun)[..], [Effect::ShowError(_)]),
        "the run is already over"
    );
}

#[test]
fn marked_runs_are_compared() {
    let mut menu = menu_with_three_runs();
    menu.page = MenuPage::Runs;
    assert!(matches!(&menu.handle_action(Action::CompareRuns)[..], [Effect::ShowError(_)]));
    menu.handle_action(Action::MarkRun);
    menu.handle_action(Action::MarkRun);
    menu.handle_action(Action::MarkRun);
    assert_eq!(menu.marked, ["aaaa0001", "bbbb0002"], "unreadable runs cannot be marked");
    assert!(menu_text(&menu, 80, 23).contains("● bbbb0002"));
    menu.handle_action(Action::CompareRuns);
    for (width, figure) in [(80, "▁"), (120, "$812,345")] {
        let screen = menu_text(&menu, width, 39);
        for part in ["Cash", "2 runs", "1━", "aaaa0001", "finished day 500", figure] {
            assert!(screen.contains(part), "{part} is missing in\n{screen}");
        }
    }
    menu.handle_action(Action::Close);
    assert!(menu.page == MenuPage::Runs);
}

#[test]
fn run_list_can_be_filtered_and_sorted() {
    let mut menu = menu_with_three_runs();
    menu.page = MenuPage::Runs;
    menu.handle_action(Action::Filter);
    assert_eq!(menu.scopes(), [Scope::Field]);
    type_text(&mut menu, "finished q");
    assert_eq!(menu.selected_run(), None, "q is typed and does not quit");
    menu.handle_key(&KeyEvent::new(KeyCode::Backspace, KeyModifiers::NONE));
    menu.handle_key(&KeyEvent::new(KeyCode::Backspace, KeyModifiers::NONE));
    menu.handle_action(Action::Commit);
    assert_eq!(menu.selected_run().map(|run| run.id.as_str()), Some("bbbb0002"));
    menu.handle_action(Action::Close);
    menu.handle_action(Action::Close);
    assert!(menu.page == MenuPage::Home);
}

#[test]
fn form_shows_problems_while_typing() {
    let mut menu = menu_with_three_runs();
    menu.handle_action(Action::NewRun);
    menu.form.selected_row = 3;
    type_text(&mut menu, "3");
    assert!(menu_text(&menu, 80, 23).contains("! enter a whole number of at least 7"));
    menu.form.selected_row = FORM_ROWS.len() - 1;
    assert!(
        menu.handle_action(Action::Open).is_empty() && menu.form.selected_row == 3,
        "the form selects the invalid row"
    );
    type_text(&mut menu, "0");
    menu.form.selected_row = 0;
    menu.handle_action(Action::Left);
    assert!(menu_text(&menu, 80, 23).contains("No branches, rewinding or tour"));
    menu.form.selected_row = FORM_ROWS.len() - 1;
    match &menu.handle_action(Action::Open)[..] {
        [Effect::Request(Request::Create(new))] => {
            assert_eq!((new.days, new.seed, new.mode), (Some(30), Some(42), Mode::Baseline))
        }
        other => panic!("{other:?}"),
    }
}

#[test]
fn form_shows_the_selected_scenario() {
    let mut menu = menu(Vec::new());
    menu.handle_action(Action::NewRun);
    menu.form.selected_row = 1;
    let digit = KeyEvent::new(KeyCode::Char('4'), KeyModifiers::NONE);
    assert!(
        matches!(&menu.handle_key(&digit)[..], [Effect::ShowError(text)] if text.starts_with("Scenario is not"))
    );
    assert!(menu_text(&menu, 80, 23).contains("left, right and enter change the scenario"));
    let configuration = Configuration::bundled();
    menu.form.selected_row = 1;
    for name in configuration.scenario_names() {
        let screen = menu_text(&menu, 120, 39);
        let scenario = configuration.load_scenario(&name).expect("a scenario");
        let (days, cash) = configuration.days_and_cash(&scenario, true).expect("its terms");
        let text = scenario.description.split(' ').take(6).collect::<Vec<_>>().join(" ");
        for part in [
            format!("‹ {name} ›"),
            format!("scenario default: {days}"),
            format!("scenario default: {}", novamind_base::formatting::dollars(cash)),
            text,
        ] {
            assert!(screen.contains(&part), "{part} is missing in\n{screen}");
        }
        menu.handle_action(Action::Right);
    }
    let short = configuration.load_scenario("short").expect("a scenario");
    assert_eq!(configuration.days_and_cash(&short, true).expect("its terms").0, 50);
}

#[test]
fn form_explains_the_generations_in_every_window() {
    let mut menu = menu(Vec::new());
    menu.handle_action(Action::NewRun);
    menu.form.selected_row = 1;
    let configuration = Configuration::bundled();
    for name in configuration.scenario_names() {
        let description = configuration.load_scenario(&name).expect("a scenario").description;
        for (width, height) in
            [(80, 23), (60, 15)].into_iter().filter(|_| ["default", "release-2"].contains(&&*name))
        {
            let screen = menu_text(&menu, width, height);
            let words = screen.replace(['│', '┃'], " ").split_whitespace().collect::<Vec<_>>().join(" ");
            assert!(words.contains(&description), "{name} at {width}x{height}:\n{screen}");
        }
        menu.handle_action(Action::Right);
    }
}

#[test]
fn unavailable_modes_are_not_offered() {
    let mut menu = menu(Vec::new());
    menu.handle_action(Action::NewRun);
    menu.form.selected_row = 0;
    for _ in Mode::ALL {
        menu.handle_action(Action::Right);
        let screen = menu_text(&menu, 120, 39);
        assert!(!screen.contains("lesson") && !screen.contains("hints"), "{screen}");
    }
}

#[test]
fn handouts_and_classes_are_opened_by_path() {
    let mut menu = menu_with_three_runs();
    let screen = menu_text(&menu, 80, 23);
    assert!(
        screen.contains("such as S07.nm") && screen.contains("Class") && screen.contains("Quit"),
        "{screen}"
    );
    menu.handle_action(Action::Last);
    menu.handle_action(Action::Up);
    menu.handle_action(Action::Open);
    assert_eq!((menu.page, menu.scopes()), (MenuPage::PathForm, vec![Scope::Field]));
    assert!(matches!(&menu.handle_action(Action::Commit)[..], [Effect::ShowError(_)]), "no path is typed");
    type_text(&mut menu, "'~/q class'");
    match &menu.handle_action(Action::Commit)[..] {
        [Effect::Request(Request::ReadClass(path, _))] => assert_eq!(path, std::path::Path::new("~/q class")),
        other => panic!("{other:?}"),
    }
    menu.show_open_error("~/q class is not a class".to_owned(), None);
    assert!(menu_text(&menu, 80, 23).contains("! ~/q class is not a class"));
    menu.handle_action(Action::Discard);
    assert!(menu.page == MenuPage::Home);
    menu.handle_action(Action::Last);
    menu.handle_action(Action::Up);
    menu.handle_action(Action::Up);
    menu.handle_action(Action::Open);
    menu.paste("S07.nm\n");
    match &menu.handle_action(Action::Commit)[..] {
        [Effect::Request(Request::OpenHandout(path))] => assert_eq!(path, std::path::Path::new("S07.nm")),
        other => panic!("{other:?}"),
    }
}

#[test]
fn published_results_include_own_runs() {
    let mut menu = menu_with_three_runs();
    menu.page = MenuPage::PublishedResults;
    let screen = menu_text(&menu, 120, 39);
    for part in
        ["Rule-based baseline", "$15,756,408", "You · bbbb0002", "sandbox · seed 42", "upper bound: $2.20B"]
    {
        assert!(screen.contains(part), "{part} is missing in\n{screen}");
    }
    menu.handle_action(Action::Last);
    menu.handle_action(Action::Down);
    assert_eq!(menu.selected, menu.last_index());
}

#[test]
fn every_page_is_drawn_at_every_size() {
    for mut menu in [menu(Vec::new()), menu_with_three_runs(), StartMenu::new(&Configuration::bundled())] {
        menu.marked = menu.runs().iter().map(|run| run.id.clone()).collect();
        let pages = [
            MenuPage::Home,
            MenuPage::NewRun,
            MenuPage::Runs,
            MenuPage::Compare,
            MenuPage::PublishedResults,
            MenuPage::PathForm,
        ];
        for page in pages {
            menu.page = page;
            for width in (0..130).step_by(26) {
                for height in (0..40).step_by(6) {
                    menu_text(&menu, width, height);
                }
            }
        }
    }
}

#[test]
fn runs_are_replayed_from_the_list_and_the_first_page() {
    let mut menu = menu_with_three_runs();
    let replays = |effects: Vec<Effect>, wanted: &str| {
        let [
            Effect::Request(Request::Replay {
                recorded: RecordSource::Run(id),
                goal: SeekTarget::First,
                follow: false,
            }),
        ] = &effects[..]
        else {
            panic!("{effects:?}")
        };
        assert_eq!(id, wanted);
    };
    replays(menu.handle_action(Action::ReplayRun), "aaaa0001");
    menu.page = MenuPage::Runs;
    menu.handle_action(Action::Down);
    replays(menu.handle_action(Action::ReplayRun), "bbbb0002");
}

#[test]
fn failed_open_offers_an_alternative() {
    let long = "trajectory.jsonl, line 8: the line does not follow from the one before. ".repeat(12);
    for (instead, words) in [
        (OpenFallback::Watch("aaaa0001".to_owned()), "Watch the run here"),
        (OpenFallback::Recover("aaaa0001".to_owned()), "as a branch?"),
    ] {
        for page in [MenuPage::Home, MenuPage::Runs] {
            let mut menu = menu_with_three_runs();
            menu.page = page;
            menu.show_open_error(long.clone(), Some(instead.clone()));
            for (width, height) in [(60, 15), (80, 23), (120, 39)] {
                let screen = menu_text(&menu, width, height);
                assert!(screen.contains(words), "{screen}");
            }
            assert_eq!(menu.scopes(), [Scope::Dialog]);
            assert!(
                menu.handle_action(Action::Down).is_empty() && menu.question.is_some(),
                "only an answer is accepted"
            );
            match (&instead, &menu.handle_action(Action::Confirm)[..]) {
                (
                    OpenFallback::Watch(_),
                    [Effect::Request(Request::Replay { goal: SeekTarget::Last, follow: true, .. })],
                ) => {}
                (OpenFallback::Recover(_), [Effect::Request(Request::Recover(id))]) => {
                    assert_eq!(id, "aaaa0001")
                }
                (_, other) => panic!("{other:?}"),
            }
            menu.show_open_error(long.clone(), Some(instead.clone()));
            assert!(menu.handle_action(Action::Cancel).is_empty() && menu.question.is_none());
        }
    }
}

#[test]
fn run_starts_only_after_consent() {
    let text = "We keep what you do for a year.\n".repeat(40) + "\nYou can stop at any time.";
    let asked = || {
        let mut menu = menu_with_three_runs();
        menu.show_open_error(text.clone(), Some(OpenFallback::AskConsent(Box::default())));
        menu
    };
    let mut menu = asked();
    let screen = menu_text(&menu, 80, 23);
    for part in ["Before the session", "We keep what you do", "n I do not", "scroll to the end to agree"] {
        assert!(screen.contains(part), "{part} is missing in\n{screen}");
    }
    assert!(!screen.contains("stop at any time"));
    assert!(
        matches!(menu.handle_action(Action::Agree)[..], [Effect::ShowError(_)]),
        "the end of the text was not shown"
    );
    (0..60).for_each(|_| drop(menu.handle_action(Action::Down)));
    let end = menu_text(&menu, 80, 23);
    assert!(end.contains("You can stop at any time.") && end.contains("y I agree"), "{end}");
    match &menu.handle_action(Action::Agree)[..] {
        [Effect::Request(Request::Create(new))] => {
            assert!(new.agreed.as_ref().is_some_and(|agreed| agreed.given.scrolled_to_end));
        }
        other => panic!("{other:?}"),
    }
    for no in [Action::Decline, Action::Close] {
        let mut menu = asked();
        assert!(matches!(menu.handle_action(no)[..], [Effect::ShowStatus(_)]));
        assert!(!menu_text(&menu, 80, 23).contains("Before the session"));
    }
}

#[test]
fn enter_edits_a_field_and_only_the_start_row_starts_a_run() {
    let mut menu = menu(Vec::new());
    menu.handle_action(Action::NewRun);
    menu.form.selected_row = 0;
    for _ in 0..FORM_ROWS.len() - 1 {
        assert!(menu.handle_action(Action::Open).is_empty(), "row {}", menu.form.selected_row);
        assert_eq!(menu.form.is_typing(), menu.form.selected_row >= 2);
        if menu.form.is_typing() {
            assert!(menu.handle_action(Action::Commit).is_empty() && !menu.form.is_typing());
        }
        menu.handle_action(Action::Down);
    }
    menu.form.selected_row = 4;
    type_text(&mut menu, "84000");
    menu.handle_action(Action::Commit);
    assert!(menu_text(&menu, 80, 23).contains("$84,000"), "{}", menu_text(&menu, 80, 23));
    menu.handle_action(Action::Open);
    type_text(&mut menu, "5");
    menu.handle_action(Action::Discard);
    assert!(menu.page == MenuPage::NewRun && menu_text(&menu, 80, 23).contains("$84,000"), "esc restores");
    menu.handle_action(Action::Last);
    assert!(matches!(&menu.handle_action(Action::Open)[..],
        [Effect::Request(Request::Create(new))] if new.cash == Some(84_000.0)));
}

#[test]
fn first_entry_opens_the_run_that_was_played_last() {
    let ended = RunSummary { ended: Some(RunEndReason::Horizon), day: 500, ..summary("bbbb0002") };
    let mut menu = menu(vec![ended, summary("aaaa0001")]);
    let screen = menu_text(&menu, 120, 39);
    assert!(screen.contains("› Open last run") && screen.contains("finished day 500"), "{screen}");
    assert!(
        matches!(&menu.handle_action(Action::Open)[..], [Effect::Request(Request::Open(id, _))] if id == "bbbb0002")
    );
}
