//! Negotiations with enterprises: waiting threads, messages, and offers to one enterprise or to several at once.

mod estimate;
mod model;
mod offer;
mod offer_pane;
mod outcomes;
mod preview;
mod rules_form;
mod sending;
#[cfg(test)]
mod tests;
mod thread;
mod thread_list;

use std::collections::{BTreeMap, BTreeSet};

use ratatui::layout::{Constraint, Layout, Rect};

use self::estimate::plan_economics;
use self::model::{Thread, ThreadState, ThreadStore};
use self::offer::{MAX_TERMS, OfferDraft, PlanChoice};
use self::outcomes::FirstOfferOutcomes;
use self::rules_form::RulesForm;
use self::thread_list::{columns, thread_row};
use super::ScreenState;
use super::panes::{Pane, PaneScreen, draw_pane};
use crate::action::Action;
use crate::context::{ScreenContext, ScreenId};
use crate::effect::Effect;
use novamind_base::formatting::parse_number;
use novamind_database::QueryResult;
use novamind_rules::{MIN_TURNS_PARAMETER, SeatUsage, ThreadContext};
use novamind_session::identifiers::{Group, Plan};
use novamind_tools::ToolId;
use novamind_tui::canvas::{Canvas, Click};
use novamind_tui::widgets::Table;
use novamind_tui::widgets::field::{NUMBER_HINT, TextField};
use novamind_worker::company::DisplayedCompany;
use novamind_worker::message::Response;
use novamind_worker::screen_queries::Reading;

/// Panes of the inbox screen.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum InboxPane {
    /// List of the threads in the current view.
    #[default]
    List,
    /// Messages of the thread, or the preview of a bulk offer.
    Thread,
    /// The offer being edited.
    Offer,
    /// Outcomes of first offers, which replace the list.
    Outcomes,
}

/// Panes in tab order while the list of threads is shown.
const LIST_PANES: [InboxPane; 3] = [InboxPane::List, InboxPane::Thread, InboxPane::Offer];
const OUTCOME_PANES: [InboxPane; 3] = [InboxPane::Outcomes, InboxPane::Thread, InboxPane::Offer];

/// Footer actions for a single thread.
const OFFER_HINTS: [Action; 6] = [
    Action::SendOffer,
    Action::OfferPlan,
    Action::OfferBasis,
    Action::OfferPrice,
    Action::MatchAskedPrice,
    Action::Close,
];

/// Actions that require a selected thread.
const THREAD_ACTIONS: [Action; 8] = [
    Action::Mark,
    Action::MarkAll,
    Action::MatchAskedPrice,
    Action::OfferPlan,
    Action::OfferBasis,
    Action::OfferPrice,
    Action::InboxGroup,
    Action::InboxSql,
];
const NO_THREAD_ERROR: &str = "No thread is selected";

const OFFER_HEIGHT: u16 = 10;

/// Plan of the first offer if nothing shows which plan suits the enterprise.
const DEFAULT_PLAN: Plan = Plan::B;

#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
enum InboxView {
    /// Threads in which the player must answer.
    #[default]
    WaitingForPlayer,
    /// Threads in which the enterprise must answer.
    WaitingForCustomer,
    Closed,
}

impl InboxView {
    fn includes(self, state: ThreadState) -> bool {
        match self {
            InboxView::WaitingForPlayer => matches!(state, ThreadState::WaitingForPlayer(_)),
            InboxView::WaitingForCustomer => state == ThreadState::WaitingForCustomer,
            InboxView::Closed => !state.is_open(),
        }
    }

    fn next(self) -> InboxView {
        match self {
            InboxView::WaitingForPlayer => InboxView::WaitingForCustomer,
            InboxView::WaitingForCustomer => InboxView::Closed,
            InboxView::Closed => InboxView::WaitingForPlayer,
        }
    }
}

