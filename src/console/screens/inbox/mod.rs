//! Negotiations with enterprises: waiting threads, messages, and offers to one enterprise or, by a rule, to
//! many.

mod estimate;
mod list;
mod model;
mod offer;
mod offer_pane;
mod outcomes;
mod post;
mod preview;
mod ruling;
#[cfg(test)]
mod tests;
mod thread;

use std::collections::{BTreeMap, BTreeSet};

use ratatui::layout::{Constraint, Layout, Rect};

use self::estimate::market_of;
use self::list::{columns, row_of};
use self::model::{Letters, State, Thread};
use self::offer::{Offer, TERMS, TermChoice};
use self::outcomes::Outcomes;
use self::ruling::Ruling;
use super::ScreenState;
use super::panes::{Pane, Paned, draw_pane};
use crate::action::Action;
use crate::context::{Look, ScreenId};
use crate::effect::Effect;
use novamind_base::notation::parse_number;
use novamind_database::Rows;
use novamind_rules::{AskingThread, SeatUsage};
use novamind_session::identifiers::Group;
use novamind_tools::ToolId;
use novamind_tui::canvas::{Canvas, Click};
use novamind_tui::widgets::Table;
use novamind_tui::widgets::field::{Field, ONLY_NUMBERS};
use novamind_worker::company::Company;
use novamind_worker::message::News;
use novamind_worker::readings::Reading;

/// Panes of the screen.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum InboxPane {
    /// Threads of a view.
    #[default]
    List,
    /// Messages of the thread, or the preview of a bulk offer.
    Thread,
    /// The offer being edited.
    Offer,
    /// Outcomes of first offers, in place of the list.
    Outcomes,
}

/// Panes in tab order: with the list of threads, and with the outcomes.
const LISTED: [InboxPane; 3] = [InboxPane::List, InboxPane::Thread, InboxPane::Offer];
const COUNTED: [InboxPane; 3] = [InboxPane::Outcomes, InboxPane::Thread, InboxPane::Offer];

/// Footer actions for a single thread.
const OFFER_HINTS: [Action; 6] = [
    Action::SendOffer,
    Action::OfferPlan,
    Action::OfferBasis,
    Action::OfferPrice,
    Action::TakeAsk,
    Action::Close,
];

/// Actions that need a thread.
const NEEDS_A_THREAD: [Action; 8] = [
    Action::Mark,
    Action::MarkAll,
    Action::TakeAsk,
    Action::OfferPlan,
    Action::OfferBasis,
    Action::OfferPrice,
    Action::InboxGroup,
    Action::InboxSql,
];
const NO_THREAD: &str = "No thread is selected";

const OFFER_HEIGHT: u16 = 10;

#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
enum InboxView {
    /// The player must answer.
    #[default]
    Waiting,
    /// The enterprise must answer.
    Theirs,
    Over,
}

impl InboxView {
    fn holds(self, state: State) -> bool {
        match self {
            InboxView::Waiting => matches!(state, State::Waiting(_)),
            InboxView::Theirs => state == State::Theirs,
            InboxView::Over => !state.is_open(),
        }
    }

    fn next(self) -> InboxView {
        match self {
            InboxView::Waiting => InboxView::Theirs,
            InboxView::Theirs => InboxView::Over,
            InboxView::Over => InboxView::Waiting,
        }
    }
}

/// The inbox screen.
#[derive(Default)]
pub struct Inbox {
    focus: InboxPane,
    view: InboxView,
    letters: Letters,
    usage: SeatUsage,
    /// Plans that enterprises named with their prices.
    named: novamind_rules::Letters,
    ruling: Option<Ruling>,
    /// Outcomes of first offers, while they replace the list.
    outcomes: Option<Outcomes>,
    last_rules: Option<String>,
    table: Table,
    /// Indexes of the listed threads among all threads.
    rows: Vec<usize>,
    marked: BTreeSet<u32>,
    drafts: BTreeMap<u32, Offer>,
    /// Offer to the marked threads.
    rule: Option<Offer>,
    /// Last sent offer that can be reused for other enterprises.
    last: Option<Offer>,
    term: usize,
    /// Its value while the user types.
    typing: Option<Field>,
    /// Rows scrolled: backwards in a thread, forwards in a preview.
    scroll: u16,
}

impl Inbox {
    fn refresh(&mut self, company: &Company) {
        let place = self.place();
        self.letters.settle(self.asking(company), &company.names);
        let threads = self.letters.threads.iter();
        let open: BTreeSet<u32> =
            threads.filter(|thread| thread.state.is_open()).map(|thread| thread.number).collect();
        self.marked.retain(|number| open.contains(number));
        self.list(place);
    }

    /// Returns the numbers of the listed threads, and of the selected one.
    fn place(&self) -> (Vec<u32>, Option<u32>) {
        let shown = self.table.shown().iter().filter_map(|row| self.number_of(*row)).collect();
        (shown, self.here().map(|thread| thread.number))
    }

