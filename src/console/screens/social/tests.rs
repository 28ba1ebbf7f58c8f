use std::sync::Arc;

use crossterm::event::{KeyCode, KeyEvent, KeyModifiers};

use super::*;
use crate::action::Scope;
use crate::keys::KeyBindings;
use crate::screens::Screen;
use crate::test_kit::{handle_action, only_question, screen_text, played_screen, played_session, loaded_screen, draw_at_all_sizes};
use novamind_record::trajectory::record::Via;
use novamind_session::Session;
use novamind_tools::Rejection;
use novamind_worker::company::DisplayedCompany;

fn with_context<T>(company: &DisplayedCompany, work: impl FnOnce(&ScreenContext<'_>) -> T) -> T {
    let keys = KeyBindings::bundled();
    work(&ScreenContext { company, keys: &keys, page_rows: 5 })
}

fn type_draft(screen: &mut Social, company: &DisplayedCompany, text: &str) {
    for letter in text.chars() {
        let key = KeyEvent::new(KeyCode::Char(letter), KeyModifiers::NONE);
        with_context(company, |context| screen.handle_key(&key, context));
    }
}

/// Returns a run that published a post after its third week and has simulated two more weeks.
fn run_with_posts() -> Session {
    let mut session = played_session(3);
    let text = "Freelancers: 20% more of your drafts are right at once, measured on 1,200 of them.";
    session.call(POST_TOOL, &json!({ "content": text }), Via::Form).expect("a post");
    for _ in 0..2 {
        let forecasts = session.company().naive_forecasts();
        session.advance("as planned", &forecasts, Via::Form, &mut |_| {}).expect("a week");
    }
    session
}

#[test]
fn feed_agrees_with_tools_and_database() {
    let mut session = run_with_posts();
    let company = DisplayedCompany::from_session(&session);
    let screen: Social = loaded_screen(&mut session, &company);
    let total = company.posts.len() as u64;
    assert!(total > 10, "{total}");
    assert_eq!(screen.feed.len() as u64, total + 1);
    assert!(screen.own_posts[0].views > 0 && screen.own_posts[0].day == 21);
    let comments = screen.others.iter().filter(|post| post.kind == PostKind::Comments).count();
    assert_eq!(comments as u32, screen.own_posts[0].comments);
    let rows = session.query("SELECT count(*) FROM social_media_posts").expect("rows");
    assert_eq!(novamind_database::number_at(&rows.rows[0], 0) as u64, total);
}

#[test]
fn large_windows_also_show_own_posts() {
    let mut session = run_with_posts();
    let company = DisplayedCompany::from_session(&session);
    let mut screen: Social = loaded_screen(&mut session, &company);
    for (width, height) in [(80, 21), (120, 37), (200, 57)] {
        let text = screen_text(&screen, &company, width, height);
        for words in ["Feed", "── day 35 · week 5", "New post", "0 of 280 characters", "p write"] {
            assert!(text.contains(words), "{width}×{height} {words} in\n{text}");
        }
        if width >= 120 {
            for words in ["Your posts", "1 · ", " views", "Posts by week", "press "] {
                assert!(text.contains(words), "{width}×{height} {words} in\n{text}");
            }
        }
    }
    screen.set_focused_pane(SocialPane::OwnPosts);
    let text = screen_text(&screen, &company, 80, 21);
    assert!(text.contains("Your posts") && text.contains("Freelancers: 20% more"), "{text}");
}

#[test]
fn filters_narrow_the_feed_until_escape() {
    let mut session = run_with_posts();
    let company = DisplayedCompany::from_session(&session);
    let mut screen: Social = loaded_screen(&mut session, &company);
    let all = screen.visible_posts.len();
    handle_action(&mut screen, Action::NextKind, &company);
    assert!(screen.visible_posts.len() < all && screen.selected_post().is_some_and(|post| post.kind == PostKind::Customers));
    handle_action(&mut screen, Action::EarlierWeek, &company);
    assert!(screen.visible_posts.iter().all(|at| screen.feed[*at].week() == 5));
    let text = screen_text(&screen, &company, 120, 37);
    assert!(text.contains("customers · week 5: "), "{text}");
    handle_action(&mut screen, Action::Filter, &company);
    assert_eq!(screen.scopes(), [Scope::Field]);
    type_draft(&mut screen, &company, "zzzz");
    handle_action(&mut screen, Action::Commit, &company);
    assert!(screen.visible_posts.is_empty());
    assert!(screen_text(&screen, &company, 80, 21).contains("No matching posts: esc"));
    draw_at_all_sizes(&mut screen, &company);
    screen.set_focused_pane(SocialPane::Feed);
    handle_action(&mut screen, Action::Close, &company);
    assert_eq!(screen.visible_posts.len(), all);
}

#[test]
fn a_post_opens_with_its_comments() {
    let mut session = run_with_posts();
    let company = DisplayedCompany::from_session(&session);
    let mut screen: Social = loaded_screen(&mut session, &company);
    let all = screen.visible_posts.len();
    screen.set_focused_pane(SocialPane::OwnPosts);
    assert!(handle_action(&mut screen, Action::Open, &company).is_empty());
    assert_eq!((screen.focus, screen.visible_posts.len() as u32), (SocialPane::Feed, screen.own_posts[0].comments + 1));
    let seen = screen_text(&screen, &company, 120, 37);
    assert!(seen.contains("thread of your post 1: ") && seen.contains("our post 1 · "), "{seen}");
    let effects = handle_action(&mut screen, Action::Open, &company);
    let [Effect::ShowText(title, text)] = &effects[..] else { panic!("{effects:?}") };
    assert!(
        title.starts_with("day 21 · our post 1 · ") && text.contains("measured on 1,200"),
        "{title} {text}"
    );
    assert_eq!(text.matches("↳ ").count() as u32, screen.own_posts[0].comments);
    handle_action(&mut screen, Action::Close, &company);
    assert_eq!(screen.visible_posts.len(), all, "esc leaves the thread");
    let effects = handle_action(&mut screen, Action::Open, &company);
    assert!(matches!(&effects[..], [Effect::ShowText(..)]), "{effects:?}");
}

#[test]
fn figures_equal_their_rows() {
    let mut session = run_with_posts();
    let company = DisplayedCompany::from_session(&session);
    let mut screen: Social = loaded_screen(&mut session, &company);
    let mut rows = |screen: &Social| {
        let figure = with_context(&company, |context| screen.figure(context)).expect("a figure");
        let sql = figure.sql.expect("rows");
        session.query(&sql).unwrap_or_else(|rejection| panic!("{sql}: {rejection}")).rows
    };
    let number = screen.selected_post().expect("a post").number;
    assert_eq!(rows(&screen)[0][0], novamind_database::Cell::Integer(i64::from(number)));
    screen.set_focused_pane(SocialPane::OwnPosts);
    assert_eq!(rows(&screen)[0][2], novamind_database::Cell::Integer(i64::from(screen.own_posts[0].views)));
    handle_action(&mut screen, Action::Right, &company);
    handle_action(&mut screen, Action::Right, &company);
    assert_eq!(rows(&screen).len() as u32, screen.own_posts[0].comments);
}

#[test]
fn post_is_checked_confirmed_and_sent() {
    let (mut session, company, mut screen) = played_screen::<Social>(2);
    let effects = handle_action(&mut screen, Action::SendPost, &company);
    assert!(matches!(&effects[..], [Effect::ShowError(text)] if text.contains("Nothing to publish")));
    let answered = screen.selected_post().expect("a post").number;
    handle_action(&mut screen, Action::Reply, &company);
    assert_eq!(screen.scopes(), [Scope::Editor, Scope::Social]);
    type_draft(&mut screen, &company, &"x".repeat(281));
    let effects = handle_action(&mut screen, Action::SendPost, &company);
    assert!(
        matches!(&effects[..], [Effect::ShowError(text)] if text.contains("Shorten it by 1")),
        "{effects:?}"
    );
    assert!(screen_text(&screen, &company, 120, 37).contains("! 281 of 280 characters: 1 too many"));
    let key = KeyEvent::new(KeyCode::Backspace, KeyModifiers::NONE);
    with_context(&company, |context| screen.handle_key(&key, context));
    handle_action(&mut screen, Action::LeaveEditor, &company);
    assert!(screen.has_unsent_text(), "the draft is kept");
    let effects = handle_action(&mut screen, Action::SendPost, &company);
    let PreviewCallQuestion { tool, arguments } = only_question(&effects);
    assert_eq!(arguments["reply_to_post_id"], answered);
    screen.pending_call.set_answer(session.preview_call(*tool, arguments));
    let effects = with_context(&company, |screen_context| screen.take_answers(screen_context));
    let [Effect::ConfirmCall { tool, arguments, text }] = &effects[..] else { panic!("{effects:?}") };
    assert!(text.contains("cannot be undone") && text.contains("on day 15"), "{text}");
    let answer = session.call(tool, arguments, Via::Form);
    let company = DisplayedCompany::from_session(&session);
    let called = Response::ToolCalled(POST_TOOL, answer.map(Box::new), Arc::new(company.clone()));
    with_context(&company, |look| screen.handle_response(&called, look));
    assert!(!screen.has_unsent_text() && screen.reply_to.is_none());
    let screen: Social = loaded_screen(&mut session, &company);
    assert_eq!(screen.own_posts[0].answered_post, Some(answered));
    assert!(screen_text(&screen, &company, 80, 21).contains("This week's post is published"));
}

#[test]
fn rejected_post_keeps_the_draft() {
    let (_, company, mut screen) = played_screen::<Social>(1);
    handle_action(&mut screen, Action::Compose, &company);
    type_draft(&mut screen, &company, "Again");
    handle_action(&mut screen, Action::SendPost, &company);
    assert!(screen.edited_text().is_none(), "keys after a cancelled question are not typed into the post");
    let refused = || Err(Rejection::new("already_posted", "you have already posted"));
    screen.pending_call.set_answer(refused());
    let effects = with_context(&company, |context| screen.take_answers(context));
    assert!(
        matches!(&effects[..], [Effect::ShowError(text)] if text.contains("already posted")),
        "{effects:?}"
    );
    assert_eq!(screen.draft.text(), "Again");
    screen.pending_call.set_answer(refused());
    let effects = with_context(&company, |screen_context| screen.take_answers(screen_context));
    assert!(effects.is_empty(), "an unexpected answer is ignored");
}

#[test]
fn viewed_posts_are_not_new() {
    let (_, _, mut screen) = played_screen::<Social>(2);
    let week = screen.others.iter().filter(|post| post.day > 7).count();
    assert_eq!((screen.unseen_count(), week > 0), (week, true));
    screen.mark_seen();
    assert_eq!(screen.unseen_count(), 0);
    // A later session counts all posts since the screen was viewed, not only those of the last week.
    (screen.newest_seen_post, screen.last_viewed_day) = (None, Some(0));
    assert_eq!(screen.unseen_count(), screen.others.len());
    assert!(screen.others.len() > week);
}

#[test]
fn draft_is_drawn_at_every_size() {
    let mut session = run_with_posts();
    let company = DisplayedCompany::from_session(&session);
    let mut screen: Social = loaded_screen(&mut session, &company);
    handle_action(&mut screen, Action::Compose, &company);
    type_draft(&mut screen, &company, "a long post with words, and more of them");
    screen_text(&screen, &company, 3, 40);
    draw_at_all_sizes(&mut screen, &company);
    let empty = screen_text(&Social::default(), &company, 80, 21);
    assert!(empty.contains("No posts yet. Run a week"), "{empty}");
}
