//! Keys without effect: if a key changes nothing on the screen and requests no work, the footer shows the reason.

use std::hash::{Hash, Hasher};

use ratatui::buffer::Buffer;
use ratatui::layout::{Position, Rect};

use super::{App, Stage};
use crate::action::{Action, Scope};
use crate::context::ScreenContext;
use crate::frame::{DrawnFrame, draw_frame};
use crate::keys::KeyMeaning;
use novamind_tui::chord::{Chord, format_sequence};
use novamind_tui::widgets::ListAction;

/// Keys since the last frame, and a digest of that frame.
#[derive(Default)]
pub(super) struct KeyEffects {
    last_frame: Option<u64>,
    /// The last key or key sequence, if it requested no work and showed no message.
    without_work: Option<Vec<Chord>>,
    keys_since_frame: u32,
}

impl App {
    /// Draws a frame and stores what the application needs to handle input. Returns the position of the cursor.
    ///
    /// The frame is compared with the previous frame. If only one key was pressed between the two frames and it changed
    /// nothing, the frame is drawn again with the reason in the footer.
    pub fn draw(&mut self, buffer: &mut Buffer) -> Option<Position> {
        let mut drawn = draw_frame(self, buffer);
        if self.is_unchanged_by_key(digest_above_footer(buffer, &drawn))
            && let Some(chords) = self.key_effects.without_work.take()
        {
            let reason = self.reason_without_effect(&chords);
            // Pressing escape or a movement key once too often is not an error.
            match chords.last().is_some_and(|chord| chord.is_escape() || chord.is_movement()) {
                true => self.show_status(reason),
                false => self.show_error(reason),
            }
            buffer.reset();
            drawn = draw_frame(self, buffer);
        }
        self.clicks = drawn.clicks;
        self.page_rows = drawn.page_rows;
        self.window = drawn.window;
        drawn.cursor
    }

    fn is_unchanged_by_key(&mut self, frame: u64) -> bool {
        let before = self.key_effects.last_frame.replace(frame);
        // Two keys can cancel each other, so several keys between two frames are not compared.
        let is_single = std::mem::take(&mut self.key_effects.keys_since_frame) == 1;
        is_single && before == Some(frame) && self.status.is_none() && self.busy.is_none()
    }

    /// Stores a handled key. `requested_work` is true if the key resulted in an order.
    pub(super) fn note_handled_key(&mut self, chords: Vec<Chord>, requested_work: bool) {
        self.key_effects.keys_since_frame += 1;
        let has_effect = requested_work || self.status.is_some() || !self.pending_chords.is_empty();
        self.key_effects.without_work = (!has_effect).then_some(chords);
    }

    /// Returns why a key or a key sequence has no effect in the focused pane or dialog.
    pub(super) fn reason_without_effect(&self, chords: &[Chord]) -> String {
        let key = format_sequence(chords);
        if self.is_editing_text()
            && let [chord] = chords
        {
            return self.reason_while_editing(&key, *chord);
        }
        match self.keys.meaning(&self.scopes(), chords) {
            KeyMeaning::Action(action) => self.reason_of_action(&key, action),
            KeyMeaning::Prefix | KeyMeaning::Unbound => self.reason_of_unbound_key(&key, chords),
        }
    }

    fn reason_while_editing(&self, key: &str, chord: Chord) -> String {
        let leave = [Action::LeaveEditor, Action::Discard]
            .into_iter()
            .find(|action| self.scopes().first() == Some(&action.entry().scope))
            .and_then(|action| self.keys.label(action))
            .unwrap_or_default();
        match chord {
            _ if chord.is_printable() => {
                format!("this field does not accept {key}; {leave} leaves the field")
            }
            _ if chord.is_deletion() => "there is no character to delete here".to_owned(),
            _ if chord.is_movement() => "the text ends here".to_owned(),
            _ => format!("{key} does nothing while you type; {leave} leaves the field"),
        }
    }

    fn reason_of_action(&self, key: &str, action: Action) -> String {
        let is_movement = !matches!(
            Option::<ListAction>::from(action),
            None | Some(ListAction::Close | ListAction::Filter | ListAction::Sort)
        );
        let rows =
            self.run().filter(|_| self.layers.is_empty()).map(|run| run.screens.get(run.screen).row_counts());
        match rows.flatten() {
            _ if action == Action::Close => "there is nothing to close here".to_owned(),
            Some((0, 0)) if action.entry().scope != Scope::Global => {
                format!("{key} ({}): the list is empty", action.entry().title)
            }
            Some((0, _)) if action.entry().scope != Scope::Global => {
                format!("{key} ({}): no row matches the filter", action.entry().title)
            }
            _ if is_movement => "there is nothing more in this direction".to_owned(),
            _ => format!("{key} ({}) changes nothing here", action.entry().title),
        }
    }

