use std::sync::Arc;

use crossterm::event::{KeyCode, KeyEvent, KeyModifiers};

use super::*;
use crate::action::Scope;
use crate::keys::Keys;
use crate::screens::Screen;
use crate::test_kit::{act, asked, drawn, on_screen, played, shown, sweep};
use novamind_record::trajectory::record::Via;
use novamind_session::Session;
use novamind_tools::Refusal;
use novamind_worker::company::Company;

fn with_look<T>(company: &Company, work: impl FnOnce(&Look<'_>) -> T) -> T {
    let keys = Keys::shipped();
    work(&Look { company, keys: &keys, page: 5 })
}

fn write(screen: &mut Social, company: &Company, text: &str) {
    for letter in text.chars() {
        let key = KeyEvent::new(KeyCode::Char(letter), KeyModifiers::NONE);
        with_look(company, |look| screen.key(&key, look));
    }
}

/// Returns a company that posted after its third week, two weeks ago.
fn talked() -> Session {
    let mut session = played(3);
    let text = "Freelancers: 20% more of your drafts are right at once, measured on 1,200 of them.";
    session.call(POST, &json!({ "content": text }), Via::Form).expect("a post");
    for _ in 0..2 {
        let forecasts = session.company().naive_forecasts();
        session.advance("as planned", &forecasts, Via::Form, &mut |_| {}).expect("a week");
    }
    session
}

#[test]
fn the_feed_holds_what_the_tools_and_the_database_tell() {
    let mut session = talked();
    let company = Company::of(&session);
    let screen: Social = shown(&mut session, &company);
    let total = company.posts.len() as u64;
    assert!(total > 10, "{total}");
    assert_eq!(screen.all.len() as u64, total + 1);
    assert!(screen.own[0].views > 0 && screen.own[0].day == 21);
    let comments = screen.others.iter().filter(|post| post.kind == PostKind::Comments).count();
    assert_eq!(comments as u32, screen.own[0].comments);
    let rows = session.query("SELECT count(*) FROM social_media_posts").expect("rows");
    assert_eq!(novamind_database::number_at(&rows.rows[0], 0) as u64, total);
}

#[test]
fn every_window_shows_feed_and_desk_and_large_ones_our_posts() {
    let mut session = talked();
    let company = Company::of(&session);
    let mut screen: Social = shown(&mut session, &company);
    for (width, height) in [(80, 21), (120, 37), (200, 57)] {
        let text = drawn(&screen, &company, width, height);
        for words in ["Feed", "── day 35 · week 5", "New post", "0 of 280 characters", "p write"] {
            assert!(text.contains(words), "{width}×{height} {words} in\n{text}");
        }
        if width >= 120 {
            for words in ["Your posts", "1 · ", " views", "Posts by week", "press "] {
                assert!(text.contains(words), "{width}×{height} {words} in\n{text}");
            }
        }
    }
    screen.focus_on(SocialPane::Own);
    let text = drawn(&screen, &company, 80, 21);
    assert!(text.contains("Your posts") && text.contains("Freelancers: 20% more"), "{text}");
}

#[test]
fn filters_narrow_the_feed_and_esc_ends_them() {
    let mut session = talked();
    let company = Company::of(&session);
    let mut screen: Social = shown(&mut session, &company);
    let all = screen.shown.len();
    act(&mut screen, Action::NextKind, &company);
    assert!(screen.shown.len() < all && screen.post().is_some_and(|post| post.kind == PostKind::Customers));
    act(&mut screen, Action::EarlierWeek, &company);
    assert!(screen.shown.iter().all(|at| screen.all[*at].week() == 5));
    let text = drawn(&screen, &company, 120, 37);
    assert!(text.contains("customers · week 5: "), "{text}");
    act(&mut screen, Action::Filter, &company);
    assert_eq!(screen.scopes(), [Scope::Field]);
    write(&mut screen, &company, "zzzz");
    act(&mut screen, Action::Commit, &company);
    assert!(screen.shown.is_empty());
    assert!(drawn(&screen, &company, 80, 21).contains("No matching posts: esc"));
    sweep(&mut screen, &company);
    screen.focus_on(SocialPane::Feed);
    act(&mut screen, Action::Close, &company);
    assert_eq!(screen.shown.len(), all);
}

#[test]
fn a_post_opens_with_its_comments() {
    let mut session = talked();
    let company = Company::of(&session);
    let mut screen: Social = shown(&mut session, &company);
    let all = screen.shown.len();
    screen.focus_on(SocialPane::Own);
    assert!(act(&mut screen, Action::Open, &company).is_empty());
    assert_eq!((screen.focus, screen.shown.len() as u32), (SocialPane::Feed, screen.own[0].comments + 1));
    let seen = drawn(&screen, &company, 120, 37);
    assert!(seen.contains("thread of your post 1: ") && seen.contains("our post 1 · "), "{seen}");
    let effects = act(&mut screen, Action::Open, &company);
    let [Effect::ShowText(title, text)] = &effects[..] else { panic!("{effects:?}") };
    assert!(
        title.starts_with("day 21 · our post 1 · ") && text.contains("measured on 1,200"),
        "{title} {text}"
    );
    assert_eq!(text.matches("↳ ").count() as u32, screen.own[0].comments);
    act(&mut screen, Action::Close, &company);
    assert_eq!(screen.shown.len(), all, "esc leaves the thread");
    let effects = act(&mut screen, Action::Open, &company);
    assert!(matches!(&effects[..], [Effect::ShowText(..)]), "{effects:?}");
}

#[test]
fn figures_are_made_of_their_rows() {
    let mut session = talked();
    let company = Company::of(&session);
    let mut screen: Social = shown(&mut session, &company);
    let mut rows = |screen: &Social| {
        let figure = with_look(&company, |look| screen.figure(look)).expect("a figure");
        let sql = figure.sql.expect("rows");
        session.query(&sql).unwrap_or_else(|refusal| panic!("{sql}: {refusal}")).rows
    };
    let number = screen.post().expect("a post").number;
    assert_eq!(rows(&screen)[0][0], novamind_database::Cell::Integer(i64::from(number)));
    screen.focus_on(SocialPane::Own);
    assert_eq!(rows(&screen)[0][2], novamind_database::Cell::Integer(i64::from(screen.own[0].views)));
    act(&mut screen, Action::Right, &company);
    act(&mut screen, Action::Right, &company);
    assert_eq!(rows(&screen).len() as u32, screen.own[0].comments);
}

#[test]
fn a_post_is_written_checked_asked_for_and_sent() {
    let (mut session, company, mut screen) = on_screen::<Social>(2);
    let effects = act(&mut screen, Action::SendPost, &company);
    assert!(matches!(&effects[..], [Effect::Complain(text)] if text.contains("Nothing to publish")));
    let answered = screen.post().expect("a post").number;
    act(&mut screen, Action::Reply, &company);
    assert_eq!(screen.scopes(), [Scope::Editor, Scope::Social]);
    write(&mut screen, &company, &"x".repeat(281));
    let effects = act(&mut screen, Action::SendPost, &company);
    assert!(
        matches!(&effects[..], [Effect::Complain(text)] if text.contains("Shorten it by 1")),
        "{effects:?}"
    );
    assert!(drawn(&screen, &company, 120, 37).contains("! 281 of 280 characters: 1 too many"));
    let key = KeyEvent::new(KeyCode::Backspace, KeyModifiers::NONE);
    with_look(&company, |look| screen.key(&key, look));
    act(&mut screen, Action::LeaveEditor, &company);
    assert!(screen.holds_unsent_text(), "the draft is kept");
    let effects = act(&mut screen, Action::SendPost, &company);
    let CallCheck { tool, arguments } = asked(&effects);
    assert_eq!(arguments["reply_to_post_id"], answered);
    screen.sending.put(session.check(*tool, arguments));
    let effects = with_look(&company, |look| screen.take_answers(look));
    let [Effect::ConfirmCall { tool, arguments, text }] = &effects[..] else { panic!("{effects:?}") };
    assert!(text.contains("cannot be undone") && text.contains("on day 15"), "{text}");
    let answer = session.call(tool, arguments, Via::Form);
    let company = Company::of(&session);
    let called = News::Called(POST, answer.map(Box::new), Arc::new(company.clone()));
    with_look(&company, |look| screen.hear(&called, look));
    assert!(!screen.holds_unsent_text() && screen.answers.is_none());
    let screen: Social = shown(&mut session, &company);
    assert_eq!(screen.own[0].answers, Some(answered));
    assert!(drawn(&screen, &company, 80, 21).contains("This week's post is published"));
}

#[test]
fn a_refused_post_keeps_the_draft() {
    let (_, company, mut screen) = on_screen::<Social>(1);
    act(&mut screen, Action::Compose, &company);
    write(&mut screen, &company, "Again");
    act(&mut screen, Action::SendPost, &company);
    let refused = || Err(Refusal::new("already_posted", "you have already posted"));
    screen.sending.put(refused());
    let effects = with_look(&company, |look| screen.take_answers(look));
    assert!(
        matches!(&effects[..], [Effect::Complain(text)] if text.contains("already posted")),
        "{effects:?}"
    );
    assert_eq!(screen.draft.text(), "Again");
    screen.sending.put(refused());
    let effects = with_look(&company, |look| screen.take_answers(look));
    assert!(effects.is_empty(), "an unexpected answer is ignored");
}

#[test]
fn what_was_looked_at_is_not_new() {
    let (_, _, mut screen) = on_screen::<Social>(2);
    let week = screen.others.iter().filter(|post| post.day > 7).count();
    assert_eq!((screen.unseen(), week > 0), (week, true));
    screen.looked_at();
    assert_eq!(screen.unseen(), 0);
}

#[test]
fn a_draft_is_drawn_in_every_window() {
    let mut session = talked();
    let company = Company::of(&session);
    let mut screen: Social = shown(&mut session, &company);
    act(&mut screen, Action::Compose, &company);
    write(&mut screen, &company, "a long post with words, and more of them");
    drawn(&screen, &company, 3, 40);
    sweep(&mut screen, &company);
    let empty = drawn(&Social::default(), &company, 80, 21);
    assert!(empty.contains("No posts yet. Run a week"), "{empty}");
}
