//! Packed days of the table `ledger`. Most rows are lead costs in the order of customers, or payments with few distinct
//! amounts.

use std::collections::BTreeMap;

use super::packing::{KindSet, PackedRows, Packer, Unpacker};
use novamind_world::events::Category;

/// Ledger categories in alphabetical order.
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
pub(super) const LEAD_COST_CATEGORY: usize = 7;
pub(super) const PAYMENT_CATEGORY: usize = 11;
/// Categories whose entries are income, as a set of bits.
pub(super) const INCOME_CATEGORIES: KindSet = 1 | 1 << 6 | 1 << PAYMENT_CATEGORY;

/// A ledger entry that is neither a lead cost nor a payment.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct OtherEntry {
    pub category: u8,
    pub amount: f64,
    pub note: String,
}

/// The ledger entries of a day: lead costs, payments, and other entries.
#[derive(Debug, Clone, PartialEq, Default)]
pub(super) struct LedgerDay {
    day: u32,
    first: u64,
    /// Cost per lead in dollars, negative.
    pub lead_cost: f64,
    leads: u32,
    payments: u32,
    /// Packed [`LeadsAndPayments`] of the day.
    pub packed: Vec<u8>,
    others: Vec<OtherEntry>,
}

/// The customers of the day's lead costs, and the customers and amounts of the day's payments.
#[derive(Debug, Clone, PartialEq, Default)]
pub(super) struct LeadsAndPayments {
    pub leads: Vec<u32>,
    pub payments: Vec<(u32, f64)>,
}

impl LedgerDay {
    /// Returns a ledger day without entries.
    pub fn new(day: u32, first: u64, lead_cost: f64) -> LedgerDay {
        let packed = LeadsAndPayments::default().pack();
        // SQLite does not store negative zero.
        let lead_cost = lead_cost + 0.0;
        LedgerDay { day, first, lead_cost, packed, ..LedgerDay::default() }
    }

    /// Sets the lead costs and payments of the day.
    pub fn set_leads_and_payments(&mut self, movements: &LeadsAndPayments) {
        (self.leads, self.payments) = (movements.leads.len() as u32, movements.payments.len() as u32);
        self.packed = movements.pack();
    }

    /// Appends an entry that is neither a lead cost nor a payment.
    pub fn push(&mut self, category: Category, amount: f64, note: String) {
        let category = CATEGORIES.binary_search(&category.id()).unwrap_or_default() as u8;
        self.others.push(OtherEntry { category, amount: amount + 0.0, note });
    }

    /// Returns the bytes that are stored in the database file.
    pub fn to_bytes(&self) -> Vec<u8> {
        let mut packer = Packer::default();
        packer.push_number(self.first);
        packer.push_float(self.lead_cost);
        for number in [u64::from(self.leads), self.payments.into(), self.packed.len() as u64] {
            packer.push_number(number);
        }
        packer.push_bytes(&self.packed);
        packer.push_number(self.others.len() as u64);
        for OtherEntry { category, amount, note } in &self.others {
            packer.push_number(u64::from(*category));
            packer.push_float(*amount);
            packer.push_number(note.len() as u64);
            packer.push_bytes(note.as_bytes());
        }
        packer.finish()
    }

    /// Parses the stored bytes of a day. Returns `None` if the bytes are invalid.
    pub fn from_bytes(day: u32, bytes: &[u8]) -> Option<LedgerDay> {
        let mut unpacker = Unpacker::new(bytes);
        let (first, lead_cost) = (unpacker.read_number()?, unpacker.read_float()?);
        let (leads, payments) = (unpacker.read_u32()?, unpacker.read_u32()?);
        let length = unpacker.read_u32()?;
        let packed = unpacker.read_bytes(length as usize)?.to_vec();
        let mut others = Vec::new();
        for _ in 0..unpacker.read_number()? {
            let (category, amount, length) =
                (unpacker.read_u32()?, unpacker.read_float()?, unpacker.read_u32()?);
            let note = std::str::from_utf8(unpacker.read_bytes(length as usize)?).ok()?.to_owned();
            let category =
                u8::try_from(category).ok().filter(|number| usize::from(*number) < CATEGORIES.len())?;
            others.push(OtherEntry { category, amount, note });
        }
        let movements = LeadsAndPayments::unpack(&packed)?;
        let sound = movements.leads.len() == leads as usize && movements.payments.len() == payments as usize;
        let read = LedgerDay { day, first, lead_cost, leads, payments, packed, others };
        (sound && unpacker.is_empty()).then_some(read)
    }

