//! Form for a new run.

use crossterm::event::{KeyCode, KeyEvent};
use ratatui::layout::Rect;

use crate::effect::Effect;
use novamind_base::formatting::{dollars, parse_number};
use novamind_record::folder::configuration::{Configuration, DEFAULT_SCENARIO};
use novamind_record::mode::Mode;
use novamind_session::NewRun;
use novamind_tui::canvas::{Canvas, Click, row_rects};
use novamind_tui::text::wrap;
use novamind_tui::theme::Role;
use novamind_tui::widgets::TextField;
use novamind_worker::request::Request;

pub(super) struct NewRunForm {
    /// Names and descriptions of all scenarios.
    scenarios: Vec<(String, String)>,
    scenario: usize,
    /// Days and starting cash of the selected scenario in the selected mode, if the scenario can be read.
    scenario_terms: Option<(u32, f64)>,
    mode: usize,
    seed: TextField,
    days: TextField,
    cash: TextField,
    participant: TextField,
    pub(super) selected_row: usize,
    /// Text of the edited field before the edit, or `None` if no field is edited.
    before_edit: Option<String>,
    pub(super) rejection: Option<String>,
}

/// Label and description of each row of the form.
pub(super) const FORM_ROWS: [(&str, &str); 7] = [
    ("Mode", "Purpose of the run; left, right and enter change the mode. Fixed once the run starts."),
    ("Scenario", "Rules of the market; left, right and enter change the scenario."),
    ("Seed", "The same seed gives the same random events."),
    ("Days", "Length of the run, at least 7. Published results are those of day 500."),
    ("Starting cash", "Dollars on day 0."),
    ("Participant", "A label for the record, required in baseline runs."),
    ("Start", "Start the run (enter)"),
];

const SCENARIO_ROW: usize = 1;
const VALUE_COLUMN: u16 = 17;
const FIELD_WIDTH: u16 = 18;

impl NewRunForm {
    pub(super) fn new(configuration: &Configuration) -> NewRunForm {
        let describe = |name: &String| {
            configuration
                .load_scenario(name)
                .map_or_else(|error| error.to_string(), |scenario| scenario.description)
        };
        let scenarios: Vec<(String, String)> =
            configuration.scenario_names().into_iter().map(|name| (name.clone(), describe(&name))).collect();
        let scenario = scenarios.iter().position(|(name, _)| name == DEFAULT_SCENARIO).unwrap_or(0);
        NewRunForm {
            scenarios,
            scenario,
            scenario_terms: None,
            mode: Mode::SELECTABLE.iter().position(|mode| *mode == Mode::Sandbox).unwrap_or(0),
            seed: TextField::with_selected_text("42"),
            days: TextField::default(),
            cash: TextField::default(),
            participant: TextField::default(),
            selected_row: FORM_ROWS.len() - 1,
            before_edit: None,
            rejection: None,
        }
    }

    /// Reads the days and the starting cash of the selected scenario.
    pub(super) fn read_terms(&mut self, configuration: &Configuration) {
        let name = self
            .scenarios
            .get(self.scenario)
            .map_or(DEFAULT_SCENARIO, |scenario_entry| scenario_entry.0.as_str());
        let is_unranked = Mode::SELECTABLE[self.mode] != Mode::Baseline;
        let scenario = configuration.load_scenario(name);
        self.scenario_terms =
            scenario.and_then(|scenario| configuration.days_and_cash(&scenario, is_unranked)).ok();
    }

    /// Returns whether a field is edited.
    pub(super) fn is_typing(&self) -> bool {
        self.before_edit.is_some()
    }

    /// Starts to edit the field of the selected row, if the row has one. Typing replaces the text.
    fn start_edit(&mut self) {
        if let Some(field) = self.field() {
            let text = field.text().to_owned();
            *field = TextField::with_selected_text(text.clone());
            self.before_edit = Some(text);
        }
    }

    /// Ends the edit and keeps the text.
    pub(super) fn commit_edit(&mut self) {
        self.before_edit = None;
    }

    /// Ends the edit and restores the text.
    pub(super) fn discard_edit(&mut self) {
        if let (Some(text), Some(field)) = (self.before_edit.take(), self.field()) {
            *field = TextField::with_selected_text(text);
        }
    }

    fn field(&mut self) -> Option<&mut TextField> {
        match self.selected_row {
            2 => Some(&mut self.seed),
            3 => Some(&mut self.days),
            4 => Some(&mut self.cash),
            5 => Some(&mut self.participant),
            _ => None,
        }
    }

