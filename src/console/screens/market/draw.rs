//! The panes, and how they share the window.

use ratatui::layout::{Constraint, Layout, Rect};

use super::model::undiscovered;
use super::{ATTEMPTS, ECONOMY, GROUPS, Market, NEWS, REPORT, economy, report};
use crate::console::action::Action;
use crate::console::canvas::{Canvas, Click};
use crate::console::screens::Look;
use crate::console::theme::Role;
use crate::notation::dollars;

/// Draws the screen.
pub(super) fn draw(market: &Market, canvas: &mut Canvas<'_>, area: Rect, look: &Look<'_>) {
    if canvas.zoomed {
        match market.focus {
            GROUPS => market.draw_groups(canvas, area, look),
            REPORT => market.draw_report(canvas, area, look),
            ATTEMPTS => market.draw_attempts(canvas, area, look),
            ECONOMY => market.draw_economy(canvas, area, look),
            _ => market.draw_news(canvas, area, look),
        }
        return;
    }
    if area.width >= 104 && area.height >= 24 {
        let [left, right] = Layout::horizontal([Constraint::Percentage(52), Constraint::Min(0)]).areas(area);
        let rows = (market.groups.len() as u16 + 3).min(area.height / 20 * 11);
        let [groups, economy] = Layout::vertical([Constraint::Length(rows), Constraint::Min(0)]).areas(left);
        let attempts = (market.facts.attempts.len() as u16 + 4).min(area.height / 5).max(6);
        let [report, found, news] = Layout::vertical([
            Constraint::Length(area.height / 20 * 11),
            Constraint::Length(attempts),
            Constraint::Min(0),
        ])
        .areas(right);
        market.draw_groups(canvas, groups, look);
        market.draw_economy(canvas, economy, look);
        market.draw_report(canvas, report, look);
        market.draw_attempts(canvas, found, look);
        market.draw_news(canvas, news, look);
        return;
    }
    // What has the focus takes the window; groups and report share it.
    let halves = [Constraint::Percentage(50), Constraint::Min(0)];
    let [upper, lower] = Layout::vertical(halves).areas(area);
    match market.focus {
        GROUPS if area.height >= 14 => {
            market.draw_groups(canvas, upper, look);
            market.draw_report(canvas, lower, look);
        }
        GROUPS => market.draw_groups(canvas, area, look),
        REPORT => market.draw_report(canvas, area, look),
        ATTEMPTS => {
            market.draw_attempts(canvas, upper, look);
            market.draw_economy(canvas, lower, look);
        }
        ECONOMY => market.draw_economy(canvas, area, look),
        _ => market.draw_news(canvas, area, look),
    }
}

impl Market {
    fn draw_economy(&self, canvas: &mut Canvas<'_>, area: Rect, look: &Look<'_>) {
        canvas.click(area, Click::Pane(ECONOMY));
        let focused = self.focus == ECONOMY;
        economy::draw(canvas, area, look.company, &self.economy(), focused);
        if focused {
            let keys =
                [Action::Left, Action::Right].map(|action| look.keys.label(action).unwrap_or_default());
            canvas.pane_keys(area, &format!("{}/{} other readings", keys[0], keys[1]));
        }
    }

    fn draw_groups(&self, canvas: &mut Canvas<'_>, area: Rect, look: &Look<'_>) {
        canvas.click(area, Click::Pane(GROUPS));
        let focused = self.focus == GROUPS;
        let known = look.company.seen.known_groups.len();
        let note = match self.table.note() {
            note if note.is_empty() => format!("{known} known · {} to find", undiscovered(look.company)),
            note => note,
        };
        let inside = canvas.pane(area, "Groups", &note, focused);
        self.table.draw(canvas, inside, focused, GROUPS);
        if focused {
            let open = look.keys.label(Action::Open).unwrap_or_default();
            let keys = look.hints(&[Action::FindGroup, Action::StudyGroup, Action::Filter]);
            canvas.pane_keys(area, &format!("{open} customers of the group · {keys}"));
        }
    }

    fn draw_report(&self, canvas: &mut Canvas<'_>, area: Rect, look: &Look<'_>) {
        canvas.click(area, Click::Pane(REPORT));
        let focused = self.focus == REPORT;
        report::draw(canvas, area, look, self.group(), self.target, self.from, focused);
    }

    fn draw_attempts(&self, canvas: &mut Canvas<'_>, area: Rect, look: &Look<'_>) {
        canvas.click(area, Click::Pane(ATTEMPTS));
        let focused = self.focus == ATTEMPTS;
        let next = dollars(look.company.terms.attempt_cost);
        let note = match self.facts.attempts.len() {
            0 => format!("next {next}"),
            count => format!(
                "{} of {count} found · {} · next {next}",
                self.facts.found(),
                dollars(self.facts.spent())
            ),
        };
        let inside = canvas.pane(area, "Attempts", &note, focused);
        if self.facts.attempts.is_empty() {
            let key = look.keys.label(Action::FindGroup).unwrap_or_default();
            canvas.text(inside, &format!("no attempts yet: {key} pays for one"), Role::Dim);
        } else {
            self.attempts.draw(canvas, inside, focused, ATTEMPTS);
        }
        canvas.pane_keys(area, &look.hint(Action::FindGroup));
    }

    fn draw_news(&self, canvas: &mut Canvas<'_>, area: Rect, look: &Look<'_>) {
        canvas.click(area, Click::Pane(NEWS));
        let focused = self.focus == NEWS;
        let note = match self.headlines.note() {
            note if note.is_empty() => format!("{} in the press", self.news.len()),
            note => note,
        };
        let inside = canvas.pane(area, "Rivals and economy in the news", &note, focused);
        if self.news.is_empty() {
            canvas.text(inside, "no news yet", Role::Dim);
            return;
        }
        self.headlines.draw(canvas, inside, focused, NEWS);
        if focused {
            canvas.pane_keys(area, &look.hints(&[Action::Open, Action::Filter]));
        }
    }
}