    /// Returns the entry at a position of the day, counted from 0.
    pub fn entry_at(&self, place: u64) -> LedgerRow<'_> {
        let (leads, payments) = (u64::from(self.leads), u64::from(self.payments));
        match place {
            place if place < leads => LedgerRow::Lead(place as usize),
            place if place < leads + payments => LedgerRow::Payment((place - leads) as usize),
            place => LedgerRow::Other(&self.others[(place - leads - payments) as usize]),
        }
    }
}

/// An entry of a ledger day. Leads and payments are indexes into the unpacked [`LeadsAndPayments`].
pub(super) enum LedgerRow<'a> {
    Lead(usize),
    Payment(usize),
    Other(&'a OtherEntry),
}

impl LeadsAndPayments {
    fn pack(&self) -> Vec<u8> {
        let mut packer = Packer::default();
        packer.push_ascending(&self.leads);
        let mut places: BTreeMap<u64, u64> = BTreeMap::new();
        let mut amounts = Vec::new();
        for (_, amount) in &self.payments {
            places.entry(amount.to_bits()).or_insert_with(|| {
                amounts.push(*amount);
                amounts.len() as u64 - 1
            });
        }
        packer.push_number(amounts.len() as u64);
        amounts.iter().for_each(|amount| packer.push_float(*amount));
        packer.push_number(self.payments.len() as u64);
        let mut before = 0i64;
        for (customer, amount) in &self.payments {
            let step = i64::from(*customer) - before;
            before = i64::from(*customer);
            // Zigzag encoding: small differences of either sign are small numbers.
            packer.push_number((step << 1 ^ step >> 63) as u64);
            packer.push_number(places[&amount.to_bits()]);
        }
        packer.finish()
    }

