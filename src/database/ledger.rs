//! The ledger as packed days. Most rows are lead costs, in the order of their customers, and payments with few different
//! amounts.

use std::collections::BTreeMap;

use super::packing::{Kinds, PackedRows, Packer, Unpacker};
use novamind_world::events::Category;

/// Categories in alphabetical order.
pub(super) const CATEGORIES: [&str; 12] = [
    "ad_revenue",
    "advertising",
    "capacity",
    "compute",
    "development",
    "group_research",
    "initial_funding",
    "lead_acquisition_cost",
    "market_research",
    "operations",
    "research_project",
    "subscription_payment",
];
pub(super) const LEADS: usize = 7;
pub(super) const PAYMENTS: usize = 11;
/// Income categories.
pub(super) const INCOME: Kinds = 1 | 1 << 6 | 1 << PAYMENTS;

/// A ledger entry that is neither a lead cost nor a payment.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct OtherEntry {
    pub category: u8,
    pub amount: f64,
    pub note: String,
}

/// The ledger entries of a day: lead costs, payments, others.
#[derive(Debug, Clone, PartialEq, Default)]
pub(super) struct LedgerDay {
    day: u32,
    first: u64,
    /// Cost per lead in dollars, negative.
    pub lead_cost: f64,
    leads: u32,
    payments: u32,
    /// Customers and amounts, packed.
    pub packed: Vec<u8>,
    others: Vec<OtherEntry>,
}

/// Customers of lead costs, and payments with their customers.
#[derive(Debug, Clone, PartialEq, Default)]
pub(super) struct Movements {
    pub leads: Vec<u32>,
    pub payments: Vec<(u32, f64)>,
}

impl LedgerDay {
    /// Returns a day without entries.
    pub fn of(day: u32, first: u64, lead_cost: f64) -> LedgerDay {
        let packed = Movements::default().packed();
        // SQLite keeps no negative zero.
        let lead_cost = lead_cost + 0.0;
        LedgerDay { day, first, lead_cost, packed, ..LedgerDay::default() }
    }

    /// Sets lead costs and payments.
    pub fn set(&mut self, movements: &Movements) {
        (self.leads, self.payments) = (movements.leads.len() as u32, movements.payments.len() as u32);
        self.packed = movements.packed();
    }

    /// Adds another entry.
    pub fn push(&mut self, category: Category, amount: f64, note: String) {
        let category = CATEGORIES.binary_search(&category.id()).unwrap_or_default() as u8;
        self.others.push(OtherEntry { category, amount: amount + 0.0, note });
    }

    /// Returns the bytes in the file.
    pub fn bytes(&self) -> Vec<u8> {
        let mut packer = Packer::default();
        packer.number(self.first);
        packer.float(self.lead_cost);
        for number in [u64::from(self.leads), self.payments.into(), self.packed.len() as u64] {
            packer.number(number);
        }
        packer.bytes(&self.packed);
        packer.number(self.others.len() as u64);
        for OtherEntry { category, amount, note } in &self.others {
            packer.number(u64::from(*category));
            packer.float(*amount);
            packer.number(note.len() as u64);
            packer.bytes(note.as_bytes());
        }
        packer.finish()
    }

    /// Parses the bytes of a day. Returns `None` if they are invalid.
    pub fn read(day: u32, bytes: &[u8]) -> Option<LedgerDay> {
        let mut unpacker = Unpacker::of(bytes);
        let (first, lead_cost) = (unpacker.number()?, unpacker.float()?);
        let (leads, payments) = (unpacker.small()?, unpacker.small()?);
        let length = unpacker.small()?;
        let packed = unpacker.bytes(length as usize)?.to_vec();
        let mut others = Vec::new();
        for _ in 0..unpacker.number()? {
            let (category, amount, length) = (unpacker.small()?, unpacker.float()?, unpacker.small()?);
            let note = std::str::from_utf8(unpacker.bytes(length as usize)?).ok()?.to_owned();
            let category = u8::try_from(category).ok().filter(|own| usize::from(*own) < CATEGORIES.len())?;
            others.push(OtherEntry { category, amount, note });
        }
        let movements = Movements::unpack(&packed)?;
        let sound = movements.leads.len() == leads as usize && movements.payments.len() == payments as usize;
        let read = LedgerDay { day, first, lead_cost, leads, payments, packed, others };
        (sound && unpacker.is_empty()).then_some(read)
    }