    /// Rebuilds the table. The selection stays on its thread or moves to the next one.
    fn list(&mut self, (shown, here): (Vec<u32>, Option<u32>)) {
        let threads = &self.letters.threads;
        self.rows = (0..threads.len()).filter(|at| self.view.holds(threads[*at].state)).collect();
        let row = |at: &usize| row_of(&threads[*at], self.marked.contains(&threads[*at].number));
        let rows = self.rows.iter().map(row).collect();
        self.table.set(columns(self.view), rows);
        let from = here.and_then(|here| shown.iter().position(|number| *number == here)).unwrap_or(0);
        let rows = self.rows.iter().enumerate().map(|(row, at)| (self.letters.threads[*at].number, row));
        let rows: BTreeMap<u32, usize> = rows.collect();
        if let Some(row) = shown.iter().skip(from).find_map(|number| rows.get(number)) {
            self.table.select(*row);
        }
    }

    /// Returns the waiting threads with all fields that rules use.
    fn asking(&self, company: &Company) -> Vec<AskingThread> {
        let market = market_of(company, &self.usage);
        let waiting = company.seen.waiting.iter();
        waiting.map(|own| AskingThread::of(own, &self.named, &market)).collect()
    }

    /// Selects a waiting thread.
    pub fn show(&mut self, number: u32, company: &Company) {
        self.view = InboxView::Waiting;
        self.close_outcomes();
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

    fn here(&self) -> Option<&Thread> {
        self.letters.threads.get(*self.rows.get(self.table.selected()?)?)
    }

    /// Returns the recipients of an offer: the marked threads, otherwise the selected one.
    fn targets(&self) -> Vec<&Thread> {
        if self.marked.is_empty() {
            return self.here().into_iter().collect();
        }
        let marked = |thread: &&Thread| self.marked.contains(&thread.number);
        self.letters.threads.iter().filter(marked).collect()
    }

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
                    if term.plan == TermChoice::Nothing {
                        term.plan = TermChoice::Fixed(novamind_session::identifiers::Plan::B);
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
            self.focus = InboxPane::Offer;
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

    fn turn_plan(&mut self) {
        self.edit(offer::Term::turn_plan);
    }

    fn turn_basis(&mut self, lists: [f64; 3]) {
        let term = self.offer().0[self.term.min(TERMS - 1)];
        let price = self.here().and_then(|thread| term.price(thread, lists)).map(|(_, price)| price);
        self.edit(|term| term.turn_basis(price));
    }
}

/// Returns the list prices of the plans, $ per month and seat.
fn list_prices(company: &Company) -> [f64; 3] {
    ["A", "B", "C"].map(|plan| company.setting(ToolId::SetPrices, plan))
}

impl ScreenState for Inbox {
    fn open_here(&self, _: &Look<'_>) -> Option<String> {
        match self.focus {
            InboxPane::Outcomes => Some("outcomes".to_owned()),
            _ => self.here().map(|thread| format!("#{}", thread.customer)),
        }
    }

    fn opened(&self) -> usize {
        usize::from(self.outcomes.is_some()) + usize::from(self.focus != self.first_pane())
    }

    fn readings(&self) -> &'static [Reading] {
        match self.outcomes {
            Some(_) => &outcomes::READINGS,
            None => &[Reading::EnterpriseTurns, Reading::Companies, Reading::Usage, Reading::LastLetters],
        }
    }

    fn take(&mut self, reading: Reading, rows: &Rows, look: &Look<'_>) {
        match reading {
            Reading::FirstOffers => {
                self.outcomes.iter_mut().for_each(|own| own.take(rows));
                return;
            }
            Reading::Usage => self.usage = SeatUsage::read(rows),
            Reading::LastLetters => self.named = novamind_rules::Letters::read(rows),
            _ => self.letters.take(reading, rows),
        }
        self.refresh(look.company);
    }

    fn renew(&mut self, look: &Look<'_>) {
        self.refresh(look.company);
    }

    fn hear(&mut self, news: &News, look: &Look<'_>) -> Vec<Effect> {
        match news {
            News::Called(_, Ok(answer), _) => {
                let effects = self.sent(answer);
                self.ruling = None;
                self.refresh(look.company);
                effects
            }
            _ => Vec::new(),
        }
    }

    fn open_object(&self, _: &Look<'_>) -> Option<(&'static str, String)> {
        Some(("thread", self.here()?.number.to_string()))
    }

    fn holds_unsent_text(&self) -> bool {
        !self.drafts.is_empty() || (self.rule.is_some() && !self.marked.is_empty())
    }
}

impl Paned for Inbox {
    type Name = InboxPane;

    fn panes(&self) -> &'static [InboxPane] {
        if self.outcomes.is_some() { &COUNTED } else { &LISTED }
    }

