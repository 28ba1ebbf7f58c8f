//! A page of questions that are shown one at a time. All answers are sent together.

use std::cell::Cell;

use crossterm::event::{KeyCode, KeyEvent};
use ratatui::layout::Rect;
use unicode_width::UnicodeWidthStr;

use super::answer::{AnswerDraft, AnswerInput};
use crate::action::{Action, Scope};
use crate::context::ScreenContext;
use crate::dialogs::{Dialog, DialogResponse};
use crate::effect::Effect;
use crate::keys::KeyBindings;
use novamind_study::{AnswerFormat, DueQuestion};
use novamind_tui::canvas::{Canvas, Click, row_rects};
use novamind_tui::chord::{Chord, format_sequence};
use novamind_tui::text::wrap;
use novamind_tui::theme::Role;
use novamind_worker::request::{Request, StudyRequest};

const MAX_TEXT_WIDTH: u16 = 92;
const MORE_OPTIONS: &str = "  ↓ more";

/// The due questions of one questionnaire.
pub struct QuestionPage {
    drafts: Vec<AnswerDraft>,
    current: usize,
    /// Index of the first visible line of the question, which may be longer than the window.
    first_line: usize,
    /// Number of visible question lines in the last frame, and the last useful scroll position.
    visible_lines: Cell<(usize, usize)>,
    problem: Option<String>,
}

impl QuestionPage {
    /// Returns the first page of the due questions and the effect that records its first question. Returns `None` if
    /// no question is due.
    pub fn for_due_questions(due: &[DueQuestion]) -> Option<(QuestionPage, Effect)> {
        let first = due.first()?;
        let same = |one: &&DueQuestion| {
            (&one.questionnaire, &one.occasion) == (&first.questionnaire, &first.occasion)
        };
        let drafts = due.iter().filter(same).cloned().map(AnswerDraft::new).collect();
        let mut page = QuestionPage {
            drafts,
            current: 0,
            first_line: 0,
            visible_lines: Cell::new((1, 0)),
            problem: None,
        };
        let effect = page.show_question(0)?;
        Some((page, effect))
    }

    fn current_draft(&self) -> &AnswerDraft {
        &self.drafts[self.current]
    }

    /// Returns whether the participant chooses the answer to the current question rather than types it.
    fn is_choice(&self) -> bool {
        matches!(self.current_draft().input, AnswerInput::Choice(_) | AnswerInput::MultipleChoice(..))
    }

    /// Shows a question of the page. If the question is shown for the first time, returns the effect that records the
    /// view.
    fn show_question(&mut self, at: usize) -> Option<Effect> {
        self.current = at.min(self.drafts.len().saturating_sub(1));
        (self.first_line, self.problem) = (0, None);
        let draft = self.drafts.get_mut(self.current)?;
        let fresh = !draft.was_shown;
        draft.start_timer();
        let question = Box::new(draft.question.clone());
        fresh.then_some(Effect::Request(Request::Study(StudyRequest::RecordShownQuestion(question))))
    }

    fn scroll_page(&mut self, forward: bool) {
        let (lines, last) = self.visible_lines.get();
        let to = if forward { self.first_line + lines } else { self.first_line.saturating_sub(lines) };
        self.first_line = to.min(last);
    }

    fn continue_to_next(&mut self) -> DialogResponse {
        let last = self.current + 1 == self.drafts.len();
        let draft = &mut self.drafts[self.current];
        if let Err(problem) = draft.confirm() {
            self.problem = Some(problem);
            return DialogResponse::stay();
        }
        draft.stop_timer();
        if last {
            let answers = self.drafts.iter().map(AnswerDraft::to_given_answer).collect();
            return DialogResponse::confirm_with(vec![Effect::Request(Request::Study(
                StudyRequest::SubmitAnswers(answers),
            ))]);
        }
        DialogResponse::stay_with(self.show_question(self.current + 1).into_iter().collect())
    }

