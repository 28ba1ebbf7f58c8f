//! The tour: steps in a real run of the default company. Each step has a text, a goal, and keys that lead to the goal
//! from any screen, pane, field or dialog.

mod claims;
mod route;
mod steps;

use ratatui::layout::Rect;
use unicode_width::UnicodeWidthStr;

use super::action::{ACTIONS, Action};
use super::keys::{KeyBindings, KeyMeaning};
use claims::insert_figures;
use novamind_tui::canvas::{Canvas, Click, row_rects};
use novamind_tui::chord::{Chord, format_sequence};
use novamind_tui::text::wrap;
use novamind_tui::theme::Role;
use novamind_worker::company::DisplayedCompany;
use route::Router;
use steps::{Goal, TourStep, steps};

pub use route::{CustomersFacts, FormFacts, KeyGroup, NextWeekFacts, TourFacts};
pub use steps::{is_tour_run, tour_run};

/// Maximum number of lines of the tour, without the separator line.
const MAX_LINES: usize = 6;

/// The user's progress in the tour.
#[derive(Debug, Clone, Default)]
pub struct Tour {
    /// Index of the current step, or `None` before the first update.
    step: Option<usize>,
    /// Index of a step that the user went back to. It is shown even if its goal is reached.
    revisited: Option<usize>,
    /// Whether the content that the current step refers to has been shown.
    is_seen: bool,
    shown: ShownStep,
}

/// The current step as displayed.
#[derive(Debug, Clone, Default)]
struct ShownStep {
    title: &'static str,
    /// Number of the step among the possible steps, and their count.
    position: (usize, usize),
    text: String,
    route: Vec<KeyGroup>,
    /// Whether the user can continue with the next step.
    is_done: bool,
    /// Actions of the tour with the keys that work where the user is.
    buttons: Vec<(Action, String)>,
}

impl Tour {
    /// Updates the tour after a change. Skips steps whose goal is reached, except steps that the user reads. Returns
    /// false if no step is left.
    pub fn update(&mut self, facts: &TourFacts<'_>, keys: &KeyBindings) -> bool {
        let company = facts.company;
        let mut at = self.step.unwrap_or_else(|| first_step(facts));
        let is_over = |step: &TourStep| step.is_reached(company) || !step.applies_to(company);
        while self.revisited != Some(at) && steps().get(at).is_some_and(is_over) {
            at += 1;
        }
        if self.step != Some(at) {
            (self.step, self.is_seen) = (Some(at), false);
        }
        let Some(step) = steps().get(at) else { return false };
        if let Goal::Read { read } = &step.goal {
            self.is_seen |= company.weeks.len() >= step.from_week && read.is_shown(facts);
        }
        let counts = |(index, step): &(usize, &TourStep)| *index == at || step.applies_to(company);
        let possible: Vec<usize> =
            steps().iter().enumerate().filter(counts).map(|(index, _)| index).collect();
        let number = possible.iter().filter(|index| **index <= at).count();
        self.shown = ShownStep {
            title: &step.title,
            position: (number, possible.len()),
            text: step.describe_difference(company).unwrap_or_else(|| {
                insert_keys(&company.numbers.substitute(&insert_figures(&step.text, company)), keys)
            }),
            route: Router { facts, keys }.route(step),
            is_done: self.is_step_done(company),
            buttons: working_buttons(facts, keys),
        };
        true
    }

    /// Returns whether the user has done what the current step asks for. A step that the user went back to is done if
    /// its goal is reached.
    pub fn is_step_done(&self, company: &DisplayedCompany) -> bool {
        let step = self.step.and_then(|at| steps().get(at));
        self.is_seen || step.is_some_and(|step| step.is_reached(company))
    }

    /// Continues with the next step, whether or not the current step is done.
    pub fn continue_to_next_step(&mut self) {
        self.step = Some(self.step.map_or(0, |step| step + 1));
        (self.is_seen, self.revisited) = (false, None);
    }

    /// Goes back to the previous possible step. Returns false if the current step is the first one.
    pub fn go_back(&mut self, company: &DisplayedCompany) -> bool {
        let before = self.step.unwrap_or(0);
        let Some(previous) = (0..before).rev().find(|at| steps()[*at].applies_to(company)) else {
            return false;
        };
        (self.step, self.revisited, self.is_seen) = (Some(previous), Some(previous), false);
        true
    }

    /// Returns the keys that the current step shows.
    pub fn key_groups(&self) -> &[KeyGroup] {
        &self.shown.route
    }

    /// Returns the title of the current step.
    pub fn title(&self) -> &'static str {
        self.shown.title
    }

    /// Returns the height of the tour pane for a window width: a separator line and the lines of text.
    pub fn height(&self, width: u16) -> u16 {
        1 + self.lines(width).len() as u16
    }

    /// Returns the lines below the separator line, with a flag for lines that name keys.
    fn lines(&self, width: u16) -> Vec<(String, bool)> {
        let room = width.saturating_sub(2) as usize;
        let text = wrap(&self.shown.text, room).into_iter().map(|line| (line, false));
        let labels: Vec<String> = self.shown.route.iter().map(|group| group.label()).collect();
        let keys = wrap(&format!("→ {}", labels.join(" · ")), room).into_iter().map(|line| (line, true));
        text.chain(keys).take(MAX_LINES).collect()
    }

    /// Draws the current step of the tour.
    pub fn draw(&self, canvas: &mut Canvas<'_>, area: Rect) {
        canvas.clear(area, Role::Text);
        canvas.draw_text(area, &"─".repeat(area.width as usize), Role::Focus);
        let (number, count) = self.shown.position;
        let title = format!(" Tour · {number} of {count} · {} ", self.shown.title);
        let place = Rect { x: area.x + 2, width: area.width.saturating_sub(2), ..area };
        canvas.draw_text(Rect { height: 1, ..place }, &title, Role::Title);
        let mut right = area.right().saturating_sub(2);
        for (action, key) in &self.shown.buttons {
            let action = *action;
            if action == Action::TourContinue && !self.shown.is_done {
                continue;
            }
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
        for (row, (line, is_keys)) in row_rects(below).zip(self.lines(area.width)) {
            let row = Rect { x: row.x + 1, width: row.width.saturating_sub(1), ..row };
            canvas.draw_text(row, &line, if is_keys { Role::Strong } else { Role::Text });
        }
    }
}

/// Returns the actions of the tour with their keys, from the right. Keys that have another meaning in the focused pane
/// or dialog are omitted.
fn working_buttons(facts: &TourFacts<'_>, keys: &KeyBindings) -> Vec<(Action, String)> {
    let button = |action: Action| {
        let works = |chords: &&[Chord]| match keys.meaning(&facts.scopes, chords) {
            KeyMeaning::Action(meaning) => meaning == action,
            KeyMeaning::Unbound => true,
            KeyMeaning::Prefix => false,
        };
        Some((action, format_sequence(keys.chords(action).find(works)?)))
    };
    [Action::TourClose, Action::TourContinue, Action::TourBack].into_iter().filter_map(button).collect()
}

/// Returns the step at which a user resumes: the step after the last one whose goal is reached, not counting steps
/// after the first open goal.
fn first_step(facts: &TourFacts<'_>) -> usize {
    let is_open =
        |step: &TourStep| !matches!(step.goal, Goal::Read { .. }) && !step.is_reached(facts.company);
    let until = steps().iter().position(is_open).unwrap_or(steps().len());
    steps()[..until].iter().rposition(|step| step.is_reached(facts.company)).map_or(0, |last| last + 1)
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
mod tests;
