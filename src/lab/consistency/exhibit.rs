//! The claims on common luck as an exhibit.

use super::{ConsistencyCheck, TriedClaim};
use crate::exhibit::{Column, Datum, Exhibit, Measure, Tabulation};

impl ConsistencyCheck {
    /// A row for each claim, and what the two plays came to.
    pub fn exhibit(&self) -> Exhibit {
        let [one, other] = &self.policies;
        let mut exhibit = Exhibit::of(format!("Common luck of policies {one} and {other}"), self.claims());
        exhibit.tables.push(self.plays());
        exhibit.notes.extend(self.claims.iter().filter_map(|own| {
            let first = own.first_difference.as_ref()?;
            Some(format!("Fails: {}. The first that differs: {first}.", own.claim))
        }));
        if self.equalises_surges {
            exhibit.notes.push(
                "One of the policies switches demand surges off; both are played with them, so that both play one world."
                    .to_owned(),
            );
        }
        exhibit.with_note(
            "Each value is read from a world in which the policy was played. Another seed shows that a claim could have failed: \
             the last column counts what differs from the same policy under it.",
        )
    }

    fn claims(&self) -> Tabulation {
        let columns = vec![
            Column::words("claim", "claim"),
            Column::words("verdict", "verdict"),
            Column::numbers("compared", "compared", Measure::Count),
            Column::words("of", "of"),
            Column::numbers("different", "different", Measure::Count),
            Column::numbers("compared_with_other_seed", "other seed, compared", Measure::Count),
            Column::numbers("different_under_other_seed", "other seed, different", Measure::Count),
        ];
        let row = |own: &TriedClaim| {
            vec![
                Datum::words(own.claim),
                Datum::words(own.verdict.in_words()),
                Datum::Number(own.compared as f64),
                Datum::words(own.of),
                Datum::Number(own.different as f64),
                Datum::Number(own.compared_with_other_seed as f64),
                Datum::Number(own.different_under_other_seed as f64),
            ]
        };
        let rows = self.claims.iter().map(row).collect();
        Tabulation { rows, ..Tabulation::new("claims", "", columns) }
    }

    fn plays(&self) -> Tabulation {
        let columns = vec![
            Column::words("policy", "policy"),
            Column::numbers("day", "last day", Measure::Days),
            Column::numbers("cash", "cash", Measure::Dollars),
            Column::numbers("customers", "customers who came", Measure::Count),
            Column::numbers("found", "groups found", Measure::Count),
        ];
        let row = |(name, end): (&String, &super::LuckEnd)| {
            vec![
                Datum::words(&**name),
                Datum::Number(f64::from(end.day)),
                Datum::Number(end.cash),
                Datum::Number(end.customers as f64),
                Datum::Number(f64::from(end.found)),
            ]
        };
        let rows = self.policies.iter().zip(&self.ends).map(row).collect();
        Tabulation { rows, ..Tabulation::new("plays", "What the two made of the first seed", columns) }
    }
}