    /// Parses packed lead costs and payments. Returns `None` if the bytes are invalid.
    pub fn unpack(bytes: &[u8]) -> Option<LeadsAndPayments> {
        let mut unpacker = Unpacker::new(bytes);
        let leads = unpacker.read_ascending()?;
        let amounts: Vec<f64> =
            (0..unpacker.read_number()?).map(|_| unpacker.read_float()).collect::<Option<_>>()?;
        let mut before = 0i64;
        let payments = (0..unpacker.read_number()?).map(|_| {
            let step = unpacker.read_number()?;
            before = before.checked_add((step >> 1) as i64 ^ -((step & 1) as i64))?;
            Some((u32::try_from(before).ok()?, *amounts.get(unpacker.read_u32()? as usize)?))
        });
        let payments = payments.collect::<Option<_>>()?;
        Some(LeadsAndPayments { leads, payments }).filter(|_| unpacker.is_empty())
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

    fn next_of_kinds(&self, kinds: KindSet, place: u64) -> Option<u64> {
        let (leads, packed) = (u64::from(self.leads), u64::from(self.leads) + u64::from(self.payments));
        if place < leads && kinds & 1 << LEAD_COST_CATEGORY != 0 {
            return Some(place);
        }
        let place = place.max(leads);
        if place < packed && kinds & 1 << PAYMENT_CATEGORY != 0 {
            return Some(place);
        }
        let place = place.max(packed);
        let mut others = self.others.iter().skip((place - packed) as usize);
        others.position(|other_entry| kinds & 1 << other_entry.category != 0).map(|at| place + at as u64)
    }
}

pub(super) fn lead_note(customer: u32) -> String {
    format!("Lead acquisition cost for customer {customer}")
}

pub(super) fn payment_note(customer: u32) -> String {
    format!("Subscription payment from customer {customer}")
}

impl LedgerDay {
    /// Returns all rows of the day: number, category, amount, note.
    pub fn rows(&self) -> impl Iterator<Item = (u64, &'static str, f64, String)> + '_ {
        let movements = LeadsAndPayments::unpack(&self.packed).unwrap_or_default();
        (0..self.len()).map(move |place| {
            let number = self.first + place;
            match self.entry_at(place) {
                LedgerRow::Lead(at) => {
                    (number, CATEGORIES[LEAD_COST_CATEGORY], self.lead_cost, lead_note(movements.leads[at]))
                }
                LedgerRow::Payment(at) => {
                    let (customer, amount) = movements.payments[at];
                    (number, CATEGORIES[PAYMENT_CATEGORY], amount, payment_note(customer))
                }
                LedgerRow::Other(other_entry) => (
                    number,
                    CATEGORIES[usize::from(other_entry.category)],
                    other_entry.amount,
                    other_entry.note.clone(),
                ),
            }
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn day() -> LedgerDay {
        let mut day = LedgerDay::new(3, 40, -0.5);
        let payments = vec![(7, 12.0), (2, 25.0), (1_000_000, 12.0)];
        day.set_leads_and_payments(&LeadsAndPayments { leads: vec![5, 6, 90], payments });
        day.push(Category::Capacity, -85.0, "Daily capacity cost".to_owned());
        day.push(Category::AdRevenue, 3.25, "In-app ad revenue (2 subscribers)".to_owned());
        day
    }

    #[test]
    fn categories_are_sorted_and_income_is_never_negative() {
        assert!(CATEGORIES.is_sorted());
        for category in Category::ALL {
            let at = CATEGORIES.binary_search(&category.id()).expect("a category");
            let income = matches!(
                category,
                Category::InitialFunding | Category::SubscriptionPayment | Category::AdRevenue
            );
            assert_eq!(INCOME_CATEGORIES & 1 << at != 0, income, "{}", category.id());
        }
        assert_eq!(
            (CATEGORIES[LEAD_COST_CATEGORY], CATEGORIES[PAYMENT_CATEGORY]),
            ("lead_acquisition_cost", "subscription_payment")
        );
    }

    #[test]
    fn ledger_day_round_trips() {
        let day = day();
        assert_eq!(LedgerDay::from_bytes(3, &day.to_bytes()), Some(day.clone()));
        assert_eq!(LedgerDay::from_bytes(3, &day.to_bytes()[1..]), None);
        assert_eq!(LedgerDay::from_bytes(3, &day.to_bytes()[..day.to_bytes().len() - 1]), None);
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
    fn next_of_kinds_skips_other_categories() {
        let day = day();
        let places = |kinds: KindSet| {
            let next = |place: &u64| day.next_of_kinds(kinds, place + 1);
            std::iter::successors(day.next_of_kinds(kinds, 0), next).collect::<Vec<_>>()
        };
        assert_eq!(places(KindSet::MAX), (0..8).collect::<Vec<_>>());
        assert_eq!(places(1 << PAYMENT_CATEGORY), [3, 4, 5]);
        assert_eq!(places(!INCOME_CATEGORIES), [0, 1, 2, 6]);
        assert_eq!(places(1), [7]);
        assert_eq!(places(0), [0u64; 0]);
    }

    proptest! {
        #[test]
        fn leads_and_payments_round_trip(leads in proptest::collection::btree_set(any::<u32>(), 0..20),
            payments in proptest::collection::vec((any::<u32>(), -9i32..9), 0..40)) {
            let payments = payments.into_iter().map(|(customer, amount)| (customer, f64::from(amount) / 7.0)).collect();
            let movements = LeadsAndPayments { leads: leads.into_iter().collect(), payments };
            prop_assert_eq!(LeadsAndPayments::unpack(&movements.pack()), Some(movements));
        }

        #[test]
        fn damaged_bytes_never_panic(bytes in proptest::collection::vec(any::<u8>(), 0..60)) {
            if let Some(day) = LedgerDay::from_bytes(1, &bytes) {
                let _ = day.rows().count();
            }
        }
    }
}
