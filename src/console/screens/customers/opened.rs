//! Selection and layout of an open group.

use ratatui::layout::{Constraint, Layout, Rect};

use super::cohorts;
use super::facts::FactsPane;
use super::fit::FitPane;
use super::quality::QualityByWeekPane;
use super::ways::CHOICES;
use super::{Customers, CustomersPane};
use crate::context::Look;
use crate::screens::panes::{Pane, Seat, draw_pane};
use novamind_tui::canvas::Canvas;

#[derive(Debug)]
pub struct Opened {
    pub focus: CustomersPane,
    /// Selected link.
    pub choice: usize,
    pub fact: usize,
    /// Weeks before the last one.
    pub back: u32,
    /// Selected flow: leads, new or cancelled.
    pub flow: usize,
    /// Selected cell of the cohorts.
    pub cohort: cohorts::CohortPlace,
    pub fit_line: usize,
    pub line: usize,
}

impl Default for Opened {
    fn default() -> Opened {
        let focus = CustomersPane::Ways;
        let cohort = cohorts::CohortPlace::default();
        Opened { focus, choice: 0, fact: 0, back: 0, flow: 0, cohort, fit_line: 0, line: 0 }
    }
}

const FIT: u16 = 24;

pub fn arrange(customers: &Customers, canvas: &mut Canvas<'_>, area: Rect, look: &Look<'_>) {
    use CustomersPane::{Cohorts, Facts, Fit, Quality, Study, Ways, Weeks};
    let mut draw = |area: Rect, pane: CustomersPane| draw_pane(customers, pane, canvas, area, look);
    let split = |area: Rect, first: u16| {
        Layout::vertical([Constraint::Length(first), Constraint::Min(0)]).areas::<2>(area)
    };
    let columns = |constraints: [Constraint; 3]| Layout::horizontal(constraints).areas::<3>(area);
    let (ways, focus) = (CHOICES as u16 + 2, customers.opened.focus);
    if area.width >= 150 && area.height >= 30 {
        let [left, middle, right] =
            columns([Constraint::Percentage(40), Constraint::Min(0), Constraint::Length(44)]);
        let [fit, weeks] = split(left, FIT.min(area.height / 2));
        let [quality, rest] = split(middle, area.height / 3);
        let [cohorts, study] = split(rest, rest.height / 2);
        let [facts, go] = split(right, area.height - ways);
        for (area, pane) in [(fit, Fit), (weeks, Weeks), (quality, Quality), (cohorts, Cohorts)] {
            draw(area, pane);
        }
        for (area, pane) in [(study, Study), (facts, Facts), (go, Ways)] {
            draw(area, pane);
        }
    } else if area.width >= 104 && area.height >= 30 {
        let [left, _, right] = columns([Constraint::Min(0), Constraint::Length(0), Constraint::Length(44)]);
        let [above, below] = split(left, FIT.min(area.height * 3 / 5));
        let [facts, go] = split(right, area.height - ways);
        draw(above, if focus == Weeks { Weeks } else { Fit });
        draw(below, if matches!(focus, Study | Cohorts) { focus } else { Quality });
        draw(facts, Facts);
        draw(go, Ways);
    } else if matches!(focus, Cohorts | Fit | Quality) {
        // The triangle, bars and curves need the full width.
        draw(area, focus);
    } else if area.width < 70 {
        // Texts side by side would be cut.
        let [above, below] = split(area, area.height.saturating_sub(6));
        draw(above, if matches!(focus, Study | Weeks) { focus } else { Fit });
        draw(below, if focus == Facts { Facts } else { Ways });
    } else {
        let [left, _, right] =
            columns([Constraint::Min(0), Constraint::Length(0), Constraint::Percentage(50)]);
        let [facts, go] = split(right, area.height.saturating_sub(ways));
        draw(left, if matches!(focus, Study | Weeks) { focus } else { Fit });
        draw(facts, Facts);
        draw(go, Ways);
    }
}

/// Draws a preview of the selected group below the list. It is not clickable.
pub fn draw_preview(customers: &Customers, canvas: &mut Canvas<'_>, area: Rect, look: &Look<'_>) {
    let middle = if area.width >= 150 { area.width * 3 / 10 } else { 0 };
    let right = Constraint::Length(46.min(area.width / 2));
    let [fit, curves, side] =
        Layout::horizontal([Constraint::Min(0), Constraint::Length(middle), right]).areas(area);
    let clicks = canvas.clicks.len();
    let seat = |area: Rect| Seat { area, focused: false, number: 0 };
    FitPane.show(customers, canvas, seat(fit), look);
    if middle > 0 {
        QualityByWeekPane.show(customers, canvas, seat(curves), look);
    }
    FactsPane.show(customers, canvas, seat(side), look);
    canvas.clicks.truncate(clicks);
}