    /// Returns the keys that answer the question of a confirmation, if one is shown.
    fn answer_keys(&self) -> Option<String> {
        let hints = self.hints();
        let label =
            |action: &Action| Some(format!("{} ({})", self.keys.label(*action)?, action.entry().title));
        let is_confirmation = hints.contains(&Action::Confirm);
        is_confirmation.then(|| hints.iter().filter_map(label).collect::<Vec<_>>().join(" or "))
    }

    fn reason_of_unbound_key(&self, key: &str, chords: &[Chord]) -> String {
        if let Some(answers) = self.answer_keys() {
            return format!("{key} is not an answer; press {answers}");
        }
        let global = match self.keys.meaning(&[Scope::Global], chords) {
            KeyMeaning::Action(action) => Some(action.entry().title),
            _ => None,
        };
        match (&self.stage, global) {
            (Stage::Run(_), Some(title)) if !self.layers.is_empty() => {
                let close = self.keys.label(Action::Close).unwrap_or_default();
                return format!("{key} ({title}) works after {close} closes this dialog");
            }
            (Stage::Menu(_) | Stage::Study(_), Some(title)) => {
                return format!("{key} ({title}) works in an open run");
            }
            _ => {}
        }
        if let Some(reason) = self.reason_of_other_pane(key, chords) {
            return reason;
        }
        let editor = self.keys.meaning(&[Scope::Editor], chords);
        if let KeyMeaning::Action(action) = editor {
            return format!("{key} ({}) works while you edit a text", action.entry().title);
        }
        let help = self.keys.label(Action::Help).unwrap_or_default();
        match self.is_help_available() {
            true => format!("{key} has no function here; {help} lists the keys that work"),
            false => format!("{key} has no function here"),
        }
    }

    /// Returns the reason if another pane of the screen binds the key.
    fn reason_of_other_pane(&self, key: &str, chords: &[Chord]) -> Option<String> {
        let run = self.run().filter(|_| self.layers.is_empty())?;
        let context = ScreenContext { company: &run.company, keys: &self.keys, page_rows: self.page_rows };
        let panes = run.screens.get(run.screen).pane_keys(&context);
        panes
            .into_iter()
            .skip(1)
            .filter(|pane| !pane.scopes.first().is_some_and(|scope| scope.is_text()))
            .find_map(|pane| match self.keys.meaning(&pane.scopes, chords) {
                KeyMeaning::Action(action) => {
                    let name = pane.title.split(" · ").next().unwrap_or_default();
                    let tab = self.keys.label(Action::FocusNext).unwrap_or_default();
                    Some(format!("{key} ({}) works in {name}; {tab} changes panes", action.entry().title))
                }
                _ => None,
            })
    }

    fn is_help_available(&self) -> bool {
        self.layers.is_empty() && matches!(self.stage, Stage::Run(_))
    }
}

/// Returns a digest of a frame without its footer, including the cursor.
fn digest_above_footer(buffer: &Buffer, drawn: &DrawnFrame) -> u64 {
    let Rect { width, height, .. } = buffer.area;
    let cells = usize::from(width) * usize::from(height.saturating_sub(1));
    let mut hasher = MixHasher(0);
    buffer.content.iter().take(cells).for_each(|cell| cell.hash(&mut hasher));
    drawn.cursor.map(|cursor| (cursor.x, cursor.y)).hash(&mut hasher);
    hasher.finish()
}

/// A fast hasher. A collision only suppresses or adds a message in the footer.
struct MixHasher(u64);

impl MixHasher {
    fn mix(&mut self, value: u64) {
        self.0 = (self.0.rotate_left(5) ^ value).wrapping_mul(0x517c_c1b7_2722_0a95);
    }
}

impl Hasher for MixHasher {
    fn finish(&self) -> u64 {
        self.0
    }

    fn write(&mut self, bytes: &[u8]) {
        for chunk in bytes.chunks(8) {
            self.mix(chunk.iter().fold(0, |number, byte| (number << 8) | u64::from(*byte)));
        }
    }

    fn write_u8(&mut self, value: u8) {
        self.mix(u64::from(value));
    }

    fn write_u16(&mut self, value: u16) {
        self.mix(u64::from(value));
    }

    fn write_u64(&mut self, value: u64) {
        self.mix(value);
    }

    fn write_usize(&mut self, value: usize) {
        self.mix(value as u64);
    }
}
