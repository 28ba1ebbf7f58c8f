//! Tests of the start menu.

use crossterm::event::{KeyCode, KeyEvent, KeyModifiers};

use super::*;
use crate::test_kit::{asked, painted};
use novamind_record::mode::Mode;
use novamind_record::trajectory::record::Ended;
use novamind_session::{Access, Goal};
use novamind_worker::request::{Recorded, Request};

pub(crate) fn summary(id: &str) -> RunSummary {
    RunSummary {
        id: id.to_owned(),
        created: "2026-11-20T10:00:00Z".to_owned(),
        played: "2026-11-21T10:42:07Z".to_owned(),
        mode: Some(Mode::Sandbox),
        seed: 42,
        scenario: "default".to_owned(),
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
fn a_run_that_a_program_plays_says_so() {
    let mut menu = menu(vec![RunSummary { is_served: true, ..summary("aaaa0001") }, summary("bbbb0002")]);
    menu.page = MenuPage::Runs;
    let rows = shown(&menu, 120, 30);
    let row = |id: &str| rows.lines().find(|line| line.contains(id)).expect(id).to_owned();
    assert!(row("aaaa0001").contains("played by a program"), "{rows}");
    assert!(!row("bbbb0002").contains("played by"), "{rows}");
}

fn menu(runs: Vec<RunSummary>) -> Menu {
    let mut menu = Menu::new(&Configuration::shipped());
    menu.take(Ok(runs));
    menu
}

fn preview() -> RunPreview {
    let cash = (0..=12).map(|week| (week * 7, 1e6 + f64::from(week * week) * 2e4)).collect();
    RunPreview { cash, subscribers: 41_950, seats: 1_240, recurring_revenue: 812_345.0 }
}

fn three() -> Menu {
    let mut menu = menu(vec![
        summary("aaaa0001"),
        RunSummary { ended: Some(Ended::Horizon), day: 500, ..summary("bbbb0002") },
        RunSummary { problem: Some("run.toml is missing".to_owned()), ..summary("cccc0003") },
    ]);
    for id in ["aaaa0001", "bbbb0002"] {
        menu.previews.insert(id.to_owned(), Some(Ok(preview())));
    }
    menu
}

fn shown(menu: &Menu, width: u16, height: u16) -> String {
    painted(width, height, |canvas, area| menu.draw(canvas, area)).join("\n")
}

fn type_text(menu: &mut Menu, text: &str) {
    for letter in text.chars() {
        menu.key(&KeyEvent::new(KeyCode::Char(letter), KeyModifiers::NONE));
    }
}

#[test]
fn a_newcomer_is_offered_the_tour_first() {
    let mut menu = menu(Vec::new());
    let screen = shown(&menu, 80, 23);
    assert!(
        screen.contains("› Tour") && screen.contains("New here?") && screen.contains("About"),
        "{screen}"
    );
    assert!(screen.contains("the run ends."), "the rules are shown completely: {screen}");
    assert!(!screen.contains("Continue") && !screen.contains("Runs"), "{screen}");
    assert!(matches!(menu.act(Action::Open)[..], [Effect::StartTour]));
}

#[test]
fn the_last_run_stands_beside_the_choices() {
    let mut menu = three();
    let screen = shown(&menu, 120, 39);
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
        matches!(&menu.act(Action::Open)[..], [Effect::Request(Request::Open(id, Access::Write))] if id == "aaaa0001")
    );
}

#[test]
fn the_preview_of_a_run_is_asked_for_once() {
    let mut menu = Menu::new(&Configuration::shipped());
    let effects = menu.take(Ok(vec![summary("aaaa0001"), summary("bbbb0002")]));
    assert_eq!(asked::<PreviewQuestion>(&effects).id, "aaaa0001");
    menu.page = MenuPage::Runs;
    assert!(menu.read_chosen().is_empty());
    assert_eq!(asked::<PreviewQuestion>(&menu.act(Action::Down)).id, "bbbb0002");
    assert!(menu.act(Action::Up).is_empty());
}

#[test]
fn a_key_that_comes_before_the_runs_are_known_means_what_is_shown_then() {
    let hurried = |keys: &[Action], runs: Vec<RunSummary>| {
        let mut menu = Menu::new(&Configuration::shipped());
        let screen = shown(&menu, 80, 23);
        assert!(screen.contains("looking for runs") && !screen.contains("New run"), "{screen}");
        for key in keys {
            assert!(menu.act(*key).is_empty(), "actions are delayed");
        }
        let effects = menu.take(Ok(runs));
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
fn a_new_list_leaves_the_choice_where_it_was() {
    let mut menu = menu(Vec::new());
    menu.act(Action::Last);
    menu.take(Ok(vec![summary("aaaa0001"), summary("bbbb0002")]));
    assert!(matches!(menu.act(Action::Open)[..], [Effect::Do(Action::Quit)]));
}

#[test]
fn runs_are_given_up_and_deleted_only_after_a_question() {
    let mut menu = three();
    menu.page = MenuPage::Runs;
    for (action, words) in [(Action::EndRun, "Giving up"), (Action::DeleteRun, "Deleting")] {
        assert!(menu.act(action).is_empty());
        let screen = shown(&menu, 80, 23).replace("\n", " ");
        let words_apart: Vec<&str> = words.split(' ').collect();
        assert!(words_apart.iter().all(|word| screen.contains(word)), "{screen}");
        assert_eq!(menu.scopes(), [Scope::Dialog]);
        assert!(menu.act(Action::Cancel).is_empty() && menu.asked.is_none());
    }
    menu.act(Action::DeleteRun);
    assert!(menu.act(Action::Down).is_empty() && menu.asked.is_some(), "only an answer is accepted");
    assert!(
        matches!(&menu.act(Action::Confirm)[..], [Effect::Request(Request::DeleteRun(id))] if id == "aaaa0001")
    );
    menu.act(Action::EndRun);
    assert!(
        matches!(&menu.act(Action::Confirm)[..], [Effect::Request(Request::EndRun(id))] if id == "aaaa0001")
    );
    menu.act(Action::Down);
    assert!(matches!(&menu.act(Action::EndRun)[..], [Effect::Complain(_)]), "the run is already over");
}

#[test]
fn marked_runs_are_compared() {
    let mut menu = three();
    menu.page = MenuPage::Runs;
    assert!(matches!(&menu.act(Action::CompareRuns)[..], [Effect::Complain(_)]));
    menu.act(Action::MarkRun);
    menu.act(Action::MarkRun);
    menu.act(Action::MarkRun);
    assert_eq!(menu.marked, ["aaaa0001", "bbbb0002"], "unreadable runs cannot be marked");
    assert!(shown(&menu, 80, 23).contains("● bbbb0002"));
    menu.act(Action::CompareRuns);
    for (width, figure) in [(80, "▁"), (120, "$812,345")] {
        let screen = shown(&menu, width, 39);
        for part in ["Cash", "2 runs", "1━", "aaaa0001", "finished day 500", figure] {
            assert!(screen.contains(part), "{part} is missing in\n{screen}");
        }
    }
    menu.act(Action::Close);
    assert!(menu.page == MenuPage::Runs);
}

#[test]
fn the_list_is_filtered_and_sorted() {
    let mut menu = three();
    menu.page = MenuPage::Runs;
    menu.act(Action::Filter);
    assert_eq!(menu.scopes(), [Scope::Field]);
    type_text(&mut menu, "finished q");
    assert_eq!(menu.chosen(), None, "q is typed and does not quit");
    menu.key(&KeyEvent::new(KeyCode::Backspace, KeyModifiers::NONE));
    menu.key(&KeyEvent::new(KeyCode::Backspace, KeyModifiers::NONE));
    menu.act(Action::Commit);
    assert_eq!(menu.chosen().map(|run| run.id.as_str()), Some("bbbb0002"));
    menu.act(Action::Close);
    menu.act(Action::Close);
    assert!(menu.page == MenuPage::Home);
}

#[test]
fn the_form_says_what_is_wrong_while_it_is_typed() {
    let mut menu = three();
    menu.act(Action::NewRun);
    menu.form.at = 3;
    type_text(&mut menu, "3");
    assert!(shown(&menu, 80, 23).contains("! enter a whole number of at least 7"));
    menu.form.at = ROWS.len() - 1;
    assert!(menu.act(Action::Open).is_empty() && menu.form.at == 3, "the form selects the invalid row");
    type_text(&mut menu, "0");
    menu.form.at = 0;
    menu.act(Action::Left);
    assert!(shown(&menu, 80, 23).contains("No branches, no rewinding"));
    menu.form.at = ROWS.len() - 1;
    match &menu.act(Action::Open)[..] {
        [Effect::Request(Request::Create(new))] => {
            assert_eq!((new.days, new.seed, new.mode), (Some(30), Some(42), Mode::Baseline))
        }
        other => panic!("{other:?}"),
    }
}

#[test]
fn the_form_shows_what_the_chosen_scenario_is_and_says() {
    let mut menu = menu(Vec::new());
    menu.act(Action::NewRun);
    let configuration = Configuration::shipped();
    menu.form.at = 1;
    for name in configuration.scenarios() {
        let screen = shown(&menu, 120, 39);
        let scenario = configuration.scenario(&name).expect("a scenario");
        let (days, cash) = configuration.terms(&scenario, true).expect("its terms");
        let told = scenario.description.split(' ').take(6).collect::<Vec<_>>().join(" ");
        for part in [
            format!("‹ {name} ›"),
            format!("scenario default: {days}"),
            format!("scenario default: {}", novamind_base::notation::dollars(cash)),
            told,
        ] {
            assert!(screen.contains(&part), "{part} is missing in\n{screen}");
        }
        menu.act(Action::Right);
    }
    let short = configuration.scenario("short").expect("a scenario");
    assert_eq!(configuration.terms(&short, true).expect("its terms").0, 50);
}

#[test]
fn modes_without_anything_to_them_are_not_offered() {
    let mut menu = menu(Vec::new());
    menu.act(Action::NewRun);
    menu.form.at = 0;
    for _ in Mode::ALL {
        menu.act(Action::Right);
        let screen = shown(&menu, 120, 39);
        assert!(!screen.contains("lesson") && !screen.contains("hints"), "{screen}");
    }
}

#[test]
fn hand_outs_and_classes_are_asked_for_by_their_paths() {
    let mut menu = three();
    let screen = shown(&menu, 80, 23);
    assert!(
        screen.contains("such as S07.nm") && screen.contains("Class") && screen.contains("Quit"),
        "{screen}"
    );
    menu.act(Action::Last);
    menu.act(Action::Up);
    menu.act(Action::Open);
    assert_eq!((menu.page, menu.scopes()), (MenuPage::Path, vec![Scope::Field]));
    assert!(matches!(&menu.act(Action::Commit)[..], [Effect::Complain(_)]), "no path is typed");
    type_text(&mut menu, "'~/q class'");
    match &menu.act(Action::Commit)[..] {
        [Effect::Request(Request::ReadClass(path, _))] => assert_eq!(path, std::path::Path::new("~/q class")),
        other => panic!("{other:?}"),
    }
    menu.refused("~/q class is not a class".to_owned(), None);
    assert!(shown(&menu, 80, 23).contains("! ~/q class is not a class"));
    menu.act(Action::Discard);
    assert!(menu.page == MenuPage::Home);
    menu.act(Action::Last);
    menu.act(Action::Up);
    menu.act(Action::Up);
    menu.act(Action::Open);
    menu.paste("S07.nm\n");
    match &menu.act(Action::Commit)[..] {
        [Effect::Request(Request::OpenHandout(path))] => assert_eq!(path, std::path::Path::new("S07.nm")),
        other => panic!("{other:?}"),
    }
}

#[test]
fn the_paper_table_shows_both_kinds_of_results() {
    let mut menu = three();
    menu.page = MenuPage::Paper;
    let screen = shown(&menu, 120, 39);
    for part in
        ["Rule-based baseline", "$15,756,408", "You · bbbb0002", "sandbox · seed 42", "upper bound: $2.20B"]
    {
        assert!(screen.contains(part), "{part} is missing in\n{screen}");
    }
    menu.act(Action::Last);
    menu.act(Action::Down);
    assert_eq!(menu.selected, menu.last());
}

#[test]
fn every_page_is_drawn_in_every_window() {
    for mut menu in [menu(Vec::new()), three(), Menu::new(&Configuration::shipped())] {
        menu.marked = menu.list().iter().map(|run| run.id.clone()).collect();
        let pages = [
            MenuPage::Home,
            MenuPage::NewRun,
            MenuPage::Runs,
            MenuPage::Compare,
            MenuPage::Paper,
            MenuPage::Path,
        ];
        for page in pages {
            menu.page = page;
            for width in (0..130).step_by(26) {
                for height in (0..40).step_by(6) {
                    shown(&menu, width, height);
                }
            }
        }
    }
}

#[test]
fn a_run_is_played_again_from_the_list_and_from_the_first_page() {
    let mut menu = three();
    let replays = |effects: Vec<Effect>, wanted: &str| {
        let [
            Effect::Request(Request::Replay {
                recorded: Recorded::Run(id),
                goal: Goal::First,
                follow: false,
            }),
        ] = &effects[..]
        else {
            panic!("{effects:?}")
        };
        assert_eq!(id, wanted);
    };
    replays(menu.act(Action::ReplayRun), "aaaa0001");
    menu.page = MenuPage::Runs;
    menu.act(Action::Down);
    replays(menu.act(Action::ReplayRun), "bbbb0002");
}

#[test]
fn a_run_that_does_not_open_is_offered_another_way_after_a_question() {
    let long = "trajectory.jsonl, line 8: the line does not follow from the one before. ".repeat(12);
    for (instead, words) in [
        (Instead::Watch("aaaa0001".to_owned()), "Watch it here"),
        (Instead::Rescue("aaaa0001".to_owned()), "as a branch?"),
    ] {
        for page in [MenuPage::Home, MenuPage::Runs] {
            let mut menu = three();
            menu.page = page;
            menu.refused(long.clone(), Some(instead.clone()));
            for (width, height) in [(60, 15), (80, 23), (120, 39)] {
                let screen = shown(&menu, width, height);
                assert!(screen.contains(words), "{screen}");
            }
            assert_eq!(menu.scopes(), [Scope::Dialog]);
            assert!(menu.act(Action::Down).is_empty() && menu.asked.is_some(), "only an answer is accepted");
            match (&instead, &menu.act(Action::Confirm)[..]) {
                (
                    Instead::Watch(_),
                    [Effect::Request(Request::Replay { goal: Goal::Last, follow: true, .. })],
                ) => {}
                (Instead::Rescue(_), [Effect::Request(Request::Rescue(id))]) => assert_eq!(id, "aaaa0001"),
                (_, other) => panic!("{other:?}"),
            }
            menu.refused(long.clone(), Some(instead.clone()));
            assert!(menu.act(Action::Cancel).is_empty() && menu.asked.is_none());
        }
    }
}

#[test]
fn a_participant_agrees_or_nothing_begins() {
    let text = "We keep what you do for a year.\n".repeat(40) + "\nYou can stop at any time.";
    let asked = || {
        let mut menu = three();
        menu.refused(text.clone(), Some(Instead::Agree(Box::default())));
        menu
    };
    let mut menu = asked();
    let screen = shown(&menu, 80, 23);
    for part in ["Before the session", "We keep what you do", "n I do not", "scroll to the end to agree"] {
        assert!(screen.contains(part), "{part} is missing in\n{screen}");
    }
    assert!(!screen.contains("stop at any time"));
    assert!(
        matches!(menu.act(Action::Agree)[..], [Effect::Complain(_)]),
        "the end of the text was not shown"
    );
    (0..60).for_each(|_| drop(menu.act(Action::Down)));
    let end = shown(&menu, 80, 23);
    assert!(end.contains("You can stop at any time.") && end.contains("y I agree"), "{end}");
    match &menu.act(Action::Agree)[..] {
        [Effect::Request(Request::Create(new))] => {
            assert!(new.agreed.as_ref().is_some_and(|agreed| agreed.given.scrolled_to_end));
        }
        other => panic!("{other:?}"),
    }
    for no in [Action::Decline, Action::Close] {
        let mut menu = asked();
        assert!(matches!(menu.act(no)[..], [Effect::Say(_)]));
        assert!(!shown(&menu, 80, 23).contains("Before the session"));
    }
}
