//! Negotiations with companies: who waits, what was said, and offers to one or to many by a rule.

mod draw;
mod estimate;
mod model;
mod offer;
mod post;
mod rows;
#[cfg(test)]
mod tests;

use std::collections::{BTreeMap, BTreeSet};

use crossterm::event::KeyEvent;
use ratatui::layout::Rect;

use self::estimate::Usage;
use self::model::{Letters, State, Thread};
use self::offer::{Choice, Offer, TERMS};
use self::rows::{columns, row_of};
use super::{Figure, Look, Screen, ScreenId, ScreenState};
use crate::console::action::{Action, Scope};
use crate::console::canvas::Canvas;
use crate::console::company::Company;
use crate::console::effect::Effect;
use crate::console::message::News;
use crate::console::readings::Reading;
use crate::console::widgets::Table;
use crate::console::widgets::field::{Field, ONLY_NUMBERS, parse_number};
use crate::session::Rows;
use crate::tools::ToolId;
use crate::world::identifiers::Group;

/// Panes.
const LIST: usize = 0;
const THREAD: usize = 1;
const OFFER: usize = 2;

/// Which threads are listed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
enum View {
    /// The player's move.
    #[default]
    Waiting,
    /// The companies' move.
    Theirs,
    /// Ended.
    Over,
}

impl View {
    fn holds(self, state: State) -> bool {
        match self {
            View::Waiting => matches!(state, State::Waiting(_)),
            View::Theirs => state == State::Theirs,
            View::Over => !state.is_open(),
        }
    }

    fn next(self) -> View {
        match self {
            View::Waiting => View::Theirs,
            View::Theirs => View::Over,
            View::Over => View::Waiting,
        }
    }
}

/// The screen.
#[derive(Default)]
pub struct Inbox {
    focus: usize,
    view: View,
    letters: Letters,
    /// What seats of companies use.
    usage: Usage,
    table: Table,
    /// Threads of the rows of the table, as places among all threads.
    rows: Vec<usize>,
    /// Threads that are marked, by number.
    marked: BTreeSet<u32>,
    /// Offers to single threads that were touched.
    drafts: BTreeMap<u32, Offer>,
    /// The rule for marked threads.
    rule: Option<Offer>,
    /// The last offer that was sent and makes sense for others.
    last: Option<Offer>,
    /// The term with the cursor.
    term: usize,
    /// Its value while it is typed.
    typing: Option<Field>,
    /// Rows that the thread is scrolled back, or the preview forward.
    scroll: u16,
}

impl Inbox {
    /// Builds the table again; the selected thread stays selected, or the one that followed it.
    fn refresh(&mut self, company: &Company) {
        let shown: Vec<u32> = self.table.shown().iter().filter_map(|row| self.number_of(*row)).collect();
        let here = self.here().map(|thread| thread.number);
        self.letters.settle(&company.seen.waiting);
        let threads = &self.letters.threads;
        let open =
            |number: &u32| threads.iter().any(|thread| thread.number == *number && thread.state.is_open());
        self.marked.retain(open);
        self.rows = (0..threads.len()).filter(|at| self.view.holds(threads[*at].state)).collect();
        let row = |at: &usize| row_of(&threads[*at], self.marked.contains(&threads[*at].number));
        let rows = self.rows.iter().map(row).collect();
        self.table.set(columns(self.view), rows);
        let from = here.and_then(|here| shown.iter().position(|number| *number == here)).unwrap_or(0);
        let next = shown.iter().skip(from).find_map(|number| self.row_of_number(*number));
        if let Some(row) = next {
            self.table.select(row);
        }
    }

    /// Shows a thread among those that wait.
    pub fn show(&mut self, number: u32, company: &Company) {
        self.view = View::Waiting;
        self.focus = LIST;
        self.typing = None;
        self.table.act(Action::Close, 0);
        self.refresh(company);
        if let Some(row) = self.row_of_number(number) {
            self.table.select(row);
        }
    }

    fn number_of(&self, row: usize) -> Option<u32> {
        self.letters.threads.get(*self.rows.get(row)?).map(|thread| thread.number)
    }

    fn row_of_number(&self, number: u32) -> Option<usize> {
        (0..self.rows.len()).find(|row| self.number_of(*row) == Some(number))
    }

    /// The selected thread.
    fn here(&self) -> Option<&Thread> {
        self.letters.threads.get(*self.rows.get(self.table.selected()?)?)
    }

    /// Threads that an offer goes to: the marked ones, or the selected one.
    fn targets(&self) -> Vec<&Thread> {
        if self.marked.is_empty() {
            return self.here().into_iter().collect();
        }
        let marked = |thread: &&Thread| self.marked.contains(&thread.number);
        self.letters.threads.iter().filter(marked).collect()
    }

    /// The offer on screen.
    fn offer(&self) -> Offer {
        if !self.marked.is_empty() {
            return self.rule.clone().unwrap_or_else(Offer::at_list);
        }
        let Some(thread) = self.here() else { return Offer::at_list() };
        let own = self.drafts.get(&thread.number).or(self.last.as_ref()).cloned();
        own.unwrap_or_else(|| Offer::first_for(thread))
    }

