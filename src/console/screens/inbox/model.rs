//! Negotiation threads with the information that the player may have.

use std::collections::{BTreeMap, BTreeSet};

use novamind_database::{Rows, number_at, text_at};
use novamind_rules::{AskingThread, offer_of, plan_in};
use novamind_session::CompanyNames;
use novamind_session::identifiers::Plan;
use novamind_worker::readings::Reading;

#[derive(Debug, Clone, PartialEq)]
pub struct Turn {
    pub number: u32,
    /// `customer`, `agent` or `system`.
    pub sender: String,
    /// Message; empty for offers.
    pub text: String,
    /// Plans and prices that the player offered.
    pub offers: Vec<(Plan, f64)>,
    pub price: Option<f64>,
    pub day: u32,
    /// Reason for closing the thread; empty if it stays open.
    pub closes: String,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum State {
    /// The enterprise waits for the player, for this number of days.
    Waiting(u32),
    /// The player waits for the enterprise.
    Theirs,
    Accepted,
    /// The player ended it.
    Rejected,
    /// It ended without a closing row: the subscription shows that the enterprise left.
    #[default]
    Lost,
}

impl State {
    /// Returns whether it accepts offers.
    pub fn is_open(self) -> bool {
        matches!(self, State::Waiting(_) | State::Theirs)
    }

    pub fn words(self) -> &'static str {
        match self {
            State::Waiting(_) => "waiting for you",
            State::Theirs => "waiting for them",
            State::Accepted => "agreed",
            State::Rejected => "ended by you",
            State::Lost => "lost",
        }
    }
}

#[derive(Debug, Clone, Default, PartialEq)]
pub struct Thread {
    pub number: u32,
    /// Customer number of the enterprise.
    pub customer: u32,
    pub name: String,
    pub group: String,
    /// Kind as in the table.
    pub kind: String,
    pub seats: f64,
    pub state: State,
    /// Its rows, oldest first.
    pub turns: Vec<Turn>,
    /// Fields for rules, while it waits for the player.
    pub asking: Option<AskingThread>,
}

impl Thread {
    /// Returns the name and number of the enterprise.
    pub fn company(&self) -> String {
        format!("{} #{}", self.name, self.customer)
    }

    pub fn kind_in_words(&self) -> &str {
        match self.kind.as_str() {
            "new_lead" => "new lead",
            "churn_prevention" => "retention",
            "plan_change" => "plan change",
            "renegotiation" => "new terms",
            other => other,
        }
    }

    /// Returns the last price that the enterprise named, with the plan if its message names one.
    pub fn asked(&self) -> Option<(Option<Plan>, f64)> {
        if let Some(own) = &self.asking {
            return Some((own.asked_plan, own.waiting.asked?));
        }
        let turn = self.turns.iter().rev().find(|turn| turn.price.is_some())?;
        Some((plan_in(&turn.text).or_else(|| self.only_offer()), turn.price?))
    }

    /// Returns the plan for its price, or the plan whose price it asks about.
    pub fn asked_plan(&self) -> Option<Plan> {
        match &self.asking {
            Some(own) => own.asked_plan,
            None => self.asked()?.0,
        }
    }

    fn only_offer(&self) -> Option<Plan> {
        match self.offered() {
            [(plan, _)] => Some(*plan),
            _ => None,
        }
    }

    /// Describes how a failed thread ended; `None` if it is open or one of its rows says so.
    pub fn end_in_words(&self) -> Option<String> {
        if self.state != State::Lost {
            return None;
        }
        let last = self.turns.last()?;
        Some(match last.sender.as_str() {
            "agent" => {
                let offers = super::offer::in_words(&last.offers);
                format!("{} declined {offers} of day {} without giving a reason.", self.company(), last.day)
            }
            _ => format!("{} got no answer to its message of day {}.", self.company(), last.day),
        })
    }

    /// Returns the player's last offer.
    pub fn offered(&self) -> &[(Plan, f64)] {
        if let Some(own) = &self.asking {
            return &own.waiting.last_offer;
        }
        let own = self.turns.iter().rev().find(|turn| !turn.offers.is_empty());
        own.map_or(&[], |turn| &turn.offers)
    }
}

#[derive(Debug, Clone, Default, PartialEq)]
pub struct Firm {
    pub group: String,
    /// Size and industry.
    pub trade: String,
    /// Culture, decision process and main concern.
    pub manner: [String; 3],
    pub status: String,
    pub plan: String,
    /// Price per seat and month.
    pub price: f64,
    /// Day on which it subscribed or asked.
    pub since: u32,
}

