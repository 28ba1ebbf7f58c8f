//! The insight report of a group: estimates with ranges, influence, and the next study.

use ratatui::layout::Rect;
use unicode_width::UnicodeWidthStr;

use super::model::{level_of, name_of, study_of, target_of};
use super::{Market, MarketPane, knowledge_of};
use crate::action::{Action, Scope};
use crate::context::{Figure, Look};
use crate::effect::Effect;
use crate::screens::panes::{Border, Pane, Seat};
use novamind_base::notation::{compact, dollars, grouped, percent};
use novamind_report::fit::{Fit, TruthRange};
use novamind_session::identifiers::Group;
use novamind_session::truth_behind;
use novamind_tools::{Estimates, Influence};
use novamind_tui::canvas::{Align, Canvas, rows_of};
use novamind_tui::text::wrapped;
use novamind_tui::theme::Role;
use novamind_worker::company::Company;

/// A line with text at the left and figures at the right.
#[derive(Debug, Clone, PartialEq)]
pub struct ReportLine {
    words: String,
    figures: String,
    role: Role,
}

impl ReportLine {
    fn head(words: &str, figures: &str) -> ReportLine {
        ReportLine { words: words.to_owned(), figures: figures.to_owned(), role: Role::Header }
    }

    fn of(words: String, figures: String) -> ReportLine {
        ReportLine { words, figures, role: Role::Text }
    }

    /// Returns a line with the true value of the estimate above.
    fn of_truth(figures: String) -> ReportLine {
        ReportLine { words: "  x-ray: true".to_owned(), figures, role: Role::Changed }
    }
}

/// An estimate: accessor, label, unit and format.
type Estimate = (fn(&Estimates) -> Option<f64>, &'static str, &'static str, fn(f64) -> String);

/// Other screens show a range for it, too.
const QUALITY_FLOOR: &str = "required quality";

const ESTIMATES: [Estimate; 8] = [
    (|all| Some(all.willingness_to_pay), BUDGET, "$/month", figure),
    (|all| Some(all.usage_volume), USAGE, "units/day", figure),
    (|all| Some(all.quality_floor_q_min), QUALITY_FLOOR, "", exact),
    (|all| Some(all.market_cap as f64), MARKET, "customers", figure),
    (|all| Some(all.annual_market_cap_growth_rate), "market growth", "a year", share),
    (|all| Some(all.contract_lockin_aversion), "lock-in aversion", "", exact),
    (|all| all.decision_rounds.map(|rounds| rounds as f64), "rounds per deal", "", figure),
    (|all| all.avg_response_days, "response time", "days", figure),
];

/// Other screens show a range for it, too.
const USAGE: &str = "usage";

/// Other screens show a range and a true value for these, too.
const BUDGET: &str = "budget";
const MARKET: &str = "market cap";

/// Returns the true value on the shown day, if the x-ray is open.
fn truth_of(words: &str, group: Group, company: &Company) -> Option<String> {
    let own = &company.hidden.as_ref()?.groups[group];
    Some(match words {
        BUDGET => figure(own.budget),
        QUALITY_FLOOR => exact(own.quality_floor),
        MARKET if own.market_cap <= 0.0 => "no limit".to_owned(),
        MARKET => grouped(own.market_cap, 0),
        _ => return None,
    })
}

fn figure(value: f64) -> String {
    match value.abs() {
        size if size >= 1000.0 => compact(value),
        size if size >= 100.0 || value.fract() == 0.0 => grouped(value, 0),
        size if size >= 10.0 => grouped(value, 1),
        _ => grouped(value, 2),
    }
}

fn exact(value: f64) -> String {
    if value != 0.0 && value.abs() < 0.01 { grouped(value, 5) } else { grouped(value, 3) }
}

fn share(value: f64) -> String {
    percent(value, 1)
}

