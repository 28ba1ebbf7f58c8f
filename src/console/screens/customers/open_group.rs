//! Selection and layout of an open group.

use ratatui::layout::{Constraint, Layout, Rect};

use super::cohorts;
use super::facts::FactsPane;
use super::fit::FitPane;
use super::quality::QualityByWeekPane;
use super::group_actions::ACTION_COUNT;
use super::{Customers, CustomersPane};
use crate::context::ScreenContext;
use crate::screens::panes::{Pane, PanePlacement, draw_pane, draw_stack};
use novamind_tui::canvas::Canvas;
use novamind_tui::widgets::ScrollState;

#[derive(Debug)]
pub struct OpenGroupState {
    pub focus: CustomersPane,
    /// Index of the selected link.
    pub action: usize,
    pub fact_line: usize,
    /// Number of weeks between the selected week and the last week.
    pub weeks_back: u32,
    /// Index of the selected flow: leads, new customers or cancellations.
    pub flow: usize,
    /// Selected cell of the cohorts.
    pub cohort: cohorts::CohortCell,
    pub fit_scroll: ScrollState,
    pub study_scroll: ScrollState,
}

impl Default for OpenGroupState {
    fn default() -> OpenGroupState {
        let focus = CustomersPane::Actions;
        let cohort = cohorts::CohortCell::default();
        let [fit_scroll, study_scroll] = Default::default();
        OpenGroupState { focus, action: 0, fact_line: 0, weeks_back: 0, flow: 0, cohort, fit_scroll, study_scroll }
    }
}

const FIT_ROWS: u16 = 24;
/// Minimum height for two panes below each other.
const MIN_SPLIT_HEIGHT: u16 = 11;

pub fn draw_open_group(customers: &Customers, canvas: &mut Canvas<'_>, area: Rect, context: &ScreenContext<'_>) {
    use CustomersPane::{Cohorts, Facts, Fit, Quality, Study, Actions, Weeks};
    let split = |area: Rect, first: u16| {
        Layout::vertical([Constraint::Length(first), Constraint::Min(0)]).areas::<2>(area)
    };
    let columns = |constraints: [Constraint; 3]| Layout::horizontal(constraints).areas::<3>(area);
    let actions_height = ACTION_COUNT as u16 + 2;
    if area.width >= 150 && area.height >= 30 {
        let [left, middle, right] =
            columns([Constraint::Percentage(40), Constraint::Min(0), Constraint::Length(44)]);
        let [fit, weeks] = split(left, FIT_ROWS.min(area.height / 2));
        let [quality, rest] = split(middle, area.height / 3);
        let [cohorts, study] = split(rest, rest.height / 2);
        let [facts, go] = split(right, area.height - actions_height);
        let upper = [(fit, Fit), (weeks, Weeks), (quality, Quality), (cohorts, Cohorts)];
        for (area, pane) in upper.into_iter().chain([(study, Study), (facts, Facts), (go, Actions)]) {
            draw_pane(customers, pane, canvas, area, context);
        }
    } else if area.width >= 104 && area.height >= 30 {
        let [left, _, right] = columns([Constraint::Min(0), Constraint::Length(0), Constraint::Length(44)]);
        let [above, below] = split(left, FIT_ROWS.min(area.height * 3 / 5));
        let [facts, go] = split(right, area.height - actions_height);
        draw_stack(customers, &[Fit, Weeks], canvas, above, context);
        draw_stack(customers, &[Quality, Cohorts, Study], canvas, below, context);
        draw_pane(customers, Facts, canvas, facts, context);
        draw_pane(customers, Actions, canvas, go, context);
    } else if area.width < 70 && area.height < MIN_SPLIT_HEIGHT {
        // The window is too small for two panes below each other.
        draw_stack(customers, &[Fit, Quality, Weeks, Cohorts, Study, Actions, Facts], canvas, area, context);
    } else if area.width < 70 {
        // The window is too narrow for two texts next to each other.
        let [above, below] = split(area, area.height.saturating_sub(6));
        draw_stack(customers, &[Fit, Quality, Weeks, Cohorts, Study], canvas, above, context);
        draw_stack(customers, &[Actions, Facts], canvas, below, context);
    } else {
        let [left, _, right] =
            columns([Constraint::Min(0), Constraint::Length(0), Constraint::Percentage(50)]);
        let [facts, go] = split(right, area.height.saturating_sub(actions_height));
        draw_stack(customers, &[Fit, Quality, Weeks, Cohorts, Study], canvas, left, context);
        draw_pane(customers, Facts, canvas, facts, context);
        draw_pane(customers, Actions, canvas, go, context);
    }
}

/// Draws a preview of the selected group below the list. The preview is not clickable.
pub fn draw_preview(customers: &Customers, canvas: &mut Canvas<'_>, area: Rect, context: &ScreenContext<'_>) {
    let middle = if area.width >= 150 { area.width * 3 / 10 } else { 0 };
    let right = Constraint::Length(46.min(area.width / 2));
    let [fit, curves, side] =
        Layout::horizontal([Constraint::Min(0), Constraint::Length(middle), right]).areas(area);
    let clicks = canvas.clicks.len();
    let seat = |area: Rect| PanePlacement { area, focused: false, index: 0 };
    FitPane.draw_with_border(customers, canvas, seat(fit), context);
    if middle > 0 {
        QualityByWeekPane.draw_with_border(customers, canvas, seat(curves), context);
    }
    FactsPane.draw_with_border(customers, canvas, seat(side), context);
    canvas.clicks.truncate(clicks);
}