    /// Returns the entry at a place, from 0.
    pub fn at(&self, place: u64) -> Movement<'_> {
        let (leads, payments) = (u64::from(self.leads), u64::from(self.payments));
        match place {
            place if place < leads => Movement::Lead(place as usize),
            place if place < leads + payments => Movement::Payment((place - leads) as usize),
            place => Movement::Other(&self.others[(place - leads - payments) as usize]),
        }
    }
}

/// An entry at a place of a day.
pub(super) enum Movement<'a> {
    Lead(usize),
    Payment(usize),
    Other(&'a OtherEntry),
}

impl Movements {
    fn packed(&self) -> Vec<u8> {
        let mut packer = Packer::default();
        packer.ascending(&self.leads);
        let mut places: BTreeMap<u64, u64> = BTreeMap::new();
        let mut amounts = Vec::new();
        for (_, amount) in &self.payments {
            places.entry(amount.to_bits()).or_insert_with(|| {
                amounts.push(*amount);
                amounts.len() as u64 - 1
            });
        }
        packer.number(amounts.len() as u64);
        amounts.iter().for_each(|amount| packer.float(*amount));
        packer.number(self.payments.len() as u64);
        let mut before = 0i64;
        for (customer, amount) in &self.payments {
            let step = i64::from(*customer) - before;
            before = i64::from(*customer);
            // Zigzag encoding: small differences of either sign are small numbers.
            packer.number((step << 1 ^ step >> 63) as u64);
            packer.number(places[&amount.to_bits()]);
        }
        packer.finish()
    }

    /// Parses packed entries. Returns `None` if the bytes are invalid.
    pub fn unpack(bytes: &[u8]) -> Option<Movements> {
        let mut unpacker = Unpacker::of(bytes);
        let leads = unpacker.ascending()?;
        let amounts: Vec<f64> = (0..unpacker.number()?).map(|_| unpacker.float()).collect::<Option<_>>()?;
        let mut before = 0i64;
        let payments = (0..unpacker.number()?).map(|_| {
            let step = unpacker.number()?;
            before = before.checked_add((step >> 1) as i64 ^ -((step & 1) as i64))?;
            Some((u32::try_from(before).ok()?, *amounts.get(unpacker.small()? as usize)?))
        });
        let payments = payments.collect::<Option<_>>()?;
        Some(Movements { leads, payments }).filter(|_| unpacker.is_empty())
    }
}

impl PackedRows for LedgerDay {
    fn day(&self) -> u32 {
        self.day
    }

    fn first(&self) -> u64 {
        self.first
    }

    fn len(&self) -> u64 {
        u64::from(self.leads) + u64::from(self.payments) + self.others.len() as u64
    }

    fn next_among(&self, kinds: Kinds, place: u64) -> Option<u64> {
        let (leads, packed) = (u64::from(self.leads), u64::from(self.leads) + u64::from(self.payments));
        if place < leads && kinds & 1 << LEADS != 0 {
            return Some(place);
        }
        let place = place.max(leads);
        if place < packed && kinds & 1 << PAYMENTS != 0 {
            return Some(place);
        }
        let place = place.max(packed);
        let mut others = self.others.iter().skip((place - packed) as usize);
        others.position(|own| kinds & 1 << own.category != 0).map(|at| place + at as u64)
    }
}

pub(super) fn lead_note(customer: u32) -> String {
    format!("Lead acquisition cost for customer {customer}")
}

pub(super) fn payment_note(customer: u32) -> String {
    format!("Subscription payment from customer {customer}")
}