    fn show_previous(&mut self) -> DialogResponse {
        let Some(before) = self.current.checked_sub(1) else {
            self.problem = Some("this is the first question of this page".to_owned());
            return DialogResponse::stay();
        };
        self.drafts[self.current].stop_timer();
        DialogResponse::stay_with(self.show_question(before).into_iter().collect())
    }

    /// Returns the title, the introduction and the question as styled lines.
    fn prompt_lines(&self, width: usize) -> Vec<(String, Role)> {
        let due = &self.current_draft().question;
        let mut lines: Vec<(String, Role)> = Vec::new();
        let introduction = due.introduction.trim();
        if self.current == 0 && !introduction.is_empty() {
            lines.extend(wrap(introduction, width).into_iter().map(|line| (line, Role::Text)));
            lines.push((String::new(), Role::Text));
        }
        lines.extend(wrap(&due.question.text, width).into_iter().map(|line| (line, Role::Strong)));
        lines
    }
}

impl Dialog for QuestionPage {
    fn record_name(&self) -> String {
        "questions".to_owned()
    }

    fn scopes(&self) -> Vec<Scope> {
        match self.current_draft().input {
            AnswerInput::Choice(_) | AnswerInput::MultipleChoice(..) => vec![Scope::Study, Scope::List],
            AnswerInput::Number(_) => vec![Scope::Field, Scope::Study],
            AnswerInput::Text(_) => vec![Scope::Editor, Scope::Study],
        }
    }

    fn hints(&self) -> Vec<Action> {
        let mut hints = Vec::new();
        // In a text answer, enter inserts a line break. The border of the page names the key that continues.
        if !matches!(self.current_draft().input, AnswerInput::Text(_)) {
            hints.push(Action::Continue);
        }
        if matches!(self.current_draft().input, AnswerInput::MultipleChoice(..)) {
            hints.push(Action::MarkOption);
        }
        if self.current > 0 {
            hints.push(Action::PreviousQuestion);
        }
        if self.is_choice() {
            hints.extend([Action::Quit, Action::Withdraw]);
        }
        hints
    }

    fn handle_action(&mut self, action: Action, _: &ScreenContext<'_>) -> DialogResponse {
        match action {
            Action::Continue | Action::Commit | Action::CommitNext | Action::Open => {
                return self.continue_to_next();
            }
            Action::PreviousQuestion | Action::CommitPrevious => return self.show_previous(),
            Action::PageUp | Action::PageDown => self.scroll_page(action == Action::PageDown),
            other => {
                self.problem = None;
                self.drafts[self.current].handle_action(other);
            }
        }
        DialogResponse::stay()
    }

    fn handle_key(&mut self, key: &KeyEvent, _: &ScreenContext<'_>) -> DialogResponse {
        let words = matches!(self.current_draft().input, AnswerInput::Text(_));
        match key.code {
            KeyCode::Tab if words => return self.continue_to_next(),
            KeyCode::PageUp | KeyCode::PageDown if words => self.scroll_page(key.code == KeyCode::PageDown),
            KeyCode::Char('q') if self.is_choice() && key.modifiers.is_empty() => {
                return DialogResponse::stay_with(vec![Effect::Execute(Action::Quit)]);
            }
            _ => self.problem = self.drafts[self.current].handle_key(key),
        }
        DialogResponse::stay()
    }

    fn paste(&mut self, text: &str, _: &ScreenContext<'_>) -> DialogResponse {
        self.problem = self.drafts[self.current].paste(text);
        DialogResponse::stay()
    }

    fn handle_click(&mut self, row: usize, _: &ScreenContext<'_>) -> DialogResponse {
        self.problem = None;
        self.drafts[self.current].choose_option(row);
        DialogResponse::stay()
    }

