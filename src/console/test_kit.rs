//! What the tests of the screens share: companies from runs in memory, a screen that was told everything, its picture
//! as text, and windows of every size.

use std::path::Path;

use ratatui::buffer::Buffer;
use ratatui::layout::Rect;

use super::action::Action;
use super::app::Settings;
use super::context::Look;
use super::dialogs::{Dialog, Outcome};
use super::effect::Effect;
use super::keys::Keys;
use super::screens::Screen;
use novamind_database::Rows;
use novamind_record::folder::configuration::Configuration;
use novamind_session::Session;
use novamind_tui::canvas::Canvas;
use novamind_tui::glyphs::Glyphs;
use novamind_tui::theme::Theme;
use novamind_worker::asking::{Ask, Question};
use novamind_worker::company::Company;
use novamind_worker::readings::Reading;
pub use novamind_worker::test_kit::{courted, played, session};

/// A company on its first day.
pub fn company() -> Company {
    Company::of(&session())
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

/// How the console looks in tests.
pub fn settings(runs: &Path) -> Settings {
    Settings {
        theme: Theme::bundled("dark").expect("a theme"),
        keys: Keys::shipped(),
        glyphs: Glyphs::Braille,
        configuration: Configuration::shipped(),
        runs: runs.to_owned(),
        again: "novamind --run latest".to_owned(),
        lists_everybody: false,
        opponents: |_, _, _| Ok(None),
    }
}

/// The question that effects ask, and none but it.
pub fn asked<Q: Question>(effects: &[Effect]) -> &Q {
    let mut asks = effects.iter().filter_map(|effect| match effect {
        Effect::Ask(ask) => Some(ask),
        _ => None,
    });
    match (asks.next().and_then(Ask::question), asks.next()) {
        (Some(question), None) => question,
        _ => panic!("{effects:?}"),
    }
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
