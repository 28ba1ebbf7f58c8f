//! Texts of notices. A notice names its enterprise if the facts of the day identify the enterprise.

use super::feed::build_entry;
use super::simulation::Simulation;
use novamind_database::ProjectionEntry;
use novamind_voice::notices::NoticeCustomer;
use novamind_world::events::{EndCause, Notice, SubscriptionStatus};
use novamind_world::params::Interface;

impl Simulation {
    pub(crate) fn database_entry(&self) -> ProjectionEntry {
        build_entry(&self.facts, self.notice_texts(), &self.feed, &self.params)
    }

    /// Returns the texts of the notices of the last day or call. Texts of repeated lead losses are empty, because the
    /// database stores repeated losses as one fact.
    pub(crate) fn notice_texts(&self) -> Vec<String> {
        let mut parties = NoticeEnterprises::from_simulation(self);
        self.facts.notices.iter().map(|notice| self.notice_text(notice, parties.next_party(notice))).collect()
    }

    fn notice_text(&self, notice: &Notice, party: Option<NoticeCustomer>) -> String {
        let Notice::OwnPostSeen(reaction) = notice else {
            return novamind_voice::notices::notice_text(notice, party);
        };
        let own_post = self.world.market.social.own.get(reaction.post as usize - 1);
        let content = own_post.map_or("", |post| post.content.as_str());
        let posts = &self.params.ceo_posts;
        match self.params.fidelity.interface {
            Interface::Release1 => novamind_voice::notices::reaction_text(content, reaction, posts),
            Interface::Release2 => novamind_voice::notices::views_text(content, reaction.views, posts),
        }
    }
}

/// The enterprises in the notices of a day, by kind of notice, in the order of the notices.
struct NoticeEnterprises {
    new_leads: std::vec::IntoIter<NoticeCustomer>,
    silent_leads: std::vec::IntoIter<NoticeCustomer>,
    timed_out_leads: std::vec::IntoIter<NoticeCustomer>,
    deals: std::vec::IntoIter<NoticeCustomer>,
}

impl NoticeEnterprises {
    fn from_simulation(simulation: &Simulation) -> NoticeEnterprises {
        let Simulation { facts, world, .. } = simulation;
        let notices =
            |fits: &dyn Fn(&Notice) -> bool| facts.notices.iter().filter(|notice| fits(notice)).count();
        // Name enterprises only if each notice has exactly one enterprise.
        let only = |parties: Vec<NoticeCustomer>, count: usize| {
            if parties.len() == count { parties.into_iter() } else { Vec::new().into_iter() }
        };
        let ended = |cause: EndCause| -> Vec<NoticeCustomer> {
            let of_cause = facts.endings.iter().filter(|ending| ending.cause == cause);
            of_cause
                .map(|ending| NoticeCustomer {
                    customer: ending.customer,
                    group: ending.group,
                    seats: ending.seats,
                })
                .collect()
        };
        let group =
            |customer: u32| world.enterprise.enterprise_customer(customer).map(|company| company.group);
        let asking: Vec<NoticeCustomer> = facts
            .openings
            .iter()
            .filter(|opening| opening.status == SubscriptionStatus::Lead)
            .filter_map(|subscription_opened| {
                Some(NoticeCustomer {
                    customer: subscription_opened.customer,
                    group: group(subscription_opened.customer)?,
                    seats: subscription_opened.seats,
                })
            })
            .collect();
        let agreed: Vec<NoticeCustomer> = facts
            .deals
            .iter()
            .filter_map(|deal| {
                Some(NoticeCustomer {
                    customer: deal.customer,
                    group: group(deal.customer)?,
                    seats: deal.seats,
                })
            })
            .collect();
        let first = |notice: &Notice| matches!(notice, Notice::LeadLostByTimeout { .. });
        NoticeEnterprises {
            new_leads: only(asking, notices(&|notice| *notice == Notice::EnterpriseLead)),
            silent_leads: only(ended(EndCause::LeadSilent), notices(&|notice| *notice == Notice::LeadSilent)),
            timed_out_leads: only(ended(EndCause::LeadTimeout), notices(&first)),
            deals: only(agreed, notices(&|notice| matches!(notice, Notice::DealWon { .. }))),
        }
    }

    fn next_party(&mut self, notice: &Notice) -> Option<NoticeCustomer> {
        match notice {
            Notice::EnterpriseLead => self.new_leads.next(),
            Notice::LeadSilent => self.silent_leads.next(),
            Notice::LeadLostByTimeout { .. } => self.timed_out_leads.next(),
            Notice::DealWon { .. } => self.deals.next(),
            _ => None,
        }
    }
}
