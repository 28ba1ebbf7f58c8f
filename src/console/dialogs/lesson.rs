//! The lesson page: task, question, hints and retries.

use crossterm::event::{KeyCode, KeyEvent};
use ratatui::layout::Rect;

use super::{Dialog, Outcome};
use crate::action::{Action, Scope};
use crate::context::Look;
use crate::effect::Effect;
use crate::lesson::{Where, draw_lines, lines_of, step_to_try};
use novamind_course::{LessonPage, LessonQuestion};
use novamind_report::lesson::typed_guess;
use novamind_tui::canvas::{Canvas, Click, centered, rows_of};
use novamind_tui::text::wrapped;
use novamind_tui::theme::Role;
use novamind_tui::widgets::{Field, Scroll};
use novamind_worker::request::{LessonRequest, Request};

const WIDEST: u16 = 84;

/// The lesson page.
#[derive(Default)]
pub struct LessonDialog {
    scroll: Scroll,
    answer: Option<AnswerField>,
    /// Whether it was opened only to answer the question.
    only_asks: bool,
}

#[derive(Default)]
struct AnswerField {
    number: Field,
    choice: usize,
    problem: Option<String>,
}

impl LessonDialog {
    /// Opens only the question of the step.
    pub fn asking() -> LessonDialog {
        LessonDialog { answer: Some(AnswerField::default()), only_asks: true, ..LessonDialog::default() }
    }

    fn asked<'a>(&self, look: &Look<'a>) -> Option<&'a LessonQuestion> {
        let question = look.company.lesson.as_ref()?.question.as_ref()?;
        (self.answer.is_some() && question.guess.is_none()).then_some(question)
    }

    fn keys(&self, page: &LessonPage) -> Vec<Action> {
        if self.answer.is_some() {
            return vec![Action::Commit, Action::Discard];
        }
        let open = page.question.as_ref().is_some_and(|question| question.guess.is_none());
        let offers = [
            (Action::AnswerQuestion, open && !page.is_over),
            (Action::LessonWeek, !open && !page.is_over),
            (Action::NextHint, !page.is_over && page.hints.len() < page.hints_in_all),
            (Action::NextPart, page.next_part.is_some()),
            (Action::Debrief, page.is_over),
            (Action::TryAgain, page.is_over || page.weeks.0 > 0 || page.before.is_some()),
            (Action::ScrollDown, true),
            (Action::Cancel, true),
        ];
        offers.into_iter().filter(|(_, offered)| *offered).map(|(action, _)| action).collect()
    }

    fn answered(&mut self, question: &LessonQuestion) -> Outcome {
        let Some(answer) = &mut self.answer else { return Outcome::stay() };
        let value = match question.choices.is_empty() {
            false => Ok(answer.choice as f64 + 1.0),
            true => typed_guess(question, answer.number.text()),
        };
        let value = match value {
            Ok(value) => value,
            Err(problem) => {
                answer.problem = Some(problem);
                return Outcome::stay();
            }
        };
        self.answer = None;
        let effects = vec![Effect::Request(Request::Lesson(LessonRequest::Guess(value)))];
        if self.only_asks { Outcome::close_with(effects) } else { Outcome::with(effects) }
    }

    fn act_on_answer(&mut self, action: Action, question: &LessonQuestion) -> Outcome {
        let last = question.choices.len().saturating_sub(1);
        let Some(answer) = &mut self.answer else { return Outcome::stay() };
        match action {
            Action::Commit | Action::Open | Action::LessonOn => return self.answered(question),
            Action::Up | Action::CommitPrevious => answer.choice = answer.choice.saturating_sub(1),
            Action::Down | Action::CommitDown | Action::CommitNext => {
                answer.choice = (answer.choice + 1).min(last)
            }
            Action::Discard | Action::Close | Action::Cancel if self.only_asks => return Outcome::close(),
            Action::Discard | Action::Close | Action::Cancel => self.answer = None,
            _ => {}
        }
        Outcome::stay()
    }

    fn go_on(&mut self, page: &LessonPage) -> Outcome {
        let open = page.question.as_ref().is_some_and(|question| question.guess.is_none());
        match (page.is_over, page.next_part) {
            (true, Some(part)) => begin_part(part),
            (true, None) => Outcome::close_with(vec![Effect::ShowDebrief]),
            (false, _) if open => {
                self.answer = Some(AnswerField::default());
                Outcome::stay()
            }
            (false, _) => Outcome::close(),
        }
    }

    fn draw_answer(&self, canvas: &mut Canvas<'_>, area: Rect, question: &LessonQuestion, look: &Look<'_>) {
        let Some(answer) = &self.answer else { return };
        let width = WIDEST.min(area.width);
        let inner = width.saturating_sub(4) as usize;
        let text = wrapped(&question.text, inner);
        let choices: Vec<(usize, Vec<String>)> = question
            .choices
            .iter()
            .enumerate()
            .map(|(at, choice)| (at, wrapped(&format!("{} {choice}", at + 1), inner.saturating_sub(2))))
            .collect();
        let rows = choices.iter().map(|(_, lines)| lines.len()).sum::<usize>().max(1);
        let own = centered(area, width, (text.len() + rows + 5) as u16);
        canvas.clear(own, Role::Text);
        let inside = canvas.pane(own, "Your guess", "asked before the weeks run", true);
        let inside = Rect { x: inside.x + 1, width: inside.width.saturating_sub(2), ..inside };
        let mut rows = rows_of(inside);
        for (row, line) in rows.by_ref().zip(&text) {
            canvas.text(row, line, Role::Strong);
        }
        // `zip` has consumed one row more than there are lines: the gap.
        for (at, lines) in &choices {
            let here = *at == answer.choice;
            for (row, (number, line)) in rows.by_ref().take(lines.len()).zip(lines.iter().enumerate()) {
                let mark = if here && number == 0 { "›" } else { " " };
                canvas.text(row, &format!("{mark} {line}"), if here { Role::Selection } else { Role::Text });
                canvas.click(row, Click::Row(0, *at));
            }
        }
        if question.choices.is_empty()
            && let Some(row) = rows.next()
        {
            let width = 20.min(row.width);
            answer.number.draw(canvas, Rect { width, ..row });
            let beside = Rect { x: row.x + width + 1, width: row.width.saturating_sub(width + 1), ..row };
            canvas.text(beside, &question.unit, Role::Dim);
        }
        if let (Some(problem), Some(row)) = (&answer.problem, rows.next()) {
            canvas.text(row, &format!("! {problem}"), Role::Bad);
        }
        canvas.pane_keys(own, &look.hints(&[Action::Commit, Action::Discard]));
    }
}

