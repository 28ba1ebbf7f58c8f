//! Open issues by group and age.

use std::collections::BTreeMap;

use ratatui::layout::Rect;

use super::model::IssueAges;
use super::panel::{ProductPanel, show_cell_effect};
use super::{Product, ProductPane};
use crate::context::Figure;
use crate::effect::Effect;
use crate::screens::panes::PanePlacement;
use novamind_base::formatting::grouped_number;
use novamind_insight::WeekQuantity;
use novamind_record::figures::WeekFigure;
use novamind_session::identifiers::Group;
use novamind_tools::ToolId;
use novamind_tui::canvas::{Canvas, Click, row_rects};
use novamind_tui::theme::Role;
use novamind_worker::company::DisplayedCompany;

/// Bar glyphs by age of the issues, the newest issues first. Older issues have denser glyphs.
const AGE_SYMBOLS: [char; 4] = ['░', '▒', '▓', '█'];

const FIGURES_WIDTH: u16 = 45;

/// Summarizes the open issues. Returns an empty text until the issues are read.
fn summary(issues: Option<&BTreeMap<String, IssueAges>>) -> String {
    let Some(issues) = issues else { return String::new() };
    let all: f64 = issues.values().flatten().fold(0.0, |sum, count| sum + count);
    let old: f64 = issues.values().fold(0.0, |sum, ages| sum + ages[2] + ages[3]);
    format!("{} open, {} for 8 days or more", grouped_number(all, 0), grouped_number(old, 0))
}

pub struct IssuesPane;

impl IssuesPane {
    fn group<'a>(&self, product: &'a Product) -> Option<&'a String> {
        product.issues.as_ref()?.keys().nth(product.selected_row(self.id()))
    }
}

impl ProductPanel for IssuesPane {
    fn id(&self) -> ProductPane {
        ProductPane::Issues
    }

    fn row_count(&self, product: &Product, _: &DisplayedCompany) -> usize {
        product.issues.as_ref().map_or(0, BTreeMap::len)
    }

    fn summary(&self, product: &Product, _: &DisplayedCompany, _: usize) -> String {
        summary(product.issues.as_ref())
    }

    fn destination(&self, _: &Product) -> &'static str {
        ToolId::SetTargetedOpsSpend.name()
    }

    fn open_effect(&self, product: &Product, _: &DisplayedCompany) -> Effect {
        show_cell_effect(ToolId::SetTargetedOpsSpend, self.group(product).cloned())
    }

    fn selected_figure(&self, product: &Product, company: &DisplayedCompany) -> Option<Figure> {
        let group = self.group(product)?;
        let sql = format!(
            "SELECT i.issue_id, i.customer_id, i.open_day, i.days_open\n\
             FROM issues i JOIN subscriptions s ON s.customer_id = i.customer_id\n\
             WHERE i.group_id = '{group}' AND i.status = 'open' AND s.status = 'subscribed'\n    \
             AND i.open_day > (SELECT max(day) FROM service_day) - 112 ORDER BY i.days_open DESC"
        );
        let title = format!("open issues of {group}");
        let quantity =
            Group::parse(group).and_then(|group| WeekQuantity::for_group(WeekFigure::OpenIssues, group));
        let figure = Figure { title, term: "issue", sql: Some(sql), week_quantity: None };
        Some(figure.with_week_quantity(quantity, company.observation.week))
    }

    fn draw_content(&self, product: &Product, canvas: &mut Canvas<'_>, placement: PanePlacement, _: &DisplayedCompany) {
        draw(product, canvas, placement);
    }
}

