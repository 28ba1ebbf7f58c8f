//! The first steps in the game, over the real game: what to look at, what to press, and whether it was done.

use std::sync::LazyLock;

use ratatui::layout::Rect;
use serde::Deserialize;
use serde_json::Value;
use unicode_width::UnicodeWidthStr;

use super::action::{ACTIONS, Action};
use super::canvas::{Canvas, Click, rows_of};
use super::company::Company;
use super::keys::Keys;
use super::screens::ScreenId;
use super::text::wrapped;
use super::theme::Role;
use crate::tools::ToolId;

/// How a step shows that it was done.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "kebab-case")]
enum Done {
    FormsOpen,
    PriceSet,
    QuotaSet,
    AdsSet,
    Asked,
    Filing,
    Rationale,
    WeekRun,
    ReportRead,
    Explained,
    SecondWeek,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct TourStep {
    title: String,
    look: String,
    press: String,
    done: Done,
}

#[derive(Deserialize)]
struct Steps {
    step: Vec<TourStep>,
}

static STEPS: LazyLock<Vec<TourStep>> = LazyLock::new(|| {
    let text = include_str!("../../assets/tour.toml");
    toml::from_str::<Steps>(text).expect("a test reads the shipped tour").step
});

/// What a step is judged by.
pub struct TourFacts<'a> {
    /// The company.
    pub company: &'a Company,
    /// The screen that is shown.
    pub here: ScreenId,
    /// Screens shown before.
    pub before: &'a [ScreenId],
    /// Step of the dialog before a week, from 1, while it is open.
    pub filing: Option<usize>,
    /// A dialog lies over the screen.
    pub dialog: bool,
    /// Something was explained in this sitting.
    pub explained: bool,
}

impl Done {
    fn holds(self, facts: &TourFacts<'_>) -> bool {
        let company = facts.company;
        let weeks = company.weeks.len();
        let any = |tool: ToolId| ["A", "B", "C"].iter().any(|plan| company.setting(tool, plan) > 0.0);
        match self {
            Done::FormsOpen => facts.here == ScreenId::Tools || any(ToolId::SetPrices),
            Done::PriceSet => any(ToolId::SetPrices),
            Done::QuotaSet => any(ToolId::SetUsageQuotas),
            Done::AdsSet => company.settings.get(&ToolId::SetTargetedAdSpend).is_some_and(spends),
            Done::Asked => weeks > 0 || !company.asked.is_empty() || facts.before.contains(&ScreenId::Sql),
            Done::Filing => weeks > 0 || facts.filing.is_some(),
            Done::Rationale => weeks > 0 || facts.filing == Some(3),
            Done::WeekRun => weeks > 0,
            Done::ReportRead => weeks > 0 && !facts.dialog,
            Done::Explained => facts.explained,
            Done::SecondWeek => weeks > 1,
        }
    }
}

/// Whether a number above 0 is somewhere in present arguments.
fn spends(arguments: &serde_json::Map<String, Value>) -> bool {
    fn holds(value: &Value) -> bool {
        match value {
            Value::Object(map) => map.values().any(holds),
            other => other.as_f64().is_some_and(|amount| amount > 0.0),
        }
    }
    arguments.values().any(holds)
}

/// Where the person is in the tour.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Tour {
    at: usize,
}

impl Tour {
    /// Goes on over every step that is done; false when none is left.
    pub fn settle(&mut self, facts: &TourFacts<'_>) -> bool {
        while STEPS.get(self.at).is_some_and(|step| step.done.holds(facts)) {
            self.at += 1;
        }
        self.at < STEPS.len()
    }

    /// Goes on without doing the step.
    pub fn skip(&mut self) {
        self.at += 1;
    }

    /// Rows it needs in a window of a width: a rule and a few lines.
    pub fn height(&self, keys: &Keys, width: u16) -> u16 {
        1 + self.lines(keys, width).len() as u16
    }

    /// What is written below the rule: lines, and whether they say what to press.
    fn lines(&self, keys: &Keys, width: u16) -> Vec<(String, bool)> {
        let Some(step) = STEPS.get(self.at) else { return Vec::new() };
        let room = width.saturating_sub(2) as usize;
        let look = wrapped(&with_keys(&step.look, keys), room).into_iter().map(|line| (line, false));
        let press = wrapped(&format!("→ {}", with_keys(&step.press, keys)), room);
        let press = press.into_iter().map(|line| (line, true));
        look.chain(press).take(4).collect()
    }

