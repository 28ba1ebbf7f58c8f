//! Test helpers for screens: companies of in-memory runs, screens with all their data, rendered text, and windows of
//! many sizes.

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

/// Returns a company on its first day.
pub fn company() -> Company {
    Company::of(&session())
}

/// Returns the query results for the readings of a screen.
pub fn answers(session: &mut Session, screen: &dyn Screen) -> Vec<(Reading, Rows)> {
    let ask = |reading: &Reading| {
        let rows = session.query(reading.sql());
        (*reading, rows.unwrap_or_else(|refusal| panic!("{reading:?}: {refusal}")))
    };
    screen.readings().iter().map(ask).collect()
}

/// Returns a screen with all data of a company.
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

/// Plays a run for some weeks. Returns it with its company and a screen with all data.
pub fn on_screen<S: Screen + Default>(weeks: usize) -> (Session, Company, S) {
    let mut session = played(weeks);
    let company = Company::of(&session);
    let screen = shown(&mut session, &company);
    (session, company, screen)
}

/// Lets a screen handle an action.
pub fn act(screen: &mut dyn Screen, action: Action, company: &Company) -> Vec<Effect> {
    let keys = Keys::shipped();
    screen.act(action, &Look { company, keys: &keys, page: 5 })
}

/// Returns the settings of test consoles.
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

/// Returns the only question among effects.
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

/// Draws a screen and returns the lines of text.
pub fn picture(screen: &dyn Screen, company: &Company, width: u16, height: u16) -> Vec<String> {
    pictured(screen, company, (width, height), false)
}

/// Draws the focused pane of a screen zoomed and returns the text.
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

/// Draws a screen and returns the text.
pub fn drawn(screen: &dyn Screen, company: &Company, width: u16, height: u16) -> String {
    picture(screen, company, width, height).join("\n")
}

/// Draws a screen in some small and large windows, with the focus on each pane. `tests/console/sizes.rs` covers more
/// sizes.
pub fn sweep(screen: &mut dyn Screen, company: &Company) {
    for focus in 0..screen.panes() {
        screen.set_focus(focus);
        let small = (0..=70).flat_map(|width| (0..=25).map(move |height| (width, height)));
        let small = small.filter(|(width, height)| (width + 3 * height) % 151 == 0);
        for (width, height) in small.chain([(80, 21), (110, 37), (200, 57), (300, 3), (3, 200), (140, 90)]) {
            drawn(screen, company, width, height);
            // A few of these sizes suffice for zoomed panes.
            if height % 6 == 0 || height == 37 {
                zoomed(screen, company, width, height);
            }
        }
    }
}

/// Lets a dialog handle an action.
pub fn in_dialog(dialog: &mut dyn Dialog, action: Action, company: &Company) -> Outcome {
    let keys = Keys::shipped();
    dialog.act(action, &Look { company, keys: &keys, page: 5 })
}

/// Draws a dialog and returns the text.
pub fn dialog_picture(dialog: &dyn Dialog, company: &Company, width: u16, height: u16) -> String {
    let keys = Keys::shipped();
    let draw =
        |canvas: &mut Canvas<'_>, area| dialog.draw(canvas, area, &Look { company, keys: &keys, page: 5 });
    painted(width, height, draw).join("\n")
}

/// Draws into a window and returns the lines of text.
pub fn painted(width: u16, height: u16, draw: impl FnOnce(&mut Canvas<'_>, Rect)) -> Vec<String> {
    let area = Rect::new(0, 0, width, height);
    let mut buffer = Buffer::empty(area);
    let theme = Theme::bundled("mono").expect("a theme");
    draw(&mut Canvas::new(&mut buffer, &theme), area);
    let line = |y: u16| (0..width).map(|x| buffer[(x, y)].symbol()).collect::<String>();
    (0..height).map(|y| line(y).trim_end().to_owned()).collect()
}
