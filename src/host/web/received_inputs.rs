//! Numbers of the inputs that the host has received from each page, so that an input that is sent twice acts once.

use std::collections::HashMap;
use std::sync::{Mutex, MutexGuard, PoisonError};

/// Number of pages of a participant that are remembered.
const MAX_PAGES: usize = 8;

/// The last input of each page, by label.
#[derive(Debug, Default)]
pub(super) struct ReceivedInputs(Mutex<HashMap<String, Vec<Page>>>);

/// A page of a participant. The page that attached last is the last of its list.
#[derive(Debug)]
struct Page {
    client: String,
    /// Number of the last input.
    number: u64,
    /// Number of the session's process that received the input.
    process: u64,
}

impl ReceivedInputs {
    /// Begins the connection of a page. Returns the number of the last input that the page's process received, and whether
    /// the process is the one to which the page was connected before.
    pub fn begin(&self, label: &str, client: &str, process: u64, resume: bool) -> (u64, bool) {
        let mut all = self.lock();
        let pages = all.entry(label.to_owned()).or_default();
        let known =
            pages.iter().position(|page| page.client == client).map(|position| pages.remove(position));
        let number = known.as_ref().map_or(0, |page| page.number);
        let continues = known.as_ref().map_or(!resume, |page| page.process == process);
        if pages.len() == MAX_PAGES {
            pages.remove(0);
        }
        pages.push(Page { client: client.to_owned(), number, process });
        (number, continues)
    }

    /// Records an input. Returns whether it is new.
    pub fn is_new(&self, label: &str, client: &str, process: u64, number: u64) -> bool {
        let mut all = self.lock();
        let page = all.get_mut(label).and_then(|pages| pages.iter_mut().find(|page| page.client == client));
        let Some(page) = page.filter(|page| number > page.number) else { return false };
        (page.number, page.process) = (number, process);
        true
    }

    /// Returns whether no other page of the participant has attached after this page.
    pub fn is_latest_client(&self, label: &str, client: &str) -> bool {
        self.lock().get(label).and_then(|pages| pages.last()).is_some_and(|page| page.client == client)
    }

    fn lock(&self) -> MutexGuard<'_, HashMap<String, Vec<Page>>> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn inputs_that_are_sent_again_act_once() {
        let inputs = ReceivedInputs::default();
        assert_eq!(inputs.begin("P01", "a", 1, false), (0, true));
        assert!(inputs.is_new("P01", "a", 1, 1));
        assert!(inputs.is_new("P01", "a", 1, 2));
        assert_eq!(inputs.begin("P01", "a", 1, true), (2, true));
        assert!(!inputs.is_new("P01", "a", 1, 2));
        assert!(inputs.is_new("P01", "a", 1, 3));
        assert!(!inputs.is_new("P01", "never attached", 1, 9));
    }

    #[test]
    fn a_restarted_process_does_not_continue_a_page() {
        let inputs = ReceivedInputs::default();
        inputs.begin("P01", "a", 1, false);
        inputs.is_new("P01", "a", 1, 5);
        assert_eq!(inputs.begin("P01", "a", 2, true), (5, false));
        // The host was restarted and knows no page.
        assert_eq!(ReceivedInputs::default().begin("P01", "a", 1, true), (0, false));
    }

    #[test]
    fn a_page_keeps_its_numbers_while_another_page_is_attached() {
        let inputs = ReceivedInputs::default();
        inputs.begin("P01", "a", 1, false);
        inputs.is_new("P01", "a", 1, 7);
        inputs.begin("P01", "b", 1, false);
        assert!(!inputs.is_latest_client("P01", "a") && inputs.is_latest_client("P01", "b"));
        assert_eq!(inputs.begin("P01", "a", 1, false), (7, true));
        for page in 0..MAX_PAGES {
            inputs.begin("P01", &format!("page {page}"), 1, false);
        }
        assert_eq!(inputs.begin("P01", "a", 1, true), (0, false), "old pages are forgotten");
    }
}
