//! The page at the end of a run: the score beside published results, and how the run was played.

use std::collections::BTreeMap;
use std::sync::OnceLock;

use ratatui::layout::Rect;
use ratatui::text::Line as TextLine;
use serde::Deserialize;
use serde_json::Value;

use super::{Dialog, Outcome};
use crate::console::action::{Action, Scope};
use crate::console::canvas::{Canvas, centered};
use crate::console::company::Company;
use crate::console::effect::Effect;
use crate::console::screens::Look;
use crate::console::text::short_dollars;
use crate::console::theme::Role;
use crate::console::widgets::{Axis, Line, chart};
use crate::notation::{dollars, grouped, percent};
use crate::session::{Ended, JournalEntry};

/// Published results (read once).
#[derive(Debug, Deserialize)]
pub struct Published {
    /// Cash of the rule-based policy, dollars.
    pub rule_based_baseline: f64,
    /// What a perfect player might reach, dollars.
    pub estimated_upper_bound: f64,
    /// Results of agents.
    pub agent: Vec<Agent>,
}

/// Results of one agent.
#[derive(Debug, Deserialize)]
pub struct Agent {
    /// Model.
    pub name: String,
    /// Runs that ended with cash below zero.
    pub bankruptcies: u32,
    /// Runs.
    pub runs: u32,
    /// Cash of the best run, dollars.
    pub best_cash: f64,
}

/// The published results.
pub fn published() -> &'static Published {
    static READ: OnceLock<Published> = OnceLock::new();
    READ.get_or_init(|| {
        toml::from_str(include_str!("../../../assets/paper-results.toml"))
            .expect("a test reads the shipped results")
    })
}

/// The final page.
pub struct FinalPage;

impl Dialog for FinalPage {
    fn scopes(&self) -> Vec<Scope> {
        vec![Scope::Final]
    }

    fn hints(&self) -> Vec<Action> {
        vec![Action::ToMenu, Action::StayInRun]
    }

    fn act(&mut self, action: Action, _: &Look<'_>) -> Outcome {
        match action {
            Action::ToMenu => Outcome::close_with(vec![Effect::Do(Action::LeaveRun)]),
            Action::StayInRun => Outcome::close(),
            _ => Outcome::stay(),
        }
    }

    fn draw(&self, canvas: &mut Canvas<'_>, area: Rect, look: &Look<'_>) {
        let company = look.company;
        let own = centered(area, 112.min(area.width), 40.min(area.height));
        canvas.clear(own, Role::Text);
        let inside = canvas.pane(own, &headline(company), "", true);
        let inside = Rect { x: inside.x + 1, width: inside.width.saturating_sub(2), ..inside };
        let mut lines = Vec::new();
        draw_ranking(canvas, company, inside.width, &mut lines);
        lines.push(TextLine::default());
        lines.extend(facts(company).into_iter().map(|(name, value)| {
            TextLine::from(vec![
                canvas.span(format!("{name:<36}"), Role::Dim),
                canvas.span(value, Role::Text),
            ])
        }));
        canvas.lines(inside, &lines);
        let used = lines.len() as u16 + 1;
        let left = Rect { y: inside.y + used, height: inside.height.saturating_sub(used), ..inside };
        let cash = [Line::of(&company.cash_by_day, Role::Series(0))];
        let x = Axis { write: &|day| format!("day {day:.0}"), holds: &[0.0] };
        chart(canvas, left, &cash, &x, &Axis { write: &short_dollars, holds: &[0.0] });
        canvas.pane_keys(own, &look.hints(&[Action::ToMenu, Action::StayInRun]));
    }
}

fn headline(company: &Company) -> String {
    let seen = &company.seen;
    match seen.ended {
        Some(Ended::Horizon) => format!("Day {}. You end with {}.", seen.day, dollars(seen.cash)),
        Some(Ended::Bankruptcy) => format!("Day {}. The company is bankrupt; the score is $0.", seen.day),
        Some(Ended::Abandoned) => format!("Day {}. The run was given up; it has no score.", seen.day),
        None => format!("Day {}", seen.day),
    }
}