#[derive(Debug, Clone, Default)]
pub struct Letters {
    read: BTreeMap<u32, Thread>,
    firms: BTreeMap<u32, Firm>,
    /// Waiting threads first, by deadline, then the others, newest first.
    pub threads: Vec<Thread>,
}

impl Letters {
    pub fn take(&mut self, reading: Reading, rows: &Rows) {
        match reading {
            Reading::EnterpriseTurns => self.read = threads_of(rows),
            Reading::Companies => self.firms = firms_of(rows),
            _ => {}
        }
    }

    pub fn firm(&self, customer: u32) -> Option<&Firm> {
        self.firms.get(&customer)
    }

    /// Combines the threads with the waiting ones and sorts them.
    pub fn settle(&mut self, waiting: Vec<AskingThread>, names: &CompanyNames) {
        let mut left = self.read.clone();
        let mut threads: Vec<Thread> = waiting.into_iter().map(|own| of_waiting(own, &mut left)).collect();
        // An enterprise has at most one open thread, its newest.
        let mut newest: BTreeSet<u32> = threads.iter().map(|thread| thread.customer).collect();
        for (_, mut thread) in left.into_iter().rev() {
            let firm = self.firms.get(&thread.customer);
            thread.group = firm.map_or(String::new(), |firm| firm.group.clone());
            thread.state = state_of(&thread, firm);
            if !newest.insert(thread.customer) && thread.state == State::Theirs {
                thread.state = State::Lost;
            }
            threads.push(thread);
        }
        for thread in &mut threads {
            thread.name = names.of(thread.customer);
            for turn in &mut thread.turns {
                turn.text = names.put_into(&turn.text);
            }
        }
        self.threads = threads;
    }
}

fn of_waiting(asking: AskingThread, read: &mut BTreeMap<u32, Thread>) -> Thread {
    let waiting = &asking.waiting;
    let known = read.remove(&waiting.thread).unwrap_or_default();
    Thread {
        number: waiting.thread,
        customer: waiting.customer,
        name: String::new(),
        group: waiting.group.to_owned(),
        kind: waiting.kind.to_owned(),
        seats: f64::from(waiting.seats),
        state: State::Waiting(waiting.days_left),
        turns: known.turns,
        asking: Some(asking),
    }
}

/// Returns the state of a thread that does not wait for the player.
fn state_of(thread: &Thread, firm: Option<&Firm>) -> State {
    let Some(last) = thread.turns.last() else { return State::Lost };
    let there = firm.is_none_or(|firm| matches!(firm.status.as_str(), "lead" | "subscribed"));
    match (last.closes.as_str(), last.sender.as_str()) {
        ("accepted", _) => State::Accepted,
        ("agent_rejected", _) => State::Rejected,
        (_, "agent") if there => State::Theirs,
        _ => State::Lost,
    }
}

fn threads_of(rows: &Rows) -> BTreeMap<u32, Thread> {
    let mut threads: BTreeMap<u32, Thread> = BTreeMap::new();
    // The reading is sorted newest first.
    for row in rows.rows.iter().rev() {
        let number = number_at(row, 0) as u32;
        let thread = threads.entry(number).or_default();
        let (offers, price) = offer_of(text_at(row, 6));
        thread.number = number;
        thread.customer = number_at(row, 1) as u32;
        thread.kind = text_at(row, 2).to_owned();
        // The player's rows have a seat count of 1.
        thread.seats = thread.seats.max(if text_at(row, 4) == "agent" { 1.0 } else { number_at(row, 8) });
        thread.turns.push(Turn {
            number: number_at(row, 3) as u32,
            sender: text_at(row, 4).to_owned(),
            text: text_at(row, 5).to_owned(),
            offers,
            price,
            day: number_at(row, 7) as u32,
            closes: text_at(row, 9).to_owned(),
        });
    }
    threads
}

fn firms_of(rows: &Rows) -> BTreeMap<u32, Firm> {
    let firm = |row: &Vec<novamind_database::Cell>| {
        let text = |at: usize| text_at(row, at).to_owned();
        let trade = format!("{} {}", text_at(row, 3), text_at(row, 2)).trim().to_owned();
        let firm = Firm {
            group: text(1),
            trade,
            manner: [text(4), text(5), text(6)],
            status: text(7),
            plan: text(8),
            price: number_at(row, 9),
            since: number_at(row, 10) as u32,
        };
        (number_at(row, 0) as u32, firm)
    };
    rows.rows.iter().map(firm).collect()
}
