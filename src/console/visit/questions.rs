//! A page of questions, shown one by one; all answers are sent together.

use std::cell::Cell;

use crossterm::event::{KeyCode, KeyEvent};
use ratatui::layout::Rect;
use unicode_width::UnicodeWidthStr;

use super::answer::{AnswerDraft, Entered};
use crate::action::{Action, Scope};
use crate::context::Look;
use crate::dialogs::{Dialog, Outcome};
use crate::effect::Effect;
use crate::keys::Keys;
use novamind_study::{DueQuestion, Form};
use novamind_tui::canvas::{Canvas, Click, rows_of};
use novamind_tui::chord::{Chord, written};
use novamind_tui::text::wrapped;
use novamind_tui::theme::Role;
use novamind_worker::request::{Request, VisitRequest};

const WIDEST: u16 = 92;
const MORE: &str = "  ↓ more";

/// The questions of a questionnaire at one occasion.
pub struct QuestionPage {
    drafts: Vec<AnswerDraft>,
    at: usize,
    /// First visible line of the question, if it is longer than the window.
    from: usize,
    /// Visible question lines of the last frame, and the last useful scroll position.
    read: Cell<(usize, usize)>,
    problem: Option<String>,
}

impl QuestionPage {
    /// Returns the first page of the due questions and the effect of showing it, or `None` if no question is due.
    pub fn first_of(due: &[DueQuestion]) -> Option<(QuestionPage, Effect)> {
        let first = due.first()?;
        let same = |one: &&DueQuestion| {
            (&one.questionnaire, &one.occasion) == (&first.questionnaire, &first.occasion)
        };
        let drafts = due.iter().filter(same).cloned().map(AnswerDraft::new).collect();
        let mut page = QuestionPage { drafts, at: 0, from: 0, read: Cell::new((1, 0)), problem: None };
        let shown = page.show(0)?;
        Some((page, shown))
    }

    fn draft(&self) -> &AnswerDraft {
        &self.drafts[self.at]
    }

    /// Returns whether the answer is chosen rather than typed.
    fn chooses(&self) -> bool {
        matches!(self.draft().entered, Entered::One(_) | Entered::Several(..))
    }

    /// Shows a question. Returns the effect that records it, the first time.
    fn show(&mut self, at: usize) -> Option<Effect> {
        self.at = at.min(self.drafts.len().saturating_sub(1));
        (self.from, self.problem) = (0, None);
        let draft = self.drafts.get_mut(self.at)?;
        let fresh = !draft.asked;
        draft.show();
        let question = Box::new(draft.due.clone());
        fresh.then_some(Effect::Request(Request::Visit(VisitRequest::Ask(question))))
    }

    fn page(&mut self, forward: bool) {
        let (lines, last) = self.read.get();
        let to = if forward { self.from + lines } else { self.from.saturating_sub(lines) };
        self.from = to.min(last);
    }

    fn go_on(&mut self) -> Outcome {
        let last = self.at + 1 == self.drafts.len();
        let draft = &mut self.drafts[self.at];
        if let Err(problem) = draft.confirm() {
            self.problem = Some(problem);
            return Outcome::stay();
        }
        draft.hide();
        if last {
            let answers = self.drafts.iter().map(AnswerDraft::given).collect();
            return Outcome::close_with(vec![Effect::Request(Request::Visit(VisitRequest::Answer(answers)))]);
        }
        Outcome::with(self.show(self.at + 1).into_iter().collect())
    }

    fn go_back(&mut self) -> Outcome {
        let Some(before) = self.at.checked_sub(1) else {
            self.problem = Some("this is the first question of this page".to_owned());
            return Outcome::stay();
        };
        self.drafts[self.at].hide();
        Outcome::with(self.show(before).into_iter().collect())
    }

    /// Returns title, introduction and question as styled lines.
    fn asked(&self, width: usize) -> Vec<(String, Role)> {
        let due = &self.draft().due;
        let mut lines: Vec<(String, Role)> = Vec::new();
        let introduction = due.introduction.trim();
        if self.at == 0 && !introduction.is_empty() {
            lines.extend(wrapped(introduction, width).into_iter().map(|line| (line, Role::Text)));
            lines.push((String::new(), Role::Text));
        }
        lines.extend(wrapped(&due.question.text, width).into_iter().map(|line| (line, Role::Strong)));
        lines
    }
}

impl Dialog for QuestionPage {
    fn what(&self) -> String {
        "questions".to_owned()
    }