    fn draw(&self, canvas: &mut Canvas<'_>, area: Rect, context: &ScreenContext<'_>) {
        let draft = self.current_draft();
        canvas.clear(area, Role::Text);
        let note = format!("question {} of {}", self.current + 1, self.drafts.len());
        let inside = canvas.draw_pane_frame(area, &draft.question.title, &note, true);
        let width = inside.width.saturating_sub(2).min(MAX_TEXT_WIDTH);
        let inside = Rect { x: inside.x + 1, width, ..inside };
        let [asked, form, last] = self.layout(inside);
        self.draw_prompt(canvas, asked);
        draw_answer(canvas, form, draft);
        match &self.problem {
            Some(problem) => canvas.draw_text(last, &format!("! {problem}"), Role::Bad),
            None => canvas.draw_text(last, &answer_hint(draft), Role::Dim),
        }
        canvas.draw_pane_keys(area, &self.key_hints(context));
    }
}

impl QuestionPage {
    /// Splits the page into the areas of the question, the answer and a line below the answer.
    fn layout(&self, inside: Rect) -> [Rect; 3] {
        let wanted = self.prompt_lines(inside.width as usize).len() as u16;
        let rows = answer_rows(self.current_draft(), inside.width).min(inside.height / 2);
        let room = inside.height.saturating_sub(2);
        let above = wanted.min(room.saturating_sub(rows)).max(room.min(1));
        let asked = Rect { height: above.min(inside.height), ..inside };
        let gap = u16::from(above + rows < room);
        let top = (asked.bottom() + gap).min(inside.bottom());
        let form = Rect { y: top, height: inside.bottom().saturating_sub(top + 1), ..inside };
        let last = Rect { y: inside.bottom().saturating_sub(1), height: inside.height.min(1), ..inside };
        [asked, form, last]
    }

    fn draw_prompt(&self, canvas: &mut Canvas<'_>, area: Rect) {
        let lines = self.prompt_lines(area.width as usize);
        let room = area.height as usize;
        let last = lines.len().saturating_sub(room);
        let from = self.first_line.min(last);
        let more = lines.len() - from > room;
        // One row less is visible, because the last row may show the scroll hint.
        self.visible_lines.set((room.saturating_sub(1).max(1), last));
        for (at, (row, (line, role))) in row_rects(area).zip(lines.iter().skip(from)).enumerate() {
            match more && at + 1 == room {
                true => canvas.draw_text(row, "↓ page down shows more of the question", Role::Warning),
                false => canvas.draw_text(row, line, *role),
            }
        }
    }

    fn key_hints(&self, context: &ScreenContext<'_>) -> String {
        let key = |action| context.keys.label(action).unwrap_or_default();
        let last = self.current + 1 == self.drafts.len();
        let on = match self.current_draft().input {
            // In a text answer, enter inserts a line break.
            AnswerInput::Text(_) => "tab".to_owned(),
            _ => key(Action::Continue),
        };
        let what = if last { "sends the answers" } else { "continues" };
        let mut words = vec![format!("{on} {what}")];
        if matches!(self.current_draft().input, AnswerInput::Text(_)) {
            words.push("enter new line".to_owned());
        }
        words.extend(self.leave_hint(context.keys).map(|key| format!("{key} leaves")));
        words.join(" · ")
    }

    /// Returns the key that leaves the page. While the participant types a text, the key is not a letter.
    fn leave_hint(&self, keys: &KeyBindings) -> Option<String> {
        let works = |chords: &&[Chord]| {
            self.is_choice() || chords.first().is_some_and(|chord| !chord.is_text_input())
        };
        keys.chords(Action::Quit).find(works).map(format_sequence)
    }
}

fn answer_hint(draft: &AnswerDraft) -> String {
    let question = &draft.question.question;
    let expected = match &question.form {
        AnswerFormat::Likert { points, .. } => format!("choose with 1 to {} or the arrows", (*points).min(9)),
        AnswerFormat::Choice { several: true, .. } => {
            "mark with space or a number; you can mark several".to_owned()
        }
        AnswerFormat::Choice { .. } | AnswerFormat::Attention { .. } => {
            "choose with a number or the arrows".to_owned()
        }
        form => form.parse_answer("").err().unwrap_or_default(),
    };
    match question.required {
        true => format!("{expected}; an answer is required"),
        false => format!("{expected}; optional"),
    }
}

