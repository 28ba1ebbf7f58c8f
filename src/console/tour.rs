//! The tour: steps in a real run, each with an explanation, keys and a completion condition.

use std::sync::LazyLock;

use ratatui::layout::Rect;
use serde::Deserialize;
use serde_json::Value;
use unicode_width::UnicodeWidthStr;

use super::action::{ACTIONS, Action};
use super::context::ScreenId;
use super::keys::KeyBindings;
use novamind_session::NewRun;
use novamind_tools::{ParameterNumbers, ToolId};
use novamind_tui::canvas::{Canvas, Click, row_rects};
use novamind_tui::text::wrap;
use novamind_tui::theme::Role;
use novamind_worker::company::DisplayedCompany;

/// Completion condition of a tour step.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "kebab-case")]
enum StepCondition {
    CustomersShown,
    GroupOpen,
    PriceSet,
    TierSet,
    QuotaSet,
    OperationsSet,
    AdsSet,
    Filing,
    Rationale,
    WeekRun,
    ReportRead,
    GroupOpenAgain,
    Changed,
    Developed,
    SecondWeek,
    Asked,
    ThirdWeek,
    FourthWeek,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct TourStep {
    title: String,
    look: String,
    press: String,
    done: StepCondition,
}

/// The practice run and the steps of the tour.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct TourDefinition {
    scenario: String,
    seed: u64,
    step: Vec<TourStep>,
}

static TOUR: LazyLock<TourDefinition> = LazyLock::new(|| {
    let text = include_str!("../../assets/tour.toml");
    toml::from_str(text).expect("a test parses the bundled tour")
});

fn steps() -> &'static [TourStep] {
    &TOUR.step
}

/// Returns the name of the scenario of the tour.
pub fn scenario() -> &'static str {
    &TOUR.scenario
}

/// Returns the definition of the practice run.
pub fn practice_run() -> NewRun {
    NewRun { seed: Some(TOUR.seed), scenario: TOUR.scenario.clone(), ..NewRun::default() }
}

/// State on which the completion conditions of steps depend.
pub struct TourFacts<'a> {
    /// The displayed company.
    pub company: &'a DisplayedCompany,
    /// The current screen.
    pub screen: ScreenId,
    /// Screens shown before the current screen.
    pub back_history: &'a [ScreenId],
    /// Number of the current step of the next-week dialog, counted from 1, while the dialog is open.
    pub next_week_step: Option<usize>,
    /// Whether a dialog is open.
    pub has_dialog: bool,
    /// Whether a group is open on the Customers screen.
    pub is_group_open: bool,
}

impl StepCondition {
    fn is_met(self, facts: &TourFacts<'_>) -> bool {
        let company = facts.company;
        let weeks = company.weeks.len();
        let any = |tool: ToolId| company.settings.get(&tool).is_some_and(has_positive_number);
        let plans = ["A", "B", "C"];
        let has_tier = plans.iter().any(|plan| company.current_setting(ToolId::SetModelTiers, plan) > 1.0);
        match self {
            StepCondition::CustomersShown => facts.screen == ScreenId::Customers || any(ToolId::SetPrices),
            StepCondition::GroupOpen => facts.is_group_open || any(ToolId::SetPrices),
            StepCondition::PriceSet => any(ToolId::SetPrices),
            StepCondition::TierSet => weeks > 0 || has_tier,
            StepCondition::QuotaSet => any(ToolId::SetUsageQuotas),
            StepCondition::OperationsSet => {
                weeks > 0 || company.current_setting(ToolId::SetDailySpend, "operations") > 0.0
            }
            StepCondition::AdsSet => any(ToolId::SetTargetedAdSpend),
            StepCondition::Filing => weeks > 0 || facts.next_week_step.is_some(),
            StepCondition::Rationale => weeks > 0 || facts.next_week_step == Some(3),
            StepCondition::WeekRun => weeks > 0,
            StepCondition::ReportRead => weeks > 1 || weeks > 0 && !facts.has_dialog,
            StepCondition::GroupOpenAgain => {
                weeks > 1 || !company.observation.changes.is_empty() || facts.is_group_open
            }
            StepCondition::Changed => weeks > 1 || !company.observation.changes.is_empty(),
            StepCondition::Developed => weeks > 1 || any(ToolId::SetTargetedDevSpend),
            StepCondition::SecondWeek => weeks > 1,
            StepCondition::Asked => {
                weeks > 2 || facts.screen == ScreenId::Sql || facts.back_history.contains(&ScreenId::Sql)
            }
            StepCondition::ThirdWeek => weeks > 2,
            StepCondition::FourthWeek => weeks > 3,
        }
    }
}

