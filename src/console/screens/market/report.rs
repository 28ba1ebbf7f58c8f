//! The insight report of a group: estimates with ranges, influence, and the next study.

use ratatui::layout::Rect;
use unicode_width::UnicodeWidthStr;

use super::model::{study_level, group_name, running_study, target_level};
use super::{Market, MarketPane, knowledge_figure};
use crate::action::{Action, Scope};
use crate::context::{Figure, ScreenContext};
use crate::effect::Effect;
use crate::screens::panes::{PaneBorder, Pane, PanePlacement};
use novamind_base::formatting::{compact_number, dollars, grouped_number, percent, pluralize};
use novamind_report::fit::{Fit, TrueValueRange};
use novamind_session::identifiers::Group;
use novamind_session::true_value_range;
use novamind_tools::{Estimates, Influence};
use novamind_tui::canvas::{Align, Canvas, row_rects};
use novamind_tui::text::wrap;
use novamind_tui::theme::Role;
use novamind_tui::widgets::ScrollState;
use novamind_worker::company::DisplayedCompany;

/// A line with text at the left and figures at the right.
#[derive(Debug, Clone, PartialEq)]
pub struct ReportLine {
    label: String,
    /// Range of the estimate, or the heading of the ranges.
    pub value: String,
    role: Role,
}

impl ReportLine {
    fn heading(words: &str, figures: &str) -> ReportLine {
        ReportLine { label: words.to_owned(), value: figures.to_owned(), role: Role::Header }
    }

    fn estimate_line(words: String, figures: String) -> ReportLine {
        ReportLine { label: words, value: figures, role: Role::Text }
    }

    /// Returns a line with the true value of the estimate in the line above.
    fn true_value_line(figures: String) -> ReportLine {
        ReportLine { label: "  x-ray: true".to_owned(), value: figures, role: Role::Changed }
    }
}

/// Accessor, label, unit and format of an estimate in the report.
type EstimateField = (fn(&Estimates) -> Option<f64>, &'static str, &'static str, fn(f64) -> String);

/// Label of the required quality in `true_value_text`.
const REQUIRED_QUALITY_LABEL: &str = "required quality";

const ESTIMATE_FIELDS: [EstimateField; 8] = [
    (|all| Some(all.willingness_to_pay), BUDGET_LABEL, "$/month", format_figure),
    (|all| Some(all.usage_volume), USAGE_LABEL, "units/day", format_figure),
    (|all| Some(all.quality_floor_q_min), REQUIRED_QUALITY_LABEL, "", format_exact),
    (|all| Some(all.market_cap as f64), MARKET_LABEL, "customers", format_figure),
    (|all| Some(all.annual_market_cap_growth_rate), "market growth", "a year", format_share),
    (|all| Some(all.contract_lockin_aversion), "lock-in aversion", "", format_exact),
    (|all| all.decision_rounds.map(|rounds| rounds as f64), "rounds per deal", "", format_figure),
    (|all| all.avg_response_days, "response time", "days", format_figure),
];

/// Label of the usage estimate.
const USAGE_LABEL: &str = "usage";

/// Labels of estimates with a true value in `true_value_text`.
const BUDGET_LABEL: &str = "budget";
const MARKET_LABEL: &str = "market cap";

/// Returns the true value of an estimate on the displayed day, if true values are shown.
fn true_value_text(words: &str, group: Group, company: &DisplayedCompany) -> Option<String> {
    let group_values = &company.hidden_values.as_ref()?.groups[group];
    Some(match words {
        BUDGET_LABEL => format_figure(group_values.budget),
        REQUIRED_QUALITY_LABEL => format_exact(group_values.quality_floor),
        MARKET_LABEL if group_values.market_cap <= 0.0 => "no limit".to_owned(),
        MARKET_LABEL => grouped_number(group_values.market_cap, 0),
        _ => return None,
    })
}

fn format_figure(value: f64) -> String {
    match value.abs() {
        size if size >= 1000.0 => compact_number(value),
        size if size >= 100.0 || value.fract() == 0.0 => grouped_number(value, 0),
        size if size >= 10.0 => grouped_number(value, 1),
        _ => grouped_number(value, 2),
    }
}

/// Decimals of quality and of weights. Weights below one thousandth are shown as zero.
const WEIGHT_DECIMALS: usize = novamind_base::formatting::QUALITY_DECIMALS;

fn format_exact(value: f64) -> String {
    grouped_number(value, WEIGHT_DECIMALS)
}

fn format_share(value: f64) -> String {
    percent(value, 1)
}