fn answer_rows(draft: &AnswerDraft, width: u16) -> u16 {
    match &draft.input {
        AnswerInput::Number(_) => 1,
        AnswerInput::Text(_) => 5,
        AnswerInput::Choice(_) if matches!(draft.question.question.form, AnswerFormat::Likert { .. }) => 2,
        AnswerInput::Choice(_) | AnswerInput::MultipleChoice(..) => option_lines(draft, width).len() as u16,
    }
}

fn draw_answer(canvas: &mut Canvas<'_>, area: Rect, draft: &AnswerDraft) {
    match (&draft.input, &draft.question.question.form) {
        (AnswerInput::Choice(chosen), AnswerFormat::Likert { points, low, high }) => {
            draw_scale(canvas, area, *points as usize, *chosen, [low, high]);
        }
        (AnswerInput::Number(field), AnswerFormat::Number { unit, .. }) => {
            let row = Rect { height: area.height.min(1), ..area };
            let place = Rect { width: 20.min(row.width), ..row };
            field.draw(canvas, place);
            let after =
                Rect { x: place.right() + 1, width: row.width.saturating_sub(place.width + 1), ..row };
            canvas.draw_text(after, unit, Role::Dim);
        }
        (AnswerInput::Text(editor), _) => {
            canvas.clear(area, Role::Field);
            editor.draw(canvas, area, true, "");
        }
        _ => draw_options(canvas, area, draft),
    }
}

/// Draws the points of a scale and the labels of its two ends.
fn draw_scale(canvas: &mut Canvas<'_>, area: Rect, points: usize, chosen: Option<usize>, ends: [&str; 2]) {
    let mut rows = row_rects(area);
    let Some(row) = rows.next() else { return };
    let each: u16 = if row.width as usize >= points * 5 { 5 } else { 4 };
    for at in 0..points {
        let place = Rect { x: row.x + at as u16 * each, width: each - 1, ..row }.intersection(row);
        let here = chosen == Some(at);
        // Brackets make the choice visible without color.
        let text = if here { format!("[{}]", at + 1) } else { format!(" {} ", at + 1) };
        canvas.draw_text(place, &text, if here { Role::Selection } else { Role::Strong });
        canvas.register_click(place, Click::Row(0, at));
    }
    let meant = |point: usize, words: &str| format!("{point} = {words}");
    let words: Vec<String> = [(1, ends[0]), (points, ends[1])]
        .into_iter()
        .filter(|(_, words)| !words.is_empty())
        .map(|(point, words)| meant(point, words))
        .collect();
    let joined = words.join("   ");
    let texts = if joined.width() <= row.width as usize { vec![joined] } else { words };
    for (row, line) in rows.zip(texts) {
        canvas.draw_text(row, &line, Role::Dim);
    }
}

/// Returns the lines of all options. Each line has the index of its option.
fn option_lines(draft: &AnswerDraft, width: u16) -> Vec<(usize, String)> {
    let sign = |at: usize| match &draft.input {
        AnswerInput::Choice(chosen) if *chosen == Some(at) => "(•)",
        AnswerInput::Choice(_) => "( )",
        AnswerInput::MultipleChoice(marked, _) if marked.get(at) == Some(&true) => "[x]",
        _ => "[ ]",
    };
    let lines = |(at, option): (usize, String)| {
        let head = format!("{:>2} {} ", at + 1, sign(at));
        // Space is reserved for the sign that more options follow.
        let room = (width as usize).saturating_sub(head.width() + MORE_OPTIONS.width()).max(1);
        let option_text = wrap(&option, room).into_iter().enumerate();
        option_text
            .map(|(line, text)| {
                let head = if line == 0 { head.clone() } else { " ".repeat(head.width()) };
                (at, head + &text)
            })
            .collect::<Vec<_>>()
    };
    draft.question.question.form.options().into_iter().enumerate().flat_map(lines).collect()
}