/// The inbox screen.
#[derive(Default)]
pub struct Inbox {
    focus: InboxPane,
    view: InboxView,
    threads: ThreadStore,
    usage: SeatUsage,
    /// Plans that enterprises asked for.
    asked_plans: novamind_rules::RequestedPlans,
    rules_form: Option<RulesForm>,
    /// Outcomes of first offers, or `None` while the list is shown.
    outcomes: Option<FirstOfferOutcomes>,
    last_rules: Option<String>,
    table: Table,
    /// Indexes of the listed threads in the list of all threads.
    rows: Vec<usize>,
    marked: BTreeSet<u32>,
    drafts: BTreeMap<u32, OfferDraft>,
    /// Draft of the offer to all marked threads.
    bulk_offer: Option<OfferDraft>,
    /// Last sent offer that can be reused for other enterprises.
    last_offer: Option<OfferDraft>,
    selected_term: usize,
    /// Input field for the value of the selected term, while the user types.
    value_field: Option<TextField>,
    /// Number of scrolled rows: up from the end of a thread, or down from the start of a preview.
    scroll: u16,
}

impl Inbox {
    fn update_threads(&mut self, company: &DisplayedCompany) {
        let place = self.list_position();
        // The tool texts that agents read do not state the number of turns, so an unfinished baseline run hides it.
        let is_shown = !company.is_baseline() || !company.is_running();
        let min_turns = company.numbers.value(MIN_TURNS_PARAMETER).filter(|_| is_shown);
        let waiting = self.waiting_threads(company);
        self.threads.merge_waiting(waiting, &company.enterprise_names, min_turns.map(|turns| turns as u32));
        let threads = self.threads.threads.iter();
        let open: BTreeSet<u32> =
            threads.filter(|thread| thread.state.is_open()).map(|thread| thread.number).collect();
        self.marked.retain(|number| open.contains(number));
        self.rebuild_table(place);
    }

    /// Returns the numbers of the listed threads and the number of the selected thread.
    fn list_position(&self) -> (Vec<u32>, Option<u32>) {
        let shown = self.table.visible_rows().iter().filter_map(|row| self.thread_in_row(*row)).collect();
        (shown, self.selected_thread().map(|thread| thread.number))
    }

    /// Rebuilds the table of threads. The selected thread stays selected. If that thread is no longer listed, the next
    /// thread is selected.
    fn rebuild_table(&mut self, (shown, here): (Vec<u32>, Option<u32>)) {
        let threads = &self.threads.threads;
        self.rows = (0..threads.len()).filter(|at| self.view.includes(threads[*at].state)).collect();
        let row = |at: &usize| thread_row(&threads[*at], self.marked.contains(&threads[*at].number));
        let rows = self.rows.iter().map(row).collect();
        self.table.set_pinned_columns(thread_list::PINNED_COLUMNS);
        self.table.set_columns_and_rows(columns(self.view), rows);
        let from = here.and_then(|here| shown.iter().position(|number| *number == here)).unwrap_or(0);
        let rows = self.rows.iter().enumerate().map(|(row, at)| (self.threads.threads[*at].number, row));
        let rows: BTreeMap<u32, usize> = rows.collect();
        if let Some(row) = shown.iter().skip(from).find_map(|number| rows.get(number)) {
            self.table.select(*row);
        }
    }

    /// Returns the waiting threads with all fields that rules use.
    fn waiting_threads(&self, company: &DisplayedCompany) -> Vec<ThreadContext> {
        let market = plan_economics(company, &self.usage);
        let waiting = company.observation.waiting.iter();
        waiting.map(|waiting_thread| ThreadContext::new(waiting_thread, &self.asked_plans, &market)).collect()
    }

    /// Selects a waiting thread.
    pub fn show_thread(&mut self, number: u32, company: &DisplayedCompany) {
        self.view = InboxView::WaitingForPlayer;
        self.close_outcomes();
        self.value_field = None;
        self.table.handle_action(Action::Close, 0);
        self.update_threads(company);
        if let Some(row) = self.row_of_thread(number) {
            self.table.select(row);
        }
    }

    fn thread_in_row(&self, row: usize) -> Option<u32> {
        self.threads.threads.get(*self.rows.get(row)?).map(|thread| thread.number)
    }

    fn row_of_thread(&self, number: u32) -> Option<usize> {
        (0..self.rows.len()).find(|row| self.thread_in_row(*row) == Some(number))
    }

