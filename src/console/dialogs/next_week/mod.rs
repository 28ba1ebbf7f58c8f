//! The next-week dialog: review, rationale and forecasts. The user can go back to earlier steps. Drafts are kept until
//! the week has run.

mod forecasts;
mod review;

use crossterm::event::KeyEvent;
use ratatui::layout::Rect;

use self::review::ChangeReview;
use super::{Dialog, DialogResponse};
use crate::action::{Action, Scope};
use crate::attention::CELL_SEPARATOR;
use crate::context::ScreenContext;
use crate::effect::Effect;
use novamind_base::formatting::{grouped_number, parse_number};
use novamind_session::Forecasts;
use novamind_tools::{Forecast, ToolId};
use novamind_tui::canvas::{Canvas, centered_rect, row_rects};
use novamind_tui::text::format_number;
use novamind_tui::theme::Role;
use novamind_tui::widgets::field::NUMBER_HINT;
use novamind_tui::widgets::{TextEditor, TextField};
use novamind_worker::company::DisplayedCompany;
use novamind_worker::request::Request;

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum NextWeekStep {
    Review,
    Rationale,
    Forecasts,
}

/// The next-week dialog and its drafts.
pub struct NextWeekDialog {
    step: NextWeekStep,
    review: ChangeReview,
    rationale: TextEditor,
    /// Fields for the low, point and high values of each horizon.
    cells: [[TextField; 3]; 4],
    focus: (usize, usize),
    is_typing: bool,
    /// Content of the focused cell before it was edited.
    previous_cell: TextField,
    was_naive: bool,
    /// Cells that were filled in with naive forecasts.
    filled_naively: [[bool; 3]; 4],
    problem: Option<String>,
    tools_with_drafts: Vec<ToolId>,
    /// Whether the run is a baseline run, in which the program does not fill in the rationale.
    is_baseline: bool,
}

/// Prompt for the rationale. The prompt contains none of the planning words that are counted in rationales.
const RATIONALE_QUESTION: &str = "Why these decisions, and what results will follow?";
const RATIONALE_NEEDED: &str = "a rationale is required: write at least one sentence";
/// Placeholder of the rationale. The placeholder contains none of the planning words that are counted in rationales.
const RATIONALE_HINT: &str = "what you changed, and your reasons";

const HORIZON_LABELS: [&str; 4] = ["1 week", "4 weeks", "12 weeks", "26 weeks"];

impl Default for NextWeekDialog {
    fn default() -> Self {
        NextWeekDialog {
            step: NextWeekStep::Review,
            review: ChangeReview::default(),
            rationale: TextEditor::default(),
            cells: Default::default(),
            focus: (0, 0),
            is_typing: false,
            previous_cell: TextField::default(),
            was_naive: false,
            filled_naively: Default::default(),
            problem: None,
            tools_with_drafts: Vec::new(),
            is_baseline: false,
        }
    }
}

impl NextWeekDialog {
    /// Returns to the first step and keeps the drafts. Warns about forms with unsent values.
    pub fn reopen(&mut self, unsent: Vec<ToolId>, baseline: bool) {
        (self.tools_with_drafts, self.is_baseline) = (unsent, baseline);
        self.step = NextWeekStep::Review;
        self.review = ChangeReview::default();
        self.problem = None;
        self.is_typing = false;
    }

    /// Returns whether the dialog has a draft that could be lost.
    pub fn has_draft(&self) -> bool {
        !self.rationale.is_blank()
            || self.player_cells().any(|(row, column)| !self.cells[row][column].is_empty())
    }

    /// Returns the rationale and the texts of the forecast cells.
    pub fn draft(&self) -> (String, [[String; 3]; 4]) {
        let mut cells: [[String; 3]; 4] = Default::default();
        for (row, column) in self.player_cells() {
            cells[row][column] = self.cells[row][column].text().to_owned();
        }
        (self.rationale.text(), cells)
    }

    /// Restores the rationale and the forecast cells of a draft.
    pub fn restore_draft(&mut self, rationale: &str, cells: &[[String; 3]; 4]) {
        self.rationale = TextEditor::with_text(rationale);
        self.cells =
            cells.each_ref().map(|row| row.each_ref().map(|text| TextField::with_text(text.as_str())));
        self.filled_naively = Default::default();
    }

    fn typed_forecasts_text(&self) -> String {
        let texts = self.player_cells().map(|(row, column)| self.cells[row][column].text());
        texts.filter(|text| !text.is_empty()).collect::<Vec<_>>().join(CELL_SEPARATOR)
    }

    /// Returns the number of the current step, counted from 1.
    pub fn step_number(&self) -> usize {
        self.step as usize + 1
    }

