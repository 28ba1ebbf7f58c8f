//! The next-week dialog: review, rationale and forecasts. The user can go back; drafts stay until the week has run.

mod forecasts;
mod review;

use crossterm::event::KeyEvent;
use ratatui::layout::Rect;

use self::review::Review;
use super::{Dialog, Outcome};
use crate::action::{Action, Scope};
use crate::attention::BETWEEN_CELLS;
use crate::context::Look;
use crate::effect::Effect;
use novamind_base::notation::{grouped, parse_number};
use novamind_session::Forecasts;
use novamind_tools::{Forecast, ToolId};
use novamind_tui::canvas::{Canvas, centered, rows_of};
use novamind_tui::text::number;
use novamind_tui::theme::Role;
use novamind_tui::widgets::field::ONLY_NUMBERS;
use novamind_tui::widgets::{Editor, Field};
use novamind_worker::company::Company;
use novamind_worker::request::Request;

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum FilingStep {
    Review,
    Rationale,
    Forecasts,
}

/// The dialog with its drafts.
pub struct FilingDialog {
    step: FilingStep,
    review: Review,
    rationale: Editor,
    /// Low, point and high of each horizon.
    cells: [[Field; 3]; 4],
    at: (usize, usize),
    typing: bool,
    /// The cell before it was edited, and whether the projection had filled it.
    before: Field,
    was_filled: bool,
    /// Cells that the projection filled in.
    filled: [[bool; 3]; 4],
    problem: Option<String>,
    unsent: Vec<ToolId>,
    /// In baseline runs the program fills in no rationale.
    baseline: bool,
}

/// Prompt for the rationale. It contains no words that are counted in rationales.
const RATIONALE_QUESTION: &str = "Why these decisions, and what will come of them?";
const RATIONALE_NEEDED: &str = "a rationale is required: write at least one sentence";
/// Placeholder of the rationale. It contains no words that are counted in rationales.
const RATIONALE_HINT: &str = "what you changed, and your reasons";

const HORIZONS: [&str; 4] = ["1 week", "4 weeks", "12 weeks", "26 weeks"];

impl Default for FilingDialog {
    fn default() -> Self {
        FilingDialog {
            step: FilingStep::Review,
            review: Review::default(),
            rationale: Editor::default(),
            cells: Default::default(),
            at: (0, 0),
            typing: false,
            before: Field::default(),
            was_filled: false,
            filled: Default::default(),
            problem: None,
            unsent: Vec::new(),
            baseline: false,
        }
    }
}

impl FilingDialog {
    /// Returns to the first step and keeps the drafts. Warns about forms with unsent values.
    pub fn reopen(&mut self, unsent: Vec<ToolId>, baseline: bool) {
        (self.unsent, self.baseline) = (unsent, baseline);
        self.step = FilingStep::Review;
        self.review = Review::default();
        self.problem = None;
        self.typing = false;
    }

    /// Returns whether there is a draft that could be lost.
    pub fn has_draft(&self) -> bool {
        !self.rationale.is_blank() || self.typed().any(|(row, column)| !self.cells[row][column].is_empty())
    }

    /// Returns the rationale and the forecast cells as typed.
    pub fn unsent(&self) -> (String, [[String; 3]; 4]) {
        let mut cells: [[String; 3]; 4] = Default::default();
        for (row, column) in self.typed() {
            cells[row][column] = self.cells[row][column].text().to_owned();
        }
        (self.rationale.text(), cells)
    }

    /// Restores a draft.
    pub fn restore(&mut self, rationale: &str, cells: &[[String; 3]; 4]) {
        self.rationale = Editor::of(rationale);
        self.cells = cells.each_ref().map(|row| row.each_ref().map(|text| Field::of(text.as_str())));
        self.filled = Default::default();
    }

    fn typed_text(&self) -> String {
        let texts = self.typed().map(|(row, column)| self.cells[row][column].text());
        texts.filter(|text| !text.is_empty()).collect::<Vec<_>>().join(BETWEEN_CELLS)
    }

