//! Offers as the user edits them: plans with prices, absolute or relative to the list price or the asked price.

use super::model::Thread;
use novamind_base::formatting::{dollars_and_cents, grouped_number};
use novamind_session::identifiers::Plan;

/// Maximum number of terms in one offer.
pub const MAX_TERMS: usize = 3;

const TERM_SEPARATOR: &str = " + ";

/// The plan of a term.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PlanChoice {
    Unused,
    Fixed(Plan),
    /// The plan that the enterprise asked for.
    NamedByCustomer,
}

/// Unit and reference price of a term's value.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PriceBasis {
    /// Dollars per seat per month.
    Dollars,
    /// Percentage of the plan's list price.
    ListPrice,
    /// Percentage of the asked price.
    AskedPrice,
}

impl PriceBasis {
    pub fn label(self) -> &'static str {
        match self {
            PriceBasis::Dollars => "$",
            PriceBasis::ListPrice => "% list",
            PriceBasis::AskedPrice => "% ask",
        }
    }
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub struct OfferTerm {
    pub plan: PlanChoice,
    pub basis: PriceBasis,
    /// Value in dollars or percent, according to `basis`.
    pub value: f64,
}

const UNUSED_TERM: OfferTerm =
    OfferTerm { plan: PlanChoice::Unused, basis: PriceBasis::ListPrice, value: 100.0 };

