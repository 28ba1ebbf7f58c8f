//! The tour: steps over the real game, each with an explanation, keys and a completion condition.

use std::sync::LazyLock;

use ratatui::layout::Rect;
use serde::Deserialize;
use serde_json::Value;
use unicode_width::UnicodeWidthStr;

use super::action::{ACTIONS, Action};
use super::context::ScreenId;
use super::keys::Keys;
use novamind_session::NewRun;
use novamind_tools::{Numbers, ToolId};
use novamind_tui::canvas::{Canvas, Click, rows_of};
use novamind_tui::text::wrapped;
use novamind_tui::theme::Role;
use novamind_worker::company::Company;

/// Completion condition of a step.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "kebab-case")]
enum Done {
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
    done: Done,
}

/// The steps of the tour, and its run.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Course {
    scenario: String,
    seed: u64,
    step: Vec<TourStep>,
}

static COURSE: LazyLock<Course> = LazyLock::new(|| {
    let text = include_str!("../../assets/tour.toml");
    toml::from_str(text).expect("a test parses the bundled tour")
});

fn steps() -> &'static [TourStep] {
    &COURSE.step
}

/// Returns the scenario of the tour.
pub fn scenario() -> &'static str {
    &COURSE.scenario
}

/// Returns the definition of the practice run.
pub fn practice_run() -> NewRun {
    NewRun { seed: Some(COURSE.seed), scenario: COURSE.scenario.clone(), ..NewRun::default() }
}

/// State that completion conditions depend on.
pub struct TourFacts<'a> {
    /// The company.
    pub company: &'a Company,
    /// The current screen.
    pub here: ScreenId,
    /// Screens shown before.
    pub before: &'a [ScreenId],
    /// Step of the next-week dialog, from 1, while it is open.
    pub filing: Option<usize>,
    /// Whether a dialog is open.
    pub dialog: bool,
    /// Whether a group is open on the Customers screen.
    pub group_open: bool,
}

impl Done {
    fn holds(self, facts: &TourFacts<'_>) -> bool {
        let company = facts.company;
        let weeks = company.weeks.len();
        let any = |tool: ToolId| company.settings.get(&tool).is_some_and(spends);
        let plans = ["A", "B", "C"];
        let has_tier = plans.iter().any(|plan| company.setting(ToolId::SetModelTiers, plan) > 1.0);
        match self {
            Done::CustomersShown => facts.here == ScreenId::Customers || any(ToolId::SetPrices),
            Done::GroupOpen => facts.group_open || any(ToolId::SetPrices),
            Done::PriceSet => any(ToolId::SetPrices),
            Done::TierSet => weeks > 0 || has_tier,
            Done::QuotaSet => any(ToolId::SetUsageQuotas),
            Done::OperationsSet => weeks > 0 || company.setting(ToolId::SetDailySpend, "operations") > 0.0,
            Done::AdsSet => any(ToolId::SetTargetedAdSpend),
            Done::Filing => weeks > 0 || facts.filing.is_some(),
            Done::Rationale => weeks > 0 || facts.filing == Some(3),
            Done::WeekRun => weeks > 0,
            Done::ReportRead => weeks > 1 || weeks > 0 && !facts.dialog,
            Done::GroupOpenAgain => weeks > 1 || !company.seen.changes.is_empty() || facts.group_open,
            Done::Changed => weeks > 1 || !company.seen.changes.is_empty(),
            Done::Developed => weeks > 1 || any(ToolId::SetTargetedDevSpend),
            Done::SecondWeek => weeks > 1,
            Done::Asked => weeks > 2 || facts.here == ScreenId::Sql || facts.before.contains(&ScreenId::Sql),
            Done::ThirdWeek => weeks > 2,
            Done::FourthWeek => weeks > 3,
        }
    }
}

/// Returns whether the arguments contain a number above 0.
fn spends(arguments: &serde_json::Map<String, Value>) -> bool {
    fn holds(value: &Value) -> bool {
        match value {
            Value::Object(map) => map.values().any(holds),
            other => other.as_f64().is_some_and(|amount| amount > 0.0),
        }
    }
    arguments.values().any(holds)
}

const MOST_LINES: usize = 4;

/// Progress in the tour.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Tour {
    at: usize,
}

impl Tour {
    /// Advances past completed steps. Returns false if none is left.
    pub fn settle(&mut self, facts: &TourFacts<'_>) -> bool {
        while steps().get(self.at).is_some_and(|step| step.done.holds(facts)) {
            self.at += 1;
        }
        self.at < steps().len()
    }

    /// Skips the current step.
    pub fn skip(&mut self) {
        self.at += 1;
    }

    /// Returns the height in a window of a width: a rule and the lines.
    pub fn height(&self, keys: &Keys, numbers: &Numbers, width: u16) -> u16 {
        1 + self.lines(keys, numbers, width).len() as u16
    }

    /// Returns the lines below the rule, and whether each names keys to press.
    fn lines(&self, keys: &Keys, numbers: &Numbers, width: u16) -> Vec<(String, bool)> {
        let Some(step) = steps().get(self.at) else { return Vec::new() };
        let room = width.saturating_sub(2) as usize;
        let look =
            wrapped(&with_keys(&numbers.fill(&step.look), keys), room).into_iter().map(|line| (line, false));
        let press = wrapped(&format!("→ {}", with_keys(&step.press, keys)), room);
        let press = press.into_iter().map(|line| (line, true));
        look.chain(press).take(MOST_LINES).collect()
    }

