//! Profile attributes of a customer, stored as positions in word lists. The words are looked up when a row is written
//! (docs/mechanics/customers/personas.md).

use crate::canonical::{Canonical, CanonicalHasher, CanonicalReader, Restore};
use crate::identifiers::Group;
use crate::params::Params;
use crate::random::Stream;

/// Positions in the word lists of the group's profile, in draw order.
///
/// Individuals: industry, role, experience, work style, technical skill, unused, unused.
/// Enterprises: industry, role, technical skill, company size, culture, decision style, primary concern.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct PersonaPicks(pub [u8; 7]);

impl Canonical for PersonaPicks {
    fn feed(&self, hasher: &mut CanonicalHasher) {
        hasher.append_bytes(&self.0);
    }
}

impl Restore for PersonaPicks {
    fn restore(reader: &mut CanonicalReader<'_>) -> Option<Self> {
        reader.read().map(PersonaPicks)
    }
}

impl PersonaPicks {
    /// Draws one list position for each profile attribute.
    pub fn draw(group: Group, params: &Params, stream: &mut Stream) -> PersonaPicks {
        let group_persona = &params.personas.group[group.index()];
        let axes = if group.is_enterprise() {
            [
                group_persona.industry.len(),
                group_persona.role.len(),
                params.personas.enterprise.tech_savvy.len(),
                group_persona.company_size.len(),
                group_persona.culture.len(),
                group_persona.decision_style.len(),
                group_persona.primary_concern.len(),
            ]
        } else {
            let common = &params.personas.individual;
            let (experience, skill) = (common.experience_levels.len(), common.tech_savvy.len());
            [
                group_persona.industry.len(),
                group_persona.role.len(),
                experience,
                group_persona.work_style.len(),
                skill,
                0,
                0,
            ]
        };
        PersonaPicks(axes.map(|length| if length == 0 { 0 } else { stream.index(length) as u8 }))
    }
}