impl OfferTerm {
    pub fn plan_label(&self) -> &'static str {
        match self.plan {
            PlanChoice::Unused => "–",
            PlanChoice::Fixed(plan) => plan.id(),
            PlanChoice::NamedByCustomer => "theirs",
        }
    }

    /// Returns the term as text: plan, value and unit, for example `B 90 % list`.
    fn to_text(self) -> String {
        format!("{} {} {}", self.plan_label(), self.value, self.basis.label())
    }

    fn parse(text: &str) -> Option<OfferTerm> {
        let mut words = text.splitn(3, ' ');
        let (plan, value, unit) = (words.next()?, words.next()?.parse().ok()?, words.next()?);
        let plans = Plan::ALL.map(PlanChoice::Fixed).into_iter().chain([PlanChoice::Unused, PlanChoice::NamedByCustomer]);
        let plan = plans.into_iter().find(|choice| OfferTerm { plan: *choice, ..UNUSED_TERM }.plan_label() == plan)?;
        let bases = [PriceBasis::Dollars, PriceBasis::ListPrice, PriceBasis::AskedPrice];
        let basis = bases.into_iter().find(|basis| basis.label() == unit)?;
        Some(OfferTerm { plan, basis, value })
    }

    /// Returns the value of the term as text for the input field.
    pub fn value_text(&self) -> String {
        let decimals = if self.value.fract() == 0.0 && self.basis != PriceBasis::Dollars { 0 } else { 2 };
        grouped_number(self.value, decimals)
    }

    /// Returns the value with its unit, for a table cell.
    pub fn value_with_unit(&self) -> String {
        match self.basis {
            PriceBasis::Dollars => format!("${}", self.value_text()),
            PriceBasis::ListPrice | PriceBasis::AskedPrice => format!("{}%", self.value_text()),
        }
    }

    /// Describes what the value means, with the price for a thread if it is known: `% of list = $81.60`.
    pub fn describe_value(&self, thread: Option<&Thread>, lists: [f64; 3]) -> String {
        let meaning = match self.basis {
            PriceBasis::Dollars => return "$ per seat".to_owned(),
            PriceBasis::ListPrice => "% of list",
            PriceBasis::AskedPrice => "% of ask",
        };
        let price = thread.and_then(|thread| self.price(thread, lists));
        price.map_or(meaning.to_owned(), |(_, price)| format!("{meaning} = {}", dollars_and_cents(price)))
    }

    pub fn cycle_plan(&mut self) {
        self.plan = match self.plan {
            PlanChoice::Unused => PlanChoice::Fixed(Plan::A),
            PlanChoice::Fixed(Plan::A) => PlanChoice::Fixed(Plan::B),
            PlanChoice::Fixed(Plan::B) => PlanChoice::Fixed(Plan::C),
            PlanChoice::Fixed(Plan::C) => PlanChoice::NamedByCustomer,
            PlanChoice::NamedByCustomer => PlanChoice::Unused,
        };
    }

    /// Selects the next price basis that has a reference price for one of the threads, and converts the value, so that
    /// the price for this thread stays the same. If the term has no price for any thread, the value becomes 100 % of the
    /// next reference price. Returns whether the basis changed.
    pub fn cycle_basis(&mut self, threads: &[&Thread], lists: [f64; 3]) -> bool {
        let bases = match self.basis {
            PriceBasis::ListPrice => [PriceBasis::AskedPrice, PriceBasis::Dollars],
            PriceBasis::AskedPrice => [PriceBasis::Dollars, PriceBasis::ListPrice],
            PriceBasis::Dollars => [PriceBasis::ListPrice, PriceBasis::AskedPrice],
        };
        let converted = |basis: PriceBasis| {
            let value = |thread: &&Thread| {
                let unit = OfferTerm { basis, value: 1.0, ..*self }.reference(thread, lists)?;
                Some(self.exact_price(thread, lists)? / unit)
            };
            Some((basis, threads.iter().find_map(value)?))
        };
        let unconverted = |basis: PriceBasis| {
            let has_reference =
                |thread: &&Thread| {
                    let term = OfferTerm { basis, ..*self };
                    self.resolve_plan(thread).and(term.reference(thread, lists)).is_some()
                };
            (basis != PriceBasis::Dollars && threads.iter().any(has_reference)).then_some((basis, 100.0))
        };
        let has_price = threads.iter().any(|thread| self.exact_price(thread, lists).is_some());
        let next = bases.into_iter().find_map(converted);
        let next = next.or_else(|| bases.into_iter().filter(|_| !has_price).find_map(unconverted));
        let Some((basis, value)) = next else { return false };
        (self.basis, self.value) = (basis, value);
        true
    }

    /// Returns the price of one unit of the value for a thread, or `None` if there is no reference price.
    fn reference(&self, thread: &Thread, lists: [f64; 3]) -> Option<f64> {
        let unit = match self.basis {
            PriceBasis::Dollars => 1.0,
            PriceBasis::ListPrice => lists[self.resolve_plan(thread)? as usize] / 100.0,
            PriceBasis::AskedPrice => thread.asked_price()?.1 / 100.0,
        };
        (unit > 0.0).then_some(unit)
    }

    fn resolve_plan(&self, thread: &Thread) -> Option<Plan> {
        match self.plan {
            PlanChoice::Unused => None,
            PlanChoice::Fixed(plan) => Some(plan),
            PlanChoice::NamedByCustomer => thread.asked_plan(),
        }
    }

    /// Returns the price before it is rounded to cents.
    fn exact_price(&self, thread: &Thread, lists: [f64; 3]) -> Option<f64> {
        self.resolve_plan(thread)?;
        Some(self.value * self.reference(thread, lists)?)
    }

    /// Describes a used term: `plan B at 90% of the list price = $28.80`. The price is omitted if it differs between
    /// enterprises.
    fn describe(&self, lists: [f64; 3]) -> Option<String> {
        let plan = match self.plan {
            PlanChoice::Unused => return None,
            PlanChoice::Fixed(plan) => format!("plan {plan}"),
            PlanChoice::NamedByCustomer => "the plan that each named".to_owned(),
        };
        let value = self.value_text();
        Some(match self.basis {
            PriceBasis::Dollars => format!("{plan} at ${value}"),
            PriceBasis::ListPrice => match self.price(&Thread::default(), lists) {
                Some((_, price)) => format!("{plan} at {value}% of the list price = {}", dollars_and_cents(price)),
                None => format!("{plan} at {value}% of the list price"),
            },
            PriceBasis::AskedPrice => format!("{plan} at {value}% of the asked price"),
        })
    }

    /// Returns the plan and price for a thread, or `None` if the term is unused or has no reference price.
    pub fn price(&self, thread: &Thread, lists: [f64; 3]) -> Option<(Plan, f64)> {
        let plan = self.resolve_plan(thread)?;
        let price = match self.basis {
            PriceBasis::Dollars => self.value,
            PriceBasis::ListPrice => lists[plan as usize] * self.value / 100.0,
            PriceBasis::AskedPrice => thread.asked_price()?.1 * self.value / 100.0,
        };
        Some((plan, (price * 100.0).round() / 100.0))
    }
}

/// A draft of an offer to one or several enterprises.
#[derive(Debug, Clone, PartialEq)]
pub struct OfferDraft(pub [OfferTerm; MAX_TERMS]);

impl OfferDraft {
    /// Returns an offer of a plan at its list price.
    pub fn at_list_price(plan: Plan) -> OfferDraft {
        OfferDraft([OfferTerm { plan: PlanChoice::Fixed(plan), ..UNUSED_TERM }, UNUSED_TERM, UNUSED_TERM])
    }

    /// Describes the used terms with the prices that are the same for all enterprises.
    pub fn describe(&self, lists: [f64; 3]) -> String {
        self.0.iter().filter_map(|term| term.describe(lists)).collect::<Vec<_>>().join(", and ")
    }