    pub(super) fn handle_key(&mut self, key: &KeyEvent) -> Vec<Effect> {
        self.rejection = None;
        // A digit starts the edit, as in the forms of tools. Other keys have functions in the list.
        if !self.is_typing() {
            if !matches!(key.code, KeyCode::Char(letter) if letter.is_ascii_digit()) {
                return Vec::new();
            }
            self.start_edit();
        }
        match self.field() {
            Some(field) => {
                field.handle_key(key);
                Vec::new()
            }
            None => {
                let row = FORM_ROWS[self.selected_row].0;
                vec![Effect::ShowError(format!(
                    "{row} is not a number; select Seed, Days or Starting cash first"
                ))]
            }
        }
    }

    pub(super) fn paste(&mut self, text: &str) {
        if !self.is_typing() {
            self.start_edit();
        }
        if let Some(field) = self.field() {
            field.insert(text.trim());
        }
    }

    pub(super) fn change_choice(&mut self, forward: bool) {
        let step = |at: usize, count: usize| {
            let count = count.max(1);
            if forward { (at + 1) % count } else { (at + count - 1) % count }
        };
        match self.selected_row {
            0 => self.mode = step(self.mode, Mode::SELECTABLE.len()),
            1 => self.scenario = step(self.scenario, self.scenarios.len()),
            _ => {}
        }
    }

    /// Edits the field of the selected row, ends the edit, or selects the next choice. In the last row, starts the run if
    /// the form is valid.
    pub(super) fn accept_row(&mut self) -> Vec<Effect> {
        if self.selected_row < FORM_ROWS.len() - 1 {
            match self.is_typing() {
                true => self.commit_edit(),
                false if self.field().is_some() => self.start_edit(),
                false => self.change_choice(true),
            }
            return Vec::new();
        }
        match (0..FORM_ROWS.len()).find(|row| self.problem(*row).is_some()) {
            Some(row) => {
                self.selected_row = row;
                Vec::new()
            }
            None => {
                self.rejection = None;
                vec![Effect::Request(Request::Create(Box::new(self.new_run())))]
            }
        }
    }