/// Returns the lines of the insight report of a known group.
pub fn report_lines(company: &DisplayedCompany, group: Group) -> Vec<ReportLine> {
    let Some(insights) = company.insights.get(&group) else { return Vec::new() };
    let noise = company.tool_limits.study_level(study_level(company, group)).map_or(0.0, |level| level.noise);
    let mut lines = vec![ReportLine::heading("mean of the group", "range")];
    for (estimate, words, unit, write) in ESTIMATE_FIELDS {
        let Some(value) = estimate(&insights.estimates) else { continue };
        let (from, to) = true_value_range(value, noise);
        let unit = match (unit, group.is_enterprise()) {
            ("$/month", true) => "$/seat·month",
            ("units/day", true) => "units/seat·day",
            ("customers", true) => "enterprises",
            (unit, _) => unit,
        };
        // Other screens use the same type for ranges, so that all ranges agree.
        let truth = TrueValueRange::from_estimate(value, noise);
        let range = match words {
            REQUIRED_QUALITY_LABEL => truth.format_quality(),
            BUDGET_LABEL | USAGE_LABEL => truth.format_units(),
            _ => format!("{} to {}", write(from), write(to)),
        };
        lines.push(ReportLine::estimate_line(format!("{words:<21}{unit}").trim_end().to_owned(), range));
        lines.extend(true_value_text(words, group, company).map(ReportLine::true_value_line));
    }
    if let Some(range) = insights.estimates.seat_range {
        let [least, most] = range.map(|seats| seats as f64);
        for (words, seats) in [("smallest enterprise", least), ("largest enterprise", most)] {
            let (from, to) = true_value_range(seats, noise);
            let range = format!("{} to {}", format_figure(from), format_figure(to));
            lines.push(ReportLine::estimate_line(format!("{words:<21}seats"), range));
        }
    }
    lines.push(ReportLine::heading("word of mouth", "leads/day per 1,000 subscribers"));
    push_influence(&mut lines, &insights.network_influence, noise, &|rate| grouped_number(rate * 1000.0, 2));
    lines.push(ReportLine::heading("reputation", "weight of reputation"));
    push_influence(&mut lines, &insights.reputation_influence, noise, &format_exact);
    lines
}