    /// Returns the number of the step, from 1.
    pub fn step_number(&self) -> usize {
        self.step as usize + 1
    }

    /// Shows why a week was rejected.
    pub fn refused(&mut self, problem: String) {
        self.problem = Some(problem);
    }

    fn next(&mut self, look: &Look<'_>) -> Outcome {
        self.problem = None;
        match self.step {
            FilingStep::Review => self.step = FilingStep::Rationale,
            FilingStep::Rationale if self.rationale.is_blank() => {
                self.problem = Some(RATIONALE_NEEDED.to_owned());
            }
            FilingStep::Rationale => self.step = FilingStep::Forecasts,
            FilingStep::Forecasts => match self.forecasts(look.company) {
                Ok(forecasts) => {
                    let rationale = self.rationale.text().trim().to_owned();
                    return Outcome::close_with(vec![Effect::Request(Request::Advance {
                        rationale,
                        forecasts,
                    })]);
                }
                Err((at, problem)) => {
                    self.at = at;
                    self.problem = Some(problem);
                }
            },
        }
        Outcome::stay()
    }

    fn back(&mut self) {
        self.problem = None;
        self.step = match self.step {
            FilingStep::Review | FilingStep::Rationale => FilingStep::Review,
            FilingStep::Forecasts => FilingStep::Rationale,
        };
    }

    /// Positions of the cells that the projection did not fill.
    fn typed(&self) -> impl Iterator<Item = (usize, usize)> + '_ {
        (0..4).flat_map(|row| (0..3).map(move |column| (row, column))).filter(|at| !self.filled[at.0][at.1])
    }

    /// Fills empty cells with the projection. Around a typed point, its interval keeps its width.
    fn fill_naively(&mut self, company: &Company) {
        for (row, naive) in company.naive.all.iter().enumerate() {
            let typed = |column: usize| parse_number(self.cells[row][column].text());
            let (low, high) = (typed(0).unwrap_or(f64::NEG_INFINITY), typed(2).unwrap_or(f64::INFINITY));
            let point = typed(1).unwrap_or(naive.point.max(low).min(high));
            let values = [point - (naive.point - naive.lower), point, point + (naive.upper - naive.point)];
            for (column, value) in values.into_iter().enumerate() {
                if self.cells[row][column].is_empty() {
                    self.cells[row][column] = Field::of(grouped(value, 0));
                    self.filled[row][column] = true;
                }
            }
        }
        self.problem = None;
    }

    /// Parses the forecasts. Returns the first invalid cell as an error.
    fn forecasts(&self, company: &Company) -> Result<Forecasts, ((usize, usize), String)> {
        let mut all = company.naive;
        all.filled_naively = self.filled.map(|row| row.contains(&true));
        for (row, cells) in self.cells.iter().enumerate() {
            if self.filled[row] == [true; 3] {
                continue;
            }
            let mut values = [0.0; 3];
            for (column, cell) in cells.iter().enumerate() {
                values[column] = parse_number(cell.text())
                    .ok_or_else(|| ((row, column), format!("{}: enter a number", HORIZONS[row])))?;
            }
            let [lower, point, upper] = values;
            if lower > upper {
                return Err(((row, 0), format!("{}: low is above high", HORIZONS[row])));
            }
            if point < lower || point > upper {
                return Err(((row, 1), format!("{}: the point is not between low and high", HORIZONS[row])));
            }
            all.all[row] = Forecast { horizon_days: all.all[row].horizon_days, point, lower, upper };
        }
        Ok(all)
    }

    fn fill_rationale(&mut self, company: &Company) {
        if !company.is_baseline() && self.rationale.is_blank() {
            let changes: Vec<String> = company
                .seen
                .changes
                .iter()
                .map(|change| format!("{} {} → {}", change.setting, number(change.old), number(change.new)))
                .chain(company.seen.purchases.iter().cloned())
                .collect();
            let text = if changes.is_empty() { "no changes".to_owned() } else { changes.join("; ") };
            self.rationale.insert(&text);
        }
    }

    fn walk(&mut self, action: Action) {
        let (row, column) = self.at;
        self.at = match action {
            Action::Up | Action::CommitPrevious => (row.saturating_sub(1), column),
            Action::Down | Action::CommitDown => ((row + 1).min(3), column),
            Action::Left => (row, column.saturating_sub(1)),
            Action::Right => (row, (column + 1).min(2)),
            Action::FocusNext | Action::CommitNext | Action::Commit => match column {
                2 => ((row + 1).min(3), if row == 3 { 2 } else { 0 }),
                _ => (row, column + 1),
            },
            _ => self.at,
        };
    }

    fn cell(&mut self) -> &mut Field {
        &mut self.cells[self.at.0][self.at.1]
    }
}

