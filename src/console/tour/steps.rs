//! The steps of the tour, which `assets/tour.toml` defines: their texts, goals and conditions.

use std::sync::LazyLock;

use serde::Deserialize;
use serde_json::Value;

use super::claims::insert_figures;
use super::route::TourFacts;
use crate::context::ScreenId;
use crate::dialogs::DialogContent;
use novamind_base::formatting::grouped_number;
use novamind_session::NewRun;
use novamind_tools::ToolId;
use novamind_worker::company::DisplayedCompany;

/// Maximum ratio of a value that reaches a goal to the value that the step asks for, and of this value to it.
const MAX_FACTOR: f64 = 2.0;
/// Number of days in a week.
const WEEK_DAYS: u32 = 7;
/// Week in which the first subscribers can cancel.
const FIRST_WEEK_OF_CANCELLATIONS: usize = 5;

/// The definition of the tour.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct TourDefinition {
    scenario: String,
    seed: u64,
    days: u32,
    step: Vec<TourStep>,
}

/// A step of the tour.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct TourStep {
    pub title: String,
    pub text: String,
    pub goal: Goal,
    /// Number of weeks that must have run before the goal can be reached.
    #[serde(default)]
    pub from_week: usize,
    #[serde(default)]
    pub needs: Option<Need>,
}

/// What the user does in a step.
#[derive(Debug, Deserialize)]
#[serde(untagged, deny_unknown_fields)]
pub(super) enum Goal {
    /// Set the first cell of a form, which a path in the arguments of the tool names.
    Set { set: ToolId, value: String, path: String, cell: String },
    /// Run weeks until this number of weeks has run.
    Weeks { weeks: usize },
    /// Look at something and continue.
    Read { read: Sight },
}

/// Something that a step shows.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub(super) enum Sight {
    Overview,
    Curve,
    Fit,
    Report,
    Cancellations,
    Causes,
    WhatIf,
    Help,
}

/// Condition of a step. If it is not met, the step is omitted.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub(super) enum Need {
    /// The run permits re-simulation.
    Resimulation,
    /// A subscriber has cancelled, or none could cancel yet.
    Cancellation,
}

static TOUR: LazyLock<TourDefinition> = LazyLock::new(|| {
    let text = include_str!("../../../assets/tour.toml");
    toml::from_str(text).expect("a test parses the bundled tour")
});

pub(super) fn steps() -> &'static [TourStep] {
    &TOUR.step
}

/// Returns the definition of the run of the tour.
pub fn tour_run() -> NewRun {
    NewRun {
        seed: Some(TOUR.seed),
        days: Some(TOUR.days),
        scenario: TOUR.scenario.clone(),
        ..NewRun::default()
    }
}

/// Returns whether a run has the scenario, seed and last day of the tour.
pub fn is_tour_run(scenario: &str, seed: u64, last_day: u32) -> bool {
    (scenario, seed, last_day) == (TOUR.scenario.as_str(), TOUR.seed, TOUR.days)
}

impl TourStep {
    /// Returns whether the step is possible in a run.
    pub fn applies_to(&self, company: &DisplayedCompany) -> bool {
        let weeks = match self.goal {
            Goal::Weeks { weeks } => weeks,
            _ => self.from_week,
        };
        let last_day = company.observation.last_day;
        let is_possible = match self.needs {
            None => true,
            Some(Need::Resimulation) => company.can_explain_causes() && can_cancel(company),
            Some(Need::Cancellation) => can_cancel(company),
        };
        let has_time = company.is_running() || company.weeks.len() >= weeks;
        is_possible && has_time && last_day >= weeks as u32 * WEEK_DAYS
    }

    /// Returns whether a step that changes the company has reached its goal. Returns false for steps without a change.
    pub fn is_reached(&self, company: &DisplayedCompany) -> bool {
        match &self.goal {
            Goal::Set { value, .. } => {
                let asked = value.parse::<f64>().unwrap_or(0.0);
                let least = asked / MAX_FACTOR;
                self.setting(company).is_some_and(|amount| (least..=asked * MAX_FACTOR).contains(&amount))
            }
            Goal::Weeks { weeks } => company.weeks.len() >= *weeks,
            Goal::Read { .. } => false,
        }
    }
}

impl TourStep {
    /// Returns the current value of the cell that the step asks for.
    fn setting(&self, company: &DisplayedCompany) -> Option<f64> {
        let Goal::Set { set, path, .. } = &self.goal else { return None };
        let path = insert_figures(path, company);
        let mut names = path.split('/');
        let first = company.settings.get(set)?.get(names.next()?)?;
        names.try_fold(first, |value, name| value.get(name))?.as_f64()
    }

    /// Describes what differs from the step, if the user set other values with its tool.
    pub fn describe_difference(&self, company: &DisplayedCompany) -> Option<String> {
        let Goal::Set { set, value, cell, .. } = &self.goal else { return None };
        if self.is_reached(company) || !is_set(*set, company) {
            return None;
        }
        let (cell, amount) = (insert_figures(cell, company), self.setting(company).unwrap_or(0.0));
        Some(format!(
            "You set something else: {cell} is {}, and this step needs {value}.",
            grouped_number(amount, 0)
        ))
    }
}

/// Returns whether a subscriber has cancelled, or may still cancel in a run that is long enough.
fn can_cancel(company: &DisplayedCompany) -> bool {
    let is_to_come = company.is_running()
        && company.weeks.len() < FIRST_WEEK_OF_CANCELLATIONS
        && company.observation.last_day >= FIRST_WEEK_OF_CANCELLATIONS as u32 * WEEK_DAYS;
    is_to_come || company.weeks.iter().any(|week| week.cancellations > 0)
}

/// Returns whether a setting has been made.
fn is_set(tool: ToolId, company: &DisplayedCompany) -> bool {
    match tool {
        ToolId::SetModelTiers => ["A", "B", "C"].iter().any(|plan| company.current_setting(tool, plan) > 1.0),
        ToolId::SetDailySpend => company.current_setting(tool, "operations") > 0.0,
        _ => company.settings.get(&tool).is_some_and(|all| all.values().any(contains_positive_number)),
    }
}

fn contains_positive_number(value: &Value) -> bool {
    match value {
        Value::Object(map) => map.values().any(contains_positive_number),
        other => other.as_f64().is_some_and(|amount| amount > 0.0),
    }
}

impl Sight {
    /// Returns the dialog that shows the content, or `None` if a screen shows it.
    pub fn dialog(self) -> Option<DialogContent> {
        match self {
            Sight::Curve => Some(DialogContent::Curve),
            Sight::Report => Some(DialogContent::WeekReport),
            Sight::Causes => Some(DialogContent::CancellationCauses),
            Sight::WhatIf => Some(DialogContent::WhatIf),
            Sight::Help => Some(DialogContent::Help),
            Sight::Overview | Sight::Fit | Sight::Cancellations => None,
        }
    }

    /// Returns whether the content is visible.
    pub fn is_shown(self, facts: &TourFacts<'_>) -> bool {
        if let Some(content) = self.dialog() {
            return facts.dialog.as_ref().is_some_and(|view| view.content == content && view.is_shown);
        }
        let is_on = |screen| facts.screen == screen && !facts.has_dialog && !facts.is_typing;
        match self {
            Sight::Fit => is_on(ScreenId::Customers) && facts.customers.shows_fit(),
            Sight::Cancellations => is_on(ScreenId::Sql) && facts.shows_cancellations,
            _ => is_on(ScreenId::Overview),
        }
    }
}