    fn set_offer(&mut self, offer: Offer) {
        match self.here().map(|thread| thread.number) {
            _ if !self.marked.is_empty() => self.rule = Some(offer),
            Some(number) => {
                self.drafts.insert(number, offer);
            }
            None => {}
        }
    }

    fn edit(&mut self, change: impl FnOnce(&mut offer::Term)) {
        let mut offer = self.offer();
        change(&mut offer.0[self.term.min(TERMS - 1)]);
        self.set_offer(offer);
    }

    fn commit(&mut self) -> Vec<Effect> {
        let Some(field) = self.typing.take() else { return Vec::new() };
        match parse_number(field.text()) {
            Some(value) => {
                self.edit(|term| {
                    term.value = value;
                    if term.plan == Choice::Nothing {
                        term.plan = Choice::Fixed(crate::world::identifiers::Plan::B);
                    }
                });
                Vec::new()
            }
            None if field.is_empty() => Vec::new(),
            None => vec![Effect::Complain(ONLY_NUMBERS.to_owned())],
        }
    }

    fn type_value(&mut self) {
        if self.here().is_some() {
            let value = self.offer().0[self.term.min(TERMS - 1)].value_in_words();
            self.typing = Some(Field::to_replace(value));
            self.focus = OFFER;
        }
    }

    fn mark(&mut self, all: bool) {
        let open = |row: &usize| {
            let thread = self.letters.threads.get(*self.rows.get(*row)?)?;
            thread.state.is_open().then_some(thread.number)
        };
        let rows: Vec<usize> =
            if all { self.table.shown().to_vec() } else { self.table.selected().into_iter().collect() };
        let numbers: Vec<u32> = rows.iter().filter_map(open).collect();
        let unmark = numbers.iter().all(|number| self.marked.contains(number));
        for number in numbers {
            if unmark {
                self.marked.remove(&number);
            } else {
                self.marked.insert(number);
            }
        }
        self.scroll = 0;
    }

    fn act_on_offer(&mut self, action: Action, lists: [f64; 3]) -> Vec<Effect> {
        match action {
            Action::Up | Action::CommitPrevious => self.term = self.term.saturating_sub(1),
            Action::Down | Action::CommitDown | Action::CommitNext => {
                self.term = (self.term + 1).min(TERMS - 1)
            }
            Action::First => self.term = 0,
            Action::Last => self.term = TERMS - 1,
            Action::Open => self.type_value(),
            Action::Right => self.turn_plan(),
            Action::Left => self.turn_basis(lists),
            Action::Close => self.focus = LIST,
            _ => {}
        }
        Vec::new()
    }

    fn turn_plan(&mut self) {
        self.edit(offer::Term::turn_plan);
    }

    fn turn_basis(&mut self, lists: [f64; 3]) {
        let term = self.offer().0[self.term.min(TERMS - 1)];
        let price = self.here().and_then(|thread| term.price(thread, lists)).map(|(_, price)| price);
        self.edit(|term| term.turn_basis(price));
    }

    fn act_on_thread(&mut self, action: Action, page: u16) {
        // A thread is read from its end, a preview from its start.
        let back = if self.marked.is_empty() { Action::Up } else { Action::Down };
        self.scroll = match action {
            Action::Up | Action::Down if action == back => self.scroll.saturating_add(1).min(500),
            Action::Up | Action::Down => self.scroll.saturating_sub(1),
            Action::PageUp | Action::PageDown if (action == Action::PageUp) == (back == Action::Up) => {
                self.scroll.saturating_add(page).min(500)
            }
            Action::PageUp | Action::PageDown => self.scroll.saturating_sub(page),
            Action::First | Action::Last => 0,
            _ => self.scroll,
        };
        if matches!(action, Action::Close) {
            self.focus = LIST;
        }
    }
}

/// List prices of the plans, dollars a month and seat.
fn list_prices(company: &Company) -> [f64; 3] {
    ["A", "B", "C"].map(|plan| company.setting(ToolId::SetPrices, plan))
}

impl ScreenState for Inbox {
    fn readings(&self) -> &'static [Reading] {
        &[Reading::EnterpriseTurns, Reading::Companies, Reading::Usage]
    }

    fn take(&mut self, reading: Reading, rows: &Rows, look: &Look<'_>) {
        if reading == Reading::Usage {
            self.usage = Usage::read(rows);
            return;
        }
        self.letters.take(reading, rows);
        self.refresh(look.company);
    }

    fn renew(&mut self, look: &Look<'_>) {
        self.refresh(look.company);
    }

    fn hear(&mut self, news: &News, look: &Look<'_>) -> Vec<Effect> {
        match news {
            News::Called(tool, Ok(answer), _) => {
                let effects = self.sent(*tool, answer);
                self.refresh(look.company);
                effects
            }
            _ => Vec::new(),
        }
    }

    fn holds_unsent_text(&self) -> bool {
        !self.drafts.is_empty() || (self.rule.is_some() && !self.marked.is_empty())
    }
}

