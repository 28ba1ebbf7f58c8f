//! The lesson page: task, question, hints and retries.

use crossterm::event::{KeyCode, KeyEvent};
use ratatui::layout::Rect;

use super::{Dialog, DialogResponse};
use crate::action::{Action, Scope};
use crate::context::ScreenContext;
use crate::effect::Effect;
use crate::lesson::{TaskPlace, draw_lines, retry_step, task_lines};
use novamind_course::{LessonQuestion, LessonStatus};
use novamind_report::lesson::parse_guess;
use novamind_tui::canvas::{Canvas, Click, centered_rect, row_rects};
use novamind_tui::text::wrap;
use novamind_tui::theme::Role;
use novamind_tui::widgets::{ScrollState, TextField};
use novamind_worker::request::{LessonRequest, Request};

const MAX_DIALOG_WIDTH: u16 = 84;

/// The lesson page.
#[derive(Default)]
pub struct LessonDialog {
    scroll: ScrollState,
    answer: Option<AnswerField>,
    /// Whether the page was opened only to answer the question.
    closes_after_answer: bool,
}

#[derive(Default)]
struct AnswerField {
    number: TextField,
    choice: usize,
    problem: Option<String>,
}

impl LessonDialog {
    /// Opens the page only to answer the question of the step.
    pub fn for_question() -> LessonDialog {
        LessonDialog {
            answer: Some(AnswerField::default()),
            closes_after_answer: true,
            ..LessonDialog::default()
        }
    }