/// Returns whether the arguments contain a number above 0.
fn has_positive_number(arguments: &serde_json::Map<String, Value>) -> bool {
    fn contains_positive_number(value: &Value) -> bool {
        match value {
            Value::Object(map) => map.values().any(contains_positive_number),
            other => other.as_f64().is_some_and(|amount| amount > 0.0),
        }
    }
    arguments.values().any(contains_positive_number)
}

const MAX_LINES: usize = 4;

/// The user's progress in the tour.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Tour {
    step: usize,
}

impl Tour {
    /// Skips all completed steps. Returns false if no step is left.
    pub fn skip_finished_steps(&mut self, facts: &TourFacts<'_>) -> bool {
        while steps().get(self.step).is_some_and(|step| step.done.is_met(facts)) {
            self.step += 1;
        }
        self.step < steps().len()
    }

    /// Skips the current step.
    pub fn skip_step(&mut self) {
        self.step += 1;
    }

    /// Returns the height of the tour pane for a window width: a separator line and the lines of text.
    pub fn height(&self, keys: &KeyBindings, numbers: &ParameterNumbers, width: u16) -> u16 {
        1 + self.lines(keys, numbers, width).len() as u16
    }

    /// Returns the lines below the separator line, with a flag for lines that name keys.
    fn lines(&self, keys: &KeyBindings, numbers: &ParameterNumbers, width: u16) -> Vec<(String, bool)> {
        let Some(step) = steps().get(self.step) else { return Vec::new() };
        let room = width.saturating_sub(2) as usize;
        let look = wrap(&insert_keys(&numbers.substitute(&step.look), keys), room)
            .into_iter()
            .map(|line| (line, false));
        let press = wrap(&format!("→ {}", insert_keys(&step.press, keys)), room);
        let press = press.into_iter().map(|line| (line, true));
        look.chain(press).take(MAX_LINES).collect()
    }

    /// Draws the current step of the tour.
    pub fn draw(&self, canvas: &mut Canvas<'_>, area: Rect, keys: &KeyBindings, numbers: &ParameterNumbers) {
        let Some(step) = steps().get(self.step) else { return };
        canvas.clear(area, Role::Text);
        canvas.draw_text(area, &"─".repeat(area.width as usize), Role::Focus);
        let title = format!(" Tour · {} of {} · {} ", self.step + 1, steps().len(), step.title);
        let place = Rect { x: area.x + 2, width: area.width.saturating_sub(2), ..area };
        canvas.draw_text(Rect { height: 1, ..place }, &title, Role::Title);
        let mut right = area.right().saturating_sub(2);
        for action in [Action::TourClose, Action::TourSkip] {
            let Some(key) = keys.label(action) else { continue };
            let words = format!(" {key} {} ", action.entry().title);
            let width = words.width() as u16;
            if right < place.x + title.width() as u16 + width {
                break;
            }
            right -= width;
            let button = Rect { x: right, width, height: 1, ..area };
            canvas.draw_text(button, &words, Role::Key);
            canvas.register_click(button, Click::Command(action.into()));
        }
        let below = Rect { y: area.y + 1, height: area.height.saturating_sub(1), ..area };
        for (row, (line, press)) in row_rects(below).zip(self.lines(keys, numbers, area.width)) {
            let row = Rect { x: row.x + 1, width: row.width.saturating_sub(1), ..row };
            canvas.draw_text(row, &line, if press { Role::Strong } else { Role::Text });
        }
    }
}