/// The published results with the person's own among them.
fn draw_ranking(canvas: &Canvas<'_>, company: &Company, width: u16, lines: &mut Vec<TextLine<'_>>) {
    let own = company.seen.score;
    let mut rows: Vec<(String, f64, bool)> =
        published().agent.iter().map(|agent| (agent.name.clone(), agent.best_cash, false)).collect();
    rows.push(("Rule-based baseline".to_owned(), published().rule_based_baseline, false));
    if let Some(score) = own {
        rows.push(("You".to_owned(), score, true));
    }
    rows.sort_by(|left, right| right.1.total_cmp(&left.1));
    let place = rows.iter().position(|row| row.2);
    let caption = match place {
        Some(place) => format!("rank {} of {} beside the published results", place + 1, rows.len()),
        None => "the published results".to_owned(),
    };
    let comparable =
        company.seen.last_day == 500 && company.seen.seed == 42 && company.seen.scenario == "default";
    let caveat = if comparable { "" } else { " (those are for 500 days, seed 42, one million at the start)" };
    lines.push(TextLine::from(canvas.span(format!("{caption}{caveat}"), Role::Dim)));
    let most = rows.iter().map(|row| row.1).fold(1.0, f64::max);
    let room = (width as usize).saturating_sub(42).min(50);
    let wanted: Vec<usize> =
        (0..rows.len()).filter(|at| *at < 5 || place.is_some_and(|own| at.abs_diff(own) <= 1)).collect();
    for at in wanted {
        let (name, cash, mine) = &rows[at];
        let bar = "█".repeat(((cash.max(0.0) / most) * room as f64).round() as usize);
        let role = if *mine { Role::Good } else { Role::Text };
        lines.push(TextLine::from(vec![
            canvas.span(if *mine { "▌ " } else { "  " }, role),
            canvas.span(format!("{name:<22}{:>12}  ", grouped(*cash, 0)), role),
            canvas.span(bar, if *mine { Role::Good } else { Role::Series(0) }),
        ]));
    }
}

/// How the run was played.
fn facts(company: &Company) -> Vec<(&'static str, String)> {
    let calibration: Vec<String> = company
        .scores
        .iter()
        .filter(|score| score.scored > 0)
        .map(|score| {
            let inside = f64::from(score.covered) / f64::from(score.scored);
            format!(
                "{} wk {} inside, {} miss",
                score.horizon_days / 7,
                percent(inside, 0),
                percent(score.mean_error, 0)
            )
        })
        .collect();
    let mut tools: BTreeMap<&str, u32> = BTreeMap::new();
    for entry in &company.journal {
        if let JournalEntry::Call { tool, .. } = entry {
            *tools.entry(tool).or_default() += 1;
        }
    }
    let mut used: Vec<(&str, u32)> = tools.into_iter().collect();
    used.sort_by(|left, right| right.1.cmp(&left.1).then(left.0.cmp(right.0)));
    let used: Vec<String> = used.iter().take(4).map(|(tool, count)| format!("{tool} {count}×")).collect();
    let (ads, development) = spend_shares(company);
    let or_none = |list: Vec<String>| if list.is_empty() { "–".to_owned() } else { list.join(" · ") };
    let share = |share: Option<f64>| share.map_or("–".to_owned(), |share| percent(share, 0));
    vec![
        ("forecasts", or_none(calibration)),
        ("ad spend on the favoured channel", share(ads)),
        ("development spend that is targeted", share(development)),
        ("tools", or_none(used)),
    ]
}

/// Share of ad spend on the channel that got most, and targeted share of development spend, both summed over the
/// weeks as they were set; none where nothing was spent.
fn spend_shares(company: &Company) -> (Option<f64>, Option<f64>) {
    let mut channels: BTreeMap<String, f64> = BTreeMap::new();
    let (mut general, mut targeted) = (0.0, 0.0);
    let mut now = Spend::default();
    for entry in &company.journal {
        match entry {
            JournalEntry::Call { tool, args, .. } => now.set(tool, args),
            JournalEntry::Week { figures } => {
                let days = f64::from(figures.days_run);
                for (channel, dollars) in &now.channels {
                    *channels.entry(channel.clone()).or_default() += dollars * days;
                }
                general += now.development * days;
                targeted += now.targeted * days;
            }
            JournalEntry::Advance { .. } => {}
        }
    }
    let total: f64 = channels.values().sum();
    let most = channels.values().copied().fold(0.0, f64::max);
    let share = |part: f64, whole: f64| (whole > 0.0).then(|| part / whole);
    (share(most, total), share(targeted, general + targeted))
}

/// Spend in force, dollars a day.
#[derive(Default)]
struct Spend {
    channels: BTreeMap<String, f64>,
    development: f64,
    targeted: f64,
}

impl Spend {
    fn set(&mut self, tool: &str, args: &Value) {
        let sum =
            |map: &Value| map.as_object().into_iter().flatten().filter_map(|(_, value)| value.as_f64()).sum();
        let whole = args.get("targeted_spend").unwrap_or(&Value::Null);
        match tool {
            "set_daily_spend" => {
                if let Some(value) = args.get("development").and_then(Value::as_f64) {
                    self.development = value;
                }
            }
            "set_targeted_dev_spend" => self.targeted = sum(whole),
            "set_targeted_ad_spend" => {
                let channel = |(name, groups): (&String, &Value)| (name.clone(), sum(groups));
                self.channels = whole.as_object().into_iter().flatten().map(channel).collect();
            }
            _ => {}
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_published_results_are_read() {
        assert!(published().rule_based_baseline > 1e7 && published().agent.len() > 10);
    }
}
