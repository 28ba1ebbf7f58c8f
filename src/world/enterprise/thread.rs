//! Threads: who said what when, which row is the last, and which row is alive.

use crate::canonical::canonical;
use crate::events::{Offering, Sender, ThreadKind};
use crate::identifiers::Group;

/// A negotiation with one company. Closed threads are forgotten; dead ones only once they stay silent.
#[derive(Debug, Clone, PartialEq)]
pub struct Thread {
    /// Running number, from 1.
    pub number: u32,
    /// The company.
    pub customer: u32,
    /// Its group.
    pub group: Group,
    /// How it began.
    pub kind: ThreadKind,
    /// Its turns; never empty.
    pub turns: Vec<Turn>,
    /// Accepted or rejected.
    pub closed: bool,
}

/// One turn, as far as the negotiation depends on it.
#[derive(Debug, Clone, PartialEq)]
pub struct Turn {
    /// Running number over all threads.
    pub message: u32,
    /// Number within the thread; the turns of one call may share one.
    pub number: u32,
    /// Who wrote it.
    pub sender: Sender,
    /// Day.
    pub day: u32,
    /// Offerings of the player.
    pub offerings: Vec<Offering>,
    /// Price that the company named, dollars a month and seat.
    pub asked: Option<f64>,
    /// Day on which the company answers.
    pub reply_day: Option<u32>,
    /// The thread died with this turn as its last.
    pub dead: bool,
}

canonical! {
    Thread { number, customer, group, kind, turns, closed }
    Turn { message, number, sender, day, offerings, asked, reply_day, dead }
}

impl Thread {
    /// The newest turn.
    pub fn last(&self) -> &Turn {
        self.turns.last().expect("a thread has a first turn")
    }

    /// The newest turn, to mark it.
    pub fn last_mut(&mut self) -> &mut Turn {
        self.turns.last_mut().expect("a thread has a first turn")
    }

    /// Whether both sides can still write.
    pub fn is_open(&self) -> bool {
        !self.closed && !self.last().dead
    }

    /// Whether the player is to write next.
    pub fn awaits_agent(&self) -> bool {
        self.is_open() && self.last().sender != Sender::Agent
    }

    /// The newest turn that did not die: what the daily step goes by. Death marks only the last turn, so a dead
    /// thread comes back with an older one unless `reappearing` says otherwise
    /// (`docs/mechanics/enterprise/thread.md#dead-threads-that-reappear`).
    pub fn live(&self, reappearing: bool) -> Option<&Turn> {
        if self.closed || (!reappearing && self.last().dead) {
            return None;
        }
        self.turns.iter().rev().find(|turn| !turn.dead)
    }

    /// The player's newest offerings.
    pub fn offerings(&self) -> &[Offering] {
        let offer = self.turns.iter().rev().find(|turn| turn.sender == Sender::Agent);
        offer.map_or(&[], |turn| &turn.offerings)
    }

    /// Turns of the player.
    pub fn agent_turns(&self) -> u32 {
        self.turns.iter().filter(|turn| turn.sender == Sender::Agent).count() as u32
    }

    /// Day of the customer's newest turn.
    pub fn customer_day(&self) -> Option<u32> {
        let customer = self.turns.iter().filter(|turn| turn.sender == Sender::Customer);
        customer.map(|turn| turn.day).max()
    }

    /// Price that the company named last.
    pub fn asked(&self) -> Option<f64> {
        self.turns.iter().rev().find_map(|turn| turn.asked)
    }

    /// Whether nothing can come of it any more after a day: it is closed, or dead and never fires again.
    pub(super) fn is_over(&self, day: u32, reappearing: bool) -> bool {
        if self.closed {
            return true;
        }
        self.last().dead
            && self.live(reappearing).is_none_or(|turn| {
                turn.sender == Sender::Agent && turn.reply_day.is_none_or(|reply| reply <= day)
            })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A thread from letters: s system, a agent, c customer; a capital one died.
    fn thread(letters: &str) -> Thread {
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
    fn dead_threads_come_back_with_an_older_turn() {
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
            let thread = thread(letters);
            assert!(!thread.is_open(), "{letters}");
            assert_eq!(thread.live(true).map(|turn| turn.sender), live, "{letters}");
            assert_eq!(thread.live(false), None, "{letters}");
            let silent = live.is_none_or(|sender| sender == Sender::Agent);
            assert_eq!(thread.is_over(50, true), silent, "{letters}");
            assert!(thread.is_over(50, false), "{letters}");
        }
    }

    #[test]
    fn a_repeated_offer_may_still_be_answered_after_death() {
        let mut thread = thread("saA");
        thread.turns[1].reply_day = Some(9);
        assert!(!thread.is_over(8, true) && thread.is_over(9, true));
    }

    #[test]
    fn open_threads_wait_for_one_side() {
        assert!(thread("s").awaits_agent() && thread("sac").awaits_agent());
        assert!(!thread("sa").awaits_agent() && thread("sa").is_open());
        assert_eq!((thread("sacaa").agent_turns(), thread("sacac").customer_day()), (3, Some(4)));
        assert_eq!(thread("sa").customer_day(), None);
    }
}