pub(super) fn begin_part(part: u32) -> Outcome {
    let asked = LessonRequest::BeginPart(part.saturating_sub(1) as usize);
    Outcome::close_with(vec![Effect::Request(Request::Lesson(asked))])
}

impl Dialog for LessonDialog {
    fn what(&self) -> String {
        "lesson".to_owned()
    }

    fn scopes(&self) -> Vec<Scope> {
        match &self.answer {
            Some(_) => vec![Scope::Field, Scope::List],
            None => vec![Scope::Lesson, Scope::Dialog, Scope::List],
        }
    }

    fn hints(&self) -> Vec<Action> {
        match &self.answer {
            Some(_) => vec![Action::Commit, Action::Discard],
            None => vec![Action::LessonOn, Action::NextHint, Action::TryAgain, Action::Cancel],
        }
    }

    fn hints_here(&self, look: &Look<'_>) -> Vec<Action> {
        look.company.lesson.as_ref().map_or_else(|| self.hints(), |page| self.keys(page))
    }

    fn act(&mut self, action: Action, look: &Look<'_>) -> Outcome {
        let Some(page) = &look.company.lesson else { return Outcome::close() };
        if let Some(question) = self.asked(look) {
            return self.act_on_answer(action, question);
        }
        self.answer = None;
        let offered = self.keys(page).contains(&action);
        match action {
            Action::LessonOn => return self.go_on(page),
            Action::AnswerQuestion if offered => self.answer = Some(AnswerField::default()),
            Action::NextHint if offered => {
                self.scroll.show_end();
                return Outcome::with(vec![Effect::Request(Request::Lesson(LessonRequest::Hint))]);
            }
            Action::NextHint => {
                return Outcome::with(vec![Effect::Complain("there are no more hints".to_owned())]);
            }
            Action::NextPart => {
                return match page.next_part {
                    Some(part) => begin_part(part),
                    None => Outcome::with(vec![Effect::Complain(
                        "there is no next part, or this part has not ended".to_owned(),
                    )]),
                };
            }
            Action::Debrief if offered => return Outcome::close_with(vec![Effect::ShowDebrief]),
            Action::Debrief => {
                let text = "the debrief is available after this part of the lesson has ended".to_owned();
                return Outcome::with(vec![Effect::Complain(text)]);
            }
            Action::TryAgain => return Outcome::with(vec![Effect::TryStepAgain(step_to_try(page))]),
            Action::LessonWeek => return Outcome::close_with(vec![Effect::Do(Action::NextWeek)]),
            Action::Cancel | Action::Close => return Outcome::close(),
            other => {
                self.scroll.act(other, look.page as usize);
            }
        }
        Outcome::stay()
    }

