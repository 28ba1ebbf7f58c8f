//! Negotiation threads with the information that is available to the player.

use std::collections::{BTreeMap, BTreeSet};

use novamind_base::formatting::dollars_and_cents;
use novamind_database::{Cell, QueryResult, number_at, text_at};
use novamind_rules::{LossCause, LostThread, Subscription, ThreadContext, Turn, first_plan_in};
use novamind_session::EnterpriseNames;
use novamind_session::identifiers::Plan;
use novamind_worker::screen_queries::Reading;

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ThreadState {
    /// The enterprise waits for the player, with this number of days left.
    WaitingForPlayer(u32),
    /// The player waits for the enterprise.
    WaitingForCustomer,
    Accepted,
    /// The player ended the thread.
    Rejected,
    /// The thread ended without a closing message. The subscription shows that the enterprise left, and the turns show
    /// who let the thread end.
    Lost(Option<LossCause>),
}

impl Default for ThreadState {
    fn default() -> ThreadState {
        ThreadState::Lost(None)
    }
}

impl ThreadState {
    /// Returns whether the thread accepts offers.
    pub fn is_open(self) -> bool {
        matches!(self, ThreadState::WaitingForPlayer(_) | ThreadState::WaitingForCustomer)
    }

    pub fn label(self) -> &'static str {
        match self {
            ThreadState::WaitingForPlayer(_) => "waiting for you",
            ThreadState::WaitingForCustomer => "awaiting reply",
            ThreadState::Accepted => "agreed",
            ThreadState::Rejected => "ended by you",
            ThreadState::Lost(Some(LossCause::Declined)) => "declined",
            ThreadState::Lost(Some(LossCause::Unanswered)) => "not answered",
            ThreadState::Lost(None) => "lost",
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
    /// Kind of the thread, as stored in the table of threads.
    pub kind: String,
    pub seats: f64,
    pub state: ThreadState,
    /// Messages of the thread, the oldest first.
    pub messages: Vec<Turn>,
    /// Fields that rules can use, while the thread waits for the player.
    pub waiting_thread: Option<ThreadContext>,
    /// How the thread was lost, if it was lost.
    pub loss: Option<LostThread>,
}

impl Thread {
    /// Returns the name and number of the enterprise.
    pub fn customer_label(&self) -> String {
        format!("{} #{}", self.name, self.customer)
    }

    pub fn kind_label(&self) -> &str {
        match self.kind.as_str() {
            "new_lead" => "new lead",
            "churn_prevention" => "retention",
            "plan_change" => "plan change",
            "renegotiation" => "new terms",
            other => other,
        }
    }

    /// Returns the last price that the enterprise named, and the plan if the message names a plan.
    pub fn asked_price(&self) -> Option<(Option<Plan>, f64)> {
        if let Some(thread_context) = &self.waiting_thread {
            return Some((thread_context.asked_plan, thread_context.waiting.asked?));
        }
        // The last message of an accepted thread repeats the price of the accepted offer.
        let asks = |turn: &&Turn| turn.price.is_some() && turn.closing_reason.is_empty();
        let turn = self.messages.iter().rev().find(asks)?;
        Some((first_plan_in(&turn.text).or_else(|| self.single_offered_plan()), turn.price?))
    }

    /// Returns the plan that belongs to the asked price, or the plan whose price the enterprise asks about.
    pub fn asked_plan(&self) -> Option<Plan> {
        match &self.waiting_thread {
            Some(thread_context) => thread_context.asked_plan,
            None => self.asked_price()?.0,
        }
    }

    fn single_offered_plan(&self) -> Option<Plan> {
        match self.last_offer() {
            [(plan, _)] => Some(*plan),
            _ => None,
        }
    }

    /// Returns the player's last offer.
    pub fn last_offer(&self) -> &[(Plan, f64)] {
        if let Some(thread_context) = &self.waiting_thread {
            return &thread_context.waiting.last_offer;
        }
        let thread_message = self.messages.iter().rev().find(|turn| !turn.offers.is_empty());
        thread_message.map_or(&[], |turn| &turn.offers)
    }
}

#[derive(Debug, Clone, Default, PartialEq)]
pub struct Enterprise {
    pub group: String,
    /// Size and industry of the enterprise.
    pub industry: String,
    /// Culture, decision process and main concern of the enterprise.
    pub traits: [String; 3],
    pub status: String,
    pub plan: String,
    /// Price in $ per seat per month.
    pub price: f64,
    /// Day on which the enterprise subscribed or asked for an offer.
    pub since_day: u32,
    /// Day on which the subscription ended.
    pub end_day: Option<u32>,
    /// Day of the last deal of a subscriber.
    pub deal_day: Option<u32>,
}

impl Enterprise {
    /// Describes the plan and the price of a subscriber, the day of the deal about them, and the first day of the
    /// subscription if it is earlier.
    pub fn describe_terms(&self) -> String {
        let terms = format!("plan {} at {}", self.plan, dollars_and_cents(self.price));
        match self.deal_day.filter(|day| *day > self.since_day) {
            Some(day) => format!("{terms} since the deal of day {day}; subscriber since day {}", self.since_day),
            None => format!("{terms} since day {}", self.since_day),
        }
    }

