use super::*;
use crate::headless::Headless;
use crate::keys::Keys;
use crate::screens::Screen;
use crate::test_kit::{act, asked, company, drawn, on_screen, played, settings, shown, sweep};
use novamind_record::folder::configuration::Configuration;
use novamind_record::mode::Mode;
use novamind_record::trajectory::record::Via;
use novamind_session::{NewRun, Session, Storage};
use novamind_tools::Refusal;
use novamind_worker::queries::{QueriedTables, Query};

fn open(company: Company) -> Company {
    Company { may_look_inside: true, ..company }
}

fn hear(screen: &mut Xray, company: &Company, found: Result<LookFound, Refusal>) -> Vec<Effect> {
    let keys = Keys::shipped();
    let look = Look { company, keys: &keys, page: 5 };
    screen.asked.put(found);
    screen.take_answers(&look)
}

fn found(line: &str) -> Result<LookFound, Refusal> {
    Ok(LookFound { lines: vec![line.to_owned()], ..LookFound::default() })
}

fn day_asked(effects: &[Effect]) -> Option<u32> {
    match effects {
        [] => None,
        effects => match asked(effects) {
            LookQuestion::Leads(_, day, _) => Some(*day),
            _ => None,
        },
    }
}

#[test]
fn one_question_is_asked_at_a_time_and_the_newest_next() {
    let mut session = played(2);
    let company = open(Company::of(&session));
    let mut screen: Xray = shown(&mut session, &company);
    assert_eq!(day_asked(&screen.ask()), Some(14));
    for _ in 0..3 {
        assert!(act(&mut screen, Action::Left, &company).is_empty(), "a question is being answered");
    }
    assert!(drawn(&screen, &company, 80, 21).contains("re-simulating …"));
    assert_eq!(day_asked(&hear(&mut screen, &company, found("of day 14"))), Some(11));
    assert!(hear(&mut screen, &company, found("of day 11")).is_empty());
    let text = drawn(&screen, &company, 80, 21);
    assert!(text.contains("of day 11") && !text.contains("of day 14"), "{text}");
    // A known answer is not requested again, and an unexpected answer is ignored.
    assert!(screen.ask().is_empty());
    assert!(hear(&mut screen, &company, found("of another run")).is_empty());
    assert!(!drawn(&screen, &company, 80, 21).contains("another run"));
}

#[test]
fn days_are_walked_between_the_first_and_the_last() {
    let mut session = played(2);
    let company = open(Company::of(&session));
    let mut screen: Xray = shown(&mut session, &company);
    for (action, day) in [
        (Action::Right, 14),
        (Action::DayWeekBefore, 7),
        (Action::DayWeekBefore, 1),
        (Action::Left, 1),
        (Action::Right, 2),
        (Action::DayWeekAfter, 9),
        (Action::DayWeekAfter, 14),
    ] {
        act(&mut screen, action, &company);
        assert_eq!(screen.day(), day, "{action:?}");
    }
    assert_eq!(screen.day, None, "the selection follows the last day");
}

#[test]
fn words_that_are_typed_meanwhile_are_asked_next_and_what_was_confirmed_is_not_dropped() {
    let mut session = played(2);
    let company = open(Company::of(&session));
    let mut screen: Xray = shown(&mut session, &company);
    assert_eq!(day_asked(&screen.ask()), Some(14));
    let asked = |effects: &[Effect]| match asked(effects) {
        LookQuestion::Words(words, _) => words.clone(),
        other => panic!("{other:?}"),
    };
    let read = |words: &str| (words.to_owned(), AskedWords::read(words).expect(words));
    act(&mut screen, Action::AskWords, &company);
    for words in ["who cash", "set group.S1.c_max_mean 300", "diff 6 7", "find leads >= 1"] {
        let (words, asked) = read(words);
        assert!(screen.send_asked(words, asked).is_empty(), "a question is being answered");
    }
    let text = drawn(&screen, &company, 80, 21);
    assert!(text.contains("find leads >= 1") && text.contains("re-simulating"), "{text}");
    let next = hear(&mut screen, &company, found("of day 14"));
    assert_eq!(asked(&next), "set group.S1.c_max_mean 300");
    let next = hear(&mut screen, &company, found("set"));
    assert_eq!(asked(&next), "find leads >= 1");
    assert!(hear(&mut screen, &company, found("the days")).is_empty());
    let text = drawn(&screen, &company, 80, 21);
    assert!(text.contains("the days"), "{text}");
}

#[test]
fn a_day_is_typed_with_a_group_or_a_customer_or_alone_and_has_to_be_there() {
    let mut session = played(2);
    let company = open(Company::of(&session));
    let mut screen: Xray = shown(&mut session, &company);
    let mut typed = |view: View, action: Action, text: &str| {
        screen.asked.cancel();
        screen.show(view);
        act(&mut screen, action, &company);
        if let Some(typing) = &mut screen.typing {
            typing.field.insert(text);
        }
        let effects = screen.commit();
        let problem = screen.problem.take();
        (effects.first().map(|_| asked::<LookQuestion>(&effects).clone()), problem, screen.day())
    };
    let (asked, _, day) = typed(View::Leads, Action::TypeChoice, "s2 9");
    assert!(matches!(asked, Some(LookQuestion::Leads(group, 9, _)) if group.id() == "S2"));
    assert_eq!(day, 9);
    let (asked, ..) = typed(View::Customer, Action::TypeChoice, "7 12");
    assert!(matches!(asked, Some(LookQuestion::Customer(7, 12))));
    // Without a day the question is for the last day, as in plain mode.
    let (asked, ..) = typed(View::Customer, Action::TypeChoice, "8");
    assert!(matches!(asked, Some(LookQuestion::Customer(8, 14))));
    let (asked, ..) = typed(View::Drift, Action::TypeChoice, "3");
    assert!(matches!(asked, Some(LookQuestion::Drift(3))));
    let (asked, ..) = typed(View::Quality, Action::SeekDay, "5");
    assert!(matches!(asked, Some(LookQuestion::Quality(_, 5))));
    for (view, text, said) in [
        (View::Leads, "S2 15", "there is no day 15; choose a day from 1 to 14"),
        (View::Customer, "7 0", "there is no day 0"),
        (View::Leads, "S2 soon", "a day is a whole number"),
        (View::Rivals, "99", "choose a day from 1 to 14"),
    ] {
        let (asked, problem, _) = typed(view, Action::TypeChoice, text);
        assert!(asked.is_none(), "{text}");
        assert!(problem.is_some_and(|problem| problem.contains(said)), "{text}");
    }
}

