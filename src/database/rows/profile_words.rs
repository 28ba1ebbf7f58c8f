//! Writes the words of customer profiles. The words of a group are written when the group is discovered or has its
//! first customer, so that the file reveals nothing about undiscovered groups.

use rusqlite::{Transaction, params};

use novamind_world::events::Facts;
use novamind_world::identifiers::Group;
use novamind_world::params::Params;

/// Writes the profile words of a group when the group becomes known.
#[derive(Default)]
pub(super) struct ProfileWordWriter {
    /// Groups whose words this writer has written.
    written: [bool; Group::COUNT],
}

impl ProfileWordWriter {
    /// Writes the words of the groups that become known through these facts.
    pub(super) fn write(
        &mut self,
        transaction: &Transaction<'_>,
        facts: &Facts,
        params: &Params,
    ) -> rusqlite::Result<()> {
        let found =
            facts.knowledge.iter().filter(|(_, knowledge)| knowledge.level >= 1).map(|(group, _)| *group);
        for group in found.chain(facts.arrivals.iter().map(|arrival| arrival.group)) {
            if !self.written[group.index()] {
                write_group(transaction, group, params)?;
                self.written[group.index()] = true;
            }
        }
        Ok(())
    }
}

fn write_group(transaction: &Transaction<'_>, group: Group, params: &Params) -> rusqlite::Result<()> {
    // A continued database already contains some of the words.
    let mut insert = transaction.prepare_cached("INSERT OR IGNORE INTO words VALUES (?1, ?2, ?3, ?4)")?;
    for (axis, words) in word_axes(group, params) {
        for (n, word) in (0u32..).zip(&words) {
            insert.execute(params![axis, group.id(), n, word])?;
        }
    }
    if group.is_enterprise() {
        let seats = params.personas.enterprise.size_plus_from_seats;
        insert.execute(params!["plus", group.id(), seats, "+"])?;
    }
    Ok(())
}

fn word_axes(group: Group, params: &Params) -> Vec<(&'static str, Vec<String>)> {
    let (group_persona, personas) = (&params.personas.group[group.index()], &params.personas);
    let floor = params.group(group).q_min_mean;
    let quality = |edges: &[f64], labels: &[String]| {
        vec![labels[edges.iter().position(|edge| floor < *edge).unwrap_or(edges.len())].clone()]
    };
    let mut axes = vec![("industry", group_persona.industry.clone()), ("role", group_persona.role.clone())];
    if group.is_enterprise() {
        let common = &personas.enterprise;
        axes.extend([
            ("experience", vec![common.experience.clone()]),
            ("work_style", group_persona.culture.clone()),
            ("tech_savvy", common.tech_savvy.clone()),
            ("size", group_persona.company_size.clone()),
            ("decision", group_persona.decision_style.clone()),
            ("concern", group_persona.primary_concern.clone()),
            ("quality", quality(&common.quality_thresholds, &common.quality_labels)),
        ]);
    } else {
        let common = &personas.individual;
        axes.extend([
            ("experience", common.experience_levels.clone()),
            ("work_style", group_persona.work_style.clone()),
            ("tech_savvy", common.tech_savvy.clone()),
            ("usage", common.usage_labels.to_vec()),
            ("budget", common.budget_labels.to_vec()),
            ("quality", quality(&common.quality_thresholds, &common.quality_labels)),
        ]);
    }
    axes
}