    /// Returns the used terms as text. [`OfferDraft::parse`] reads the text.
    pub fn to_text(&self) -> String {
        let used = self.0.iter().filter(|term| term.plan != PlanChoice::Unused);
        used.map(|term| term.to_text()).collect::<Vec<_>>().join(TERM_SEPARATOR)
    }

    /// Parses the text of an offer. Returns `None` if the text is not an offer.
    pub fn parse(text: &str) -> Option<OfferDraft> {
        let mut offer = OfferDraft([UNUSED_TERM; MAX_TERMS]);
        for (at, term) in text.split(TERM_SEPARATOR).enumerate() {
            *offer.0.get_mut(at)? = OfferTerm::parse(term)?;
        }
        Some(offer)
    }

    /// Returns an offer of the plan that the enterprise named, at its asked price.
    pub fn at_asked_price() -> OfferDraft {
        OfferDraft([
            OfferTerm { plan: PlanChoice::NamedByCustomer, basis: PriceBasis::AskedPrice, value: 100.0 },
            UNUSED_TERM,
            UNUSED_TERM,
        ])
    }

    /// Returns the initial offer to an enterprise: the asked price, otherwise the list price of a plan.
    pub fn initial_for(thread: &Thread, plan: Plan) -> OfferDraft {
        match (thread.asked_plan(), thread.asked_price()) {
            (Some(_), Some(_)) => OfferDraft::at_asked_price(),
            _ => OfferDraft::at_list_price(plan),
        }
    }

    /// Describes the prices for an enterprise that are percentages: `B at 90% of list = $28.80`.
    pub fn describe_percentages(&self, thread: &Thread, lists: [f64; 3]) -> Option<String> {
        let describe = |term: &OfferTerm| {
            let (plan, _) = term.price(thread, lists)?;
            let meaning = term.describe_value(Some(thread), lists);
            (term.basis != PriceBasis::Dollars).then(|| format!("{plan} at {}{meaning}", term.value_text()))
        };
        let described: Vec<String> = self.0.iter().filter_map(describe).collect();
        (!described.is_empty()).then(|| described.join(", "))
    }

    /// Returns whether the offer can be reused for other enterprises.
    pub fn is_reusable(&self) -> bool {
        self.0.iter().all(|term| term.plan == PlanChoice::Unused || term.basis != PriceBasis::Dollars)
    }

