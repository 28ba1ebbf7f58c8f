//! Reports on weeks and runs. A `RunReport` contains the data of a whole run and can be written as Markdown or HTML.
//! Reports contain only recorded data. Causes are reported only if a re-simulation has computed them (`why`).
//!
//! Reports are computed from data that the player can see: observations, the journal, and guarded queries. Each measure
//! is computed by one pure function. `outline` converts a report to a `page::Page`, which `html` and `markdown` format.

pub mod action_items;
pub mod anonymization;
mod bankruptcy;
mod card;
pub mod class;
pub mod collection;
pub mod cost_review;
pub mod curve;
pub mod database_figures;
pub mod deals;
pub mod debrief;
pub mod decision_periods;
pub mod decision_words;
mod figure_change;
pub mod fit;
mod formatting;
pub mod funnel;
pub mod highlights;
pub mod html;
pub mod insights;
pub mod inspection;
pub mod lead_costs;
pub mod lesson;
pub mod logbook;
mod markdown;
pub mod measured_conversion;
pub mod measures;
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
pub mod ranking_eligibility;
pub mod research;
mod run_report;
pub mod svg;
pub mod tables;
pub mod term_picture;
#[cfg(any(test, feature = "test-kit"))]
pub mod test_kit;
pub mod transcript;
pub mod week;
pub mod whatif;
pub mod why;

use novamind_course::Debrief;

pub use formatting::{
    cash_before_purchases, category_name, describe_cash_change, describe_first_change, describe_origin,
    figure_label, figure_name, pluralize,
};
pub use logbook::Logbook;
pub use run_report::RunReport;
pub use week::WeekReport;

/// Formats the report on a run as Markdown.
pub fn report_to_markdown(report: &RunReport) -> String {
    markdown::to_markdown(&outline::report_page(report))
}

/// Returns the report on a run as one self-contained HTML page without scripts.
pub fn report_to_html(report: &RunReport) -> String {
    html::to_html(&outline::report_page(report))
}

/// Returns the debrief of a lesson as Markdown.
pub fn debrief_to_markdown(debrief: &Debrief) -> String {
    markdown::to_markdown(&debrief::debrief_page(debrief))
}

/// Returns the debrief of a lesson as one self-contained HTML page without scripts.
pub fn debrief_to_html(debrief: &Debrief) -> String {
    html::to_html(&debrief::debrief_page(debrief))
}

/// Returns the card of a run as text with lines of at most 80 columns.
pub fn card_to_text(report: &RunReport) -> String {
    card::to_text(report)
}

/// Returns the card of a run as a self-contained SVG of 1200 by 630 pixels.
pub fn card_to_svg(report: &RunReport) -> String {
    card::to_svg(report)
}

/// Returns the session summary for the experimenter as Markdown.
pub fn session_to_markdown(logbook: &Logbook) -> String {
    markdown::to_markdown(&logbook::session_page(logbook))
}

/// Returns the session summary for the experimenter as one HTML page.
pub fn session_to_html(logbook: &Logbook) -> String {
    html::to_html(&logbook::session_page(logbook))
}

/// Returns the logbook of a short run that was recorded on disk.
#[cfg(any(test, feature = "test-kit"))]
pub fn sample_logbook() -> Logbook {
    let (session, lines) = test_kit::recorded_run();
    Logbook::new(&session, &lines, &[])
}