impl Dialog for FilingDialog {
    fn what(&self) -> String {
        "next week".to_owned()
    }

    fn step(&self) -> Option<&'static str> {
        Some(match self.step {
            FilingStep::Review => "review",
            FilingStep::Rationale => "rationale",
            FilingStep::Forecasts => "forecasts",
        })
    }

    fn edited(&self) -> Option<(String, String)> {
        match self.step {
            FilingStep::Review => None,
            FilingStep::Rationale => Some(("rationale".to_owned(), self.rationale.text())),
            FilingStep::Forecasts => Some(("forecasts".to_owned(), self.typed_text())),
        }
    }

    fn scopes(&self) -> Vec<Scope> {
        match self.step {
            FilingStep::Review => vec![Scope::Filing, Scope::List],
            FilingStep::Rationale => vec![Scope::Editor, Scope::Filing],
            FilingStep::Forecasts if self.typing => vec![Scope::Field, Scope::Filing],
            FilingStep::Forecasts => vec![Scope::Filing, Scope::List],
        }
    }

    fn hints(&self) -> Vec<Action> {
        let mut hints = match self.step {
            FilingStep::Review => vec![Action::NextStep, Action::FillNaively, Action::Close],
            FilingStep::Rationale => {
                vec![Action::NextStep, Action::PreviousStep, Action::FillRationale, Action::LeaveEditor]
            }
            FilingStep::Forecasts if self.typing => {
                vec![Action::CommitNext, Action::CommitDown, Action::Discard]
            }
            FilingStep::Forecasts => {
                vec![Action::NextStep, Action::FillNaively, Action::PreviousStep, Action::Close]
            }
        };
        if self.baseline {
            let filled = self.step == FilingStep::Forecasts;
            hints.retain(|action| {
                *action != Action::FillRationale && (filled || *action != Action::FillNaively)
            });
        }
        hints
    }

    fn act(&mut self, action: Action, look: &Look<'_>) -> Outcome {
        match action {
            Action::NextStep if !self.typing => return self.next(look),
            Action::NextStep => {
                self.typing = false;
                return self.next(look);
            }
            Action::PreviousStep => {
                self.typing = false;
                self.back();
            }
            Action::Close | Action::LeaveEditor => return Outcome::close(),
            Action::FillRationale if self.step == FilingStep::Rationale => self.fill_rationale(look.company),
            Action::FillNaively if self.step == FilingStep::Forecasts => self.fill_naively(look.company),
            // Without new decisions, one key fills everything and goes to the last step.
            Action::FillNaively if self.step == FilingStep::Review && !look.company.is_baseline() => {
                self.fill_rationale(look.company);
                self.fill_naively(look.company);
                self.step = FilingStep::Forecasts;
            }
            Action::FillNaively if self.step == FilingStep::Review => {
                self.problem = Some("you can fill in forecasts in step 3".to_owned());
            }
            Action::Discard => {
                self.typing = false;
                let before = self.before.clone();
                *self.cell() = before;
                self.filled[self.at.0][self.at.1] = self.was_filled;
            }
            Action::Commit | Action::CommitNext | Action::CommitDown | Action::CommitPrevious => {
                self.typing = false;
                self.walk(action);
            }
            other if self.step == FilingStep::Forecasts => self.walk(other),
            other if self.step == FilingStep::Review => self.review.scroll(other, look.page as usize),
            _ => {}
        }
        Outcome::stay()
    }

    fn key(&mut self, key: &KeyEvent, look: &Look<'_>) -> Outcome {
        match self.step {
            FilingStep::Rationale if key.code == crossterm::event::KeyCode::Tab => return self.next(look),
            FilingStep::Rationale => {
                self.rationale.key(key);
                self.problem = None;
            }
            FilingStep::Forecasts if self.typing => {
                self.problem = (!self.cell().number_key(key)).then(|| ONLY_NUMBERS.to_owned());
            }
            FilingStep::Forecasts => {
                let starts = novamind_tui::chord::Chord::of(key).begins_number();
                if starts {
                    self.before = self.cell().clone();
                    *self.cell() = Field::default();
                    self.cell().key(key);
                    self.was_filled = std::mem::take(&mut self.filled[self.at.0][self.at.1]);
                    (self.typing, self.problem) = (true, None);
                }
            }
            FilingStep::Review => {}
        }
        Outcome::stay()
    }

    fn paste(&mut self, text: &str, _: &Look<'_>) -> Outcome {
        match self.step {
            FilingStep::Rationale => self.rationale.insert(text),
            FilingStep::Forecasts if self.typing => self.cell().insert(text),
            _ => {}
        }
        Outcome::stay()
    }

    fn click(&mut self, row: usize, _: &Look<'_>) -> Outcome {
        if self.step == FilingStep::Forecasts && !self.typing {
            self.at = (row / 3, row % 3);
        }
        Outcome::stay()
    }

    fn draw(&self, canvas: &mut Canvas<'_>, area: Rect, look: &Look<'_>) {
        let own = centered(area, 106.min(area.width), 26.min(area.height));
        canvas.clear(own, Role::Text);
        let mark = |step: FilingStep, name: &str| match (self.step as u8).cmp(&(step as u8)) {
            std::cmp::Ordering::Greater => format!("{name} ✓"),
            std::cmp::Ordering::Equal => format!("[{name}]"),
            std::cmp::Ordering::Less => name.to_owned(),
        };
        let days = look.company.next_decision_day - look.company.seen.day;
        let title = format!(
            "Next week · {} · {} · {}",
            mark(FilingStep::Review, "1 review"),
            mark(FilingStep::Rationale, "2 rationale"),
            mark(FilingStep::Forecasts, "3 forecasts")
        );
        let note = format!("{days} days, to day {}", look.company.next_decision_day);
        let inside = canvas.pane(own, &title, &note, true);
        let inside = Rect { x: inside.x + 1, width: inside.width.saturating_sub(2), ..inside };
        let body = Rect { height: inside.height.saturating_sub(1), ..inside };
        match self.step {
            FilingStep::Review => self.review.draw(canvas, body, look.company, &self.unsent),
            FilingStep::Rationale => self.draw_rationale(canvas, body, look.company),
            FilingStep::Forecasts => self.draw_forecasts(canvas, body, look),
        }
        if let Some(problem) = &self.problem {
            let row = Rect { y: body.bottom(), height: 1, ..body };
            canvas.text(row, &format!("! {problem}"), Role::Bad);
        }
        canvas.pane_keys(own, &look.hints(&self.hints()));
    }
}

impl FilingDialog {
    fn draw_rationale(&self, canvas: &mut Canvas<'_>, area: Rect, company: &Company) {
        let why =
            if company.is_baseline() { "Required, and saved with the run." } else { "Saved with the run." };
        let used = 3;
        for (row, (line, role)) in rows_of(area).zip([(RATIONALE_QUESTION, Role::Text), (why, Role::Dim)]) {
            canvas.text(row, line, role);
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
    fn nothing_that_asks_for_a_rationale_says_a_word_that_is_counted_in_it() {
        for said in [RATIONALE_QUESTION, RATIONALE_HINT, RATIONALE_NEEDED] {
            let words = said.to_lowercase();
            let words = words.split(|letter: char| !letter.is_alphabetic());
            let counted: Vec<&str> = words.filter(|word| PLANNING_WORDS.contains(word)).collect();
            assert_eq!(counted, Vec::<&str>::new(), "{said}");
        }
    }
}