/// Replaces action names in braces with their keys. An action without a key is replaced with the palette key and the
/// title of the action.
fn insert_keys(text: &str, keys: &KeyBindings) -> String {
    let mut words = String::new();
    let mut rest = text;
    while let Some((before, after)) = rest.split_once('{') {
        words.push_str(before);
        let (name, after) = after.split_once('}').unwrap_or((after, ""));
        match ACTIONS.iter().find(|entry| entry.name == name) {
            Some(entry) => match keys.label(entry.action) {
                Some(key) => words.push_str(&key),
                None => {
                    let palette = keys.label(Action::Palette).unwrap_or_default();
                    words.push_str(&format!("{palette} {}", entry.title));
                }
            },
            None => words.push_str(name),
        }
        rest = after;
    }
    words + rest
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;
    use crate::test_kit::{new_company, played_session, render_rows};
    use novamind_record::folder::configuration::Configuration;
    use novamind_record::trajectory::record::Via;
    use novamind_report::action_items::ActionTarget;
    use novamind_report::fit::RangePosition;
    use novamind_session::Session;
    use novamind_session::identifiers::Group;
    use novamind_worker::company::DisplayedCompany;

    fn facts(company: &DisplayedCompany) -> TourFacts<'_> {
        TourFacts {
            company,
            screen: ScreenId::Overview,
            back_history: &[],
            next_week_step: None,
            has_dialog: false,
            is_group_open: false,
        }
    }

    #[test]
    fn tour_steps_name_existing_actions_and_parameters() {
        let keys = KeyBindings::bundled();
        let numbers = ParameterNumbers::bundled();
        for (at, step) in steps().iter().enumerate() {
            for text in [&step.look, &step.press] {
                let filled = numbers.substitute(text);
                for name in
                    filled.split('{').skip(1).filter_map(|rest| rest.split_once('}')).map(|(name, _)| name)
                {
                    assert!(ACTIONS.iter().any(|entry| entry.name == name), "{}: {name}", step.title);
                }
            }
            let tour = Tour { step: at };
            let lines = tour.lines(&keys, &numbers, 80);
            assert!(tour.height(&keys, &numbers, 80) <= 4, "{}: {lines:?}", step.title);
            assert!(tour.height(&keys, &numbers, 60) <= 5, "{}", step.title);
            let narrow: Vec<String> =
                tour.lines(&keys, &numbers, 60).into_iter().map(|(line, _)| line).collect();
            let press = format!("→ {}", insert_keys(&numbers.substitute(&step.press), &keys));
            assert!(narrow.join(" ").ends_with(&press), "{}: {narrow:?}", step.title);
            let shown =
                render_rows(80, 4, |canvas, area| tour.draw(canvas, area, &keys, &numbers)).join("\n");
            assert!(shown.contains(&format!("Tour · {} of {}", at + 1, steps().len())), "{shown}");
            assert!(!shown.contains('{') && shown.contains("→ ") && !shown.contains('…'), "{shown}");
        }
    }

    #[test]
    fn tour_starts_at_the_first_unfinished_step() {
        let fresh = new_company();
        let mut tour = Tour::default();
        assert!(tour.skip_finished_steps(&facts(&fresh)));
        assert_eq!(tour.step, 0);
        assert!(tour.skip_finished_steps(&TourFacts { screen: ScreenId::Customers, ..facts(&fresh) }));
        assert_eq!(steps()[tour.step].done, StepCondition::GroupOpen);
        assert!(tour.skip_finished_steps(&TourFacts { is_group_open: true, ..facts(&fresh) }));
        assert_eq!(steps()[tour.step].done, StepCondition::PriceSet);
        let played = DisplayedCompany::from_session(&played_session(2));
        let mut tour = Tour::default();
        assert!(tour.skip_finished_steps(&facts(&played)));
        assert_eq!(steps()[tour.step].done, StepCondition::Asked, "a returning user continues near the end");
        assert!(tour.skip_finished_steps(&TourFacts { screen: ScreenId::Sql, ..facts(&played) }));
        assert_eq!(steps()[tour.step].done, StepCondition::ThirdWeek);
        tour.skip_step();
        tour.skip_step();
        assert!(!tour.skip_finished_steps(&facts(&played)), "the tour is complete");
    }

    #[test]
    fn every_step_can_be_skipped_and_drawn_in_any_window() {
        let fresh = new_company();
        let keys = KeyBindings::bundled();
        let numbers = ParameterNumbers::bundled();
        let mut tour = Tour::default();
        for _ in 0..steps().len() {
            assert!(tour.skip_finished_steps(&facts(&fresh)));
            for (width, height) in [(0, 0), (1, 1), (20, 3), (60, 5), (200, 4)] {
                render_rows(width, height, |canvas, area| tour.draw(canvas, area, &keys, &numbers));
            }
            tour.skip_step();
        }
        assert!(!tour.skip_finished_steps(&facts(&fresh)));
        assert_eq!(tour.height(&keys, &numbers, 80), 1);
    }

    #[test]
    fn practice_run_matches_the_steps() {
        let mut run = Session::create(practice_run(), &Configuration::bundled()).expect("a practice run");
        let s2 = |run: &Session| {
            DisplayedCompany::from_session(run)
                .fit(Group::parse("S2").expect("a group"))
                .expect("S2 is known")
                .clone()
        };
        let wanted = s2(&run);
        assert!(
            wanted.budget.position_of(45.0) == RangePosition::Below,
            "well below what S2 pays: {:?}",
            wanted.budget
        );
        assert!(wanted.usage.position_of(400.0) == RangePosition::Above, "400 covers S2: {:?}", wanted.usage);
        for (tool, arguments) in [
            ("set_prices", json!({"B": 45})),
            ("set_model_tiers", json!({"B": 2})),
            ("set_usage_quotas", json!({"A": 0, "B": 400, "C": 0})),
            ("set_daily_spend", json!({"operations": 160})),
            ("set_targeted_ad_spend", json!({"targeted_spend": {"social_media": {"S2": 700}}})),
        ] {
            run.call(tool, &arguments, Via::Script).expect(tool);
        }
        let week = |run: &mut Session| {
            let forecasts = run.company().naive_forecasts();
            run.advance("the tour", &forecasts, Via::Script, &mut |_| {}).expect("a week").figures
        };
        let first = week(&mut run);
        let (leads, signed) = (first.new_individual_leads, first.new_individual_subscribers);
        assert!(leads > 100 && signed > 0 && signed * 5 < leads, "few signed: {signed} of {leads}");
        let company = DisplayedCompany::from_session(&run);
        let need = company.action_items.first().expect("an action item");
        let ActionTarget::Call(tool, arguments) = &need.target else { panic!("{need:?}") };
        assert_eq!((*tool, arguments), (ToolId::SetModelTiers, &json!({"B": 3})), "a better model for B");
        run.call("set_model_tiers", arguments, Via::Script).expect("the call of the need");
        run.call("set_targeted_dev_spend", &json!({"targeted_spend": {"S2": 1100}}), Via::Script)
            .expect("development");
        let second = week(&mut run);
        assert!(second.new_individual_subscribers > signed, "the better model helps: {second:?}");
        let mut left = 0;
        while run.company().observe().ended.is_none() {
            left += week(&mut run).cancellations;
        }
        assert!(left > 0, "a subscriber leaves before the end");
        let numbers =
            DisplayedCompany::from_session(&run).numbers.substitute("{billing.billing_period_days}");
        assert_eq!(numbers, "30");
    }
}