#[test]
fn nothing_is_asked_where_hidden_state_stays_hidden() {
    let (_, company, mut screen) = on_screen::<Xray>(2);
    assert!(screen.ask().is_empty());
    screen.show_breakpoints();
    assert!(screen.ask().is_empty());
    for action in [Action::TypeChoice, Action::RunDays, Action::LookBack, Action::Left, Action::Open] {
        assert!(act(&mut screen, action, &company).is_empty(), "{action:?}");
    }
    assert!(!screen.scopes().iter().any(|scope| scope.is_text()));
    let text = drawn(&screen, &company, 100, 30);
    assert!(text.contains("The x-ray works in debug runs and in runs that are over."), "{text}");
}

#[test]
fn what_is_typed_is_read_or_said_to_be_wrong() {
    use super::typing::Expected::{Condition, Customer, Days, Group, Part};
    for (expected, text, part) in [
        (Group, "S99", "there is no group S99"),
        (Part, "servise", "did you mean service?"),
        (Customer, "-4", "a customer number"),
        (Days, "0", "a number of days"),
        (Condition, "churn >", ""),
    ] {
        let problem = expected.read(text).expect_err(text);
        assert!(problem.contains(part), "{problem}");
    }
    assert!(matches!(Group.read(" s2 "), Ok(Typed::Group(group, None)) if group.id() == "S2"));
    assert!(matches!(Days.read("28"), Ok(Typed::Days(28))));
}

#[test]
fn every_size_is_drawn() {
    let mut session = played(2);
    let company = open(Company::of(&session));
    let mut screen: Xray = shown(&mut session, &company);
    for view in [View::Leads, View::Breakpoints] {
        screen.show(view);
        screen.ask();
        hear(&mut screen, &company, found("a long line of words that is broken into a narrow window"));
        screen.type_in(Expected::in_view(view));
        screen.problem = Some("something is wrong".to_owned());
        drawn(&screen, &company, 60, 13);
        sweep(&mut screen, &company);
    }
}

#[test]
fn before_the_first_day_nothing_is_asked() {
    let company = open(company());
    let mut screen = Xray::default();
    let keys = Keys::shipped();
    screen.renew(&Look { company: &company, keys: &keys, page: 5 });
    assert!(screen.ask().is_empty());
    assert!(drawn(&screen, &company, 80, 21).contains("No day has been simulated yet"));
}

/// Requests that bypass the screen must not reveal, record or change hidden state.
#[test]
fn requests_that_go_around_the_screen_are_refused() {
    for mode in [Mode::Baseline, Mode::Sandbox, Mode::Lesson] {
        let runs = tempfile::tempdir().expect("a folder");
        let new = NewRun {
            mode,
            days: Some(28),
            participant: (mode == Mode::Baseline).then(|| "P01".to_owned()),
            storage: Storage::Runs(runs.path().to_owned()),
            ..NewRun::default()
        };
        let mut session = Session::create(new, &Configuration::shipped()).expect("a run");
        let forecasts = session.company().naive_forecasts();
        session.advance("wait", &forecasts, Via::Form, &mut |_| {}).expect("a week");
        let file = session.folder().expect("a folder").join("trajectory.jsonl");
        drop(session);
        let mut console = Headless::new(settings(runs.path()), (200, 60));
        console.settle().expect("the menu");
        console.open("latest").expect("it opens");
        let group = Group::all().next().expect("a group");
        let words = |text: &str| {
            let asked = AskedWords::read(text).expect(text);
            Effect::Ask(Pending::default().ask(LookQuestion::Words(text.to_owned(), asked)))
        };
        let query = Query { sql: "SELECT * FROM hidden.groups".to_owned(), of: QueriedTables::Hidden };
        for effect in [
            Effect::Ask(Pending::default().ask(LookQuestion::Leads(group, 7, Vec::new()))),
            Effect::Ask(Pending::default().ask(LookQuestion::Spillover(7))),
            words("find leads >= 0"),
            words("who cash"),
            words("diff 6 7"),
            words("set group.S1.c_max_mean 300"),
            Effect::SendWords("set group.S1.c_max_mean 300".to_owned()),
            Effect::Ask(Pending::default().ask(query)),
        ] {
            console.app.start_with(effect);
            console.settle().expect("an answer");
        }
        console.finish();
        let lines = std::fs::read_to_string(&file).expect("lines");
        assert!(!lines.contains("\"xray\"") && !lines.contains("\"override\""), "{mode:?}: {lines}");
    }
}
