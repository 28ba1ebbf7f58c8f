//! Threads of negotiations as the player may know them: what the rows say, and what they do not.

use std::collections::{BTreeMap, BTreeSet};

use novamind_worker::readings::Reading;
use novamind_rules::{AskingThread, offer_of, plan_in};
use novamind_database::{Rows, number_at, text_at};
use novamind_session::CompanyNames;
use novamind_session::identifiers::Plan;

/// One row of a thread.
#[derive(Debug, Clone, PartialEq)]
pub struct Turn {
    /// Number in its thread.
    pub number: u32,
    /// `customer`, `agent` or `system`.
    pub sender: String,
    /// Words; empty for offers.
    pub text: String,
    /// What the player offered.
    pub offers: Vec<(Plan, f64)>,
    /// Price that the company named.
    pub price: Option<f64>,
    /// Day it was written.
    pub day: u32,
    /// Why it closed the thread; empty otherwise.
    pub closes: String,
}

/// Whose move it is, or how a thread ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum State {
    /// The company waits for the player, who has some days left.
    Waiting(u32),
    /// The player waits for the company.
    Theirs,
    /// They agreed.
    Accepted,
    /// The player ended it.
    Rejected,
    /// The company fell silent or was not answered. No row says so; its subscription does.
    #[default]
    Lost,
}

impl State {
    /// Whether an offer goes into the thread.
    pub fn is_open(self) -> bool {
        matches!(self, State::Waiting(_) | State::Theirs)
    }

    /// In words.
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

/// A thread.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Thread {
    /// Its number.
    pub number: u32,
    /// The company.
    pub customer: u32,
    /// Its name.
    pub name: String,
    /// Group of the company.
    pub group: String,
    /// How it began, as the table says it.
    pub kind: String,
    /// Whole seats.
    pub seats: f64,
    /// Whose move it is.
    pub state: State,
    /// Its rows, the oldest first.
    pub turns: Vec<Turn>,
    /// What rules see of it while it waits for the player.
    pub asking: Option<AskingThread>,
}

impl Thread {
    /// The company by its name and number.
    pub fn company(&self) -> String {
        format!("{} #{}", self.name, self.customer)
    }

    /// Kind in words.
    pub fn kind_in_words(&self) -> &str {
        match self.kind.as_str() {
            "new_lead" => "new lead",
            "churn_prevention" => "retention",
            "plan_change" => "plan change",
            "renegotiation" => "new terms",
            other => other,
        }
    }

    /// Price that the company named last, and the plan its words name with it.
    pub fn asked(&self) -> Option<(Option<Plan>, f64)> {
        if let Some(own) = &self.asking {
            return Some((own.asked_plan, own.waiting.asked?));
        }
        let turn = self.turns.iter().rev().find(|turn| turn.price.is_some())?;
        Some((plan_in(&turn.text).or_else(|| self.only_offer()), turn.price?))
    }

    /// The plan that its price is for, or whose price it asks.
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

    /// How a thread that came to nothing ended; none while it is open, and where a row of it says so.
    pub fn end_in_words(&self) -> Option<String> {
        if self.state != State::Lost {
            return None;
        }
        let last = self.turns.last()?;
        Some(match last.sender.as_str() {
            "agent" => {
                let offers = super::offer::in_words(&last.offers);
                format!("{} declined {offers} of day {} without another word.", self.company(), last.day)
            }
            _ => format!("{} got no answer to its message of day {}.", self.company(), last.day),
        })
    }

    /// What the player offered last.
    pub fn offered(&self) -> &[(Plan, f64)] {
        if let Some(own) = &self.asking {
            return &own.waiting.last_offer;
        }
        let own = self.turns.iter().rev().find(|turn| !turn.offers.is_empty());
        own.map_or(&[], |turn| &turn.offers)
    }
}

/// A company.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Firm {
    /// Group.
    pub group: String,
    /// Size and trade.
    pub trade: String,
    /// Culture, way to decide, concern.
    pub manner: [String; 3],
    /// State of its subscription.
    pub status: String,
    /// Its plan.
    pub plan: String,
    /// What it pays for a seat and month.
    pub price: f64,
    /// Day since which it subscribes, or asked.
    pub since: u32,
}

/// Every thread that was read.
#[derive(Debug, Clone, Default)]
pub struct Letters {
    read: BTreeMap<u32, Thread>,
    firms: BTreeMap<u32, Firm>,
    /// Threads: those that wait first, in the order in which they are lost, then the newest.
    pub threads: Vec<Thread>,
}

impl Letters {
    /// Takes what the database answered.
    pub fn take(&mut self, reading: Reading, rows: &Rows) {
        match reading {
            Reading::EnterpriseTurns => self.read = threads_of(rows),
            Reading::Companies => self.firms = firms_of(rows),
            _ => {}
        }
    }

    /// The company of a thread.
    pub fn firm(&self, customer: u32) -> Option<&Firm> {
        self.firms.get(&customer)
    }

    /// Brings threads and those that wait together.
    pub fn settle(&mut self, waiting: Vec<AskingThread>, names: &CompanyNames) {
        let mut left = self.read.clone();
        let mut threads: Vec<Thread> = waiting.into_iter().map(|own| of_waiting(own, &mut left)).collect();
        // A company has one open thread at the most, its newest.
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

/// State of a thread that does not wait for the player.
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
    // The answer begins with the newest row.
    for row in rows.rows.iter().rev() {
        let number = number_at(row, 0) as u32;
        let thread = threads.entry(number).or_default();
        let (offers, price) = offer_of(text_at(row, 6));
        thread.number = number;
        thread.customer = number_at(row, 1) as u32;
        thread.kind = text_at(row, 2).to_owned();
        // Rows of the player count one seat, whatever the company has.
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
