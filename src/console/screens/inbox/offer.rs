//! Offers as the user edits them: plans with prices, absolute or relative to the list price or the asking
//! price.

use super::model::Thread;
use novamind_base::notation::grouped;
use novamind_session::identifiers::Plan;

/// Terms per offer; the maximum for one message.
pub const TERMS: usize = 3;

/// The plan of a term.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum TermChoice {
    Nothing,
    Fixed(Plan),
    /// The plan that the enterprise named with its price.
    Theirs,
}

/// Basis of the value of a term.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Basis {
    /// Dollars per month and seat.
    Dollars,
    /// Percent of the plan's list price.
    List,
    /// Percent of the asking price.
    Asked,
}

impl Basis {
    pub fn words(self) -> &'static str {
        match self {
            Basis::Dollars => "$",
            Basis::List => "% list",
            Basis::Asked => "% ask",
        }
    }
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Term {
    pub plan: TermChoice,
    pub basis: Basis,
    /// Dollars or percent.
    pub value: f64,
}

const UNUSED: Term = Term { plan: TermChoice::Nothing, basis: Basis::List, value: 100.0 };

impl Term {
    pub fn plan_in_words(&self) -> &'static str {
        match self.plan {
            TermChoice::Nothing => "–",
            TermChoice::Fixed(plan) => plan.id(),
            TermChoice::Theirs => "theirs",
        }
    }

    /// Returns its value as text for the input field.
    pub fn value_in_words(&self) -> String {
        let decimals = if self.value.fract() == 0.0 && self.basis != Basis::Dollars { 0 } else { 2 };
        grouped(self.value, decimals)
    }

    pub fn turn_plan(&mut self) {
        self.plan = match self.plan {
            TermChoice::Nothing => TermChoice::Fixed(Plan::A),
            TermChoice::Fixed(Plan::A) => TermChoice::Fixed(Plan::B),
            TermChoice::Fixed(Plan::B) => TermChoice::Fixed(Plan::C),
            TermChoice::Fixed(Plan::C) => TermChoice::Theirs,
            TermChoice::Theirs => TermChoice::Nothing,
        };
    }

    /// Selects the next basis and resets the value, because dollars and percent are not interchangeable.
    pub fn turn_basis(&mut self, price: Option<f64>) {
        (self.basis, self.value) = match self.basis {
            Basis::List => (Basis::Asked, self.value),
            Basis::Asked => (Basis::Dollars, price.unwrap_or(0.0)),
            Basis::Dollars => (Basis::List, 100.0),
        };
    }

    /// Returns the plan and price for a thread; `None` if the term is unused or its reference price is
    /// missing.
    pub fn price(&self, thread: &Thread, lists: [f64; 3]) -> Option<(Plan, f64)> {
        let asked = thread.asked();
        let plan = match self.plan {
            TermChoice::Nothing => return None,
            TermChoice::Fixed(plan) => plan,
            TermChoice::Theirs => thread.asked_plan()?,
        };
        let price = match self.basis {
            Basis::Dollars => self.value,
            Basis::List => lists[plan as usize] * self.value / 100.0,
            Basis::Asked => asked?.1 * self.value / 100.0,
        };
        Some((plan, (price * 100.0).round() / 100.0))
    }
}

/// An offer to one enterprise, or a rule for many.
#[derive(Debug, Clone, PartialEq)]
pub struct Offer(pub [Term; TERMS]);

impl Offer {
    pub fn at_list() -> Offer {
        Offer([Term { plan: TermChoice::Fixed(Plan::B), ..UNUSED }, UNUSED, UNUSED])
    }

    /// Returns the asking price, for the plan that the enterprise named.
    pub fn as_asked() -> Offer {
        Offer([Term { plan: TermChoice::Theirs, basis: Basis::Asked, value: 100.0 }, UNUSED, UNUSED])
    }