    fn selected_thread(&self) -> Option<&Thread> {
        self.threads.threads.get(*self.rows.get(self.table.selected()?)?)
    }

    /// Returns the threads that receive an offer: all marked threads, otherwise the selected thread.
    fn targets(&self) -> Vec<&Thread> {
        if self.marked.is_empty() {
            return self.selected_thread().into_iter().collect();
        }
        let marked = |thread: &&Thread| self.marked.contains(&thread.number);
        self.threads.threads.iter().filter(marked).collect()
    }

    fn current_offer(&self, company: &DisplayedCompany) -> OfferDraft {
        if !self.marked.is_empty() {
            return self.bulk_offer.clone().unwrap_or_else(|| self.initial_bulk_offer(company));
        }
        let Some(thread) = self.selected_thread() else { return OfferDraft::at_list_price(DEFAULT_PLAN) };
        let offer_draft = self.drafts.get(&thread.number).or(self.last_offer.as_ref()).cloned();
        offer_draft.unwrap_or_else(|| OfferDraft::initial_for(thread, self.suitable_plan(thread, company)))
    }

    /// Returns the offer to the marked threads until the user changes it: the offer that the user wrote for the selected
    /// thread, otherwise the only offer written for a marked thread, otherwise the list price of the plan that suits
    /// most of the enterprises.
    fn initial_bulk_offer(&self, company: &DisplayedCompany) -> OfferDraft {
        let targets = self.targets();
        let written: Vec<&OfferDraft> =
            targets.iter().filter_map(|thread| self.drafts.get(&thread.number)).collect();
        let selected = self.selected_thread().filter(|thread| self.marked.contains(&thread.number));
        let of_selected = selected.and_then(|thread| self.drafts.get(&thread.number));
        let only = written.first().filter(|first| written.iter().all(|other| other == *first));
        if let Some(offer) = of_selected.or(only.copied()) {
            return offer.clone();
        }
        let suitable: Vec<Plan> = targets.iter().map(|thread| self.suitable_plan(thread, company)).collect();
        let count = |plan: &Plan| suitable.iter().filter(|other| *other == plan).count();
        OfferDraft::at_list_price(Plan::ALL.into_iter().rev().max_by_key(count).unwrap_or(DEFAULT_PLAN))
    }

    /// Returns the plan that an enterprise named, otherwise the plan of a subscriber, otherwise the cheapest plan whose
    /// quality and quota can suit the enterprise according to the market study.
    fn suitable_plan(&self, thread: &Thread, company: &DisplayedCompany) -> Plan {
        let subscription = self.threads.enterprise(thread.customer);
        let subscribed = subscription.filter(|enterprise| enterprise.status == "subscribed");
        let of_market = || {
            let fit = company.fit(Group::parse(&thread.group)?)?;
            fit.cheapest_suitable_plan(thread.waiting_thread.as_ref()?.required_quota)
        };
        let plan = thread.asked_plan().or_else(|| subscribed.and_then(|enterprise| Plan::parse(&enterprise.plan)));
        plan.or_else(of_market).unwrap_or(DEFAULT_PLAN)
    }

    fn set_offer(&mut self, offer: OfferDraft) {
        match self.selected_thread().map(|thread| thread.number) {
            _ if !self.marked.is_empty() => self.bulk_offer = Some(offer),
            Some(number) => {
                self.drafts.insert(number, offer);
                // The next bulk offer starts from the offer that was written last.
                self.bulk_offer = None;
            }
            None => {}
        }
    }

    /// Returns the marked threads for which the user wrote another offer than the bulk offer.
    fn replaced_drafts(&self, company: &DisplayedCompany) -> Vec<&Thread> {
        if self.marked.is_empty() {
            return Vec::new();
        }
        let bulk = self.current_offer(company);
        let is_replaced = |thread: &&Thread| self.drafts.get(&thread.number).is_some_and(|draft| *draft != bulk);
        self.targets().into_iter().filter(is_replaced).collect()
    }

