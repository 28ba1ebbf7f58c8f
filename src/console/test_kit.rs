//! What the tests of the screens share: companies from runs in memory, a screen that was told everything, its picture
//! as text, and windows of every size.

use ratatui::buffer::Buffer;
use ratatui::layout::Rect;
use serde_json::{Value, json};

use super::action::Action;
use super::company::Company;
use super::context::Look;
use super::dialogs::{Dialog, Outcome};
use super::effect::Effect;
use super::keys::Keys;
use super::readings::Reading;
use super::screens::Screen;
use novamind_session::{Configuration, NewRun, Rows, Session, Storage, Via};
use novamind_tui::canvas::Canvas;
use novamind_tui::theme::Theme;

/// A run in memory on its first day.
pub fn session() -> Session {
    let new = NewRun { storage: Storage::Memory, ..NewRun::default() };
    Session::create(new, &Configuration::shipped()).expect("a run in memory")
}

/// A company on its first day.
pub fn company() -> Company {
    Company::of(&session())
}

/// A run that was played for some weeks by a sensible beginner.
pub fn played(weeks: usize) -> Session {
    let new = NewRun { seed: Some(7), days: Some(200), storage: Storage::Memory, ..NewRun::default() };
    let mut session = Session::create(new, &Configuration::shipped()).expect("a run");
    if weeks > 0 {
        open_shop(&mut session);
    }
    for _ in 0..weeks {
        let forecasts = session.naive_forecasts();
        session.advance("as planned", &forecasts, Via::Form, &mut |_| {}).expect("a week");
    }
    session
}

fn open_shop(session: &mut Session) {
    let calls: [(&str, Value); 8] = [
        ("set_prices", json!({"A": 12, "B": 25, "C": 55})),
        ("set_model_tiers", json!({"B": 2, "C": 4})),
        ("set_usage_quotas", json!({"A": 60000, "B": 250000, "C": 1200000})),
        ("set_daily_spend", json!({"operations": 200, "development": 200})),
        ("set_targeted_dev_spend", json!({"S1": 6000})),
        ("set_targeted_ad_spend", json!({"content_marketing": {"S1": 750}, "linkedin": {"E1": 300}})),
        ("set_capacity_tier", json!({"tier": 2})),
        ("start_research_project", json!({"tier": 1})),
    ];
    for (tool, arguments) in calls {
        session.call(tool, &arguments, Via::Form).unwrap_or_else(|refusal| panic!("{tool}: {refusal}"));
    }
}

/// A run in which companies ask for offers.
pub fn courted() -> Session {
    let new =
        NewRun { seed: Some(11), cash: Some(20_000_000.0), storage: Storage::Memory, ..NewRun::default() };
    let mut session = Session::create(new, &Configuration::shipped()).expect("a run");
    let ads = json!({"E1": 4000, "E2": 4000, "E3": 4000});
    for (tool, arguments) in [
        ("set_prices", json!({"A": 14, "B": 32, "C": 55})),
        ("set_model_tiers", json!({"A": 4, "B": 4, "C": 4})),
        ("set_usage_quotas", json!({"A": 300, "B": 30_000, "C": 1_000_000})),
        ("set_targeted_dev_spend", json!({"E1": 4000, "E2": 5000, "E3": 5000})),
        ("set_targeted_ad_spend", json!({"targeted_spend": {"social_media": ads, "linkedin": ads}})),
        ("set_capacity_tier", json!({"tier": 5})),
    ] {
        session.call(tool, &arguments, Via::Script).unwrap_or_else(|refusal| panic!("{tool}: {refusal}"));
    }
    for _ in 0..20 {
        if session.observe().waiting.len() >= 3 {
            return session;
        }
        let forecasts = session.naive_forecasts();
        session.advance("as planned", &forecasts, Via::Script, &mut |_| {}).expect("a week");
    }
    panic!("nobody came in twenty weeks");
}

/// Answers of the database to what a screen asks.
pub fn answers(session: &mut Session, screen: &dyn Screen) -> Vec<(Reading, Rows)> {
    let ask = |reading: &Reading| {
        let rows = session.query(reading.sql());
        (*reading, rows.unwrap_or_else(|refusal| panic!("{reading:?}: {refusal}")))
    };
    screen.readings().iter().map(ask).collect()
}