    /// Returns the initial offer to an enterprise: its asking price, otherwise the list price of the plan
    /// that it asks about.
    pub fn first_for(thread: &Thread) -> Offer {
        match (thread.asked_plan(), thread.asked()) {
            (Some(_), Some(_)) => Offer::as_asked(),
            (Some(plan), None) => Offer([Term { plan: TermChoice::Fixed(plan), ..UNUSED }, UNUSED, UNUSED]),
            (None, _) => Offer::at_list(),
        }
    }

    /// Returns whether it can be reused for other enterprises.
    pub fn is_rule(&self) -> bool {
        self.0.iter().all(|term| term.plan == TermChoice::Nothing || term.basis != Basis::Dollars)
    }

    /// Returns the plans and prices for a thread.
    ///
    /// # Errors
    /// The reason why nothing can be sent.
    pub fn to(&self, thread: &Thread, lists: [f64; 3]) -> Result<Vec<(Plan, f64)>, String> {
        let terms: Vec<(Plan, f64)> = self.0.iter().filter_map(|term| term.price(thread, lists)).collect();
        match terms.iter().find(|(_, price)| *price <= 0.0) {
            Some((plan, _)) => Err(format!("plan {plan} would be free. Type a price above 0.")),
            None if terms.is_empty() && self.0.iter().all(|term| term.plan == TermChoice::Nothing) => {
                Err("no plan is chosen".to_owned())
            }
            None if terms.is_empty() => Err("they named no price".to_owned()),
            None => Ok(terms),
        }
    }
}

/// Returns an offer in short form: `B $38.00 · C $61.00`.
pub fn in_words(offers: &[(Plan, f64)]) -> String {
    let one = |(plan, price): &(Plan, f64)| format!("{plan} ${}", grouped(*price, 2));
    offers.iter().map(one).collect::<Vec<_>>().join(" · ")
}

#[cfg(test)]
mod tests {
    use super::super::model::Turn;
    use super::*;

    const LISTS: [f64; 3] = [14.0, 32.0, 0.0];

    fn asking() -> Thread {
        let turn = Turn {
            number: 2,
            sender: "customer".to_owned(),
            text: "At $20.01 for plan A".to_owned(),
            offers: Vec::new(),
            price: Some(20.01),
            day: 3,
            closes: String::new(),
        };
        Thread { turns: vec![turn], ..Thread::default() }
    }

    #[test]
    fn rules_are_relative_to_the_list_or_to_the_ask() {
        let (asking, silent) = (asking(), Thread::default());
        assert_eq!(Offer::as_asked().to(&asking, LISTS), Ok(vec![(Plan::A, 20.01)]));
        assert!(Offer::as_asked().to(&silent, LISTS).is_err());
        assert_eq!(Offer::at_list().to(&silent, LISTS), Ok(vec![(Plan::B, 32.0)]));
        let mut offer = Offer::at_list();
        offer.0[0].value = 90.0;
        offer.0[1] = Term { plan: TermChoice::Fixed(Plan::C), basis: Basis::Asked, value: 150.0 };
        assert_eq!(offer.to(&asking, LISTS), Ok(vec![(Plan::B, 28.8), (Plan::C, 30.02)]));
        assert_eq!(
            offer.to(&silent, LISTS),
            Ok(vec![(Plan::B, 28.8)]),
            "a term without a reference price is left out"
        );
        offer.0[2] = Term { plan: TermChoice::Fixed(Plan::C), ..UNUSED };
        assert!(offer.to(&asking, LISTS).is_err_and(|why| why.contains("plan C would be free")));
        assert!(Offer([UNUSED; 3]).to(&asking, LISTS).is_err_and(|why| why.contains("no plan")));
    }

    #[test]
    fn plans_and_bases_turn_round() {
        let mut term = UNUSED;
        for words in ["A", "B", "C", "theirs", "–"] {
            term.turn_plan();
            assert_eq!(term.plan_in_words(), words);
        }
        for (words, value) in [("% ask", 100.0), ("$", 28.5), ("% list", 100.0)] {
            term.turn_basis(Some(28.5));
            assert_eq!((term.basis.words(), term.value), (words, value));
        }
        assert!(Offer::at_list().is_rule());
    }
}