impl LedgerDay {
    /// Returns all rows: number, category, amount, note.
    pub fn rows(&self) -> impl Iterator<Item = (u64, &'static str, f64, String)> + '_ {
        let movements = Movements::unpack(&self.packed).unwrap_or_default();
        (0..self.len()).map(move |place| {
            let number = self.first + place;
            match self.at(place) {
                Movement::Lead(at) => {
                    (number, CATEGORIES[LEADS], self.lead_cost, lead_note(movements.leads[at]))
                }
                Movement::Payment(at) => {
                    let (customer, amount) = movements.payments[at];
                    (number, CATEGORIES[PAYMENTS], amount, payment_note(customer))
                }
                Movement::Other(own) => {
                    (number, CATEGORIES[usize::from(own.category)], own.amount, own.note.clone())
                }
            }
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn day() -> LedgerDay {
        let mut day = LedgerDay::of(3, 40, -0.5);
        let payments = vec![(7, 12.0), (2, 25.0), (1_000_000, 12.0)];
        day.set(&Movements { leads: vec![5, 6, 90], payments });
        day.push(Category::Capacity, -85.0, "Daily capacity cost".to_owned());
        day.push(Category::AdRevenue, 3.25, "In-app ad revenue (2 subscribers)".to_owned());
        day
    }

    #[test]
    fn categories_stand_in_ascending_order_and_income_is_what_never_takes() {
        assert!(CATEGORIES.is_sorted());
        for category in Category::ALL {
            let at = CATEGORIES.binary_search(&category.id()).expect("a category");
            let income = matches!(
                category,
                Category::InitialFunding | Category::SubscriptionPayment | Category::AdRevenue
            );
            assert_eq!(INCOME & 1 << at != 0, income, "{}", category.id());
        }
        assert_eq!(
            (CATEGORIES[LEADS], CATEGORIES[PAYMENTS]),
            ("lead_acquisition_cost", "subscription_payment")
        );
    }

    #[test]
    fn a_day_comes_back_as_it_went() {
        let day = day();
        assert_eq!(LedgerDay::read(3, &day.bytes()), Some(day.clone()));
        assert_eq!(LedgerDay::read(3, &day.bytes()[1..]), None);
        assert_eq!(LedgerDay::read(3, &day.bytes()[..day.bytes().len() - 1]), None);
        let rows: Vec<_> = day.rows().collect();
        assert_eq!(rows.len() as u64, day.len());
        assert_eq!(
            rows[2],
            (42, "lead_acquisition_cost", -0.5, "Lead acquisition cost for customer 90".to_owned())
        );
        assert_eq!(
            rows[4],
            (44, "subscription_payment", 25.0, "Subscription payment from customer 2".to_owned())
        );
        assert_eq!(rows[6].1, "capacity");
    }

    #[test]
    fn kinds_skip_what_they_leave_out() {
        let day = day();
        let places = |kinds: Kinds| {
            let next = |place: &u64| day.next_among(kinds, place + 1);
            std::iter::successors(day.next_among(kinds, 0), next).collect::<Vec<_>>()
        };
        assert_eq!(places(Kinds::MAX), (0..8).collect::<Vec<_>>());
        assert_eq!(places(1 << PAYMENTS), [3, 4, 5]);
        assert_eq!(places(!INCOME), [0, 1, 2, 6]);
        assert_eq!(places(1), [7]);
        assert_eq!(places(0), [0u64; 0]);
    }

    proptest! {
        #[test]
        fn movements_come_back_as_they_went(leads in proptest::collection::btree_set(any::<u32>(), 0..20),
            payments in proptest::collection::vec((any::<u32>(), -9i32..9), 0..40)) {
            let payments = payments.into_iter().map(|(customer, amount)| (customer, f64::from(amount) / 7.0)).collect();
            let movements = Movements { leads: leads.into_iter().collect(), payments };
            prop_assert_eq!(Movements::unpack(&movements.packed()), Some(movements));
        }

        #[test]
        fn damaged_bytes_never_panic(bytes in proptest::collection::vec(any::<u8>(), 0..60)) {
            if let Some(day) = LedgerDay::read(1, &bytes) {
                let _ = day.rows().count();
            }
        }
    }
}