    /// Shows why a week was rejected.
    pub fn show_rejection(&mut self, problem: String) {
        self.problem = Some(problem);
    }

    fn next_step(&mut self, context: &ScreenContext<'_>) -> DialogResponse {
        self.problem = None;
        match self.step {
            NextWeekStep::Review => self.step = NextWeekStep::Rationale,
            NextWeekStep::Rationale if self.rationale.is_blank() => {
                self.problem = Some(RATIONALE_NEEDED.to_owned());
            }
            NextWeekStep::Rationale => {
                let last = context.company.observation.horizons_in_run.saturating_sub(1);
                self.focus.0 = self.focus.0.min(last);
                self.step = NextWeekStep::Forecasts;
            }
            NextWeekStep::Forecasts => match self.parse_forecasts(context.company) {
                Ok(forecasts) => {
                    let rationale = self.rationale.text().trim().to_owned();
                    return DialogResponse::confirm_with(vec![Effect::Request(Request::Advance {
                        rationale,
                        forecasts,
                    })]);
                }
                Err((at, problem)) => {
                    self.focus = at;
                    self.problem = Some(problem);
                }
            },
        }
        DialogResponse::stay()
    }

    fn previous_step(&mut self) {
        self.problem = None;
        self.step = match self.step {
            NextWeekStep::Review | NextWeekStep::Rationale => NextWeekStep::Review,
            NextWeekStep::Forecasts => NextWeekStep::Rationale,
        };
    }

    /// Returns the positions of the cells that were not filled in with naive forecasts.
    fn player_cells(&self) -> impl Iterator<Item = (usize, usize)> + '_ {
        (0..4)
            .flat_map(|row| (0..3).map(move |column| (row, column)))
            .filter(|at| !self.filled_naively[at.0][at.1])
    }

    /// Fills empty cells with naive forecasts. If the point was typed, the interval of the naive forecast is moved to
    /// that point.
    fn fill_naive_forecasts(&mut self, company: &DisplayedCompany) {
        let asked = company.observation.horizons_in_run;
        for (row, naive) in company.naive_forecasts.all.iter().enumerate().take(asked) {
            let typed = |column: usize| parse_number(self.cells[row][column].text());
            let (low, high) = (typed(0).unwrap_or(f64::NEG_INFINITY), typed(2).unwrap_or(f64::INFINITY));
            let point = typed(1).unwrap_or(naive.point.max(low).min(high));
            let values = [point - (naive.point - naive.lower), point, point + (naive.upper - naive.point)];
            for (column, value) in values.into_iter().enumerate() {
                if self.cells[row][column].is_empty() {
                    self.cells[row][column] = TextField::with_text(grouped_number(value, 0));
                    self.filled_naively[row][column] = true;
                }
            }
        }
        self.problem = None;
    }

    /// Parses the forecasts. The error contains the position of the first invalid cell and the reason.
    fn parse_forecasts(&self, company: &DisplayedCompany) -> Result<Forecasts, ((usize, usize), String)> {
        let mut all = company.naive_forecasts;
        // Forecasts for days after the run cannot be scored, so they are not asked for.
        for (row, cells) in self.cells.iter().enumerate().take(company.observation.horizons_in_run) {
            all.filled_naively[row] = self.filled_naively[row].contains(&true);
            if self.filled_naively[row] == [true; 3] {
                continue;
            }
            let mut values = [0.0; 3];
            for (column, cell) in cells.iter().enumerate() {
                values[column] = parse_number(cell.text())
                    .ok_or_else(|| ((row, column), format!("{}: enter a number", HORIZON_LABELS[row])))?;
            }
            let [lower, point, upper] = values;
            if lower > upper {
                return Err(((row, 0), format!("{}: low is above high", HORIZON_LABELS[row])));
            }
            if point < lower || point > upper {
                return Err((
                    (row, 1),
                    format!("{}: the point is not between low and high", HORIZON_LABELS[row]),
                ));
            }
            all.all[row] = Forecast { horizon_days: all.all[row].horizon_days, point, lower, upper };
        }
        Ok(all)
    }

    fn fill_rationale(&mut self, company: &DisplayedCompany) {
        if !company.is_baseline() && self.rationale.is_blank() {
            let changes: Vec<String> = company
                .observation
                .changes
                .iter()
                .map(|change| {
                    format!(
                        "{} {} → {}",
                        change.setting,
                        format_number(change.old),
                        format_number(change.new)
                    )
                })
                .chain(company.observation.purchases.iter().cloned())
                .collect();
            let text = if changes.is_empty() { "no changes".to_owned() } else { changes.join("; ") };
            self.rationale.insert(&text);
        }
    }

    fn move_focus(&mut self, action: Action, company: &DisplayedCompany) {
        let (row, column) = self.focus;
        let last = company.observation.horizons_in_run.saturating_sub(1);
        self.focus = match action {
            Action::Up | Action::CommitPrevious => (row.saturating_sub(1), column),
            Action::Down | Action::CommitDown => ((row + 1).min(last), column),
            Action::Left => (row, column.saturating_sub(1)),
            Action::Right => (row, (column + 1).min(2)),
            Action::FocusNext | Action::CommitNext | Action::Commit => match column {
                2 => ((row + 1).min(last), if row == last { 2 } else { 0 }),
                _ => (row, column + 1),
            },
            _ => self.focus,
        };
    }

    fn cell(&mut self) -> &mut TextField {
        &mut self.cells[self.focus.0][self.focus.1]
    }
}

