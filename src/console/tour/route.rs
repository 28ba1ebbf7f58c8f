//! The keys that lead to the goal of a step, from wherever the user is.
//!
//! A dialog or a text field that the step does not need is closed first. Until then, only the key that closes it is
//! shown. Therefore, no key of a step reaches a pane or a field that the step does not intend.

use super::claims::insert_figures;
use super::steps::{Goal, Sight, TourStep};
use crate::action::{Action, Scope};
use crate::context::ScreenId;
use crate::dialogs::DialogView;
use crate::keys::KeyBindings;
use novamind_tools::ToolId;
use novamind_worker::company::DisplayedCompany;

/// Rationale that the tour proposes for the first week.
const EXAMPLE_RATIONALE: &str = "A first try.";
/// Text that finds the query for cancelled subscribers in the palette.
const CANCELLATIONS_QUERY_WORDS: &str = "their issues";
/// Actions that close a dialog or end typing.
const CLOSING_ACTIONS: [Action; 7] = [
    Action::Discard,
    Action::LeaveEditor,
    Action::Close,
    Action::Cancel,
    Action::CloseChart,
    Action::StayInRun,
    Action::RestoreDrafts,
];

/// The state of the console on which the tour depends: what the user sees, and which keys apply.
pub struct TourFacts<'a> {
    /// The displayed company.
    pub company: &'a DisplayedCompany,
    /// The current screen.
    pub screen: ScreenId,
    /// Key scopes of the focused pane or dialog, the innermost first.
    pub scopes: Vec<Scope>,
    /// Whether keys type characters.
    pub is_typing: bool,
    /// Whether a dialog is open.
    pub has_dialog: bool,
    /// Content of the top dialog that a step can show.
    pub dialog: Option<DialogView>,
    /// The next-week dialog.
    pub next_week: NextWeekFacts,
    /// The Customers screen.
    pub customers: CustomersFacts,
    /// The form that has the focus.
    pub form: Option<FormFacts>,
    /// Whether the SQL screen shows rows of the query for cancelled subscribers.
    pub shows_cancellations: bool,
}

/// State of the next-week dialog.
#[derive(Debug, Clone, Copy, Default)]
pub struct NextWeekFacts {
    /// Number of the step, counted from 1, while the dialog is open.
    pub open_step: Option<usize>,
    /// Whether the user has entered a rationale.
    pub has_rationale: bool,
}

/// Position of the user on the Customers screen.
#[derive(Debug, Clone, Copy, Default)]
pub struct CustomersFacts {
    /// Whether a group is open.
    pub is_group_open: bool,
    /// Number of focus moves to the groups pane, or to Fit if a group is open.
    pub panes_to_goal: usize,
    /// Number of focus moves to Fit after a group was opened.
    pub panes_to_fit: usize,
    /// Number of focus moves to the groups pane after the open group was closed.
    pub panes_to_list: usize,
    /// Rows from the selected group down to the first known group. Negative if the first known group is above.
    pub rows_to_example: isize,
    /// Columns from the selected column to the cancellations column. Negative if that column is on the left.
    pub columns_to_cancellations: isize,
    /// Heading of the cancellations column.
    pub cancellations_heading: &'static str,
}

impl CustomersFacts {
    /// Returns whether Fit of a group has the focus, so that it is visible in every window.
    pub fn shows_fit(&self) -> bool {
        self.is_group_open && self.panes_to_goal == 0
    }
}

/// The form that has the focus on the Tools screen.
#[derive(Debug, Clone, Default)]
pub struct FormFacts {
    /// The tool of the form.
    pub tool: Option<ToolId>,
    /// Whether the first cell of the form is selected.
    pub is_at_first_cell: bool,
    /// Draft of the first cell.
    pub draft: Option<String>,
    /// Text of the cell that the user types into, and whether typing replaces the text.
    pub typed: Option<(String, bool)>,
}

/// One key or a typed text.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum KeyPress {
    /// A key or key sequence, in the notation of the key file.
    Key(String),
    /// A text that is typed letter by letter.
    Text(String),
}

/// Keys that belong together, with a short description of their effect.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct KeyGroup {
    /// The keys.
    pub presses: Vec<KeyPress>,
    /// Description of the effect.
    pub effect: String,
}

impl KeyGroup {
    /// Returns the keys in the notation of the key file, with typed texts in quotes: `: 'set_prices' enter`.
    pub fn notation(&self) -> String {
        let one = |press: &KeyPress| match press {
            KeyPress::Key(key) => key.clone(),
            KeyPress::Text(text) => format!("'{}'", text.replace(' ', "_")),
        };
        self.presses.iter().map(one).collect::<Vec<_>>().join(" ")
    }