    /// Returns the unsent offers to waiting threads as text, by thread. The bulk offer is returned once
    /// for each marked thread.
    pub fn draft_offers(&self, company: &DisplayedCompany) -> BTreeMap<u32, String> {
        let marked = self.bulk_offer.iter().flat_map(|offer| self.marked.iter().map(move |number| (number, offer)));
        let all: BTreeMap<u32, &OfferDraft> =
            self.drafts.iter().chain(marked).map(|(number, offer)| (*number, offer)).collect();
        let is_waiting = |number: &u32| company.observation.waiting.iter().any(|waiting| waiting.thread == *number);
        all.into_iter().filter(|(number, _)| is_waiting(number)).map(|(number, offer)| (number, offer.to_text())).collect()
    }

    /// Restores unsent offers. Ignores texts that are not offers.
    pub fn restore_offers(&mut self, offers: &BTreeMap<u32, String>) {
        let parsed = offers.iter().filter_map(|(number, text)| Some((*number, OfferDraft::parse(text)?)));
        self.drafts.extend(parsed);
    }

    fn edit_term(&mut self, company: &DisplayedCompany, change: impl FnOnce(&mut offer::OfferTerm)) {
        let mut offer = self.current_offer(company);
        change(&mut offer.0[self.selected_term.min(MAX_TERMS - 1)]);
        self.set_offer(offer);
    }

    fn commit_value(&mut self, company: &DisplayedCompany) -> Vec<Effect> {
        let Some(field) = self.value_field.take() else { return Vec::new() };
        match parse_number(field.text()) {
            Some(value) => {
                let plan = self.selected_thread().map(|thread| self.suitable_plan(thread, company));
                self.edit_term(company, |term| {
                    term.value = value;
                    if term.plan == PlanChoice::Unused {
                        term.plan = PlanChoice::Fixed(plan.unwrap_or(DEFAULT_PLAN));
                    }
                });
                Vec::new()
            }
            None if field.is_empty() => Vec::new(),
            None => vec![Effect::ShowError(NUMBER_HINT.to_owned())],
        }
    }

    fn start_typing(&mut self, company: &DisplayedCompany) {
        if self.selected_thread().is_some() {
            let value = self.current_offer(company).0[self.selected_term.min(MAX_TERMS - 1)].value_text();
            self.value_field = Some(TextField::with_selected_text(value));
            self.focus = InboxPane::Offer;
        }
    }

    fn toggle_marks(&mut self, all: bool) {
        let open = |row: &usize| {
            let thread = self.threads.threads.get(*self.rows.get(*row)?)?;
            thread.state.is_open().then_some(thread.number)
        };
        let rows: Vec<usize> = if all {
            self.table.visible_rows().to_vec()
        } else {
            self.table.selected().into_iter().collect()
        };
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

    fn cycle_plan(&mut self, company: &DisplayedCompany) {
        self.edit_term(company, offer::OfferTerm::cycle_plan);
    }

    /// Changes the basis of the selected term. The price stays the same, for the selected thread if possible.
    fn cycle_basis(&mut self, company: &DisplayedCompany) -> Vec<Effect> {
        let mut offer = self.current_offer(company);
        let term = &mut offer.0[self.selected_term.min(MAX_TERMS - 1)];
        let mut threads = self.targets();
        let selected = self.selected_thread().map(|thread| thread.number);
        threads.sort_by_key(|thread| Some(thread.number) != selected);
        if term.plan == PlanChoice::Unused {
            return vec![Effect::ShowError("This line has no plan. Choose a plan first.".to_owned())];
        }
        if !term.cycle_basis(&threads, list_prices(company)) {
            let text = match term.plan {
                PlanChoice::NamedByCustomer => "None of these enterprises named a plan. Choose plan A, B or C first.",
                _ => "The plan has no list price, and no enterprise asked a price. Set a list price first.",
            };
            return vec![Effect::ShowError(text.to_owned())];
        }
        self.set_offer(offer);
        Vec::new()
    }
}

/// Returns the list prices of the plans, $ per seat per month.
fn list_prices(company: &DisplayedCompany) -> [f64; 3] {
    ["A", "B", "C"].map(|plan| company.current_setting(ToolId::SetPrices, plan))
}

impl ScreenState for Inbox {
    fn selected_group(&self, _: &ScreenContext<'_>) -> Option<Group> {
        self.selected_thread().and_then(|thread| Group::parse(&thread.group))
    }