    /// Draws the step.
    pub fn draw(&self, canvas: &mut Canvas<'_>, area: Rect, keys: &Keys, numbers: &Numbers) {
        let Some(step) = steps().get(self.at) else { return };
        canvas.clear(area, Role::Text);
        canvas.text(area, &"─".repeat(area.width as usize), Role::Focus);
        let title = format!(" Tour · {} of {} · {} ", self.at + 1, steps().len(), step.title);
        let place = Rect { x: area.x + 2, width: area.width.saturating_sub(2), ..area };
        canvas.text(Rect { height: 1, ..place }, &title, Role::Title);
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
            canvas.text(button, &words, Role::Key);
            canvas.click(button, Click::Do(action.into()));
        }
        let below = Rect { y: area.y + 1, height: area.height.saturating_sub(1), ..area };
        for (row, (line, press)) in rows_of(below).zip(self.lines(keys, numbers, area.width)) {
            let row = Rect { x: row.x + 1, width: row.width.saturating_sub(1), ..row };
            canvas.text(row, &line, if press { Role::Strong } else { Role::Text });
        }
    }
}

/// Replaces action names in braces with their keys, or with the palette if an action has none.
fn with_keys(text: &str, keys: &Keys) -> String {
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
    use crate::test_kit::{company, painted, played};
    use novamind_record::folder::configuration::Configuration;
    use novamind_record::trajectory::record::Via;
    use novamind_report::fit::Beside;
    use novamind_report::needs::Place;
    use novamind_session::Session;
    use novamind_session::identifiers::Group;
    use novamind_worker::company::Company;

    fn facts(company: &Company) -> TourFacts<'_> {
        TourFacts {
            company,
            here: ScreenId::Overview,
            before: &[],
            filing: None,
            dialog: false,
            group_open: false,
        }
    }

    #[test]
    fn steps_name_actions_and_numbers_that_exist_and_are_short() {
        let keys = Keys::shipped();
        let numbers = Numbers::shipped();
        for (at, step) in steps().iter().enumerate() {
            for text in [&step.look, &step.press] {
                let filled = numbers.fill(text);
                for name in
                    filled.split('{').skip(1).filter_map(|rest| rest.split_once('}')).map(|(name, _)| name)
                {
                    assert!(ACTIONS.iter().any(|entry| entry.name == name), "{}: {name}", step.title);
                }
            }
            let tour = Tour { at };
            let lines = tour.lines(&keys, &numbers, 80);
            assert!(tour.height(&keys, &numbers, 80) <= 4, "{}: {lines:?}", step.title);
            assert!(tour.height(&keys, &numbers, 60) <= 5, "{}", step.title);
            let narrow: Vec<String> =
                tour.lines(&keys, &numbers, 60).into_iter().map(|(line, _)| line).collect();
            let press = format!("→ {}", with_keys(&numbers.fill(&step.press), &keys));
            assert!(narrow.join(" ").ends_with(&press), "{}: {narrow:?}", step.title);
            let shown = painted(80, 4, |canvas, area| tour.draw(canvas, area, &keys, &numbers)).join("\n");
            assert!(shown.contains(&format!("Tour · {} of {}", at + 1, steps().len())), "{shown}");
            assert!(!shown.contains('{') && shown.contains("→ ") && !shown.contains('…'), "{shown}");
        }
    }

    #[test]
    fn a_new_company_begins_at_the_first_step_and_a_played_one_near_the_end() {
        let fresh = company();
        let mut tour = Tour::default();
        assert!(tour.settle(&facts(&fresh)));
        assert_eq!(tour.at, 0);
        assert!(tour.settle(&TourFacts { here: ScreenId::Customers, ..facts(&fresh) }));
        assert_eq!(steps()[tour.at].done, Done::GroupOpen);
        assert!(tour.settle(&TourFacts { group_open: true, ..facts(&fresh) }));
        assert_eq!(steps()[tour.at].done, Done::PriceSet);
        let played = Company::of(&played(2));
        let mut tour = Tour::default();
        assert!(tour.settle(&facts(&played)));
        assert_eq!(steps()[tour.at].done, Done::Asked, "a returning user continues near the end");
        assert!(tour.settle(&TourFacts { here: ScreenId::Sql, ..facts(&played) }));
        assert_eq!(steps()[tour.at].done, Done::ThirdWeek);
        tour.skip();
        tour.skip();
        assert!(!tour.settle(&facts(&played)), "the tour is complete");
    }

    #[test]
    fn every_step_can_be_skipped_and_drawn_in_any_window() {
        let fresh = company();
        let keys = Keys::shipped();
        let numbers = Numbers::shipped();
        let mut tour = Tour::default();
        for _ in 0..steps().len() {
            assert!(tour.settle(&facts(&fresh)));
            for (width, height) in [(0, 0), (1, 1), (20, 3), (60, 5), (200, 4)] {
                painted(width, height, |canvas, area| tour.draw(canvas, area, &keys, &numbers));
            }
            tour.skip();
        }
        assert!(!tour.settle(&facts(&fresh)));
        assert_eq!(tour.height(&keys, &numbers, 80), 1);
    }

    #[test]
    fn the_practice_run_is_what_the_steps_say() {
        let mut run = Session::create(practice_run(), &Configuration::shipped()).expect("a practice run");
        let s2 = |run: &Session| {
            Company::of(run).fit(Group::parse("S2").expect("a group")).expect("S2 is known").clone()
        };
        let wanted = s2(&run);
        assert!(wanted.budget.beside(45.0) == Beside::Below, "well below what S2 pays: {:?}", wanted.budget);
        assert!(wanted.usage.beside(400.0) == Beside::Above, "400 covers S2: {:?}", wanted.usage);
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
        let company = Company::of(&run);
        let need = company.needs.first().expect("an action item");
        let Place::Call(tool, arguments) = &need.place else { panic!("{need:?}") };
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
        let numbers = Company::of(&run).numbers.fill("{billing.billing_period_days}");
        assert_eq!(numbers, "30");
    }
}
