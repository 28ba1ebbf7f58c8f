//! Tables of the claims on common random draws.

use super::{ConsistencyCheck, TriedClaim};
use crate::exhibit::{Column, Datum, Exhibit, Measure, Tabulation};

impl ConsistencyCheck {
    /// Returns a row per claim and the results of the two plays.
    pub fn exhibit(&self) -> Exhibit {
        let [one, other] = &self.policies;
        let mut exhibit =
            Exhibit::of(format!("Common random draws of policies {one} and {other}"), self.claims());
        exhibit.tables.push(self.plays());
        exhibit.notes.extend(self.claims.iter().filter_map(|own| {
            let first = own.first_difference.as_ref()?;
            Some(format!("Fails: {}. First difference: {first}.", own.claim))
        }));
        if self.equalises_surges {
            exhibit.notes.push(
                "One of the policies switches demand surges off. Both are played with surges, so that both play the same world."
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
            Column::numbers("customers", "leads", Measure::Count),
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
        Tabulation {
            rows,
            ..Tabulation::new("plays", "Results of the two policies on the first seed", columns)
        }
    }
}