/// Returns the lines of the report of a known group.
pub fn lines(company: &Company, group: Group) -> Vec<ReportLine> {
    let Some(insights) = company.insights.get(&group) else { return Vec::new() };
    let noise = company.terms.level(level_of(company, group)).map_or(0.0, |level| level.noise);
    let mut lines = vec![ReportLine::head("mean of the group", "range")];
    for (estimate, words, unit, write) in ESTIMATES {
        let Some(value) = estimate(&insights.estimates) else { continue };
        let (from, to) = truth_behind(value, noise);
        let unit = match (unit, group.is_enterprise()) {
            ("$/month", true) => "$/month, seat",
            ("units/day", true) => "units/day, seat",
            ("customers", true) => "enterprises",
            (unit, _) => unit,
        };
        // Ranges on other screens come from the same type, so that all agree.
        let truth = TruthRange::behind(value, noise);
        let range = match words {
            QUALITY_FLOOR => truth.quality(),
            BUDGET | USAGE => truth.units(),
            _ => format!("{} to {}", write(from), write(to)),
        };
        lines.push(ReportLine::of(format!("{words:<21}{unit}").trim_end().to_owned(), range));
        lines.extend(truth_of(words, group, company).map(ReportLine::of_truth));
    }
    if let Some(range) = insights.estimates.seat_range {
        let [least, most] = range.map(|seats| seats as f64);
        for (words, seats) in [("smallest enterprise", least), ("largest enterprise", most)] {
            let (from, to) = truth_behind(seats, noise);
            let range = format!("{} to {}", figure(from), figure(to));
            lines.push(ReportLine::of(format!("{words:<21}seats"), range));
        }
    }
    lines.push(ReportLine::head("word of mouth", "leads/day per 1,000 subscribers"));
    influence(&mut lines, &insights.network_influence, noise, &|rate| figure(rate * 1000.0));
    lines.push(ReportLine::head("reputation", "weight of reputation"));
    influence(&mut lines, &insights.reputation_influence, noise, &exact);
    lines
}

