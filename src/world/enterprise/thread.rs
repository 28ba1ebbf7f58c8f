//! Threads, their turns, and the turn that determines the next step.

use crate::canonical::canonical;
use crate::events::{Offering, Sender, ThreadKind};
use crate::identifiers::Group;

/// A negotiation with one enterprise. A closed thread is removed immediately. A dead thread is removed when it can no
/// longer trigger.
#[derive(Debug, Clone, PartialEq)]
pub struct Thread {
    /// Number of the thread among all threads of the run, from 1.
    pub number: u32,
    /// Customer number of the enterprise.
    pub customer: u32,
    /// Group of the enterprise.
    pub group: Group,
    /// Reason why the thread was opened.
    pub kind: ThreadKind,
    /// Turns of the thread; never empty.
    pub turns: Vec<Turn>,
    /// Whether an offer was accepted or the player rejected the thread.
    pub closed: bool,
}

/// The part of a turn that affects the negotiation.
#[derive(Debug, Clone, PartialEq)]
pub struct Turn {
    /// Number of the turn among the turns of all threads.
    pub message: u32,
    /// Number of the turn within the thread. Turns of the same tool call can have the same number.
    pub number: u32,
    /// Side that added the turn: the system, the enterprise or the player.
    pub sender: Sender,
    /// Day on which the turn was added.
    pub day: u32,
    /// Offerings that the player sent in this turn; empty in other turns.
    pub offerings: Vec<Offering>,
    /// Price that the enterprise named in this turn, dollars per seat per month.
    pub asked: Option<f64>,
    /// Day on which the enterprise replies to this turn; `None` if no reply is due.
    pub reply_day: Option<u32>,
    /// Whether the thread died while this turn was the last turn.
    pub dead: bool,
}

canonical! {
    Thread { number, customer, group, kind, turns, closed }
    Turn { message, number, sender, day, offerings, asked, reply_day, dead }
}

impl Thread {
    /// Returns the newest turn of the thread.
    pub fn last(&self) -> &Turn {
        self.turns.last().expect("a thread has a first turn")
    }

    /// Returns a mutable reference to the newest turn.
    pub fn last_mut(&mut self) -> &mut Turn {
        self.turns.last_mut().expect("a thread has a first turn")
    }

    /// Returns whether the thread is neither closed nor dead.
    pub fn is_open(&self) -> bool {
        !self.closed && !self.last().dead
    }

    /// Returns whether the thread is open and waits for a message of the player.
    pub fn awaits_player(&self) -> bool {
        self.is_open() && self.last().sender != Sender::Agent
    }

    /// Returns the newest turn that is not dead. This turn determines the next step of the thread. Only the last turn
    /// is marked dead, so a dead thread reappears with an older turn, unless `reappearing` is false
    /// (`docs/mechanics/enterprise/thread.md#dead-threads-that-reappear`).
    pub fn active_turn(&self, reappearing: bool) -> Option<&Turn> {
        if self.closed || (!reappearing && self.last().dead) {
            return None;
        }
        self.turns.iter().rev().find(|turn| !turn.dead)
    }

    /// Returns the offerings in the player's newest turn.
    pub fn last_offerings(&self) -> &[Offering] {
        let offer = self.turns.iter().rev().find(|turn| turn.sender == Sender::Agent);
        offer.map_or(&[], |turn| &turn.offerings)
    }

    /// Returns the number of turns by the player.
    pub fn player_turn_count(&self) -> u32 {
        self.turns.iter().filter(|turn| turn.sender == Sender::Agent).count() as u32
    }

    /// Returns the day of the customer's newest turn, or `None` if the customer has not written.
    pub fn last_customer_day(&self) -> Option<u32> {
        let customer = self.turns.iter().filter(|turn| turn.sender == Sender::Customer);
        customer.map(|turn| turn.day).max()
    }

    /// Returns the asked price, which is the last price that the enterprise named, or `None` if it named no price.
    pub fn last_asked_price(&self) -> Option<f64> {
        self.turns.iter().rev().find_map(|turn| turn.asked)
    }

    /// Returns whether the thread has no effect after `day`, because it is closed or because it is dead and cannot
    /// trigger again.
    pub(super) fn is_finished(&self, day: u32, reappearing: bool) -> bool {
        if self.closed {
            return true;
        }
        self.last().dead
            && self.active_turn(reappearing).is_none_or(|turn| {
                turn.sender == Sender::Agent && turn.reply_day.is_none_or(|reply| reply <= day)
            })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Builds a thread from letters: s system, a agent, c customer; an uppercase letter is a dead turn.
    fn thread_from_letters(letters: &str) -> Thread {
        let turn = |(number, letter): (usize, char)| Turn {
            message: number as u32,
            number: number as u32,
            sender: match letter.to_ascii_lowercase() {
                's' => Sender::System,
                'a' => Sender::Agent,
                _ => Sender::Customer,
            },
            day: number as u32,
            offerings: Vec::new(),
            asked: None,
            reply_day: None,
            dead: letter.is_ascii_uppercase(),
        };
        Thread {
            number: 1,
            customer: 2,
            group: Group::parse("E1").expect("a group"),
            kind: ThreadKind::NewLead,
            turns: letters.chars().enumerate().map(turn).collect(),
            closed: false,
        }
    }

    #[test]
    fn dead_threads_reappear_with_an_older_turn() {
        for (letters, live) in [
            ("S", None),
            ("sA", Some(Sender::System)),
            ("sacA", Some(Sender::Customer)),
            ("saC", Some(Sender::Agent)),
            ("sC", Some(Sender::System)),
            ("scA", Some(Sender::Customer)),
            ("acA", Some(Sender::Customer)),
            ("sacaC", Some(Sender::Agent)),
            ("A", None),
            ("saA", Some(Sender::Agent)),
        ] {
            let thread = thread_from_letters(letters);
            assert!(!thread.is_open(), "{letters}");
            assert_eq!(thread.active_turn(true).map(|turn| turn.sender), live, "{letters}");
            assert_eq!(thread.active_turn(false), None, "{letters}");
            let silent = live.is_none_or(|sender| sender == Sender::Agent);
            assert_eq!(thread.is_finished(50, true), silent, "{letters}");
            assert!(thread.is_finished(50, false), "{letters}");
        }
    }

    #[test]
    fn repeated_offer_can_be_answered_after_thread_death() {
        let mut thread = thread_from_letters("saA");
        thread.turns[1].reply_day = Some(9);
        assert!(!thread.is_finished(8, true) && thread.is_finished(9, true));
    }

    #[test]
    fn open_threads_await_one_side() {
        assert!(thread_from_letters("s").awaits_player() && thread_from_letters("sac").awaits_player());
        assert!(!thread_from_letters("sa").awaits_player() && thread_from_letters("sa").is_open());
        assert_eq!(
            (
                thread_from_letters("sacaa").player_turn_count(),
                thread_from_letters("sacac").last_customer_day()
            ),
            (3, Some(4))
        );
        assert_eq!(thread_from_letters("sa").last_customer_day(), None);
    }
}
