//! The draft of a participant's answer to a study question.

use std::time::Duration;

use crossterm::event::{KeyCode, KeyEvent, KeyModifiers};
use serde_json::Value;

use crate::action::Action;
use novamind_record::clock::monotonic_time;
use novamind_study::{AnswerFormat, DueQuestion};
use novamind_tui::widgets::{TextEditor, TextField};
use novamind_worker::request::GivenAnswer;

/// The answer that the participant has entered.
#[derive(Debug, Clone)]
pub enum AnswerInput {
    /// Index of a point on a scale or of one option.
    Choice(Option<usize>),
    /// Whether each option is marked, and the index of the option under the cursor.
    MultipleChoice(Vec<bool>, usize),
    /// Field with a typed number.
    Number(TextField),
    /// Editor with a typed text.
    Text(Box<TextEditor>),
}

/// A question with the draft of its answer.
pub struct AnswerDraft {
    /// The question to answer.
    pub question: DueQuestion,
    /// The answer that the participant has entered.
    pub input: AnswerInput,
    /// Whether the question was shown before.
    pub was_shown: bool,
    /// The answer that was confirmed last.
    confirmed_answer: Option<Value>,
    changes: u32,
    /// Time for which earlier views showed the question, in milliseconds.
    previous_ms: u64,
    shown_at: Duration,
}

impl AnswerDraft {
    /// Returns an empty draft for a question that has not been shown yet.
    pub fn new(due: DueQuestion) -> AnswerDraft {
        let entered = match &due.question.form {
            AnswerFormat::Likert { .. }
            | AnswerFormat::Choice { several: false, .. }
            | AnswerFormat::Attention { .. } => AnswerInput::Choice(None),
            AnswerFormat::Choice { options, several: true } => {
                AnswerInput::MultipleChoice(vec![false; options.len()], 0)
            }
            AnswerFormat::Number { .. } => AnswerInput::Number(TextField::default()),
            AnswerFormat::Text { .. } => AnswerInput::Text(Box::default()),
        };
        AnswerDraft {
            question: due,
            input: entered,
            was_shown: false,
            confirmed_answer: None,
            changes: 0,
            previous_ms: 0,
            shown_at: monotonic_time(),
        }
    }

    /// Starts the view timer.
    pub fn start_timer(&mut self) {
        (self.was_shown, self.shown_at) = (true, monotonic_time());
    }

    /// Pauses the view timer.
    pub fn stop_timer(&mut self) {
        self.previous_ms += monotonic_time().saturating_sub(self.shown_at).as_millis() as u64;
    }

    /// Returns the input in the notation of plain mode.
    fn typed_text(&self) -> String {
        let number = |at: usize| (at + 1).to_string();
        match &self.input {
            AnswerInput::Choice(chosen) => chosen.map(number).unwrap_or_default(),
            AnswerInput::MultipleChoice(marked, _) => {
                let chosen = marked.iter().enumerate().filter(|(_, marked)| **marked);
                chosen.map(|(at, _)| number(at)).collect::<Vec<_>>().join(",")
            }
            AnswerInput::Number(field) => field.text().trim().to_owned(),
            AnswerInput::Text(editor) => editor.text().trim().to_owned(),
        }
    }

    /// Validates and accepts the input as the answer.
    ///
    /// # Errors
    /// The input is invalid. The message describes the expected input.
    pub fn confirm(&mut self) -> Result<(), String> {
        let form = &self.question.question.form;
        let typed = self.typed_text();
        let value = match typed.is_empty() {
            true if !self.question.question.required => Value::Null,
            true => {
                return Err(format!(
                    "an answer is required: {}",
                    form.parse_answer("").err().unwrap_or_default()
                ));
            }
            false => form.parse_answer(&typed).map_err(|expected| format!("expected: {expected}"))?,
        };
        let is_single_choice = matches!(self.input, AnswerInput::Choice(_));
        let differs = self.confirmed_answer.as_ref().is_some_and(|before| *before != value);
        self.changes += u32::from(differs && !is_single_choice);
        self.confirmed_answer = Some(value);
        Ok(())
    }

    /// Returns the confirmed answer with its view time and changes.
    pub fn to_given_answer(&self) -> GivenAnswer {
        GivenAnswer {
            due: self.question.clone(),
            value: self.confirmed_answer.clone().unwrap_or(Value::Null),
            shown_ms: self.previous_ms,
            changes: self.changes,
        }
    }

    fn option_count(&self) -> usize {
        self.question.question.form.options().len()
    }

    /// Chooses an option. If the participant can mark several options, toggles the option.
    pub fn choose_option(&mut self, at: usize) {
        if at >= self.option_count() {
            return;
        }
        match &mut self.input {
            AnswerInput::Choice(chosen) => {
                // The first choice does not count as a change.
                self.changes += u32::from(chosen.is_some_and(|before| before != at));
                *chosen = Some(at);
            }
            AnswerInput::MultipleChoice(marked, here) => {
                marked[at] = !marked[at];
                *here = at;
            }
            AnswerInput::Number(_) | AnswerInput::Text(_) => {}
        }
    }

    /// Handles an action in the input of the answer.
    pub fn handle_action(&mut self, action: Action) {
        let last = self.option_count().saturating_sub(1);
        let step = |at: usize| match action {
            Action::Up | Action::Left => Some(at.saturating_sub(1)),
            Action::Down | Action::Right => Some((at + 1).min(last)),
            Action::First => Some(0),
            Action::Last => Some(last),
            _ => None,
        };
        match &mut self.input {
            AnswerInput::Choice(chosen) => {
                let to = match (*chosen, action) {
                    (Some(at), _) => step(at),
                    (None, Action::Down | Action::Right | Action::First | Action::MarkOption) => Some(0),
                    (None, Action::Up | Action::Left | Action::Last) => Some(last),
                    (None, _) => None,
                };
                if let Some(at) = to {
                    self.choose_option(at);
                }
            }
            AnswerInput::MultipleChoice(_, here) => {
                let at = *here;
                match (action, step(at)) {
                    (Action::MarkOption, _) => self.choose_option(at),
                    (_, Some(to)) => *here = to,
                    _ => {}
                }
            }
            AnswerInput::Number(_) | AnswerInput::Text(_) => {}
        }
    }

    /// Handles a typed key. Returns the reason why the key was ignored, if the reason is not obvious.
    pub fn handle_key(&mut self, key: &KeyEvent) -> Option<String> {
        let plain = !key.modifiers.intersects(KeyModifiers::CONTROL | KeyModifiers::ALT);
        match (&mut self.input, key.code) {
            (AnswerInput::Number(field), _) => {
                let expected = || self.question.question.form.parse_answer("").err().unwrap_or_default();
                return (!field.handle_number_key(key)).then(|| format!("type {}", expected()));
            }
            (AnswerInput::Text(editor), _) => editor.handle_key(key),
            (_, KeyCode::Char(letter)) if plain => {
                if let Some(at) = letter.to_digit(10).and_then(|digit| digit.checked_sub(1)) {
                    self.choose_option(at as usize);
                }
            }
            _ => {}
        }
        None
    }

    /// Handles text that is pasted into the answer. Returns a problem with the text.
    pub fn paste(&mut self, text: &str) -> Option<String> {
        match &mut self.input {
            AnswerInput::Number(field) => return field.paste_number(text).err(),
            AnswerInput::Text(editor) => editor.insert(text),
            _ => {}
        }
        None
    }
}