    fn scopes(&self) -> Vec<Scope> {
        match self.draft().entered {
            Entered::One(_) | Entered::Several(..) => vec![Scope::Visit, Scope::List],
            Entered::Number(_) => vec![Scope::Field, Scope::Visit],
            Entered::Words(_) => vec![Scope::Editor, Scope::Visit],
        }
    }

    fn hints(&self) -> Vec<Action> {
        let mut hints = Vec::new();
        // In a text answer the first key inserts a line break; the frame names the key that continues.
        if !matches!(self.draft().entered, Entered::Words(_)) {
            hints.push(Action::GoOn);
        }
        if matches!(self.draft().entered, Entered::Several(..)) {
            hints.push(Action::MarkOption);
        }
        if self.at > 0 {
            hints.push(Action::GoBack);
        }
        if self.chooses() {
            hints.extend([Action::Quit, Action::Withdraw]);
        }
        hints
    }

    fn act(&mut self, action: Action, _: &Look<'_>) -> Outcome {
        match action {
            Action::GoOn | Action::Commit | Action::CommitNext | Action::Open => return self.go_on(),
            Action::GoBack | Action::CommitPrevious => return self.go_back(),
            Action::PageUp | Action::PageDown => self.page(action == Action::PageDown),
            other => {
                self.problem = None;
                self.drafts[self.at].act(other);
            }
        }
        Outcome::stay()
    }

    fn key(&mut self, key: &KeyEvent, _: &Look<'_>) -> Outcome {
        let words = matches!(self.draft().entered, Entered::Words(_));
        match key.code {
            KeyCode::Tab if words => return self.go_on(),
            KeyCode::PageUp | KeyCode::PageDown if words => self.page(key.code == KeyCode::PageDown),
            KeyCode::Char('q') if self.chooses() && key.modifiers.is_empty() => {
                return Outcome::with(vec![Effect::Do(Action::Quit)]);
            }
            _ => self.problem = self.drafts[self.at].key(key),
        }
        Outcome::stay()
    }

    fn paste(&mut self, text: &str, _: &Look<'_>) -> Outcome {
        self.drafts[self.at].paste(text);
        Outcome::stay()
    }

    fn click(&mut self, row: usize, _: &Look<'_>) -> Outcome {
        self.problem = None;
        self.drafts[self.at].choose(row);
        Outcome::stay()
    }

    fn draw(&self, canvas: &mut Canvas<'_>, area: Rect, look: &Look<'_>) {
        let draft = self.draft();
        canvas.clear(area, Role::Text);
        let note = format!("question {} of {}", self.at + 1, self.drafts.len());
        let inside = canvas.pane(area, &draft.due.title, &note, true);
        let width = inside.width.saturating_sub(2).min(WIDEST);
        let inside = Rect { x: inside.x + 1, width, ..inside };
        let [asked, form, last] = self.parts(inside);
        self.draw_asked(canvas, asked);
        draw_form(canvas, form, draft);
        match &self.problem {
            Some(problem) => canvas.text(last, &format!("! {problem}"), Role::Bad),
            None => canvas.text(last, &said_below(draft), Role::Dim),
        }
        canvas.pane_keys(area, &self.keys_in_words(look));
    }
}

impl QuestionPage {
    /// Splits the space into question, answer and a line below.
    fn parts(&self, inside: Rect) -> [Rect; 3] {
        let wanted = self.asked(inside.width as usize).len() as u16;
        let rows = form_rows(self.draft(), inside.width).min(inside.height / 2);
        let room = inside.height.saturating_sub(2);
        let above = wanted.min(room.saturating_sub(rows)).max(room.min(1));
        let asked = Rect { height: above.min(inside.height), ..inside };
        let gap = u16::from(above + rows < room);
        let top = (asked.bottom() + gap).min(inside.bottom());
        let form = Rect { y: top, height: inside.bottom().saturating_sub(top + 1), ..inside };
        let last = Rect { y: inside.bottom().saturating_sub(1), height: inside.height.min(1), ..inside };
        [asked, form, last]
    }

    fn draw_asked(&self, canvas: &mut Canvas<'_>, area: Rect) {
        let lines = self.asked(area.width as usize);
        let room = area.height as usize;
        let last = lines.len().saturating_sub(room);
        let from = self.from.min(last);
        let more = lines.len() - from > room;
        // The last row may be used for the scroll hint.
        self.read.set((room.saturating_sub(1).max(1), last));
        for (at, (row, (line, role))) in rows_of(area).zip(lines.iter().skip(from)).enumerate() {
            match more && at + 1 == room {
                true => canvas.text(row, "↓ page down shows more of the question", Role::Warning),
                false => canvas.text(row, line, *role),
            }
        }
    }