/// Draws one row for all groups together, followed by one row per group. All bars have the same scale.
fn draw(product: &Product, canvas: &mut Canvas<'_>, placement: PanePlacement) {
    let (area, selected) = (placement.area, product.selected_row(ProductPane::Issues));
    let head = ["to 3 d", "4-7 d", "8-14 d", "15+ d", "all"].map(str::to_owned);
    canvas.draw_text(area, &line("group", &head), Role::Header);
    if area.height < 2 {
        return;
    }
    let below = Rect { y: area.y + 1, height: area.height - 1, ..area };
    let Some(issues) = product.issues.as_ref().filter(|issues| !issues.is_empty()) else {
        let words = if product.issues.is_some() { "No open issues" } else { "reading …" };
        return canvas.draw_text(below, words, Role::Dim);
    };
    if area.width > FIGURES_WIDTH + 22 {
        let place = Rect { x: area.x + FIGURES_WIDTH + 2, width: area.width - FIGURES_WIDTH - 2, height: 1, ..area };
        canvas.draw_text(place, "░ new … █ old", Role::Dim);
    }
    let mut all: IssueAges = [0.0; 4];
    for ages in issues.values() {
        all.iter_mut().zip(ages).for_each(|(sum, count)| *sum += count);
    }
    let whole = issues.values().map(|ages| ages.iter().sum::<f64>()).fold(1.0, f64::max);
    let first = Rect { height: 1, ..below };
    canvas.draw_text(first, &line("all", &cells(&all)), Role::Strong);
    let below = Rect { y: below.y + 1, height: below.height - 1, ..below };
    if placement.focused {
        canvas.page_rows = below.height.max(1);
    }
    let from = canvas.scroll_to_row(below, selected, issues.len());
    for (row, (at, (group, ages))) in row_rects(below).zip(issues.iter().enumerate().skip(from)) {
        let role = match (placement.focused && at == selected, ages[3] > 0.0) {
            (true, _) => Role::Selection,
            (false, true) => Role::Warning,
            (false, false) => Role::Text,
        };
        canvas.clear(row, role);
        canvas.draw_text(row, &line(group, &cells(ages)), role);
        canvas.register_click(row, Click::Row(placement.index, at));
        if row.width > FIGURES_WIDTH + 8 {
            let place = Rect { x: row.x + FIGURES_WIDTH + 2, width: row.width - FIGURES_WIDTH - 2, ..row };
            let text = stacked_bar(ages, whole, place.width as usize);
            canvas.draw_text(place, &text, if role == Role::Selection { role } else { Role::Series(0) });
        }
    }
}

fn line(name: &str, cells: &[String; 5]) -> String {
    let [young, week, fortnight, old, all] = cells;
    format!("{name:<5}{young:>8}{week:>8}{fortnight:>8}{old:>8}{all:>8}")
}

fn cells(ages: &IssueAges) -> [String; 5] {
    let [young, week, fortnight, old] = *ages;
    [young, week, fortnight, old, ages.iter().sum()].map(|count| match count {
        0.0 => "–".to_owned(),
        count => grouped_number(count, 0),
    })
}

/// Returns the issue ages of a group as one stacked bar. `whole` is the number of issues that fills the bar.
fn stacked_bar(ages: &IssueAges, whole: f64, width: usize) -> String {
    let (mut text, mut sum, mut drawn) = (String::new(), 0.0, 0);
    for (count, shade) in ages.iter().zip(AGE_SYMBOLS) {
        sum += count;
        let to = (sum / whole * width as f64).round() as usize;
        text.extend(std::iter::repeat_n(shade, to.saturating_sub(drawn)));
        drawn = to.max(drawn);
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn stacked_bar_length_is_the_share_and_shade_the_age() {
        assert_eq!(stacked_bar(&[5.0, 0.0, 2.0, 3.0], 10.0, 10), "░░░░░▓▓███");
        assert_eq!(stacked_bar(&[1.0, 0.0, 0.0, 1.0], 10.0, 10), "░█");
        assert_eq!(stacked_bar(&[0.0; 4], 1.0, 10), "");
        assert_eq!(summary(Some(&BTreeMap::new())), "0 open, 0 for 8 days or more");
        assert_eq!(summary(None), "");
    }
}
