//! Test helpers for screens: companies of in-memory runs, screens with all their data, rendered text, and windows of
//! different sizes.

use std::path::Path;

use ratatui::buffer::Buffer;
use ratatui::layout::Rect;

use super::action::Action;
use super::app::Settings;
use super::context::ScreenContext;
use super::dialogs::{Dialog, DialogResponse};
use super::effect::Effect;
use super::keys::KeyBindings;
use super::screens::Screen;
use novamind_database::QueryResult;
use novamind_record::folder::configuration::Configuration;
use novamind_session::Session;
use novamind_tui::canvas::Canvas;
use novamind_tui::glyphs::Glyphs;
use novamind_tui::theme::Theme;
use novamind_worker::company::DisplayedCompany;
use novamind_worker::question::{OutgoingQuestion, Question};
use novamind_worker::screen_queries::Reading;
pub use novamind_worker::test_kit::{new_session, played_session, session_with_negotiations};

/// Returns the company of a new run.
pub fn new_company() -> DisplayedCompany {
    DisplayedCompany::from_session(&new_session())
}

/// Runs the queries of a screen and returns the results.
pub fn run_screen_queries(session: &mut Session, screen: &dyn Screen) -> Vec<(Reading, QueryResult)> {
    let ask = |reading: &Reading| {
        let rows = session.query(reading.sql());
        (*reading, rows.unwrap_or_else(|rejection| panic!("{reading:?}: {rejection}")))
    };
    screen.screen_queries().iter().map(ask).collect()
}

/// Returns a screen that has received all data of a company.
pub fn loaded_screen<S: Screen + Default>(session: &mut Session, company: &DisplayedCompany) -> S {
    let mut screen = S::default();
    let keys = KeyBindings::bundled();
    let context = ScreenContext { company, keys: &keys, page_rows: 5 };
    screen.on_company_change(&context);
    for (reading, rows) in run_screen_queries(session, &screen) {
        screen.apply_rows(reading, &rows, &context);
    }
    screen
}

/// Plays a run for a number of weeks. Returns the session, the company and a screen with all data.
pub fn played_screen<S: Screen + Default>(weeks: usize) -> (Session, DisplayedCompany, S) {
    let mut session = played_session(weeks);
    let company = DisplayedCompany::from_session(&session);
    let screen = loaded_screen(&mut session, &company);
    (session, company, screen)
}

/// Sends an action to a screen and returns the effects.
pub fn handle_action(screen: &mut dyn Screen, action: Action, company: &DisplayedCompany) -> Vec<Effect> {
    let keys = KeyBindings::bundled();
    screen.handle_action(action, &ScreenContext { company, keys: &keys, page_rows: 5 })
}

/// Returns the settings of test consoles.
pub fn settings(runs: &Path) -> Settings {
    Settings {
        theme: Theme::bundled("dark").expect("a theme"),
        keys: KeyBindings::bundled(),
        glyphs: Glyphs::Braille,
        configuration: Configuration::bundled(),
        runs: runs.to_owned(),
        resume_command: "novamind --run latest".to_owned(),
        lists_all_participants: false,
        hosted: false,
        opponents: |_, _, _| Ok(None),
    }
}

/// Returns the only question in a list of effects.
pub fn only_question<Q: Question>(effects: &[Effect]) -> &Q {
    let mut asks = effects.iter().filter_map(|effect| match effect {
        Effect::Ask(ask) => Some(ask),
        _ => None,
    });
    match (asks.next().and_then(OutgoingQuestion::question), asks.next()) {
        (Some(question), None) => question,
        _ => panic!("{effects:?}"),
    }
}

/// Draws a screen and returns the text of each row.
pub fn screen_rows(screen: &dyn Screen, company: &DisplayedCompany, width: u16, height: u16) -> Vec<String> {
    render_screen(screen, company, (width, height), false)
}

/// Draws a screen with its focused pane zoomed and returns the text.
pub fn zoomed_text(screen: &dyn Screen, company: &DisplayedCompany, width: u16, height: u16) -> String {
    render_screen(screen, company, (width, height), true).join("\n")
}

fn render_screen(
    screen: &dyn Screen,
    company: &DisplayedCompany,
    (width, height): (u16, u16),
    zoomed: bool,
) -> Vec<String> {
    let keys = KeyBindings::bundled();
    render_rows(width, height, |canvas, area| {
        canvas.zoomed = zoomed;
        screen.draw(canvas, area, &ScreenContext { company, keys: &keys, page_rows: 5 });
    })
}

/// Draws a screen and returns the text.
pub fn screen_text(screen: &dyn Screen, company: &DisplayedCompany, width: u16, height: u16) -> String {
    screen_rows(screen, company, width, height).join("\n")
}

/// Draws a screen in small and large windows, with the focus on each pane. `tests/console/sizes.rs` covers more
/// sizes.
pub fn draw_at_all_sizes(screen: &mut dyn Screen, company: &DisplayedCompany) {
    for focus in 0..screen.pane_count() {
        screen.set_focus(focus);
        let small = (0..=70).flat_map(|width| (0..=25).map(move |height| (width, height)));
        let small = small.filter(|(width, height)| (width + 3 * height) % 151 == 0);
        for (width, height) in small.chain([(80, 21), (110, 37), (200, 57), (300, 3), (3, 200), (140, 90)]) {
            screen_text(screen, company, width, height);
            // Zoomed panes are drawn only at some of these sizes.
            if height % 6 == 0 || height == 37 {
                zoomed_text(screen, company, width, height);
            }
        }
    }
}

/// Sends an action to a dialog and returns the response.
pub fn dialog_action(dialog: &mut dyn Dialog, action: Action, company: &DisplayedCompany) -> DialogResponse {
    let keys = KeyBindings::bundled();
    dialog.handle_action(action, &ScreenContext { company, keys: &keys, page_rows: 5 })
}

/// Draws a dialog and returns the text.
pub fn dialog_text(dialog: &dyn Dialog, company: &DisplayedCompany, width: u16, height: u16) -> String {
    let keys = KeyBindings::bundled();
    let draw = |canvas: &mut Canvas<'_>, area| {
        dialog.draw(canvas, area, &ScreenContext { company, keys: &keys, page_rows: 5 })
    };
    render_rows(width, height, draw).join("\n")
}

/// Draws into a window and returns the text of each row.
pub fn render_rows(width: u16, height: u16, draw: impl FnOnce(&mut Canvas<'_>, Rect)) -> Vec<String> {
    let area = Rect::new(0, 0, width, height);
    let mut buffer = Buffer::empty(area);
    let theme = Theme::bundled("mono").expect("a theme");
    draw(&mut Canvas::new(&mut buffer, &theme), area);
    let line = |y: u16| (0..width).map(|x| buffer[(x, y)].symbol()).collect::<String>();
    (0..height).map(|y| line(y).trim_end().to_owned()).collect()
}