    /// Draws the step into its rows.
    pub fn draw(&self, canvas: &mut Canvas<'_>, area: Rect, keys: &Keys) {
        let Some(step) = STEPS.get(self.at) else { return };
        canvas.clear(area, Role::Text);
        canvas.text(area, &"─".repeat(area.width as usize), Role::Focus);
        let title = format!(" Tour · {} of {} · {} ", self.at + 1, STEPS.len(), step.title);
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
            canvas.click(button, Click::Do(action));
        }
        let below = Rect { y: area.y + 1, height: area.height.saturating_sub(1), ..area };
        for (row, (line, press)) in rows_of(below).zip(self.lines(keys, area.width)) {
            let row = Rect { x: row.x + 1, width: row.width.saturating_sub(1), ..row };
            canvas.text(row, &line, if press { Role::Strong } else { Role::Text });
        }
    }
}

/// Words with the keys of the actions they name; an action without a key is found in the palette.
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
    use super::*;
    use crate::console::company::Company;
    use crate::console::test_kit::{company, painted, played};

    fn facts(company: &Company) -> TourFacts<'_> {
        TourFacts {
            company,
            here: ScreenId::Overview,
            before: &[],
            filing: None,
            dialog: false,
            explained: false,
        }
    }

    #[test]
    fn steps_name_actions_that_exist_and_fit_four_rows_of_80_columns() {
        let keys = Keys::shipped();
        for (at, step) in STEPS.iter().enumerate() {
            for text in [&step.look, &step.press] {
                for name in
                    text.split('{').skip(1).filter_map(|rest| rest.split_once('}')).map(|(name, _)| name)
                {
                    assert!(ACTIONS.iter().any(|entry| entry.name == name), "{}: {name}", step.title);
                }
            }
            let tour = Tour { at };
            assert!(tour.height(&keys, 80) <= 4, "{}: {:?}", step.title, tour.lines(&keys, 80));
            assert!(tour.height(&keys, 60) <= 5, "{}", step.title);
            let shown = painted(80, 4, |canvas, area| tour.draw(canvas, area, &keys)).join("\n");
            assert!(shown.contains(&format!("Tour · {} of {}", at + 1, STEPS.len())), "{shown}");
            assert!(!shown.contains('{') && shown.contains("→ ") && !shown.contains('…'), "{shown}");
        }
        assert!((9..=12).contains(&STEPS.len()));
    }

    #[test]
    fn a_new_company_begins_at_the_first_step_and_a_played_one_near_the_end() {
        let fresh = company();
        let mut tour = Tour::default();
        assert!(tour.settle(&facts(&fresh)));
        assert_eq!(tour.at, 0);
        assert!(tour.settle(&TourFacts { here: ScreenId::Tools, ..facts(&fresh) }));
        assert_eq!(STEPS[tour.at].done, Done::PriceSet);
        let played = Company::of(&played(1));
        assert!(tour.settle(&TourFacts { dialog: true, ..facts(&played) }));
        assert_eq!(STEPS[tour.at].done, Done::ReportRead);
        assert!(tour.settle(&facts(&played)));
        assert_eq!(STEPS[tour.at].done, Done::Explained);
        assert!(tour.settle(&TourFacts { explained: true, ..facts(&played) }));
        assert_eq!(STEPS[tour.at].done, Done::SecondWeek);
        tour.skip();
        assert!(!tour.settle(&facts(&played)), "the tour is over");
    }

    #[test]
    fn every_step_can_be_skipped_and_drawn_in_any_window() {
        let fresh = company();
        let keys = Keys::shipped();
        let mut tour = Tour::default();
        for _ in 0..STEPS.len() {
            assert!(tour.settle(&facts(&fresh)));
            for (width, height) in [(0, 0), (1, 1), (20, 3), (60, 5), (200, 4)] {
                painted(width, height, |canvas, area| tour.draw(canvas, area, &keys));
            }
            tour.skip();
        }
        assert!(!tour.settle(&facts(&fresh)));
        assert_eq!(tour.height(&keys, 80), 1);
    }
}