    fn subscription(&self) -> Subscription {
        Subscription {
            status: self.status.clone(),
            plan: Plan::parse(&self.plan),
            price: self.price,
            end_day: self.end_day,
        }
    }
}

#[derive(Debug, Clone, Default)]
pub struct ThreadStore {
    recorded: BTreeMap<u32, Thread>,
    enterprises: BTreeMap<u32, Enterprise>,
    /// Waiting threads by deadline, followed by all other threads, the newest first.
    pub threads: Vec<Thread>,
}

impl ThreadStore {
    pub fn apply_rows(&mut self, reading: Reading, rows: &QueryResult) {
        match reading {
            Reading::EnterpriseTurns => self.recorded = parse_threads(rows),
            Reading::Companies => self.enterprises = parse_enterprises(rows),
            _ => {}
        }
    }

    pub fn enterprise(&self, customer: u32) -> Option<&Enterprise> {
        self.enterprises.get(&customer)
    }

    /// Merges the threads that wait for the player into the list, and sorts the list. For `min_turns`, see
    /// [`LostThread::from_turns`].
    pub fn merge_waiting(
        &mut self,
        waiting: Vec<ThreadContext>,
        names: &EnterpriseNames,
        min_turns: Option<u32>,
    ) {
        let mut left = self.recorded.clone();
        let mut threads: Vec<Thread> = waiting
            .into_iter()
            .map(|thread_context| thread_from_waiting(thread_context, &mut left))
            .collect();
        // Only the newest thread of an enterprise can be open.
        let mut newest: BTreeSet<u32> = threads.iter().map(|thread| thread.customer).collect();
        for (_, mut thread) in left.into_iter().rev() {
            let firm = self.enterprises.get(&thread.customer);
            thread.group = firm.map_or(String::new(), |firm| firm.group.clone());
            let subscription = firm.map(Enterprise::subscription);
            thread.loss = subscription.and_then(|subscription| {
                LostThread::from_turns(&thread.messages, &thread.kind, &subscription, min_turns)
            });
            thread.state = closed_or_waiting_state(&thread);
            if !newest.insert(thread.customer) && thread.state == ThreadState::WaitingForCustomer {
                thread.state = ThreadState::Lost(None);
            }
            threads.push(thread);
        }
        for thread in &mut threads {
            thread.name = names.name(thread.customer);
            for turn in &mut thread.messages {
                turn.text = names.insert_names(&turn.text);
            }
            for fact in thread.loss.iter_mut().flat_map(|loss| &mut loss.facts) {
                *fact = names.insert_names(fact);
            }
        }
        self.threads = threads;
    }
}

fn thread_from_waiting(asking: ThreadContext, read: &mut BTreeMap<u32, Thread>) -> Thread {
    let waiting = &asking.waiting;
    let known = read.remove(&waiting.thread).unwrap_or_default();
    Thread {
        number: waiting.thread,
        customer: waiting.customer,
        name: String::new(),
        group: waiting.group.to_owned(),
        kind: waiting.kind.to_owned(),
        seats: f64::from(waiting.seats),
        state: ThreadState::WaitingForPlayer(waiting.days_left),
        messages: known.messages,
        waiting_thread: Some(asking),
        loss: None,
    }
}

/// Returns the state of a thread that does not wait for the player.
fn closed_or_waiting_state(thread: &Thread) -> ThreadState {
    let Some(last) = thread.messages.last() else { return ThreadState::Lost(None) };
    match (last.closing_reason.as_str(), &thread.loss) {
        ("accepted", _) => ThreadState::Accepted,
        ("agent_rejected", _) => ThreadState::Rejected,
        (_, Some(loss)) => ThreadState::Lost(Some(loss.cause)),
        (_, None) if last.sender == "agent" => ThreadState::WaitingForCustomer,
        (_, None) => ThreadState::Lost(None),
    }
}

fn parse_threads(rows: &QueryResult) -> BTreeMap<u32, Thread> {
    let mut threads: BTreeMap<u32, Thread> = BTreeMap::new();
    // The query result starts with the newest row.
    for row in rows.rows.iter().rev() {
        let number = number_at(row, 0) as u32;
        let thread = threads.entry(number).or_default();
        thread.number = number;
        thread.customer = number_at(row, 1) as u32;
        thread.kind = text_at(row, 2).to_owned();
        // Rows of the player contain a seat count of 1 instead of the enterprise's seat count.
        thread.seats = thread.seats.max(if text_at(row, 4) == "agent" { 1.0 } else { number_at(row, 8) });
        thread.messages.push(Turn::from_row(row));
    }
    threads
}

fn parse_enterprises(rows: &QueryResult) -> BTreeMap<u32, Enterprise> {
    let firm = |row: &Vec<Cell>| {
        let text = |at: usize| text_at(row, at).to_owned();
        let day = |at: usize| {
            row.get(at).filter(|cell| !matches!(cell, Cell::Null)).map(|_| number_at(row, at) as u32)
        };
        let trade = format!("{} {}", text_at(row, 3), text_at(row, 2)).trim().to_owned();
        let firm = Enterprise {
            group: text(1),
            industry: trade,
            traits: [text(4), text(5), text(6)],
            status: text(7),
            plan: text(8),
            price: number_at(row, 9),
            since_day: number_at(row, 10) as u32,
            end_day: day(11),
            deal_day: day(12),
        };
        (number_at(row, 0) as u32, firm)
    };
    rows.rows.iter().map(firm).collect()
}
