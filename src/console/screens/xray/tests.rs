use super::*;
use crate::headless::Headless;
use crate::keys::KeyBindings;
use crate::screens::Screen;
use crate::test_kit::{handle_action, only_question, new_company, screen_text, played_screen, played_session, settings, loaded_screen, draw_at_all_sizes};
use novamind_record::folder::configuration::Configuration;
use novamind_record::mode::Mode;
use novamind_record::trajectory::record::Via;
use novamind_session::{NewRun, Session, Storage};
use novamind_tools::Rejection;
use novamind_worker::queries::{QueriedTables, Query};

fn with_inspection_permission(company: DisplayedCompany) -> DisplayedCompany {
    DisplayedCompany { can_inspect: true, ..company }
}

fn receive_inspection(screen: &mut Xray, company: &DisplayedCompany, found: Result<InspectionAnswer, Rejection>) -> Vec<Effect> {
    let keys = KeyBindings::bundled();
    let context = ScreenContext { company, keys: &keys, page_rows: 5 };
    screen.pending_question.set_answer(found);
    screen.take_answers(&context)
}

fn inspection_with_line(line: &str) -> Result<InspectionAnswer, Rejection> {
    Ok(InspectionAnswer { lines: vec![line.to_owned()], ..InspectionAnswer::default() })
}

fn asked_day(effects: &[Effect]) -> Option<u32> {
    match effects {
        [] => None,
        effects => match only_question(effects) {
            InspectionQuestion::Leads(_, day, _) => Some(*day),
            _ => None,
        },
    }
}

#[test]
fn questions_are_sent_one_at_a_time() {
    let mut session = played_session(2);
    let company = with_inspection_permission(DisplayedCompany::from_session(&session));
    let mut screen: Xray = loaded_screen(&mut session, &company);
    assert_eq!(asked_day(&screen.request_inspection()), Some(14));
    for _ in 0..3 {
        assert!(handle_action(&mut screen, Action::Left, &company).is_empty(), "a question is being answered");
    }
    assert!(screen_text(&screen, &company, 80, 21).contains("re-simulating …"));
    assert_eq!(asked_day(&receive_inspection(&mut screen, &company, inspection_with_line("of day 14"))), Some(11));
    assert!(receive_inspection(&mut screen, &company, inspection_with_line("of day 11")).is_empty());
    let text = screen_text(&screen, &company, 80, 21);
    assert!(text.contains("of day 11") && !text.contains("of day 14"), "{text}");
    // A question with a known answer is not sent again, and an unexpected answer is ignored.
    assert!(screen.request_inspection().is_empty());
    assert!(receive_inspection(&mut screen, &company, inspection_with_line("of another run")).is_empty());
    assert!(!screen_text(&screen, &company, 80, 21).contains("another run"));
}

#[test]
fn day_navigation_stops_at_the_first_and_last_day() {
    let mut session = played_session(2);
    let company = with_inspection_permission(DisplayedCompany::from_session(&session));
    let mut screen: Xray = loaded_screen(&mut session, &company);
    for (action, day) in [
        (Action::Right, 14),
        (Action::DayWeekBefore, 7),
        (Action::DayWeekBefore, 1),
        (Action::Left, 1),
        (Action::Right, 2),
        (Action::DayWeekAfter, 9),
        (Action::DayWeekAfter, 14),
    ] {
        handle_action(&mut screen, action, &company);
        assert_eq!(screen.day(), day, "{action:?}");
    }
    assert_eq!(screen.day, None, "the selection follows the last day");
}

