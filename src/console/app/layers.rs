//! Open dialogs, the topmost last. Each dialog records how long it was open and how much time the user spent on its
//! steps.

use std::time::Duration;

use crate::attention::millis;
use crate::dialogs::Dialog;
use novamind_record::trajectory::record::{DialogOutcome, DialogStep, DialogUse};

/// A dialog over the screen.
pub enum Layer {
    /// The next-week dialog. Its drafts are kept after the dialog closes.
    NextWeek,
    /// Any other dialog.
    Dialog(Box<dyn Dialog>),
}

/// The dialogs that are open.
#[derive(Default)]
pub struct Layers {
    open: Vec<OpenLayer>,
}

struct OpenLayer {
    layer: Layer,
    record_name: String,
    opened_at: Duration,
    /// Steps that the user entered, with the time of entry.
    steps: Vec<(&'static str, Duration)>,
}

impl Layers {
    /// Opens a dialog above all open dialogs.
    pub fn push(&mut self, layer: Layer, now: Duration) {
        let what = match &layer {
            Layer::NextWeek => "next week".to_owned(),
            Layer::Dialog(dialog) => dialog.record_name(),
        };
        self.open.push(OpenLayer { layer, record_name: what, opened_at: now, steps: Vec::new() });
    }

    /// Closes the top dialog and returns its usage record.
    pub fn pop(&mut self, outcome: DialogOutcome, now: Duration) -> Option<DialogUse> {
        let OpenLayer { record_name: what, opened_at: since, steps, .. } = self.open.pop()?;
        let ends = steps.iter().skip(1).map(|(_, entered)| *entered).chain([now]);
        let step = |((step, entered), end): (&(&'static str, Duration), Duration)| DialogStep {
            step: (*step).to_owned(),
            for_ms: millis(end.saturating_sub(*entered)),
        };
        let steps = steps.iter().zip(ends).map(step).collect();
        Some(DialogUse { what, outcome, for_ms: millis(now.saturating_sub(since)), steps })
    }

    /// Records that the user entered a step of the top dialog.
    pub fn enter_step(&mut self, step: &'static str, now: Duration) {
        if let Some(top) = self.open.last_mut()
            && top.steps.last().is_none_or(|(last, _)| *last != step)
        {
            top.steps.push((step, now));
        }
    }

    /// Returns the recorded name of the dialog below the top one.
    pub fn covered_dialog_name(&self) -> Option<&str> {
        self.open.iter().rev().nth(1).map(|below| below.record_name.as_str())
    }

    /// Returns the top dialog.
    pub fn top(&self) -> Option<&Layer> {
        self.open.last().map(|open| &open.layer)
    }

    /// Returns the top dialog mutably.
    pub fn top_mut(&mut self) -> Option<&mut Layer> {
        self.open.last_mut().map(|open| &mut open.layer)
    }

    /// Returns an iterator over the dialogs, the topmost last.
    pub fn iter(&self) -> impl Iterator<Item = &Layer> {
        self.open.iter().map(|open| &open.layer)
    }

    /// Returns a mutable iterator over the dialogs, the topmost last.
    pub fn iter_mut(&mut self) -> impl Iterator<Item = &mut Layer> {
        self.open.iter_mut().map(|open| &mut open.layer)
    }

    /// Returns whether no dialog is open.
    pub fn is_empty(&self) -> bool {
        self.open.is_empty()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn dialog_use_lists_steps_in_order() {
        let at = Duration::from_millis;
        let mut layers = Layers::default();
        layers.push(Layer::NextWeek, at(100));
        for (step, now) in [("review", 100), ("review", 110), ("rationale", 150), ("review", 400)] {
            layers.enter_step(step, at(now));
        }
        let used = layers.pop(DialogOutcome::Cancelled, at(1000)).expect("an open dialog");
        let steps: Vec<(&str, u64)> =
            used.steps.iter().map(|dialog_step| (dialog_step.step.as_str(), dialog_step.for_ms)).collect();
        assert_eq!((used.what.as_str(), used.for_ms), ("next week", 900));
        assert_eq!(steps, [("review", 50), ("rationale", 250), ("review", 600)]);
        assert!(layers.is_empty() && layers.pop(DialogOutcome::Cancelled, at(1)).is_none());
    }
}