impl Dialog for NextWeekDialog {
    fn record_name(&self) -> String {
        "next week".to_owned()
    }

    fn step(&self) -> Option<&'static str> {
        Some(match self.step {
            NextWeekStep::Review => "review",
            NextWeekStep::Rationale => "rationale",
            NextWeekStep::Forecasts => "forecasts",
        })
    }

    fn edited_text(&self) -> Option<(String, String)> {
        match self.step {
            NextWeekStep::Review => None,
            NextWeekStep::Rationale => Some(("rationale".to_owned(), self.rationale.text())),
            NextWeekStep::Forecasts => Some(("forecasts".to_owned(), self.typed_forecasts_text())),
        }
    }

    fn scopes(&self) -> Vec<Scope> {
        match self.step {
            NextWeekStep::Review => vec![Scope::NextWeek, Scope::List],
            NextWeekStep::Rationale => vec![Scope::Editor, Scope::NextWeek],
            NextWeekStep::Forecasts if self.is_typing => vec![Scope::Field, Scope::NextWeek],
            NextWeekStep::Forecasts => vec![Scope::NextWeek, Scope::List],
        }
    }

    fn hints(&self) -> Vec<Action> {
        let mut hints = match self.step {
            NextWeekStep::Review => vec![Action::NextStep, Action::FillNaiveForecasts, Action::Close],
            NextWeekStep::Rationale => {
                vec![Action::NextStep, Action::PreviousStep, Action::FillRationale, Action::LeaveEditor]
            }
            NextWeekStep::Forecasts if self.is_typing => {
                vec![Action::CommitNext, Action::CommitDown, Action::Discard]
            }
            NextWeekStep::Forecasts => {
                vec![Action::NextStep, Action::FillNaiveForecasts, Action::PreviousStep, Action::Close]
            }
        };
        if self.is_baseline {
            let filled = self.step == NextWeekStep::Forecasts;
            hints.retain(|action| {
                *action != Action::FillRationale && (filled || *action != Action::FillNaiveForecasts)
            });
        }
        hints
    }

    fn handle_action(&mut self, action: Action, context: &ScreenContext<'_>) -> DialogResponse {
        match action {
            Action::NextStep if !self.is_typing => return self.next_step(context),
            Action::NextStep => {
                self.is_typing = false;
                return self.next_step(context);
            }
            Action::PreviousStep => {
                self.is_typing = false;
                self.previous_step();
            }
            Action::Close | Action::LeaveEditor => return DialogResponse::close(),
            Action::FillRationale if self.step == NextWeekStep::Rationale => {
                self.fill_rationale(context.company)
            }
            Action::FillNaiveForecasts if self.step == NextWeekStep::Forecasts => {
                self.fill_naive_forecasts(context.company)
            }
            // Even if there are no decisions this week, one key fills in all texts and goes to the last step.
            Action::FillNaiveForecasts
                if self.step == NextWeekStep::Review && !context.company.is_baseline() =>
            {
                self.fill_rationale(context.company);
                self.fill_naive_forecasts(context.company);
                self.focus = (0, 0);
                self.step = NextWeekStep::Forecasts;
            }
            Action::FillNaiveForecasts if self.step == NextWeekStep::Review => {
                self.problem = Some("you can fill in forecasts in step 3".to_owned());
            }
            Action::Discard => {
                self.is_typing = false;
                let before = self.previous_cell.clone();
                *self.cell() = before;
                self.filled_naively[self.focus.0][self.focus.1] = self.was_naive;
            }
            Action::Commit | Action::CommitNext | Action::CommitDown | Action::CommitPrevious => {
                self.is_typing = false;
                self.move_focus(action, context.company);
            }
            other if self.step == NextWeekStep::Forecasts => self.move_focus(other, context.company),
            other if self.step == NextWeekStep::Review => {
                self.review.handle_scroll(other, context.page_rows as usize)
            }
            _ => {}
        }
        DialogResponse::stay()
    }

    fn handle_key(&mut self, key: &KeyEvent, context: &ScreenContext<'_>) -> DialogResponse {
        match self.step {
            NextWeekStep::Rationale if key.code == crossterm::event::KeyCode::Tab => {
                return self.next_step(context);
            }
            NextWeekStep::Rationale => {
                self.rationale.handle_key(key);
                self.problem = None;
            }
            NextWeekStep::Forecasts if self.is_typing => {
                self.problem = (!self.cell().handle_number_key(key)).then(|| NUMBER_HINT.to_owned());
            }
            NextWeekStep::Forecasts if context.company.observation.horizons_in_run == 0 => {}
            NextWeekStep::Forecasts => {
                let starts = novamind_tui::chord::Chord::from_event(key).starts_number();
                if starts {
                    self.previous_cell = self.cell().clone();
                    *self.cell() = TextField::default();
                    self.cell().handle_key(key);
                    self.was_naive = std::mem::take(&mut self.filled_naively[self.focus.0][self.focus.1]);
                    (self.is_typing, self.problem) = (true, None);
                }
            }
            NextWeekStep::Review => {}
        }
        DialogResponse::stay()
    }

    fn paste(&mut self, text: &str, _: &ScreenContext<'_>) -> DialogResponse {
        match self.step {
            NextWeekStep::Rationale => self.rationale.insert(text),
            NextWeekStep::Forecasts if self.is_typing => self.problem = self.cell().paste_number(text).err(),
            _ => {}
        }
        DialogResponse::stay()
    }

    fn handle_click(&mut self, row: usize, _: &ScreenContext<'_>) -> DialogResponse {
        if self.step == NextWeekStep::Forecasts && !self.is_typing {
            self.focus = (row / 3, row % 3);
        }
        DialogResponse::stay()
    }

    fn draw(&self, canvas: &mut Canvas<'_>, area: Rect, context: &ScreenContext<'_>) {
        let dialog_area = centered_rect(area, 106.min(area.width), 26.min(area.height));
        canvas.clear(dialog_area, Role::Text);
        let mark = |step: NextWeekStep, name: &str| match (self.step as u8).cmp(&(step as u8)) {
            std::cmp::Ordering::Greater => format!("{name} ✓"),
            std::cmp::Ordering::Equal => format!("[{name}]"),
            std::cmp::Ordering::Less => name.to_owned(),
        };
        let days = context.company.next_decision_day - context.company.observation.day;
        let title = format!(
            "Next week · {} · {} · {}",
            mark(NextWeekStep::Review, "1 review"),
            mark(NextWeekStep::Rationale, "2 rationale"),
            mark(NextWeekStep::Forecasts, "3 forecasts")
        );
        let note = format!("{days} days, to day {}", context.company.next_decision_day);
        let inside = canvas.draw_pane_frame(dialog_area, &title, &note, true);
        let inside = Rect { x: inside.x + 1, width: inside.width.saturating_sub(2), ..inside };
        let body = Rect { height: inside.height.saturating_sub(1), ..inside };
        match self.step {
            NextWeekStep::Review => self.review.draw(canvas, body, context.company, &self.tools_with_drafts),
            NextWeekStep::Rationale => self.draw_rationale(canvas, body, context.company),
            NextWeekStep::Forecasts => self.draw_forecasts(canvas, body, context),
        }
        if let Some(problem) = &self.problem {
            let row = Rect { y: body.bottom(), height: 1, ..body };
            canvas.draw_text(row, &format!("! {problem}"), Role::Bad);
        }
        canvas.draw_pane_keys(dialog_area, &context.hints(&self.hints()));
    }
}

impl NextWeekDialog {
    fn draw_rationale(&self, canvas: &mut Canvas<'_>, area: Rect, company: &DisplayedCompany) {
        let why =
            if company.is_baseline() { "Required, and saved with the run." } else { "Saved with the run." };
        let used = 3;
        for (row, (line, role)) in row_rects(area).zip([(RATIONALE_QUESTION, Role::Text), (why, Role::Dim)]) {
            canvas.draw_text(row, line, role);
        }
        let editor = Rect { y: area.y + used, height: area.height.saturating_sub(used), ..area };
        self.rationale.draw(canvas, editor, true, RATIONALE_HINT);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use novamind_report::measures::PLANNING_WORDS;

    #[test]
    fn rationale_prompts_contain_no_counted_word() {
        for text in [RATIONALE_QUESTION, RATIONALE_HINT, RATIONALE_NEEDED] {
            let words = text.to_lowercase();
            let words = words.split(|letter: char| !letter.is_alphabetic());
            let counted: Vec<&str> = words.filter(|word| PLANNING_WORDS.contains(word)).collect();
            assert_eq!(counted, Vec::<&str>::new(), "{text}");
        }
    }
}