    /// Returns the keys as shown to the user. Repeated keys are counted: `right ×3`.
    pub fn label(&self) -> String {
        let mut parts: Vec<(String, usize)> = Vec::new();
        for press in &self.presses {
            let text = match press {
                KeyPress::Key(text) | KeyPress::Text(text) => text.clone(),
            };
            match parts.last_mut() {
                Some((last, count)) if *last == text => *count += 1,
                _ => parts.push((text, 1)),
            }
        }
        let part = |(text, count): (String, usize)| match count {
            1 => text,
            count => format!("{text} ×{count}"),
        };
        format!("{} ({})", parts.into_iter().map(part).collect::<Vec<_>>().join(" "), self.effect)
    }
}

/// Finds the keys of a step.
pub(super) struct Router<'a> {
    pub facts: &'a TourFacts<'a>,
    pub keys: &'a KeyBindings,
}

impl Router<'_> {
    /// Returns the keys that lead to the goal of a step, in order.
    pub fn route(&self, step: &TourStep) -> Vec<KeyGroup> {
        let company = self.facts.company;
        if company.weeks.len() < step.from_week {
            return self.unless_covered(self.week_route());
        }
        if step.is_reached(company) {
            return vec![self.group(&[Action::TourContinue], "continue")];
        }
        match &step.goal {
            Goal::Set { set, value, cell, .. } => {
                let cell = insert_figures(cell, company);
                self.form_route(*set, value, &cell)
            }
            Goal::Weeks { .. } => self.unless_covered(self.week_route()),
            Goal::Read { read } => self.sight_route(*read),
        }
    }

    /// Returns the key of an action. Prefers a key that works in the focused pane.
    fn key(&self, action: Action) -> KeyPress {
        // In panes with number cells, a letter is safer than a digit, which may start a number.
        let has_number_cells = self.facts.scopes.contains(&Scope::Form);
        let is_usable =
            |key: &String| !has_number_cells || !key.starts_with(|first: char| first.is_ascii_digit());
        let working = self.keys.working_keys(action, &self.facts.scopes).into_iter().find(is_usable);
        let label = working.or_else(|| self.keys.label(action)).unwrap_or_default();
        KeyPress::Key(label)
    }

    fn group(&self, actions: &[Action], effect: &str) -> KeyGroup {
        let presses = actions.iter().map(|action| self.key(*action)).collect();
        KeyGroup { presses, effect: effect.to_owned() }
    }

    /// Returns the key that closes the top dialog or ends typing, or `None` if the keys of a screen work.
    fn close_first(&self) -> Option<Vec<KeyGroup>> {
        if !self.facts.has_dialog && !self.facts.is_typing {
            return None;
        }
        let closes = |action: &&Action| !self.keys.working_keys(**action, &self.facts.scopes).is_empty();
        let action = CLOSING_ACTIONS.iter().find(closes).copied().unwrap_or(Action::Close);
        let effect = if self.facts.has_dialog { "close this first" } else { "stop typing first" };
        Some(vec![self.group(&[action], effect)])
    }

    /// Returns the keys of a route that starts on a screen. In a dialog or a text field, returns the key that closes
    /// it.
    fn on_screen(&self, route: Vec<KeyGroup>) -> Vec<KeyGroup> {
        self.close_first().unwrap_or(route)
    }

    fn unless_covered(&self, route: Vec<KeyGroup>) -> Vec<KeyGroup> {
        match self.facts.next_week.open_step {
            Some(_) if !self.facts.scopes.contains(&Scope::Field) => route,
            _ => self.on_screen(route),
        }
    }

    /// Returns the keys that open an entry of the palette.
    fn palette(&self, words: &str, effect: &str) -> KeyGroup {
        let presses =
            vec![self.key(Action::Palette), KeyPress::Text(words.to_owned()), self.key(Action::Commit)];
        KeyGroup { presses, effect: effect.to_owned() }
    }

    fn form_route(&self, tool: ToolId, value: &str, cell: &str) -> Vec<KeyGroup> {
        let apply = self.group(&[Action::Apply], "send");
        let finish = |text: &str| KeyGroup {
            presses: vec![KeyPress::Text(text.to_owned()), self.key(Action::Commit)],
            effect: cell.to_owned(),
        };
        let edit = KeyGroup {
            presses: [vec![self.key(Action::EditCell)], finish(value).presses].concat(),
            effect: cell.to_owned(),
        };
        let form = self.facts.form.as_ref().filter(|form| {
            form.tool == Some(tool) && self.facts.screen == ScreenId::Tools && !self.facts.has_dialog
        });
        match form {
            Some(FormFacts { typed: Some((typed, is_replaced)), is_at_first_cell: true, .. }) => {
                let left = if *is_replaced { Some(value) } else { value.strip_prefix(typed.as_str()) };
                match left {
                    Some("") => vec![self.group(&[Action::Commit], cell), apply],
                    Some(left) => vec![finish(left), apply],
                    None => self.on_screen(Vec::new()),
                }
            }
            Some(form) if form.typed.is_none() && form.draft.as_deref() == Some(value) => vec![apply],
            Some(form) if form.typed.is_none() && form.is_at_first_cell => vec![edit, apply],
            Some(form) if form.typed.is_none() && self.facts.scopes.contains(&Scope::Form) => {
                vec![self.group(&[Action::First], "first row"), edit, apply]
            }
            _ => self.on_screen(vec![self.palette(tool.name(), "form"), edit, apply]),
        }
    }

    /// Returns the keys that run one week.
    fn week_route(&self) -> Vec<KeyGroup> {
        let company = self.facts.company;
        let next = |effect: &str| self.group(&[Action::NextStep], effect);
        let fill = self.group(&[Action::FillNaiveForecasts], "fill in");
        let rationale = match self.facts.next_week.has_rationale {
            true => next("rationale"),
            false => KeyGroup {
                presses: vec![KeyPress::Text(EXAMPLE_RATIONALE.to_owned()), self.key(Action::NextStep)],
                effect: "rationale".to_owned(),
            },
        };
        let forecasts = [fill.clone(), next("run the week")];
        // The first week shows every step. In baseline runs, the player writes every rationale.
        let is_long = company.weeks.is_empty() || company.is_baseline();
        let review = match is_long {
            true => [vec![next("review"), rationale.clone()], forecasts.to_vec()].concat(),
            false => forecasts.to_vec(),
        };
        match self.facts.next_week.open_step {
            None => [vec![self.group(&[Action::NextWeek], "next week")], review].concat(),
            Some(1) => review,
            Some(2) => [vec![rationale], forecasts.to_vec()].concat(),
            Some(_) => forecasts.to_vec(),
        }
    }

    fn sight_route(&self, sight: Sight) -> Vec<KeyGroup> {
        let next = self.group(&[Action::TourContinue], "continue");
        if sight.is_shown(self.facts) {
            return vec![next];
        }
        if let Some(view) = self.facts.dialog.as_ref().filter(|view| Some(view.content) == sight.dialog()) {
            return match view.actions.is_empty() {
                true => vec![KeyGroup { presses: Vec::new(), effect: "wait for the simulation".to_owned() }],
                false => vec![self.group(&view.actions, "simulate"), next],
            };
        }
        let route = match sight {
            Sight::Overview => vec![self.group(&[Action::Overview], "Overview")],
            Sight::Curve => vec![self.group(&[Action::Curves], "curve")],
            Sight::Report => vec![self.group(&[Action::Report], "report")],
            Sight::Help => vec![self.group(&[Action::Help], "keys of this screen")],
            Sight::Cancellations => vec![self.palette(CANCELLATIONS_QUERY_WORDS, "query")],
            Sight::Fit => self.fit_route(),
            Sight::Causes => self.causes_route(),
            Sight::WhatIf => {
                let change = [Action::OmitDecision, Action::SimulateBranches];
                vec![self.group(&[Action::Branches], "what if"), self.group(&change, "omit, simulate")]
            }
        };
        self.on_screen([route, vec![next]].concat())
    }

    fn customers(&self) -> Vec<KeyGroup> {
        match self.facts.screen {
            ScreenId::Customers => Vec::new(),
            _ => vec![self.group(&[Action::Customers], "Customers")],
        }
    }

    /// Returns a group with a repeated key, or nothing if the key is not needed.
    fn repeated(&self, action: Action, count: usize, effect: &str) -> Vec<KeyGroup> {
        match count {
            0 => Vec::new(),
            count => vec![self.group(&vec![action; count], effect)],
        }
    }

    fn fit_route(&self) -> Vec<KeyGroup> {
        let customers = &self.facts.customers;
        let mut route = self.customers();
        if customers.is_group_open {
            route.extend(self.repeated(Action::FocusNext, customers.panes_to_goal, "Fit"));
            return route;
        }
        route.extend(self.repeated(Action::FocusNext, customers.panes_to_goal, "groups"));
        route.push(self.group(&[Action::Open], "open the group"));
        route.extend(self.repeated(Action::FocusNext, customers.panes_to_fit, "Fit"));
        route
    }

    fn causes_route(&self) -> Vec<KeyGroup> {
        let customers = &self.facts.customers;
        let mut route = self.customers();
        if customers.is_group_open {
            route.push(self.group(&[Action::Close], "all groups"));
        }
        route.extend(self.repeated(Action::FocusNext, customers.panes_to_list, "groups"));
        let action_for_sign = |count: isize, more, less| if count < 0 { less } else { more };
        let rows = customers.rows_to_example;
        route.extend(self.repeated(
            action_for_sign(rows, Action::Down, Action::Up),
            rows.unsigned_abs(),
            "group",
        ));
        let columns = customers.columns_to_cancellations;
        let sideways = action_for_sign(columns, Action::Right, Action::Left);
        let to_column = format!("to the column \"{}\"", customers.cancellations_heading);
        route.extend(self.repeated(sideways, columns.unsigned_abs(), &to_column));
        route.push(self.group(&[Action::Why], "why"));
        route
    }
}