    fn pane(name: InboxPane) -> &'static dyn Pane<Inbox> {
        match name {
            InboxPane::List => &list::ThreadListPane,
            InboxPane::Thread => &thread::ThreadPane,
            InboxPane::Offer => &offer_pane::OfferPane,
            InboxPane::Outcomes => &outcomes::OutcomesPane,
        }
    }

    fn focused(&self) -> InboxPane {
        self.focus
    }

    fn focus_on(&mut self, name: InboxPane) {
        self.focus = name;
        self.typing = None;
        if let Some(ruling) = &mut self.ruling {
            ruling.typing = name == InboxPane::Offer;
        }
    }

    fn act_anywhere(&mut self, action: Action, look: &Look<'_>) -> Option<Vec<Effect>> {
        if let Some(effects) = self.turn_outcomes(action) {
            return Some(effects);
        }
        let lists = list_prices(look.company);
        if let Some(ruling) = &mut self.ruling {
            match action {
                Action::SendOffer => return Some(self.send_by_rules(look.company)),
                Action::Discard | Action::Close => self.ruling = None,
                Action::Commit => ruling.typing = false,
                Action::InboxRules | Action::Open => self.focus_on(InboxPane::Offer),
                Action::CommitNext | Action::CommitPrevious => self.focus_on(InboxPane::Thread),
                _ => return None,
            }
            return Some(Vec::new());
        }
        if self.typing.is_some() {
            if action == Action::Discard {
                self.typing = None;
                return Some(Vec::new());
            }
            let problem = self.commit();
            if !problem.is_empty() || action == Action::Commit {
                return Some(problem);
            }
        }
        if self.here().is_none() && NEEDS_A_THREAD.contains(&action) {
            return Some(vec![Effect::Complain(NO_THREAD.to_owned())]);
        }
        match action {
            Action::Mark | Action::MarkAll => {
                self.mark(action == Action::MarkAll);
                self.list(self.place());
                if action == Action::Mark {
                    self.table.act(Action::Down, look.page);
                }
            }
            Action::OtherThreads => {
                let place = self.place();
                self.view = self.view.next();
                self.list(place);
                self.table.act(Action::First, look.page);
                self.scroll = 0;
            }
            Action::TakeAsk => {
                let targets = self.targets();
                if !targets.is_empty() && targets.iter().all(|thread| thread.asked().is_none()) {
                    return Some(vec![Effect::Complain("No asking price yet. Type a price.".to_owned())]);
                }
                self.set_offer(Offer::as_asked());
            }
            Action::OfferPlan => self.turn_plan(),
            Action::OfferBasis => self.turn_basis(lists),
            Action::OfferPrice => self.type_value(),
            Action::InboxRules => return Some(self.start_ruling(look.company)),
            Action::SendOffer => return Some(self.send(look.company)),
            Action::RejectOffer => return Some(self.reject(look.company)),
            Action::InboxGroup => {
                let group = self.here().and_then(|thread| Group::parse(&thread.group));
                let shown = group.map(|group| Effect::ShowGroup(ScreenId::Customers, group));
                return Some(shown.into_iter().collect());
            }
            Action::InboxSql => return Some(self.here().map(post::statement).into_iter().collect()),
            _ => return None,
        }
        Some(Vec::new())
    }

    fn arrange(&self, canvas: &mut Canvas<'_>, area: Rect, look: &Look<'_>) {
        use InboxPane::{Offer, Thread};
        let first = self.first_pane();
        if area.width < 104 && self.ruling.is_some() {
            return ruling::arrange_small(self, canvas, area, look);
        }
        if area.width < 104 {
            let below = (OFFER_HEIGHT + 1).min(area.height.div_ceil(2));
            let [list, below] = Layout::vertical([Constraint::Min(0), Constraint::Length(below)]).areas(area);
            let [thread, offer] =
                Layout::horizontal([Constraint::Min(0), Constraint::Length(44)]).areas(below);
            for (pane, place) in [(first, list), (Thread, thread), (Offer, offer)] {
                draw_pane(self, pane, canvas, place, look);
            }
            return;
        }
        // The offer needs all its columns; the list can drop its last ones.
        let right = (area.width * 43 / 100).max(offer_pane::WORTH + 2);
        let [list, right] = Layout::horizontal([Constraint::Min(0), Constraint::Length(right)]).areas(area);
        let [above, offer] =
            Layout::vertical([Constraint::Min(0), Constraint::Length(OFFER_HEIGHT)]).areas(right);
        draw_pane(self, first, canvas, list, look);
        // Messages are drawn above the preview if both fit.
        let beside = match !self.marked.is_empty() && above.height >= 20 {
            true => Constraint::Percentage(45),
            false => Constraint::Length(0),
        };
        let [said, own] = Layout::vertical([beside, Constraint::Min(0)]).areas(above);
        if !said.is_empty() {
            canvas.click(said, Click::Pane(Thread as usize));
            thread::draw_beside(self, canvas, said, look);
        }
        draw_pane(self, Thread, canvas, own, look);
        draw_pane(self, Offer, canvas, offer, look);
    }
}