#[test]
fn confirmed_commands_stay_queued() {
    let mut session = played_session(2);
    let company = with_inspection_permission(DisplayedCompany::from_session(&session));
    let mut screen: Xray = loaded_screen(&mut session, &company);
    assert_eq!(asked_day(&screen.request_inspection()), Some(14));
    let asked = |effects: &[Effect]| match only_question(effects) {
        InspectionQuestion::Command(words, _) => words.clone(),
        other => panic!("{other:?}"),
    };
    let read = |words: &str| (words.to_owned(), InspectionCommand::parse(words).expect(words));
    handle_action(&mut screen, Action::TypeCommand, &company);
    for words in ["who cash", "set group.S1.c_max_mean 300", "diff 6 7", "find leads >= 1"] {
        let (words, inspection_command) = read(words);
        assert!(screen.enqueue_command(words, inspection_command).is_empty(), "a question is being answered");
    }
    let text = screen_text(&screen, &company, 80, 21);
    assert!(text.contains("find leads >= 1") && text.contains("re-simulating"), "{text}");
    let next = receive_inspection(&mut screen, &company, inspection_with_line("of day 14"));
    assert_eq!(asked(&next), "set group.S1.c_max_mean 300");
    let next = receive_inspection(&mut screen, &company, inspection_with_line("set"));
    assert_eq!(asked(&next), "find leads >= 1");
    assert!(receive_inspection(&mut screen, &company, inspection_with_line("the days")).is_empty());
    let text = screen_text(&screen, &company, 80, 21);
    assert!(text.contains("the days"), "{text}");
}

#[test]
fn input_accepts_only_simulated_days() {
    let mut session = played_session(2);
    let company = with_inspection_permission(DisplayedCompany::from_session(&session));
    let mut screen: Xray = loaded_screen(&mut session, &company);
    let mut typed = |view: XrayView, action: Action, text: &str| {
        screen.pending_question.cancel();
        screen.show_view(view);
        handle_action(&mut screen, action, &company);
        if let Some(typing) = &mut screen.input {
            typing.field.insert(text);
        }
        let effects = screen.submit_input();
        let problem = screen.problem.take();
        (effects.first().map(|_| only_question::<InspectionQuestion>(&effects).clone()), problem, screen.day())
    };
    let (inspection_question, _, day) = typed(XrayView::Leads, Action::TypeTarget, "s2 9");
    assert!(matches!(inspection_question, Some(InspectionQuestion::Leads(group, 9, _)) if group.id() == "S2"));
    assert_eq!(day, 9);
    let (asked, ..) = typed(XrayView::Customer, Action::TypeTarget, "7 12");
    assert!(matches!(asked, Some(InspectionQuestion::Customer(7, 12))));
    // Input without a day selects the last day, as in plain mode.
    let (asked, ..) = typed(XrayView::Customer, Action::TypeTarget, "8");
    assert!(matches!(asked, Some(InspectionQuestion::Customer(8, 14))));
    let (asked, ..) = typed(XrayView::Drift, Action::TypeTarget, "3");
    assert!(matches!(asked, Some(InspectionQuestion::Drift(3))));
    let (asked, ..) = typed(XrayView::Quality, Action::SeekDay, "5");
    assert!(matches!(asked, Some(InspectionQuestion::Quality(_, 5))));
    for (view, text, expected) in [
        (XrayView::Leads, "S2 15", "there is no day 15; choose a day from 1 to 14"),
        (XrayView::Customer, "7 0", "there is no day 0"),
        (XrayView::Leads, "S2 soon", "a day is a whole number"),
        (XrayView::Competitors, "99", "choose a day from 1 to 14"),
    ] {
        let (asked, problem, _) = typed(view, Action::TypeTarget, text);
        assert!(asked.is_none(), "{text}");
        assert!(problem.is_some_and(|problem| problem.contains(expected)), "{text}");
    }
}

#[test]
fn no_question_is_sent_without_permission() {
    let (_, company, mut screen) = played_screen::<Xray>(2);
    assert!(screen.request_inspection().is_empty());
    screen.show_breakpoints();
    assert!(screen.request_inspection().is_empty());
    for action in [Action::TypeTarget, Action::RunDays, Action::BreakpointHistory, Action::Left, Action::Open] {
        assert!(handle_action(&mut screen, action, &company).is_empty(), "{action:?}");
    }
    assert!(!screen.scopes().iter().any(|scope| scope.is_text()));
    let text = screen_text(&screen, &company, 100, 30);
    assert!(text.contains("The x-ray is available in debug runs and in runs that have ended."), "{text}");
}