    fn keys_in_words(&self, look: &Look<'_>) -> String {
        let key = |action| look.keys.label(action).unwrap_or_default();
        let last = self.at + 1 == self.drafts.len();
        let on = match self.draft().entered {
            // Enter inserts a line break.
            Entered::Words(_) => "tab".to_owned(),
            _ => key(Action::GoOn),
        };
        let what = if last { "sends the answers" } else { "continues" };
        let mut words = vec![format!("{on} {what}")];
        if matches!(self.draft().entered, Entered::Words(_)) {
            words.push("enter new line".to_owned());
        }
        words.extend(self.way_out(look.keys).map(|key| format!("{key} leaves")));
        words.join(" · ")
    }

    /// Returns the key that leaves the page; not a letter while text is typed.
    fn way_out(&self, keys: &Keys) -> Option<String> {
        let works =
            |chords: &&[Chord]| self.chooses() || chords.first().is_some_and(|chord| !chord.is_text());
        keys.chords(Action::Quit).find(works).map(written)
    }
}

fn said_below(draft: &AnswerDraft) -> String {
    let question = &draft.due.question;
    let expected = match &question.form {
        Form::Likert { points, .. } => format!("choose with 1 to {} or the arrows", (*points).min(9)),
        Form::Choice { several: true, .. } => "mark with space or a number; you can mark several".to_owned(),
        Form::Choice { .. } | Form::Attention { .. } => "choose with a number or the arrows".to_owned(),
        form => form.value("").err().unwrap_or_default(),
    };
    match question.required {
        true => format!("{expected}; an answer is required"),
        false => format!("{expected}; optional"),
    }
}

fn form_rows(draft: &AnswerDraft, width: u16) -> u16 {
    match &draft.entered {
        Entered::Number(_) => 1,
        Entered::Words(_) => 5,
        Entered::One(_) if matches!(draft.due.question.form, Form::Likert { .. }) => 2,
        Entered::One(_) | Entered::Several(..) => option_lines(draft, width).len() as u16,
    }
}

fn draw_form(canvas: &mut Canvas<'_>, area: Rect, draft: &AnswerDraft) {
    match (&draft.entered, &draft.due.question.form) {
        (Entered::One(chosen), Form::Likert { points, low, high }) => {
            draw_scale(canvas, area, *points as usize, *chosen, [low, high]);
        }
        (Entered::Number(field), Form::Number { unit, .. }) => {
            let row = Rect { height: area.height.min(1), ..area };
            let place = Rect { width: 20.min(row.width), ..row };
            field.draw(canvas, place);
            let after =
                Rect { x: place.right() + 1, width: row.width.saturating_sub(place.width + 1), ..row };
            canvas.text(after, unit, Role::Dim);
        }
        (Entered::Words(editor), _) => {
            canvas.clear(area, Role::Field);
            editor.draw(canvas, area, true, "");
        }
        _ => draw_options(canvas, area, draft),
    }
}

/// Draws a scale with the labels of its ends.
fn draw_scale(canvas: &mut Canvas<'_>, area: Rect, points: usize, chosen: Option<usize>, ends: [&str; 2]) {
    let mut rows = rows_of(area);
    let Some(row) = rows.next() else { return };
    let each: u16 = if row.width as usize >= points * 5 { 5 } else { 4 };
    for at in 0..points {
        let place = Rect { x: row.x + at as u16 * each, width: each - 1, ..row }.intersection(row);
        let here = chosen == Some(at);
        // Brackets make the choice visible without color.
        let text = if here { format!("[{}]", at + 1) } else { format!(" {} ", at + 1) };
        canvas.text(place, &text, if here { Role::Selection } else { Role::Strong });
        canvas.click(place, Click::Row(0, at));
    }
    let meant = |point: usize, words: &str| format!("{point} = {words}");
    let words: Vec<String> = [(1, ends[0]), (points, ends[1])]
        .into_iter()
        .filter(|(_, words)| !words.is_empty())
        .map(|(point, words)| meant(point, words))
        .collect();
    let beside = words.join("   ");
    let told = if beside.width() <= row.width as usize { vec![beside] } else { words };
    for (row, line) in rows.zip(told) {
        canvas.text(row, &line, Role::Dim);
    }
}