impl Screen for Inbox {
    fn scopes(&self) -> Vec<Scope> {
        match (self.typing.is_some(), self.focus == LIST && self.table.is_typing()) {
            (true, _) => vec![Scope::Field, Scope::Inbox],
            (_, true) => vec![Scope::Field, Scope::List],
            _ => vec![Scope::Inbox, Scope::List],
        }
    }

    fn hints(&self) -> Vec<Action> {
        match self.focus {
            _ if self.typing.is_some() => vec![Action::Commit, Action::SendOffer, Action::Discard],
            LIST if self.table.is_typing() => vec![Action::Commit, Action::Discard],
            LIST => vec![
                Action::Open,
                Action::SendOffer,
                Action::TakeAsk,
                Action::Mark,
                Action::MarkAll,
                Action::RejectOffer,
                Action::OtherThreads,
                Action::Filter,
                Action::Sort,
                Action::InboxGroup,
                Action::InboxSql,
            ],
            _ => vec![
                Action::SendOffer,
                Action::OfferPlan,
                Action::OfferBasis,
                Action::OfferPrice,
                Action::TakeAsk,
                Action::Close,
            ],
        }
    }

    fn panes(&self) -> usize {
        3
    }

    fn focus(&self) -> usize {
        self.focus
    }

    fn set_focus(&mut self, pane: usize) {
        self.focus = pane.min(OFFER);
        self.typing = None;
    }

    fn figure(&self, _: &Look<'_>) -> Option<Figure> {
        let thread = self.here()?;
        let figure = match (self.focus, self.table.selected_column()) {
            (OFFER, _) => post::usage_figure(thread),
            (LIST, 5) => post::figure(thread, "seats of", "seats"),
            (LIST, 6) => post::figure(thread, "price asked by", "offer"),
            _ => post::figure(thread, "thread with", "thread"),
        };
        Some(figure)
    }

    fn act(&mut self, action: Action, look: &Look<'_>) -> Vec<Effect> {
        let lists = list_prices(look.company);
        if self.typing.is_some() {
            if action == Action::Discard {
                self.typing = None;
                return Vec::new();
            }
            let problem = self.commit();
            if !problem.is_empty() || action == Action::Commit {
                return problem;
            }
        }
        match action {
            Action::Mark | Action::MarkAll => {
                self.mark(action == Action::MarkAll);
                self.refresh(look.company);
                if action == Action::Mark {
                    self.table.act(Action::Down, look.page);
                }
            }
            Action::OtherThreads => {
                self.view = self.view.next();
                self.refresh(look.company);
                self.table.act(Action::First, look.page);
                self.scroll = 0;
            }
            Action::TakeAsk => {
                let targets = self.targets();
                if !targets.is_empty() && targets.iter().all(|thread| thread.asked().is_none()) {
                    return vec![Effect::Complain("no price has been asked yet: name one".to_owned())];
                }
                self.set_offer(Offer::as_asked());
            }
            Action::OfferPlan => self.turn_plan(),
            Action::OfferBasis => self.turn_basis(lists),
            Action::OfferPrice => self.type_value(),
            Action::SendOffer => return self.send(look.company),
            Action::RejectOffer => return self.reject(look.company),
            Action::InboxGroup => {
                let group = self.here().and_then(|thread| Group::parse(&thread.group));
                let shown = group.map(|group| Effect::ShowGroup(ScreenId::Customers, group));
                return shown.into_iter().collect();
            }
            Action::InboxSql => return self.here().map(post::statement).into_iter().collect(),
            action if self.focus == OFFER => return self.act_on_offer(action, lists),
            action if self.focus == THREAD => self.act_on_thread(action, look.page),
            Action::Open => self.focus = OFFER,
            action => {
                self.scroll = 0;
                self.table.act(action, look.page);
            }
        }
        Vec::new()
    }

    fn key(&mut self, key: &KeyEvent, _: &Look<'_>) -> Vec<Effect> {
        if let Some(field) = &mut self.typing {
            let taken = field.number_key(key);
            return if taken { Vec::new() } else { vec![Effect::Complain(ONLY_NUMBERS.to_owned())] };
        }
        self.table.edit_filter(|field| {
            field.key(key);
        });
        Vec::new()
    }

    fn paste(&mut self, text: &str, _: &Look<'_>) -> Vec<Effect> {
        if let Some(field) = &mut self.typing {
            field.insert(text);
        } else {
            self.table.edit_filter(|field| field.insert(text));
        }
        Vec::new()
    }

    fn click(&mut self, pane: usize, row: usize, _: &Look<'_>) -> Vec<Effect> {
        match pane {
            OFFER => {
                let again = self.term == row;
                self.term = row.min(TERMS - 1);
                if again {
                    self.type_value();
                }
            }
            LIST => {
                self.table.select_place(row);
                self.scroll = 0;
            }
            _ => {}
        }
        Vec::new()
    }

    fn draw(&self, canvas: &mut Canvas<'_>, area: Rect, look: &Look<'_>) {
        draw::draw(self, canvas, area, look);
    }
}
