//! The draft of an answer to a study question.

use std::time::Duration;

use crossterm::event::{KeyCode, KeyEvent, KeyModifiers};
use serde_json::Value;

use crate::action::Action;
use novamind_record::clock::steady;
use novamind_study::{DueQuestion, Form};
use novamind_tui::widgets::{Editor, Field};
use novamind_worker::request::GivenAnswer;

/// The input so far.
#[derive(Debug, Clone)]
pub enum Entered {
    /// A point of a scale or one of several options, by index.
    One(Option<usize>),
    /// Several options, and the option under the cursor.
    Several(Vec<bool>, usize),
    /// A number as typed.
    Number(Field),
    /// A text.
    Words(Box<Editor>),
}

/// A question with the input so far.
pub struct AnswerDraft {
    /// The question.
    pub due: DueQuestion,
    /// The input.
    pub entered: Entered,
    /// Whether it was shown before.
    pub asked: bool,
    /// The last confirmed answer.
    confirmed: Option<Value>,
    changes: u32,
    /// Milliseconds on the screen in earlier views.
    shown_ms: u64,
    shown: Duration,
}

impl AnswerDraft {
    /// Returns an empty draft of a question that was not shown yet.
    pub fn new(due: DueQuestion) -> AnswerDraft {
        let entered = match &due.question.form {
            Form::Likert { .. } | Form::Choice { several: false, .. } | Form::Attention { .. } => {
                Entered::One(None)
            }
            Form::Choice { options, several: true } => Entered::Several(vec![false; options.len()], 0),
            Form::Number { .. } => Entered::Number(Field::default()),
            Form::Text { .. } => Entered::Words(Box::default()),
        };
        AnswerDraft { due, entered, asked: false, confirmed: None, changes: 0, shown_ms: 0, shown: steady() }
    }

    /// Starts the view timer.
    pub fn show(&mut self) {
        (self.asked, self.shown) = (true, steady());
    }

    /// Pauses the view timer.
    pub fn hide(&mut self) {
        self.shown_ms += steady().saturating_sub(self.shown).as_millis() as u64;
    }

    /// Returns the input in the notation of plain mode.
    fn typed(&self) -> String {
        let number = |at: usize| (at + 1).to_string();
        match &self.entered {
            Entered::One(chosen) => chosen.map(number).unwrap_or_default(),
            Entered::Several(marked, _) => {
                let chosen = marked.iter().enumerate().filter(|(_, marked)| **marked);
                chosen.map(|(at, _)| number(at)).collect::<Vec<_>>().join(",")
            }
            Entered::Number(field) => field.text().trim().to_owned(),
            Entered::Words(editor) => editor.text().trim().to_owned(),
        }
    }

    /// Validates and accepts the input as the answer.
    ///
    /// # Errors
    /// The input is invalid; the message says what is expected.
    pub fn confirm(&mut self) -> Result<(), String> {
        let form = &self.due.question.form;
        let typed = self.typed();
        let value = match typed.is_empty() {
            true if !self.due.question.required => Value::Null,
            true => {
                return Err(format!("an answer is required: {}", form.value("").err().unwrap_or_default()));
            }
            false => form.value(&typed).map_err(|expected| format!("needed: {expected}"))?,
        };
        let chosen_live = matches!(self.entered, Entered::One(_));
        let differs = self.confirmed.as_ref().is_some_and(|before| *before != value);
        self.changes += u32::from(differs && !chosen_live);
        self.confirmed = Some(value);
        Ok(())
    }

    /// Returns the answer.
    pub fn given(&self) -> GivenAnswer {
        GivenAnswer {
            due: self.due.clone(),
            value: self.confirmed.clone().unwrap_or(Value::Null),
            for_ms: self.shown_ms,
            changes: self.changes,
        }
    }

    fn options(&self) -> usize {
        self.due.question.form.options().len()
    }

    /// Chooses an option, or toggles it if several can be marked.
    pub fn choose(&mut self, at: usize) {
        if at >= self.options() {
            return;
        }
        match &mut self.entered {
            Entered::One(chosen) => {
                // The first choice is not a change.
                self.changes += u32::from(chosen.is_some_and(|before| before != at));
                *chosen = Some(at);
            }
            Entered::Several(marked, here) => {
                marked[at] = !marked[at];
                *here = at;
            }
            Entered::Number(_) | Entered::Words(_) => {}
        }
    }

    /// Handles an action on the input.
    pub fn act(&mut self, action: Action) {
        let last = self.options().saturating_sub(1);
        let step = |at: usize| match action {
            Action::Up | Action::Left => Some(at.saturating_sub(1)),
            Action::Down | Action::Right => Some((at + 1).min(last)),
            Action::First => Some(0),
            Action::Last => Some(last),
            _ => None,
        };
        match &mut self.entered {
            Entered::One(chosen) => {
                let to = match (*chosen, action) {
                    (Some(at), _) => step(at),
                    (None, Action::Down | Action::Right | Action::First | Action::MarkOption) => Some(0),
                    (None, Action::Up | Action::Left | Action::Last) => Some(last),
                    (None, _) => None,
                };
                if let Some(at) = to {
                    self.choose(at);
                }
            }
            Entered::Several(_, here) => {
                let at = *here;
                match (action, step(at)) {
                    (Action::MarkOption, _) => self.choose(at),
                    (_, Some(to)) => *here = to,
                    _ => {}
                }
            }
            Entered::Number(_) | Entered::Words(_) => {}
        }
    }

    /// Handles a typed key. Returns why it was ignored if that is not obvious.
    pub fn key(&mut self, key: &KeyEvent) -> Option<String> {
        let plain = !key.modifiers.intersects(KeyModifiers::CONTROL | KeyModifiers::ALT);
        match (&mut self.entered, key.code) {
            (Entered::Number(field), _) => {
                let expected = || self.due.question.form.value("").err().unwrap_or_default();
                return (!field.number_key(key)).then(|| format!("type {}", expected()));
            }
            (Entered::Words(editor), _) => editor.key(key),
            (_, KeyCode::Char(letter)) if plain => {
                if let Some(at) = letter.to_digit(10).and_then(|digit| digit.checked_sub(1)) {
                    self.choose(at as usize);
                }
            }
            _ => {}
        }
        None
    }

    /// Handles pasted text.
    pub fn paste(&mut self, text: &str) {
        match &mut self.entered {
            Entered::Number(field) => field.insert(text.trim()),
            Entered::Words(editor) => editor.insert(text),
            _ => {}
        }
    }
}