    fn problem(&self, row: usize) -> Option<&'static str> {
        let whole = |field: &TextField, least: f64| {
            let fits = |number: f64| number >= least && number.fract() == 0.0 && number < 9e15;
            field.text().trim().is_empty() || parse_number(field.text()).is_some_and(fits)
        };
        match row {
            2 if !whole(&self.seed, 0.0) => Some("enter a whole number of at least 0"),
            3 if !whole(&self.days, 7.0) => Some("enter a whole number of at least 7"),
            4 if !self.cash.text().trim().is_empty()
                && parse_number(self.cash.text()).is_none_or(|cash| cash <= 0.0) =>
            {
                Some("enter dollars above 0, such as 500k")
            }
            _ => None,
        }
    }

    fn new_run(&self) -> NewRun {
        let participant = self.participant.text().trim();
        NewRun {
            seed: parse_number(self.seed.text()).map(|seed| seed as u64),
            days: parse_number(self.days.text()).map(|days| days.min(f64::from(u32::MAX)) as u32),
            cash: parse_number(self.cash.text()),
            scenario: self
                .scenarios
                .get(self.scenario)
                .map_or(DEFAULT_SCENARIO, |entry| entry.0.as_str())
                .to_owned(),
            mode: Mode::SELECTABLE[self.mode],
            participant: (!participant.is_empty()).then(|| participant.to_owned()),
            ..NewRun::default()
        }
    }

    fn value(&self, row: usize) -> (String, Role) {
        let or = |field: &TextField, empty: &str| match field.text() {
            "" => (empty.to_owned(), Role::Dim),
            text => (text.to_owned(), Role::Text),
        };
        match row {
            0 => (format!("‹ {} ›", Mode::SELECTABLE[self.mode].id()), Role::Text),
            1 => {
                let chosen = self.scenarios.get(self.scenario);
                (chosen.map_or(String::new(), |(name, _)| format!("‹ {name} ›")), Role::Text)
            }
            2 => or(&self.seed, "random"),
            3 => or(&self.days, &default_text(self.scenario_terms.map(|(days, _)| format_days(days)))),
            4 if parse_number(self.cash.text()).is_some_and(|cash| cash > 0.0) => {
                (dollars(parse_number(self.cash.text()).unwrap_or_default()), Role::Text)
            }
            4 => or(&self.cash, &default_text(self.scenario_terms.map(|(_, cash)| dollars(cash)))),
            5 => or(&self.participant, "none"),
            // The last row starts the run and shows the selected mode.
            _ => (format!("a {} run", Mode::SELECTABLE[self.mode].id()), Role::Text),
        }
    }

    pub(super) fn draw(&self, canvas: &mut Canvas<'_>, area: Rect) {
        let inside = canvas.draw_pane_frame(area, "New run", "", true);
        let inside = Rect { x: inside.x + 1, width: inside.width.saturating_sub(2), ..inside };
        // A blank row precedes the last row, if there is space.
        let gap = usize::from(inside.height as usize > FORM_ROWS.len() + 6);
        for at in 0..FORM_ROWS.len() {
            let y = inside.y + (at + if at + 1 == FORM_ROWS.len() { gap } else { 0 }) as u16;
            if y < inside.bottom() {
                self.draw_row(canvas, Rect { y, height: 1, ..inside }, at);
            }
        }
        let used = (FORM_ROWS.len() + gap + usize::from(inside.height > 10)) as u16;
        let below = Rect { y: inside.y + used, height: inside.height.saturating_sub(used), ..inside };
        let mut lines: Vec<(String, Role)> = Vec::new();
        let mut push_text = |text: &str, role: Role| {
            lines.extend(wrap(text, below.width.min(100) as usize).into_iter().map(|line| (line, role)));
        };
        let scenario = self.scenarios.get(self.scenario).map_or("", |entry| entry.1.as_str());
        let (help, scenario) = (FORM_ROWS[self.selected_row].1, format!("scenario: {scenario}"));
        // A small window has space for only one of the texts.
        let (first, last) = match self.selected_row == SCENARIO_ROW && self.rejection.is_none() {
            true => (&*scenario, help),
            false => (help, &*scenario),
        };
        match &self.rejection {
            Some(problem) => push_text(&format!("! {problem}"), Role::Bad),
            None => push_text(first, Role::Text),
        }
        let mode = Mode::SELECTABLE[self.mode];
        push_text("", Role::Dim);
        push_text(&format!("{}: {}. {}", mode.id(), mode.purpose(), mode_description(mode)), Role::Text);
        push_text(last, Role::Text);
        for (row, (line, role)) in row_rects(below).zip(&lines) {
            canvas.draw_text(row, line, *role);
        }
    }

    fn draw_row(&self, canvas: &mut Canvas<'_>, row: Rect, at: usize) {
        let here = at == self.selected_row;
        let name = Rect { width: 15.min(row.width), ..row };
        let role = if here { Role::Selection } else { Role::Text };
        let mark = if here { "›" } else { " " };
        canvas.draw_text(name, &format!("{mark}{:<14}", FORM_ROWS[at].0), role);
        let place = Rect { x: row.x + VALUE_COLUMN, width: row.width.saturating_sub(VALUE_COLUMN), ..row };
        let field = match at {
            2 => Some(&self.seed),
            3 => Some(&self.days),
            4 => Some(&self.cash),
            5 => Some(&self.participant),
            _ => None,
        };
        let (value, role) = self.value(at);
        match field {
            Some(field) if here && self.is_typing() => {
                field.draw(canvas, Rect { width: FIELD_WIDTH.min(place.width), ..place })
            }
            _ => canvas.draw_text(place, &value, role),
        }
        if let Some(problem) = self.problem(at) {
            let right = Rect {
                x: place.x + FIELD_WIDTH + 1,
                width: place.width.saturating_sub(FIELD_WIDTH + 1),
                ..place
            };
            canvas.draw_text(right, &format!("! {problem}"), Role::Bad);
        }
        canvas.register_click(row, Click::Row(0, at));
    }
}

fn format_days(days: u32) -> String {
    novamind_base::formatting::grouped_number(f64::from(days), 0)
}

/// Returns the placeholder of an empty field with the default of the scenario.
fn default_text(value: Option<String>) -> String {
    value.map_or("scenario default".to_owned(), |value| format!("scenario default: {value}"))
}

/// Describes the permissions of a mode.
fn mode_description(mode: Mode) -> &'static str {
    match mode {
        Mode::Baseline => {
            "No branches, rewinding or tour; you write the rationale and the forecasts. The result can be compared with published results."
        }
        Mode::Sandbox => {
            "Everything in baseline, plus branches from any earlier week; forecasts may be filled in."
        }
        Mode::Lesson => "Everything in sandbox; the run is recorded as a lesson.",
        Mode::Debug => "Everything in sandbox, plus hidden state; not comparable with other runs.",
    }
}