fn draw_options(canvas: &mut Canvas<'_>, area: Rect, draft: &AnswerDraft) {
    let here = match &draft.input {
        AnswerInput::Choice(chosen) => *chosen,
        AnswerInput::MultipleChoice(_, here) => Some(*here),
        _ => None,
    };
    let lines = option_lines(draft, area.width);
    let room = area.height as usize;
    // The last line of the selected option must be visible.
    let until = lines.iter().rposition(|(at, _)| Some(*at) == here).map_or(0, |at| at + 1);
    let from = until.saturating_sub(room);
    let more = lines.len() - from > room;
    for (row, (at, line)) in row_rects(area).zip(lines.iter().skip(from)) {
        let role = if Some(*at) == here { Role::Selection } else { Role::Text };
        canvas.draw_text(row, line, role);
        canvas.register_click(row, Click::Row(0, *at));
    }
    if more && let Some(row) = row_rects(area).last() {
        let place =
            Rect { x: row.right().saturating_sub(MORE_OPTIONS.width() as u16), ..row }.intersection(row);
        canvas.draw_text(place, MORE_OPTIONS, Role::Warning);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_kit::{dialog_action, dialog_text, new_company};
    use novamind_study::Question;

    fn page(text: &str, forms: &[AnswerFormat]) -> QuestionPage {
        let due = |(at, form): (usize, &AnswerFormat)| DueQuestion {
            questionnaire: "q".to_owned(),
            title: "Questions".to_owned(),
            introduction: "Before you begin.".to_owned(),
            occasion: "before".to_owned(),
            question: Question {
                id: format!("q{at}"),
                text: text.to_owned(),
                form: form.clone(),
                required: true,
            },
        };
        let all: Vec<DueQuestion> = forms.iter().enumerate().map(due).collect();
        QuestionPage::for_due_questions(&all).expect("something is due").0
    }

    fn all_forms() -> Vec<AnswerFormat> {
        let options: Vec<String> =
            (1..=14).map(|at| format!("option number {at} {}", "of many ".repeat(8))).collect();
        vec![
            AnswerFormat::Likert { points: 11, low: "not at all".to_owned(), high: "very much".to_owned() },
            AnswerFormat::Choice { options: options.clone(), several: false },
            AnswerFormat::Choice { options: options.clone(), several: true },
            AnswerFormat::Attention { options, expected: String::new() },
            AnswerFormat::Number { min: Some(0.0), max: None, unit: "dollars".to_owned() },
            AnswerFormat::Text { most: 100 },
        ]
    }

    #[test]
    fn every_question_form_is_drawn_at_every_size() {
        let company = new_company();
        for form in all_forms() {
            let page = page(&"A long question. ".repeat(30), &[form]);
            for width in [0, 9, 30, 59, 60, 61, 126] {
                for height in (0..40).step_by(6) {
                    dialog_text(&page, &company, width, height);
                }
            }
        }
    }

    #[test]
    fn every_line_of_a_question_is_reachable_in_the_smallest_window() {
        let company = new_company();
        let words: Vec<String> = (1..=120).map(|at| format!("word{at}.")).collect();
        for form in &all_forms()[1..4] {
            let mut page = page(&words.join(" "), std::slice::from_ref(form));
            let mut seen = String::new();
            for _ in 0..20 {
                seen += &dialog_text(&page, &company, 60, 13);
                dialog_action(&mut page, Action::PageDown, &company);
            }
            assert!(words.iter().all(|word| seen.contains(word)), "{seen}");
            for at in 1..=14 {
                dialog_action(&mut page, Action::Down, &company);
                let shown = dialog_text(&page, &company, 60, 13);
                let here = if matches!(page.current_draft().input, AnswerInput::MultipleChoice(..)) {
                    at + 1
                } else {
                    at
                };
                assert!(shown.contains(&format!("option number {}", here.min(14))), "{at}\n{shown}");
            }
        }
    }
}
