//! A new database: tables, words, and the market observer.

use rusqlite::{Connection, params};

use crate::world::events::{Category, Source};
use crate::world::identifiers::Group;
use crate::world::params::Params;

/// Number of the layout of the database. A file with another one is made anew: raise it with every change of
/// `schema.sql` or of what is written into its tables.
pub(in crate::database) const LAYOUT: u32 = 4;

/// Creates the tables, the words, and row 1 of `customers`: the market observer.
pub(in crate::database) fn create(connection: &mut Connection, params: &Params) -> rusqlite::Result<()> {
    let transaction = connection.transaction()?;
    transaction.execute_batch(include_str!("../schema.sql"))?;
    transaction.pragma_update(None, "user_version", LAYOUT)?;
    transaction.execute(
        "INSERT INTO customer_rows (customer_id, group_id, created_day, email) \
         VALUES (1, 'S1', 0, 'market_observer@external')",
        [],
    )?;
    {
        let mut insert = transaction.prepare("INSERT INTO words VALUES (?1, ?2, ?3, ?4)")?;
        for group in Group::all() {
            for (axis, words) in axes(group, params) {
                for (n, word) in (0u32..).zip(&words) {
                    insert.execute(params![axis, group.id(), n, word])?;
                }
            }
            if group.is_enterprise() {
                insert.execute(params![
                    "plus",
                    group.id(),
                    params.personas.enterprise.size_plus_from_seats,
                    "+"
                ])?;
            }
        }
    }
    transaction.commit()
}

/// Word lists of a group by axis.
fn axes(group: Group, params: &Params) -> Vec<(&'static str, Vec<String>)> {
    let (own, personas) = (&params.personas.group[group.index()], &params.personas);
    let floor = params.group(group).q_min_mean;
    let quality = |edges: &[f64], labels: &[String]| {
        vec![labels[edges.iter().position(|edge| floor < *edge).unwrap_or(edges.len())].clone()]
    };
    let mut axes = vec![("industry", own.industry.clone()), ("role", own.role.clone())];
    if group.is_enterprise() {
        let common = &personas.enterprise;
        axes.extend([
            ("experience", vec![common.experience.clone()]),
            ("work_style", own.culture.clone()),
            ("tech_savvy", common.tech_savvy.clone()),
            ("size", own.company_size.clone()),
            ("decision", own.decision_style.clone()),
            ("concern", own.primary_concern.clone()),
            ("quality", quality(&common.quality_thresholds, &common.quality_labels)),
        ]);
    } else {
        let common = &personas.individual;
        axes.extend([
            ("experience", common.experience_levels.clone()),
            ("work_style", own.work_style.clone()),
            ("tech_savvy", common.tech_savvy.clone()),
            ("usage", common.usage_labels.to_vec()),
            ("budget", common.budget_labels.to_vec()),
            ("quality", quality(&common.quality_thresholds, &common.quality_labels)),
        ]);
    }
    axes
}

/// All sources fit the CASE of the view `customers`.
const _: () = assert!(Source::Organic as u8 == 6);
/// All categories fit the CASE of the view `ledger`.
const _: () = assert!(Category::ResearchProject as u8 == 11);