    fn open_item_title(&self, _: &ScreenContext<'_>) -> Option<String> {
        match self.focus {
            InboxPane::Outcomes => Some("outcomes".to_owned()),
            _ => self.selected_thread().map(|thread| format!("#{}", thread.customer)),
        }
    }

    fn screen_escape_depth(&self) -> usize {
        usize::from(self.outcomes.is_some()) + usize::from(self.focus != self.left_pane())
    }

    fn screen_queries(&self) -> &'static [Reading] {
        match self.outcomes {
            Some(_) => &outcomes::OUTCOME_QUERIES,
            None => &[Reading::EnterpriseTurns, Reading::Companies, Reading::Usage, Reading::LastLetters],
        }
    }

    fn apply_rows(&mut self, reading: Reading, rows: &QueryResult, context: &ScreenContext<'_>) {
        match reading {
            Reading::FirstOffers => {
                self.outcomes.iter_mut().for_each(|offer_outcomes| offer_outcomes.set_rows(rows));
                return;
            }
            Reading::Usage => self.usage = SeatUsage::from_rows(rows),
            Reading::LastLetters => self.asked_plans = novamind_rules::RequestedPlans::from_rows(rows),
            _ => self.threads.apply_rows(reading, rows),
        }
        self.update_threads(context.company);
    }

    fn on_company_change(&mut self, context: &ScreenContext<'_>) {
        self.update_threads(context.company);
    }

    fn handle_response(&mut self, news: &Response, context: &ScreenContext<'_>) -> Vec<Effect> {
        match news {
            Response::ToolCalled(_, Ok(answer), _) => {
                let effects = self.handle_send_result(answer, context.company);
                self.rules_form = None;
                self.update_threads(context.company);
                effects
            }
            _ => Vec::new(),
        }
    }

    fn open_object(&self, _: &ScreenContext<'_>) -> Option<(&'static str, String)> {
        Some(("thread", self.selected_thread()?.number.to_string()))
    }

    fn has_unsent_text(&self) -> bool {
        !self.drafts.is_empty() || (self.bulk_offer.is_some() && !self.marked.is_empty())
    }
}

impl PaneScreen for Inbox {
    type PaneId = InboxPane;