    fn open_question<'a>(&self, context: &ScreenContext<'a>) -> Option<&'a LessonQuestion> {
        let question = context.company.lesson.as_ref()?.question.as_ref()?;
        (self.answer.is_some() && question.guess.is_none()).then_some(question)
    }

    fn actions(&self, page: &LessonStatus) -> Vec<Action> {
        if self.answer.is_some() {
            return vec![Action::Commit, Action::Discard];
        }
        let open = page.question.as_ref().is_some_and(|question| question.guess.is_none());
        let offers = [
            (Action::AnswerQuestion, open && !page.is_finished),
            (Action::LessonWeek, !open && !page.is_finished),
            (Action::NextHint, !page.is_finished && page.hints.len() < page.hint_count),
            (Action::NextPart, page.next_part.is_some()),
            (Action::Debrief, page.is_finished),
            (Action::TryAgain, page.is_finished || page.weeks.0 > 0 || page.previous_step.is_some()),
            (Action::ScrollDown, true),
            (Action::Cancel, true),
        ];
        offers.into_iter().filter(|(_, offered)| *offered).map(|(action, _)| action).collect()
    }

    fn submit_answer(&mut self, question: &LessonQuestion) -> DialogResponse {
        let Some(answer) = &mut self.answer else { return DialogResponse::stay() };
        let value = match question.choices.is_empty() {
            false => Ok(answer.choice as f64 + 1.0),
            true => parse_guess(question, answer.number.text()),
        };
        let value = match value {
            Ok(value) => value,
            Err(problem) => {
                answer.problem = Some(problem);
                return DialogResponse::stay();
            }
        };
        self.answer = None;
        let effects = vec![Effect::Request(Request::Lesson(LessonRequest::Guess(value)))];
        if self.closes_after_answer {
            DialogResponse::confirm_with(effects)
        } else {
            DialogResponse::stay_with(effects)
        }
    }

    fn handle_answer_action(&mut self, action: Action, question: &LessonQuestion) -> DialogResponse {
        let last = question.choices.len().saturating_sub(1);
        let Some(answer) = &mut self.answer else { return DialogResponse::stay() };
        match action {
            Action::Commit | Action::Open | Action::ContinueLesson => return self.submit_answer(question),
            Action::Up | Action::CommitPrevious => answer.choice = answer.choice.saturating_sub(1),
            Action::Down | Action::CommitDown | Action::CommitNext => {
                answer.choice = (answer.choice + 1).min(last)
            }
            Action::Discard | Action::Close | Action::Cancel if self.closes_after_answer => {
                return DialogResponse::close();
            }
            Action::Discard | Action::Close | Action::Cancel => self.answer = None,
            _ => {}
        }
        DialogResponse::stay()
    }

    fn continue_lesson(&mut self, page: &LessonStatus) -> DialogResponse {
        let open = page.question.as_ref().is_some_and(|question| question.guess.is_none());
        match (page.is_finished, page.next_part) {
            (true, Some(part)) => start_part(part),
            (true, None) => DialogResponse::confirm_with(vec![Effect::ShowDebrief]),
            (false, _) if open => {
                self.answer = Some(AnswerField::default());
                DialogResponse::stay()
            }
            (false, _) => DialogResponse::close(),
        }
    }

    fn draw_answer(
        &self,
        canvas: &mut Canvas<'_>,
        area: Rect,
        question: &LessonQuestion,
        context: &ScreenContext<'_>,
    ) {
        let Some(answer) = &self.answer else { return };
        let width = MAX_DIALOG_WIDTH.min(area.width);
        let inner = width.saturating_sub(4) as usize;
        let text = wrap(&question.text, inner);
        let choices: Vec<(usize, Vec<String>)> = question
            .choices
            .iter()
            .enumerate()
            .map(|(at, choice)| (at, wrap(&format!("{} {choice}", at + 1), inner.saturating_sub(2))))
            .collect();
        let rows = choices.iter().map(|(_, lines)| lines.len()).sum::<usize>().max(1);
        let dialog_area = centered_rect(area, width, (text.len() + rows + 5) as u16);
        canvas.clear(dialog_area, Role::Text);
        let inside = canvas.draw_pane_frame(dialog_area, "Your guess", "answer before the weeks run", true);
        let inside = Rect { x: inside.x + 1, width: inside.width.saturating_sub(2), ..inside };
        let mut rows = row_rects(inside);
        for (row, line) in rows.by_ref().zip(&text) {
            canvas.draw_text(row, line, Role::Strong);
        }
        // `zip` has already consumed the next row, which stays blank between the question and the choices.
        for (at, lines) in &choices {
            let here = *at == answer.choice;
            for (row, (number, line)) in rows.by_ref().take(lines.len()).zip(lines.iter().enumerate()) {
                let mark = if here && number == 0 { "›" } else { " " };
                canvas.draw_text(
                    row,
                    &format!("{mark} {line}"),
                    if here { Role::Selection } else { Role::Text },
                );
                canvas.register_click(row, Click::Row(0, *at));
            }
        }
        if question.choices.is_empty()
            && let Some(row) = rows.next()
        {
            let width = 20.min(row.width);
            answer.number.draw(canvas, Rect { width, ..row });
            let unit_area = Rect { x: row.x + width + 1, width: row.width.saturating_sub(width + 1), ..row };
            canvas.draw_text(unit_area, &question.unit, Role::Dim);
        }
        if let (Some(problem), Some(row)) = (&answer.problem, rows.next()) {
            canvas.draw_text(row, &format!("! {problem}"), Role::Bad);
        }
        canvas.draw_pane_keys(dialog_area, &context.hints(&[Action::Commit, Action::Discard]));
    }
}

pub(super) fn start_part(part: u32) -> DialogResponse {
    let lesson_request = LessonRequest::StartPart(part.saturating_sub(1) as usize);
    DialogResponse::confirm_with(vec![Effect::Request(Request::Lesson(lesson_request))])
}

