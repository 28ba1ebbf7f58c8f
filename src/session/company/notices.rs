//! Texts of notices. A notice names its enterprise if the day's facts identify it.

use super::feed::entry_of;
use super::simulation::Simulation;
use novamind_database::Entry;
use novamind_voice::notices::Party;
use novamind_world::events::{EndCause, Notice, SubscriptionStatus};

impl Simulation {
    pub(crate) fn entry(&self) -> Entry {
        entry_of(&self.facts, self.notice_texts(), &self.feed, &self.params)
    }

    /// Returns the texts of the notices of the last day or call. Texts of repeated lead losses are empty, because the
    /// database stores them as one fact.
    pub(crate) fn notice_texts(&self) -> Vec<String> {
        let mut parties = Parties::of(self);
        self.facts.notices.iter().map(|notice| self.notice_text(notice, parties.next(notice))).collect()
    }

    fn notice_text(&self, notice: &Notice, party: Option<Party>) -> String {
        let Notice::OwnPostSeen(reaction) = notice else {
            return novamind_voice::notices::notice(notice, party);
        };
        let own = self.world.market.social.own.get(reaction.post as usize - 1);
        let content = own.map_or("", |post| post.content.as_str());
        novamind_voice::notices::reaction_to(content, reaction, &self.params.ceo_posts)
    }
}

/// The enterprises of a day's notices, by kind, in the order of the notices.
struct Parties {
    asking: std::vec::IntoIter<Party>,
    silent: std::vec::IntoIter<Party>,
    unanswered: std::vec::IntoIter<Party>,
    agreed: std::vec::IntoIter<Party>,
}

impl Parties {
    fn of(simulation: &Simulation) -> Parties {
        let Simulation { facts, world, .. } = simulation;
        let notices = |fits: &dyn Fn(&Notice) -> bool| facts.notices.iter().filter(|own| fits(own)).count();
        // Without a one-to-one match, no enterprise is named.
        let only = |parties: Vec<Party>, count: usize| {
            if parties.len() == count { parties.into_iter() } else { Vec::new().into_iter() }
        };
        let ended = |cause: EndCause| -> Vec<Party> {
            let of_cause = facts.endings.iter().filter(|ending| ending.cause == cause);
            of_cause
                .map(|ending| Party { customer: ending.customer, group: ending.group, seats: ending.seats })
                .collect()
        };
        let group = |customer: u32| world.enterprise.company(customer).map(|company| company.group);
        let asking: Vec<Party> = facts
            .openings
            .iter()
            .filter(|opening| opening.status == SubscriptionStatus::Lead)
            .filter_map(|own| {
                Some(Party { customer: own.customer, group: group(own.customer)?, seats: own.seats })
            })
            .collect();
        let agreed: Vec<Party> = facts
            .deals
            .iter()
            .filter_map(|deal| {
                Some(Party { customer: deal.customer, group: group(deal.customer)?, seats: deal.seats })
            })
            .collect();
        let first = |notice: &Notice| matches!(notice, Notice::LeadLostByTimeout { .. });
        Parties {
            asking: only(asking, notices(&|own| *own == Notice::EnterpriseLead)),
            silent: only(ended(EndCause::LeadSilent), notices(&|own| *own == Notice::LeadSilent)),
            unanswered: only(ended(EndCause::LeadTimeout), notices(&first)),
            agreed: only(agreed, notices(&|own| matches!(own, Notice::DealWon { .. }))),
        }
    }

    fn next(&mut self, notice: &Notice) -> Option<Party> {
        match notice {
            Notice::EnterpriseLead => self.asking.next(),
            Notice::LeadSilent => self.silent.next(),
            Notice::LeadLostByTimeout { .. } => self.unanswered.next(),
            Notice::DealWon { .. } => self.agreed.next(),
            _ => None,
        }
    }
}