/// A screen that knows all of a company.
pub fn shown<S: Screen + Default>(session: &mut Session, company: &Company) -> S {
    let mut screen = S::default();
    let keys = Keys::shipped();
    let look = Look { company, keys: &keys, page: 5 };
    screen.renew(&look);
    for (reading, rows) in answers(session, &screen) {
        screen.take(reading, &rows, &look);
    }
    screen
}

/// A run that was played for some weeks, its company, and a screen that knows all of it.
pub fn on_screen<S: Screen + Default>(weeks: usize) -> (Session, Company, S) {
    let mut session = played(weeks);
    let company = Company::of(&session);
    let screen = shown(&mut session, &company);
    (session, company, screen)
}

/// Lets a screen do an action.
pub fn act(screen: &mut dyn Screen, action: Action, company: &Company) -> Vec<Effect> {
    let keys = Keys::shipped();
    screen.act(action, &Look { company, keys: &keys, page: 5 })
}

/// Draws a screen in a window; the lines of text that are seen.
pub fn picture(screen: &dyn Screen, company: &Company, width: u16, height: u16) -> Vec<String> {
    pictured(screen, company, (width, height), false)
}

/// The focused pane of a screen with the whole window, as one text.
pub fn zoomed(screen: &dyn Screen, company: &Company, width: u16, height: u16) -> String {
    pictured(screen, company, (width, height), true).join("\n")
}

fn pictured(
    screen: &dyn Screen,
    company: &Company,
    (width, height): (u16, u16),
    zoomed: bool,
) -> Vec<String> {
    let keys = Keys::shipped();
    painted(width, height, |canvas, area| {
        canvas.zoomed = zoomed;
        screen.draw(canvas, area, &Look { company, keys: &keys, page: 5 });
    })
}

/// The same picture as one text.
pub fn drawn(screen: &dyn Screen, company: &Company, width: u16, height: u16) -> String {
    picture(screen, company, width, height).join("\n")
}

/// Draws a screen in a few small and some large windows, with each of its panes in the focus. `tests/console/sizes.rs` draws
/// every screen in many more.
pub fn sweep(screen: &mut dyn Screen, company: &Company) {
    for focus in 0..screen.panes() {
        screen.set_focus(focus);
        let small = (0..=70).flat_map(|width| (0..=25).map(move |height| (width, height)));
        let small = small.filter(|(width, height)| (width + 3 * height) % 151 == 0);
        for (width, height) in small.chain([(80, 21), (110, 37), (200, 57), (300, 3), (3, 200), (140, 90)]) {
            drawn(screen, company, width, height);
            // Some of these are enough to see that a pane alone fits as well.
            if height % 6 == 0 || height == 37 {
                zoomed(screen, company, width, height);
            }
        }
    }
}

/// Lets a dialog do an action.
pub fn in_dialog(dialog: &mut dyn Dialog, action: Action, company: &Company) -> Outcome {
    let keys = Keys::shipped();
    dialog.act(action, &Look { company, keys: &keys, page: 5 })
}

/// Draws a dialog in a window, as one text.
pub fn dialog_picture(dialog: &dyn Dialog, company: &Company, width: u16, height: u16) -> String {
    let keys = Keys::shipped();
    let draw =
        |canvas: &mut Canvas<'_>, area| dialog.draw(canvas, area, &Look { company, keys: &keys, page: 5 });
    painted(width, height, draw).join("\n")
}

/// What is drawn into a window: the lines of text that are seen.
pub fn painted(width: u16, height: u16, draw: impl FnOnce(&mut Canvas<'_>, Rect)) -> Vec<String> {
    let area = Rect::new(0, 0, width, height);
    let mut buffer = Buffer::empty(area);
    let theme = Theme::bundled("mono").expect("a theme");
    draw(&mut Canvas::new(&mut buffer, &theme), area);
    let line = |y: u16| (0..width).map(|x| buffer[(x, y)].symbol()).collect::<String>();
    (0..height).map(|y| line(y).trim_end().to_owned()).collect()
}
