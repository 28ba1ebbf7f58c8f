//! What tests of screens need: a company from a run in memory, and a picture of a screen as text.

use ratatui::buffer::Buffer;
use ratatui::layout::Rect;

use super::canvas::Canvas;
use super::company::Company;
use super::keys::Keys;
use super::screens::{Look, Screen};
use super::theme::Theme;
use crate::session::{Configuration, NewRun, Session, Storage};

/// A run in memory.
pub fn session() -> Session {
    let new = NewRun { storage: Storage::Memory, ..NewRun::default() };
    Session::create(new, &Configuration::shipped()).expect("a run in memory")
}

/// A company on its first day.
pub fn company() -> Company {
    Company::of(&session())
}

/// Draws a screen of a size; the lines of text that are seen.
pub fn picture(screen: &dyn Screen, company: &Company, width: u16, height: u16) -> Vec<String> {
    let theme = Theme::find("dark", &Configuration::shipped()).expect("a theme");
    let keys = Keys::shipped();
    let area = Rect::new(0, 0, width, height);
    let mut buffer = Buffer::empty(area);
    let mut canvas = Canvas::new(&mut buffer, &theme);
    screen.draw(&mut canvas, area, &Look { company, keys: &keys, page: 10 });
    let line = |y: u16| (0..width).map(|x| buffer[(x, y)].symbol()).collect::<String>();
    (0..height).map(|y| line(y).trim_end().to_owned()).collect()
}

/// Draws a screen in every small size: nothing may panic.
pub fn sweep(screen: &dyn Screen, company: &Company) {
    for width in 0..70 {
        for height in 0..25 {
            picture(screen, company, width, height);
        }
    }
}
