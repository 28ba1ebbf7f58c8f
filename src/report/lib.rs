//! Reports on weeks and runs. A `Story` contains the data of a whole run and can be written as Markdown or HTML. Reports
//! state what the records show; the only causes they name come from re-simulation (`why`).
//!
//! Everything is computed from data visible to the player: observations, the journal, and guarded queries. Each measure
//! is one pure function. `outline` converts a story to a `page::Page`, which the writers format.

pub mod anonymised;
pub mod books;
mod card;
pub mod chapters;
pub mod class;
pub mod collection;
pub mod comparable;
pub mod curve;
pub mod deals;
pub mod debrief;
pub mod fit;
pub mod funnel;
pub mod highlights;
pub mod html;
pub mod insights;
pub mod lead_costs;
pub mod lesson;
pub mod logbook;
mod markdown;
pub mod measures;
mod movement;
pub mod needs;
pub mod opponents;
mod outline;
pub mod page;
pub mod parameters;
pub mod peak;
pub mod plan_margins;
pub mod plot;
pub mod post_leads;
pub mod prose;
pub mod protocol;
pub mod ranking;
pub mod research;
pub mod review;
mod story;
pub mod svg;
pub mod tables;
pub mod term_picture;
#[cfg(any(test, feature = "test-kit"))]
pub mod test_kit;
pub mod transcript;
mod turn;
pub mod week;
pub mod whatif;
pub mod why;
mod words;
pub mod xray;

use novamind_course::Debrief;

pub use logbook::Logbook;
pub use story::Story;
pub use week::WeekReport;
pub use words::{cash_change_in_words, category_name, count, first_change_in_words, origin_in_words};

/// Returns the report on a run as Markdown.
pub fn as_markdown(story: &Story) -> String {
    markdown::write(&outline::page_of(story))
}

/// Returns the report on a run as one self-contained HTML page without scripts.
pub fn as_html(story: &Story) -> String {
    html::write(&outline::page_of(story))
}

/// Returns the debrief of a lesson as Markdown.
pub fn debrief_as_markdown(own: &Debrief) -> String {
    markdown::write(&debrief::page_of(own))
}

/// Returns the debrief of a lesson as one self-contained HTML page without scripts.
pub fn debrief_as_html(own: &Debrief) -> String {
    html::write(&debrief::page_of(own))
}

/// Returns the card of a run as text of 80 columns.
pub fn card_as_text(story: &Story) -> String {
    card::as_text(story)
}

/// Returns the card of a run as a self-contained SVG of 1200 by 630.
pub fn card_as_svg(story: &Story) -> String {
    card::as_svg(story)
}

/// Returns the session summary for the experimenter as Markdown.
pub fn session_as_markdown(logbook: &Logbook) -> String {
    markdown::write(&logbook::page_of(logbook))
}

/// Returns the session summary for the experimenter as one HTML page.
pub fn session_as_html(logbook: &Logbook) -> String {
    html::write(&logbook::page_of(logbook))
}

/// Returns the logbook of a short run on disk.
#[cfg(any(test, feature = "test-kit"))]
pub fn logbook_of_tests() -> Logbook {
    let (session, lines) = test_kit::recorded();
    Logbook::of(&session, &lines, &[])
}
