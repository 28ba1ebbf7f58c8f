use super::*;
use crate::console::keys::Keys;
use crate::console::screens::Screen;
use crate::console::test_kit::{act, company, drawn, played, shown, sweep};

fn open(company: Company) -> Company {
    Company { may_look_inside: true, ..company }
}

fn hear(screen: &mut Xray, company: &Company, found: Result<LookFound, Refusal>) -> Vec<Effect> {
    let keys = Keys::shipped();
    let look = Look { company, keys: &keys, page: 5 };
    screen.hear(&News::LookedInside(1, Box::new(found)), &look)
}

fn found(line: &str) -> Result<LookFound, Refusal> {
    Ok(LookFound { lines: vec![line.to_owned()], breakpoints: Vec::new() })
}

fn day_asked(effects: &[Effect]) -> Option<u32> {
    match effects {
        [Effect::LookInside(LookQuestion::Leads(_, day, _))] => Some(*day),
        _ => None,
    }
}

#[test]
fn one_question_is_asked_at_a_time_and_the_newest_next() {
    let mut session = played(2);
    let company = open(Company::of(&session));
    let mut screen: Xray = shown(&mut session, &company);
    assert_eq!(day_asked(&screen.ask()), Some(14));
    for _ in 0..3 {
        assert!(act(&mut screen, Action::Left, &company).is_empty(), "one is being answered");
    }
    assert!(drawn(&screen, &company, 80, 21).contains("simulating days again …"));
    assert_eq!(day_asked(&hear(&mut screen, &company, found("of day 14"))), Some(11));
    assert!(hear(&mut screen, &company, found("of day 11")).is_empty());
    let text = drawn(&screen, &company, 80, 21);
    assert!(text.contains("of day 11") && !text.contains("of day 14"), "{text}");
    // What is known is not asked again, and an answer that nobody waits for is dropped.
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
    assert_eq!(screen.day, None, "the last day is followed");
}

#[test]
fn nothing_is_asked_where_hidden_state_stays_hidden() {
    let mut session = played(2);
    let company = Company::of(&session);
    let mut screen: Xray = shown(&mut session, &company);
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
        (Customer, "-4", "the number of a customer"),
        (Days, "0", "a number of days"),
        (Condition, "churn >", ""),
    ] {
        let problem = expected.read(text).expect_err(text);
        assert!(problem.contains(part), "{problem}");
    }
    assert!(matches!(Group.read(" s2 "), Ok(Typed::Group(group)) if group.id() == "S2"));
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
    assert!(drawn(&screen, &company, 80, 21).contains("no day has run yet"));
}
