//! Tables of the claims about common random draws.

use super::{ClaimResult, ConsistencyCheck};
use crate::lab_report::{CellValue, Column, LabReport, LabTable, Measure};

impl ConsistencyCheck {
    /// Returns a report with a row per claim and the results of the two policies.
    pub fn to_lab_report(&self) -> LabReport {
        let [one, other] = &self.policies;
        let mut exhibit = LabReport::with_table(
            format!("Common random draws of policies {one} and {other}"),
            self.claim_table(),
        );
        exhibit.tables.push(self.play_table());
        exhibit.notes.extend(self.claims.iter().filter_map(|claim_result| {
            let first = claim_result.first_difference.as_ref()?;
            Some(format!("Fails: {}. First difference: {first}.", claim_result.claim))
        }));
        if self.equalizes_surges {
            exhibit.notes.push(
                "One of the policies switches demand surges off. Both are played with surges, so that both play the same world."
                    .to_owned(),
            );
        }
        exhibit.with_note(
            "Each value is read from a world in which the policy was played. A control play of the first policy with another seed shows that a claim could have failed. The last column counts the values that differ in the control play.",
        )
    }

    fn claim_table(&self) -> LabTable {
        let columns = vec![
            Column::text("claim", "claim"),
            Column::text("verdict", "verdict"),
            Column::number("compared", "compared", Measure::Count),
            Column::text("of", "of"),
            Column::number("different", "different", Measure::Count),
            Column::number("compared_with_other_seed", "other seed, compared", Measure::Count),
            Column::number("different_under_other_seed", "other seed, different", Measure::Count),
        ];
        let row = |claim_result: &ClaimResult| {
            vec![
                CellValue::text(claim_result.claim),
                CellValue::text(claim_result.outcome.label()),
                CellValue::Number(claim_result.compared as f64),
                CellValue::text(claim_result.of),
                CellValue::Number(claim_result.different as f64),
                CellValue::Number(claim_result.compared_with_other_seed as f64),
                CellValue::Number(claim_result.different_under_other_seed as f64),
            ]
        };
        let rows = self.claims.iter().map(row).collect();
        LabTable { rows, ..LabTable::new("claims", "", columns) }
    }

    fn play_table(&self) -> LabTable {
        let columns = vec![
            Column::text("policy", "policy"),
            Column::number("day", "last day", Measure::Days),
            Column::number("cash", "cash", Measure::Dollars),
            Column::number("customers", "leads", Measure::Count),
            Column::number("found", "groups found", Measure::Count),
        ];
        let row = |(name, end): (&String, &super::PlayEnd)| {
            vec![
                CellValue::text(&**name),
                CellValue::Number(f64::from(end.day)),
                CellValue::Number(end.cash),
                CellValue::Number(end.customers as f64),
                CellValue::Number(f64::from(end.found)),
            ]
        };
        let rows = self.policies.iter().zip(&self.ends).map(row).collect();
        LabTable { rows, ..LabTable::new("plays", "Results of the two policies on the first seed", columns) }
    }
}