    /// Returns the plans and prices for a thread.
    ///
    /// # Errors
    /// No offer can be sent. The error is the reason.
    pub fn resolve(&self, thread: &Thread, lists: [f64; 3]) -> Result<Vec<(Plan, f64)>, String> {
        let terms: Vec<(Plan, f64)> = self.0.iter().filter_map(|term| term.price(thread, lists)).collect();
        match terms.iter().find(|(_, price)| *price <= 0.0) {
            Some((plan, _)) => Err(format!("plan {plan} would be free. Type a price above 0.")),
            None if terms.is_empty() && self.0.iter().all(|term| term.plan == PlanChoice::Unused) => {
                Err("no plan is chosen".to_owned())
            }
            None if terms.is_empty() => Err("no asked price".to_owned()),
            None => Ok(terms),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use novamind_rules::Turn;

    const LIST_PRICES: [f64; 3] = [14.0, 32.0, 0.0];

    #[test]
    fn offer_is_restored_from_its_text() {
        let term = |plan, basis, value| OfferTerm { plan, basis, value };
        let offer = OfferDraft([
            term(PlanChoice::Fixed(Plan::C), PriceBasis::Dollars, 38.25),
            term(PlanChoice::NamedByCustomer, PriceBasis::AskedPrice, 90.0),
            UNUSED_TERM,
        ]);
        assert_eq!(offer.to_text(), "C 38.25 $ + theirs 90 % ask");
        for offer in [offer, OfferDraft::at_list_price(Plan::B), OfferDraft::at_asked_price()] {
            assert_eq!(OfferDraft::parse(&offer.to_text()), Some(offer));
        }
        for text in ["", "B", "B x % list", "D 1 $", "A 1 $ + A 1 $ + A 1 $ + A 1 $"] {
            assert_eq!(OfferDraft::parse(text), None, "{text}");
        }
    }

    fn waiting_thread() -> Thread {
        let turn = Turn {
            number: 2,
            sender: "customer".to_owned(),
            text: "At $20.01 for plan A".to_owned(),
            offers: Vec::new(),
            price: Some(20.01),
            day: 3,
            closing_reason: String::new(),
        };
        Thread { messages: vec![turn], ..Thread::default() }
    }

    #[test]
    fn reusable_offers_are_relative_to_list_or_asked_price() {
        let (asking, silent) = (waiting_thread(), Thread::default());
        assert_eq!(OfferDraft::at_asked_price().resolve(&asking, LIST_PRICES), Ok(vec![(Plan::A, 20.01)]));
        assert!(OfferDraft::at_asked_price().resolve(&silent, LIST_PRICES).is_err());
        assert_eq!(OfferDraft::at_list_price(Plan::B).resolve(&silent, LIST_PRICES), Ok(vec![(Plan::B, 32.0)]));
        let mut offer = OfferDraft::at_list_price(Plan::B);
        offer.0[0].value = 90.0;
        offer.0[1] =
            OfferTerm { plan: PlanChoice::Fixed(Plan::C), basis: PriceBasis::AskedPrice, value: 150.0 };
        assert_eq!(offer.resolve(&asking, LIST_PRICES), Ok(vec![(Plan::B, 28.8), (Plan::C, 30.02)]));
        assert_eq!(
            offer.resolve(&silent, LIST_PRICES),
            Ok(vec![(Plan::B, 28.8)]),
            "a term without a reference price is left out"
        );
        offer.0[2] = OfferTerm { plan: PlanChoice::Fixed(Plan::C), ..UNUSED_TERM };
        assert!(offer.resolve(&asking, LIST_PRICES).is_err_and(|why| why.contains("plan C would be free")));
        assert!(
            OfferDraft([UNUSED_TERM; 3])
                .resolve(&asking, LIST_PRICES)
                .is_err_and(|why| why.contains("no plan"))
        );
    }

    #[test]
    fn plans_and_bases_cycle() {
        let mut term = UNUSED_TERM;
        for words in ["A", "B", "C", "theirs", "–"] {
            term.cycle_plan();
            assert_eq!(term.plan_label(), words);
        }
        assert!(!term.cycle_basis(&[&waiting_thread()], LIST_PRICES), "an unused term has no price");
        assert!(OfferDraft::at_list_price(Plan::B).is_reusable());
    }

    #[test]
    fn values_are_described_with_their_basis() {
        let (asking, silent) = (waiting_thread(), Thread::default());
        let mut offer = OfferDraft::at_list_price(Plan::B);
        offer.0[0].value = 48.0;
        assert_eq!(offer.describe(LIST_PRICES), "plan B at 48% of the list price = $15.36");
        assert_eq!(offer.describe_percentages(&silent, LIST_PRICES).as_deref(), Some("B at 48% of list = $15.36"));
        assert_eq!(offer.0[0].value_with_unit(), "48%");
        assert_eq!(offer.0[0].describe_value(None, LIST_PRICES), "% of list");
        let asked = OfferDraft::at_asked_price();
        assert_eq!(asked.describe_percentages(&asking, LIST_PRICES).as_deref(), Some("A at 100% of ask = $20.01"));
        offer.0[0].basis = PriceBasis::Dollars;
        assert_eq!((offer.0[0].value_with_unit().as_str(), offer.describe_percentages(&asking, LIST_PRICES)), ("$48.00", None));
        assert_eq!(offer.0[0].describe_value(Some(&asking), LIST_PRICES), "$ per seat");
    }

    #[test]
    fn changing_the_basis_keeps_the_price() {
        let (asking, silent) = (waiting_thread(), Thread::default());
        let term = |plan| OfferTerm { plan: PlanChoice::Fixed(plan), ..UNUSED_TERM };
        let mut plan_b = term(Plan::B);
        for (basis, value) in [("% ask", 32.0 / 0.2001), ("$", 32.0), ("% list", 100.0)] {
            assert!(plan_b.cycle_basis(&[&silent, &asking], LIST_PRICES));
            assert_eq!(plan_b.basis.label(), basis);
            assert!((plan_b.value - value).abs() < 1e-9, "{basis} {}", plan_b.value);
            assert_eq!(plan_b.price(&asking, LIST_PRICES), Some((Plan::B, 32.0)));
        }
        for basis in ["$", "% list"] {
            assert!(plan_b.cycle_basis(&[&silent], LIST_PRICES), "an enterprise without an asked price");
            assert_eq!((plan_b.basis.label(), plan_b.price(&silent, LIST_PRICES)), (basis, Some((Plan::B, 32.0))));
        }
        let mut without_ask = OfferTerm { basis: PriceBasis::AskedPrice, value: 60.0, ..term(Plan::B) };
        assert!(without_ask.cycle_basis(&[&silent], LIST_PRICES), "the list price is a reference");
        assert_eq!((without_ask.basis, without_ask.value), (PriceBasis::ListPrice, 100.0));
        let mut unpriced = OfferTerm { basis: PriceBasis::Dollars, value: 48.0, ..term(Plan::C) };
        assert!(!unpriced.cycle_basis(&[&silent], LIST_PRICES), "48 dollars are never 48 percent");
        assert_eq!((unpriced.basis, unpriced.value), (PriceBasis::Dollars, 48.0));
    }
}