impl Dialog for LessonDialog {
    fn record_name(&self) -> String {
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
            None => vec![Action::ContinueLesson, Action::NextHint, Action::TryAgain, Action::Cancel],
        }
    }

    fn hints_in_context(&self, context: &ScreenContext<'_>) -> Vec<Action> {
        context.company.lesson.as_ref().map_or_else(|| self.hints(), |page| self.actions(page))
    }

    fn handle_action(&mut self, action: Action, context: &ScreenContext<'_>) -> DialogResponse {
        let Some(page) = &context.company.lesson else { return DialogResponse::close() };
        if let Some(question) = self.open_question(context) {
            return self.handle_answer_action(action, question);
        }
        self.answer = None;
        let offered = self.actions(page).contains(&action);
        match action {
            Action::ContinueLesson => return self.continue_lesson(page),
            // The keys that show the task also hide the task.
            Action::HideLessonPage => return DialogResponse::close(),
            Action::AnswerQuestion if offered => self.answer = Some(AnswerField::default()),
            Action::NextHint if offered => {
                self.scroll.scroll_to_end();
                return DialogResponse::stay_with(vec![Effect::Request(Request::Lesson(
                    LessonRequest::Hint,
                ))]);
            }
            Action::NextHint => {
                return DialogResponse::stay_with(vec![Effect::ShowError(
                    "there are no more hints".to_owned(),
                )]);
            }
            Action::NextPart => {
                return match page.next_part {
                    Some(part) => start_part(part),
                    None => DialogResponse::stay_with(vec![Effect::ShowError(
                        "there is no next part, or this part has not ended".to_owned(),
                    )]),
                };
            }
            Action::Debrief if offered => return DialogResponse::confirm_with(vec![Effect::ShowDebrief]),
            Action::Debrief => {
                let text = "the debrief is available after the end of this part of the lesson".to_owned();
                return DialogResponse::stay_with(vec![Effect::ShowError(text)]);
            }
            Action::TryAgain => {
                return DialogResponse::stay_with(vec![Effect::TryStepAgain(retry_step(page))]);
            }
            Action::LessonWeek => {
                return DialogResponse::confirm_with(vec![Effect::Execute(Action::NextWeek)]);
            }
            Action::Cancel | Action::Close => return DialogResponse::close(),
            other => {
                self.scroll.handle_action(other, context.page_rows as usize);
            }
        }
        DialogResponse::stay()
    }

    fn handle_key(&mut self, key: &KeyEvent, context: &ScreenContext<'_>) -> DialogResponse {
        let Some(question) = self.open_question(context) else { return DialogResponse::stay() };
        let count = question.choices.len();
        let Some(answer) = &mut self.answer else { return DialogResponse::stay() };
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
                if count == 0 && !answer.number.handle_number_key(key) {
                    answer.problem = Some("enter a number".to_owned());
                }
            }
        }
        DialogResponse::stay()
    }

    fn paste(&mut self, text: &str, context: &ScreenContext<'_>) -> DialogResponse {
        let needs_number = self.open_question(context).is_some_and(|question| question.choices.is_empty());
        if let Some(answer) = self.answer.as_mut().filter(|_| needs_number) {
            answer.number.insert(text.trim());
        }
        DialogResponse::stay()
    }

    fn handle_click(&mut self, row: usize, context: &ScreenContext<'_>) -> DialogResponse {
        let Some(question) = self.open_question(context) else { return DialogResponse::stay() };
        let Some(answer) = &mut self.answer else { return DialogResponse::stay() };
        if answer.choice == row {
            return self.submit_answer(question);
        }
        answer.choice = row.min(question.choices.len().saturating_sub(1));
        DialogResponse::stay()
    }

    fn draw(&self, canvas: &mut Canvas<'_>, area: Rect, context: &ScreenContext<'_>) {
        let Some(page) = &context.company.lesson else { return };
        if let Some(question) = self.open_question(context).filter(|_| self.closes_after_answer) {
            return self.draw_answer(canvas, area, question, context);
        }
        let widest_area = centered_rect(area, MAX_DIALOG_WIDTH.min(area.width), area.height);
        let lines =
            task_lines(page, context, (widest_area.width.saturating_sub(4) as usize, TaskPlace::FullPage));
        let dialog_area = centered_rect(area, widest_area.width, (lines.len() as u16).saturating_add(2));
        canvas.clear(dialog_area, Role::Text);
        let note = format!("week {} of {}", (page.weeks.0 + 1).min(page.weeks.1), page.weeks.1);
        let inside = canvas.draw_pane_frame(dialog_area, "Lesson", &note, true);
        let inside = Rect { x: inside.x + 1, width: inside.width.saturating_sub(2), ..inside };
        canvas.page_rows = inside.height.max(1);
        let from = self.scroll.scroll_rows(canvas, inside, lines.len());
        draw_lines(canvas, inside, &lines, from);
        let cut = lines.len() > inside.height as usize;
        let keys = self.actions(page).into_iter().filter(|action| cut || *action != Action::ScrollDown);
        canvas.draw_pane_keys(dialog_area, &context.hints(&keys.collect::<Vec<_>>()));
        if let Some(question) = self.open_question(context) {
            self.draw_answer(canvas, area, question, context);
        }
    }
}