#[test]
fn input_is_parsed_or_rejected() {
    use super::input::InputKind::{Condition, Customer, Days, Group, Part};
    for (expected, text, part) in [
        (Group, "S99", "there is no group S99"),
        (Part, "servise", "did you mean service?"),
        (Customer, "-4", "a customer number"),
        (Days, "0", "a number of days"),
        (Condition, "churn >", ""),
    ] {
        let problem = expected.parse(text).expect_err(text);
        assert!(problem.contains(part), "{problem}");
    }
    assert!(matches!(Group.parse(" s2 "), Ok(ParsedInput::Group(group, None)) if group.id() == "S2"));
    assert!(matches!(Days.parse("28"), Ok(ParsedInput::Days(28))));
}

#[test]
fn screen_is_drawn_at_every_size() {
    let mut session = played_session(2);
    let company = with_inspection_permission(DisplayedCompany::from_session(&session));
    let mut screen: Xray = loaded_screen(&mut session, &company);
    for view in [XrayView::Leads, XrayView::Breakpoints] {
        screen.show_view(view);
        screen.request_inspection();
        receive_inspection(&mut screen, &company, inspection_with_line("a long line of words that is broken into a narrow window"));
        screen.start_input(InputKind::for_view(view));
        screen.problem = Some("something is wrong".to_owned());
        screen_text(&screen, &company, 60, 13);
        draw_at_all_sizes(&mut screen, &company);
    }
}

#[test]
fn no_question_is_sent_before_the_first_day() {
    let company = with_inspection_permission(new_company());
    let mut screen = Xray::default();
    let keys = KeyBindings::bundled();
    screen.on_company_change(&ScreenContext { company: &company, keys: &keys, page_rows: 5 });
    assert!(screen.request_inspection().is_empty());
    assert!(screen_text(&screen, &company, 80, 21).contains("No day has been simulated yet"));
}

/// Checks that requests that bypass the screen do not reveal, record or change hidden state.
#[test]
fn requests_that_bypass_the_screen_are_rejected() {
    for mode in [Mode::Baseline, Mode::Sandbox, Mode::Lesson] {
        let runs = tempfile::tempdir().expect("a folder");
        let new = NewRun {
            mode,
            days: Some(28),
            participant: (mode == Mode::Baseline).then(|| "P01".to_owned()),
            storage: Storage::Runs(runs.path().to_owned()),
            ..NewRun::default()
        };
        let mut session = Session::create(new, &Configuration::bundled()).expect("a run");
        let forecasts = session.company().naive_forecasts();
        session.advance("wait", &forecasts, Via::Form, &mut |_| {}).expect("a week");
        let file = session.folder().expect("a folder").join("trajectory.jsonl");
        drop(session);
        let mut console = Headless::new(settings(runs.path()), (200, 60));
        console.wait_until_idle().expect("the menu");
        console.open("latest").expect("the run opens");
        let group = Group::all().next().expect("a group");
        let words = |text: &str| {
            let inspection_command = InspectionCommand::parse(text).expect(text);
            Effect::Ask(Pending::default().ask(InspectionQuestion::Command(text.to_owned(), inspection_command)))
        };
        let query = Query { sql: "SELECT * FROM hidden.groups".to_owned(), tables: QueriedTables::Hidden };
        for effect in [
            Effect::Ask(Pending::default().ask(InspectionQuestion::Leads(group, 7, Vec::new()))),
            Effect::Ask(Pending::default().ask(InspectionQuestion::Spillover(7))),
            words("find leads >= 0"),
            words("who cash"),
            words("diff 6 7"),
            words("set group.S1.c_max_mean 300"),
            Effect::SendCommand("set group.S1.c_max_mean 300".to_owned()),
            Effect::Ask(Pending::default().ask(query)),
        ] {
            console.app.start(effect);
            console.wait_until_idle().expect("an answer");
        }
        console.finish();
        let lines = std::fs::read_to_string(&file).expect("lines");
        assert!(!lines.contains("\"xray\"") && !lines.contains("\"override\""), "{mode:?}: {lines}");
    }
}
