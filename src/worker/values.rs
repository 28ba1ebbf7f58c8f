//! True values of a day, for the screens that show them beside figures and estimates.

use std::sync::Arc;

use super::SessionThread;
use crate::message::News;
use novamind_insight::Inspect;

impl SessionThread {
    /// Looks at the true values of a day, and says what was seen or why nothing is shown.
    pub(super) fn read_hidden_values(&mut self, day: u32) {
        let found =
            self.session_to_look_into(false).and_then(|session| session.inspect().hidden_values(Some(day)));
        // A line that the disk refuses is noticed as after any other work.
        self.with_run(|_| None);
        self.say(News::HiddenValues(Box::new(found.map(Arc::new))));
    }
}