/// Returns the option lines with the index of their option.
fn option_lines(draft: &AnswerDraft, width: u16) -> Vec<(usize, String)> {
    let sign = |at: usize| match &draft.entered {
        Entered::One(chosen) if *chosen == Some(at) => "(•)",
        Entered::One(_) => "( )",
        Entered::Several(marked, _) if marked.get(at) == Some(&true) => "[x]",
        _ => "[ ]",
    };
    let lines = |(at, option): (usize, String)| {
        let head = format!("{:>2} {} ", at + 1, sign(at));
        // Space for the sign that more options follow.
        let room = (width as usize).saturating_sub(head.width() + MORE.width()).max(1);
        let told = wrapped(&option, room).into_iter().enumerate();
        told.map(|(line, text)| {
            let head = if line == 0 { head.clone() } else { " ".repeat(head.width()) };
            (at, head + &text)
        })
        .collect::<Vec<_>>()
    };
    draft.due.question.form.options().into_iter().enumerate().flat_map(lines).collect()
}

fn draw_options(canvas: &mut Canvas<'_>, area: Rect, draft: &AnswerDraft) {
    let here = match &draft.entered {
        Entered::One(chosen) => *chosen,
        Entered::Several(_, here) => Some(*here),
        _ => None,
    };
    let lines = option_lines(draft, area.width);
    let room = area.height as usize;
    // The last line of the selected option must be visible.
    let until = lines.iter().rposition(|(at, _)| Some(*at) == here).map_or(0, |at| at + 1);
    let from = until.saturating_sub(room);
    let more = lines.len() - from > room;
    for (row, (at, line)) in rows_of(area).zip(lines.iter().skip(from)) {
        let role = if Some(*at) == here { Role::Selection } else { Role::Text };
        canvas.text(row, line, role);
        canvas.click(row, Click::Row(0, *at));
    }
    if more && let Some(row) = rows_of(area).last() {
        let place = Rect { x: row.right().saturating_sub(MORE.width() as u16), ..row }.intersection(row);
        canvas.text(place, MORE, Role::Warning);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_kit::{company, dialog_picture, in_dialog};
    use novamind_study::Question;

    fn page(text: &str, forms: &[Form]) -> QuestionPage {
        let due = |(at, form): (usize, &Form)| DueQuestion {
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
        QuestionPage::first_of(&all).expect("something is due").0
    }

    fn forms() -> Vec<Form> {
        let options: Vec<String> =
            (1..=14).map(|at| format!("option number {at} {}", "of many ".repeat(8))).collect();
        vec![
            Form::Likert { points: 11, low: "not at all".to_owned(), high: "very much".to_owned() },
            Form::Choice { options: options.clone(), several: false },
            Form::Choice { options: options.clone(), several: true },
            Form::Attention { options, expected: String::new() },
            Form::Number { min: Some(0.0), max: None, unit: "dollars".to_owned() },
            Form::Text { most: 100 },
        ]
    }

    #[test]
    fn every_form_is_drawn_in_every_window() {
        let company = company();
        for form in forms() {
            let page = page(&"A long question. ".repeat(30), &[form]);
            for width in [0, 9, 30, 59, 60, 61, 126] {
                for height in (0..40).step_by(6) {
                    dialog_picture(&page, &company, width, height);
                }
            }
        }
    }

    #[test]
    fn what_is_chosen_and_every_line_of_the_question_can_be_seen_in_the_smallest_window() {
        let company = company();
        let words: Vec<String> = (1..=120).map(|at| format!("word{at}.")).collect();
        for form in &forms()[1..4] {
            let mut page = page(&words.join(" "), std::slice::from_ref(form));
            let mut seen = String::new();
            for _ in 0..20 {
                seen += &dialog_picture(&page, &company, 60, 13);
                in_dialog(&mut page, Action::PageDown, &company);
            }
            assert!(words.iter().all(|word| seen.contains(word)), "{seen}");
            for at in 1..=14 {
                in_dialog(&mut page, Action::Down, &company);
                let shown = dialog_picture(&page, &company, 60, 13);
                let here = if matches!(page.draft().entered, Entered::Several(..)) { at + 1 } else { at };
                assert!(shown.contains(&format!("option number {}", here.min(14))), "{at}\n{shown}");
            }
        }
    }
}