    fn key(&mut self, key: &KeyEvent, look: &Look<'_>) -> Outcome {
        let Some(question) = self.asked(look) else { return Outcome::stay() };
        let count = question.choices.len();
        let Some(answer) = &mut self.answer else { return Outcome::stay() };
        answer.problem = None;
        match key.code {
            KeyCode::Char(letter) if count > 0 => {
                let place = letter.to_digit(10).and_then(|digit| (digit as usize).checked_sub(1));
                match (place.filter(|place| *place < count), letter) {
                    (Some(place), _) => answer.choice = place,
                    (None, 'j') => answer.choice = (answer.choice + 1).min(count - 1),
                    (None, 'k') => answer.choice = answer.choice.saturating_sub(1),
                    _ => {}
                }
            }
            KeyCode::Char('%') if count == 0 => answer.number.insert("%"),
            _ => {
                if count == 0 && !answer.number.number_key(key) {
                    answer.problem = Some("enter a number".to_owned());
                }
            }
        }
        Outcome::stay()
    }

    fn paste(&mut self, text: &str, look: &Look<'_>) -> Outcome {
        let asks_number = self.asked(look).is_some_and(|question| question.choices.is_empty());
        if let Some(answer) = self.answer.as_mut().filter(|_| asks_number) {
            answer.number.insert(text.trim());
        }
        Outcome::stay()
    }

    fn click(&mut self, row: usize, look: &Look<'_>) -> Outcome {
        let Some(question) = self.asked(look) else { return Outcome::stay() };
        let Some(answer) = &mut self.answer else { return Outcome::stay() };
        if answer.choice == row {
            return self.answered(question);
        }
        answer.choice = row.min(question.choices.len().saturating_sub(1));
        Outcome::stay()
    }

    fn draw(&self, canvas: &mut Canvas<'_>, area: Rect, look: &Look<'_>) {
        let Some(page) = &look.company.lesson else { return };
        if let Some(question) = self.asked(look).filter(|_| self.only_asks) {
            return self.draw_answer(canvas, area, question, look);
        }
        let own = centered(area, WIDEST.min(area.width), area.height);
        let lines = lines_of(page, look, (own.width.saturating_sub(4) as usize, Where::OnPage));
        let own = centered(area, own.width, (lines.len() as u16).saturating_add(2));
        canvas.clear(own, Role::Text);
        let note = format!("week {} of {}", (page.weeks.0 + 1).min(page.weeks.1), page.weeks.1);
        let inside = canvas.pane(own, "Lesson", &note, true);
        let inside = Rect { x: inside.x + 1, width: inside.width.saturating_sub(2), ..inside };
        canvas.page = inside.height.max(1);
        let from = self.scroll.within(lines.len().saturating_sub(inside.height as usize));
        draw_lines(canvas, inside, &lines, from);
        let cut = lines.len() > inside.height as usize;
        let keys = self.keys(page).into_iter().filter(|action| cut || *action != Action::ScrollDown);
        canvas.pane_keys(own, &look.hints(&keys.collect::<Vec<_>>()));
        if let Some(question) = self.asked(look) {
            self.draw_answer(canvas, area, question, look);
        }
    }
}