    fn panes(&self) -> &'static [InboxPane] {
        if self.outcomes.is_some() { &OUTCOME_PANES } else { &LIST_PANES }
    }

    fn pane(name: InboxPane) -> &'static dyn Pane<Inbox> {
        match name {
            InboxPane::List => &thread_list::ThreadListPane,
            InboxPane::Thread => &thread::ThreadPane,
            InboxPane::Offer => &offer_pane::OfferPane,
            InboxPane::Outcomes => &outcomes::OutcomesPane,
        }
    }

    fn focused_pane(&self) -> InboxPane {
        self.focus
    }

    /// If the list is empty, the other panes are empty too.
    fn enlarged_pane(&self) -> InboxPane {
        if self.rows.is_empty() && self.rules_form.is_none() { self.left_pane() } else { self.focus }
    }

    fn set_focused_pane(&mut self, name: InboxPane) {
        self.focus = name;
        self.value_field = None;
        if let Some(ruling) = &mut self.rules_form {
            ruling.is_typing = name == InboxPane::Offer;
        }
    }

    fn handle_screen_action(&mut self, action: Action, context: &ScreenContext<'_>) -> Option<Vec<Effect>> {
        if let Some(effects) = self.handle_outcomes_action(action) {
            return Some(effects);
        }
        if let Some(ruling) = &mut self.rules_form {
            match action {
                Action::SendOffer => return Some(self.send_rule_answers(context.company)),
                Action::Discard | Action::Close => self.rules_form = None,
                Action::Commit => ruling.is_typing = false,
                Action::InboxRules | Action::Open => self.set_focused_pane(InboxPane::Offer),
                Action::CommitNext | Action::CommitPrevious => self.set_focused_pane(InboxPane::Thread),
                _ => return None,
            }
            return Some(Vec::new());
        }
        if self.value_field.is_some() {
            if action == Action::Discard {
                self.value_field = None;
                return Some(Vec::new());
            }
            let problem = self.commit_value(context.company);
            if !problem.is_empty() || action == Action::Commit {
                return Some(problem);
            }
        }
        if self.selected_thread().is_none() && THREAD_ACTIONS.contains(&action) {
            return Some(vec![Effect::ShowError(NO_THREAD_ERROR.to_owned())]);
        }
        match action {
            Action::Mark | Action::MarkAll => {
                self.toggle_marks(action == Action::MarkAll);
                self.rebuild_table(self.list_position());
                if action == Action::Mark {
                    self.table.handle_action(Action::Down, context.page_rows);
                }
            }
            Action::NextThreadView => {
                let place = self.list_position();
                self.view = self.view.next();
                self.rebuild_table(place);
                self.table.handle_action(Action::First, context.page_rows);
                self.scroll = 0;
            }
            Action::MatchAskedPrice => {
                let targets = self.targets();
                if !targets.is_empty() && targets.iter().all(|thread| thread.asked_price().is_none()) {
                    return Some(vec![Effect::ShowError("No asked price yet. Type a price.".to_owned())]);
                }
                self.set_offer(OfferDraft::at_asked_price());
            }
            Action::OfferPlan => self.cycle_plan(context.company),
            Action::OfferBasis => return Some(self.cycle_basis(context.company)),
            Action::OfferPrice => self.start_typing(context.company),
            Action::InboxRules => return Some(self.open_rules(context.company)),
            Action::SendOffer => return Some(self.send_offers(context.company)),
            Action::RejectOffer => return Some(self.confirm_rejection(context.company)),
            Action::InboxGroup => {
                let effect = self.selected_group(context).map(|group| Effect::ShowGroup(ScreenId::Customers, group));
                return Some(effect.into_iter().collect());
            }
            Action::InboxSql => {
                return Some(self.selected_thread().map(sending::open_thread_query).into_iter().collect());
            }
            _ => return None,
        }
        Some(Vec::new())
    }

    fn draw_panes(&self, canvas: &mut Canvas<'_>, area: Rect, context: &ScreenContext<'_>) {
        use InboxPane::{Offer, Thread};
        let first = self.left_pane();
        if area.width < 104 && self.rules_form.is_some() {
            return rules_form::draw_small_layout(self, canvas, area, context);
        }
        if area.width < 104 {
            let below = (OFFER_HEIGHT + 1).min(area.height.div_ceil(2));
            let [list, below] = Layout::vertical([Constraint::Min(0), Constraint::Length(below)]).areas(area);
            let [thread, offer] =
                Layout::horizontal([Constraint::Min(0), Constraint::Length(44)]).areas(below);
            for (pane, place) in [(first, list), (Thread, thread), (Offer, offer)] {
                draw_pane(self, pane, canvas, place, context);
            }
            return;
        }
        // The offer pane needs all its columns. The list of threads can omit its last columns.
        let right = (area.width * 43 / 100).max(offer_pane::MIN_FULL_WIDTH + 2);
        let [list, right] = Layout::horizontal([Constraint::Min(0), Constraint::Length(right)]).areas(area);
        let [above, offer] =
            Layout::vertical([Constraint::Min(0), Constraint::Length(OFFER_HEIGHT)]).areas(right);
        draw_pane(self, first, canvas, list, context);
        // The messages of the thread are drawn above the preview if both fit.
        let constraint = match !self.marked.is_empty() && above.height >= 20 {
            true => Constraint::Percentage(45),
            false => Constraint::Length(0),
        };
        let [side_thread_area, thread_area] = Layout::vertical([constraint, Constraint::Min(0)]).areas(above);
        if !side_thread_area.is_empty() {
            canvas.register_click(side_thread_area, Click::Pane(Thread as usize));
            thread::draw_side_thread(self, canvas, side_thread_area, context);
        }
        draw_pane(self, Thread, canvas, thread_area, context);
        draw_pane(self, Offer, canvas, offer, context);
    }
}