fn influence(lines: &mut Vec<ReportLine>, influence: &Influence, noise: f64, write: &dyn Fn(f64) -> String) {
    let range = |value: f64| {
        let (from, to) = truth_behind(value, noise);
        format!("{} to {}", write(from), write(to))
    };
    for (all, words) in [(&influence.outgoing, "for"), (&influence.incoming, "from")] {
        let mut links: Vec<(&'static str, f64)> =
            all.iter().map(|(group, value)| (group.id(), *value)).collect();
        links.sort_by(|left, right| right.1.total_cmp(&left.1).then(left.0.cmp(right.0)));
        if links.is_empty() {
            lines.push(ReportLine::of(format!("  {words} no known group"), String::new()));
        }
        lines
            .extend(links.iter().map(|(id, value)| ReportLine::of(format!("  {words} {id}"), range(*value))));
    }
}

/// Returns the day and age of a group's estimates.
pub fn studied(company: &Company, group: Group) -> String {
    company.fit(group).map_or(String::new(), Fit::studied)
}

/// Returns the cost and result of the next study, or the running study.
fn study_words(company: &Company, group: Group, chosen: Option<u8>) -> String {
    if let Some(study) = study_of(company, group) {
        return format!("study to level {} due on day {}", study.target, study.due_day);
    }
    let target = target_of(company, group, chosen);
    let Some(terms) = company.terms.level(target) else { return String::new() };
    let what = match target == level_of(company, group) {
        true => format!("update at level {target}"),
        false => format!("to level {target}"),
    };
    format!("{what}: {}, {} days, then ±{}", dollars(terms.cost), terms.days, percent(terms.noise, 0))
}

/// The report of the selected group.
pub struct ReportPane;

impl Pane<Market> for ReportPane {
    fn scopes(&self, _: &Market) -> Vec<Scope> {
        vec![Scope::Market, Scope::List]
    }

    fn hints(&self, _: &Market) -> Vec<Action> {
        super::GROUP_HINTS.to_vec()
    }

    fn figure(&self, market: &Market, look: &Look<'_>) -> Option<Figure> {
        knowledge_of(market.group()?, look.company, "get_group_insights", "estimates of")
    }

    fn act(&self, market: &mut Market, action: Action, look: &Look<'_>) -> Vec<Effect> {
        let page = usize::from(look.page.max(1));
        let count = market.group().map_or(0, |group| lines(look.company, group).len());
        let (from, last) = (market.from, count.saturating_sub(page));
        market.from = match action {
            Action::Open => return market.show_customers(look.company),
            Action::Up => from.min(last).saturating_sub(1),
            Action::Down => (from + 1).min(last),
            Action::PageUp => from.saturating_sub(page),
            Action::PageDown => (from + page).min(last),
            Action::First => 0,
            Action::Last => last,
            Action::Close => {
                market.focus = MarketPane::Groups;
                0
            }
            _ => from,
        };
        Vec::new()
    }

    fn border(&self, market: &Market, _: Rect, look: &Look<'_>) -> Border {
        let company = look.company;
        let Some(group) = market.group() else {
            return Border { title: "Insight report".to_owned(), ..Border::default() };
        };
        let level = level_of(company, group);
        if level == 0 {
            return Border { title: format!("{group} · not found yet"), ..Border::default() };
        }
        let noise = company.terms.level(level).map_or(0.0, |level| level.noise);
        Border {
            title: format!("{group} · {}", name_of(company, group)),
            note: format!("level {level} · ±{} · {}", percent(noise, 0), studied(company, group)),
            keys: look.hints(&[Action::StudyGroup, Action::LevelUp, Action::LevelDown]),
            keys_always: true,
        }
    }

    fn draw(&self, market: &Market, canvas: &mut Canvas<'_>, seat: Seat, look: &Look<'_>) {
        let (company, inside) = (look.company, seat.area);
        let Some(group) = market.group().filter(|_| !inside.is_empty()) else { return };
        if level_of(company, group) == 0 {
            return draw_unknown(canvas, inside, look);
        }
        let running = study_of(company, group).is_some();
        let role = if running { Role::Warning } else { Role::Strong };
        canvas.text(Rect { height: 1, ..inside }, &study_words(company, group, market.target), role);
        let rest = Rect { y: inside.y + 1, height: inside.height - 1, ..inside };
        if seat.focused {
            canvas.page = rest.height.max(1);
        }
        draw_estimates(canvas, rest, company, group, market.from);
    }
}

/// Explains how an unknown group can be found.
fn draw_unknown(canvas: &mut Canvas<'_>, area: Rect, look: &Look<'_>) {
    let terms = &look.company.terms;
    let words = format!(
        "This group has not been found yet. {} pays {} for a market research attempt; {} % of attempts find one of the unknown groups. A found group sends leads from the next day.",
        look.keys.label(Action::FindGroup).unwrap_or_default(),
        dollars(terms.attempt_cost),
        grouped(terms.attempt_chance * 100.0, 0)
    );
    for (row, line) in rows_of(area).zip(wrapped(&words, area.width as usize)) {
        canvas.text(row, &line, Role::Dim);
    }
}

/// Draws the estimates from a given line.
pub fn draw_estimates(canvas: &mut Canvas<'_>, area: Rect, company: &Company, group: Group, from: usize) {
    let lines = lines(company, group);
    let from = from.min(lines.len().saturating_sub(area.height as usize));
    for (row, line) in rows_of(area).zip(&lines[from..]) {
        canvas.text(row, &line.words, line.role);
        let taken = line.words.width() as u16 + 2;
        // Do not draw a range that is cut off.
        if taken + line.figures.width() as u16 <= row.width {
            canvas.aligned(row, &line.figures, line.role, Align::Right);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn figures_keep_the_digits_that_matter() {
        for (value, words) in
            [(1234.5, "1.23k"), (230.4, "230"), (23.44, "23.4"), (2.345, "2.35"), (3.0, "3")]
        {
            assert_eq!(figure(value), words);
        }
        assert_eq!(
            (exact(0.51), exact(0.0031), exact(0.0)),
            ("0.510".into(), "0.00310".into(), "0.000".into())
        );
    }
}
