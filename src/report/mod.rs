//! A run reported: what a week changed, and the whole run as a [`Story`] that can be written as Markdown or as a page for
//! a browser. A report says what the records show; it names no causes.
//!
//! Everything here is computed from what a player may see: observations, the journal, and guarded queries. Each measure
//! is one pure function. [`outline`] turns a story into a [`page::Page`]; the writers know nothing of companies.

pub mod books;
pub mod chapters;
pub mod funnel;
pub mod highlights;
pub mod html;
pub mod logbook;
pub mod markdown;
pub mod measures;
pub mod movement;
pub mod needs;
pub mod outline;
pub mod page;
pub mod ranking;
pub mod review;
pub mod story;
pub mod svg;
#[cfg(test)]
pub mod test_kit;
pub mod turn;
pub mod week;
mod words;

pub use logbook::Logbook;
pub use story::Story;
pub use week::WeekReport;
pub use words::{category_name, count};

/// The report of a run as Markdown.
pub fn as_markdown(story: &Story) -> String {
    markdown::write(&outline::page_of(story))
}

/// The report of a run as one page for a browser, without scripts and without other files.
pub fn as_html(story: &Story) -> String {
    html::write(&outline::page_of(story))
}

/// How a run was played, for whoever led the session, as Markdown.
pub fn session_as_markdown(logbook: &Logbook) -> String {
    markdown::write(&logbook::page_of(logbook))
}

/// How a run was played, for whoever led the session, as one page for a browser.
pub fn session_as_html(logbook: &Logbook) -> String {
    html::write(&logbook::page_of(logbook))
}