fn push_influence(lines: &mut Vec<ReportLine>, influence: &Influence, noise: f64, write: &dyn Fn(f64) -> String) {
    let range = |value: f64| {
        let (from, to) = true_value_range(value, noise);
        format!("{} to {}", write(from), write(to))
    };
    for (all, words) in [(&influence.outgoing, "for"), (&influence.incoming, "from")] {
        let mut links: Vec<(&'static str, f64)> =
            all.iter().map(|(group, value)| (group.id(), *value)).collect();
        links.sort_by(|left, right| right.1.total_cmp(&left.1).then(left.0.cmp(right.0)));
        if links.is_empty() {
            lines.push(ReportLine::estimate_line(format!("  {words} no known group"), String::new()));
        }
        lines
            .extend(links.iter().map(|(id, value)| ReportLine::estimate_line(format!("  {words} {id}"), range(*value))));
    }
}

/// Describes the day and the age of a group's estimates.
pub fn study_date_text(company: &DisplayedCompany, group: Group) -> String {
    company.fit(group).map_or(String::new(), Fit::describe_study_day)
}

/// Describes the study in progress, or the cost and the margin of error of the next study.
fn study_offer_text(company: &DisplayedCompany, group: Group, chosen: Option<u8>) -> String {
    if let Some(study) = running_study(company, group) {
        return format!("study to level {} due on day {}", study.target, study.due_day);
    }
    let target = target_level(company, group, chosen);
    let Some(terms) = company.tool_limits.study_level(target) else { return String::new() };
    let what = match target == study_level(company, group) {
        true => format!("update at level {target}"),
        false => format!("study to level {target}"),
    };
    format!("{what}: {}, {}, then noise ±{}", dollars(terms.cost), pluralize(terms.days, "day"), percent(terms.noise, 0))
}

/// Pane with the insight report of the selected group.
pub struct ReportPane;

impl Pane<Market> for ReportPane {
    fn scopes(&self, _: &Market) -> Vec<Scope> {
        vec![Scope::Market, Scope::List]
    }

    fn hints(&self, _: &Market) -> Vec<Action> {
        super::GROUP_HINTS.to_vec()
    }

    fn figure(&self, market: &Market, context: &ScreenContext<'_>) -> Option<Figure> {
        knowledge_figure(market.group()?, context.company, "get_group_insights", "estimates of")
    }

    fn handle_action(&self, market: &mut Market, action: Action, context: &ScreenContext<'_>) -> Vec<Effect> {
        match action {
            Action::Open => return market.show_customers_effect(context.company),
            Action::Close => {
                market.focus = MarketPane::Groups;
                market.report_scroll = ScrollState::default();
            }
            _ => {
                market.report_scroll.handle_action(action, context.page_rows.into());
            }
        }
        Vec::new()
    }

    fn border(&self, market: &Market, _: Rect, context: &ScreenContext<'_>) -> PaneBorder {
        let company = context.company;
        let Some(group) = market.group() else {
            return PaneBorder { title: "Insight report".to_owned(), ..PaneBorder::default() };
        };
        let level = study_level(company, group);
        if level == 0 {
            return PaneBorder { title: format!("{group} · not found yet"), ..PaneBorder::default() };
        }
        let noise = company.tool_limits.study_level(level).map_or(0.0, |level| level.noise);
        PaneBorder {
            title: format!("{group} · {}", group_name(company, group)),
            note: format!("level {level} · noise ±{} · {}", percent(noise, 0), study_date_text(company, group)),
            keys: context.hints(&[Action::StudyGroup, Action::LevelUp, Action::LevelDown]),
            shows_keys_always: true,
        }
    }

    fn draw(&self, market: &Market, canvas: &mut Canvas<'_>, placement: PanePlacement, context: &ScreenContext<'_>) {
        let (company, inside) = (context.company, placement.area);
        let Some(group) = market.group().filter(|_| !inside.is_empty()) else { return };
        if study_level(company, group) == 0 {
            return draw_unknown(canvas, inside, context);
        }
        let running = running_study(company, group).is_some();
        let role = if running { Role::Warning } else { Role::Strong };
        canvas.draw_text(Rect { height: 1, ..inside }, &study_offer_text(company, group, market.target_level), role);
        let rest = Rect { y: inside.y + 1, height: inside.height - 1, ..inside };
        if placement.focused {
            canvas.page_rows = rest.height.max(1);
        }
        draw_estimates(canvas, rest, company, group, &market.report_scroll);
    }
}

/// Explains how the player can find an unknown group.
fn draw_unknown(canvas: &mut Canvas<'_>, area: Rect, context: &ScreenContext<'_>) {
    let terms = &context.company.tool_limits;
    let words = format!(
        "This group has not been found yet. Press {} to pay {} for a market research attempt; {} % of attempts find one of the unknown groups. A found group sends leads from the next day.",
        context.keys.label(Action::FindGroup).unwrap_or_default(),
        dollars(terms.attempt_cost),
        grouped_number(terms.attempt_chance * 100.0, 0)
    );
    for (row, line) in row_rects(area).zip(wrap(&words, area.width as usize)) {
        canvas.draw_text(row, &line, Role::Dim);
    }
}

/// Draws the estimates of a group at a scroll position.
pub fn draw_estimates(
    canvas: &mut Canvas<'_>,
    area: Rect,
    company: &DisplayedCompany,
    group: Group,
    scroll: &ScrollState,
) {
    let lines = report_lines(company, group);
    let rows: Vec<_> = lines.iter().flat_map(|line| estimate_rows(line, area.width.into())).collect();
    let from = scroll.scroll_rows(canvas, area, rows.len());
    for (row, (label, value, role)) in row_rects(area).zip(&rows[from..]) {
        canvas.draw_text(row, label, *role);
        canvas.draw_aligned(row, value, *role, Align::Right);
    }
}

/// Returns the label, the value and the role of each row of a line. In a narrow area, the label has no gaps. If that is
/// still too wide, the value is in a second row.
fn estimate_rows(line: &ReportLine, width: usize) -> Vec<(String, String, Role)> {
    let fits = |label: &str| line.value.is_empty() || label.width() + 2 + line.value.width() <= width;
    let indent = line.label.len() - line.label.trim_start().len();
    let close = " ".repeat(indent) + &line.label.split_whitespace().collect::<Vec<_>>().join(" ");
    match [line.label.clone(), close.clone()].into_iter().find(|label| fits(label)) {
        Some(label) => vec![(label, line.value.clone(), line.role)],
        None => vec![(close, String::new(), line.role), (String::new(), line.value.clone(), line.role)],
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn format_figure_keeps_significant_digits() {
        for (value, words) in
            [(1234.5, "1.23k"), (230.4, "230"), (23.44, "23.4"), (2.345, "2.35"), (3.0, "3")]
        {
            assert_eq!(format_figure(value), words);
        }
        assert_eq!(
            (format_exact(0.51), format_exact(0.0031), format_exact(0.0)),
            ("0.510".into(), "0.003".into(), "0.000".into())
        );
    }
}
