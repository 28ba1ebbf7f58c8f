//! Irrevocable actions: purchases, posts, offers and ended threads. Similar actions of a call or a week are merged.

use std::collections::BTreeMap;
use std::fmt::{self, Display, Formatter};

use serde::{Deserialize, Serialize};

use super::simulation::Simulation;
use novamind_base::formatting::{dollars_and_cents, grouped_number};
use novamind_world::command::ResolvedCommand;
use novamind_world::enterprise::messages::OfferMessage;
use novamind_world::events::Offering;
use novamind_world::identifiers::{Group, Plan};

/// Maximum number of offers or threads of one call that are listed one by one.
const MAX_NAMED_ENTRIES: usize = 5;

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(crate) enum IrrevocableAction {
    Single(String),
    /// Offers of the same plans to enterprises of a group.
    Offered {
        group: Option<Group>,
        /// Each offered plan, with its lowest and highest price.
        offerings: Vec<(Plan, f64, f64)>,
        companies: u32,
    },
    /// Ended threads with enterprises of a group.
    Ended {
        group: Group,
        companies: u32,
    },
}

impl IrrevocableAction {
    pub(crate) fn merge_all(done: &mut Vec<IrrevocableAction>, more: Vec<IrrevocableAction>) {
        for irrevocable_action in more {
            if !done.iter_mut().any(|before| before.try_merge(&irrevocable_action)) {
                done.push(irrevocable_action);
            }
        }
    }

    /// Merges another action into this action. Returns false if the two actions cannot be merged.
    fn try_merge(&mut self, other: &IrrevocableAction) -> bool {
        use IrrevocableAction::{Ended, Offered};
        match (self, other) {
            (
                Offered { group, offerings, companies },
                Offered { group: to, offerings: more, companies: count },
            ) if group == to && offered_plans(offerings).eq(offered_plans(more)) => {
                for ((_, least, most), (_, low, high)) in offerings.iter_mut().zip(more) {
                    (*least, *most) = (least.min(*low), most.max(*high));
                }
                *companies += count;
                true
            }
            (Ended { group, companies }, Ended { group: of, companies: count }) if group == of => {
                *companies += count;
                true
            }
            _ => false,
        }
    }
}

fn offered_plans(offerings: &[(Plan, f64, f64)]) -> impl Iterator<Item = Plan> {
    offerings.iter().map(|(plan, ..)| *plan)
}

impl Display for IrrevocableAction {
    fn fmt(&self, out: &mut Formatter<'_>) -> fmt::Result {
        match self {
            IrrevocableAction::Single(words) => out.write_str(words),
            IrrevocableAction::Offered { group, offerings, companies } => {
                let offerings: Vec<String> = offerings.iter().map(describe_offering).collect();
                write!(
                    out,
                    "offered {} to {}",
                    offerings.join(" or "),
                    describe_companies(*companies, *group)
                )
            }
            IrrevocableAction::Ended { group, companies } => {
                write!(out, "threads with {} ended", describe_companies(*companies, Some(*group)))
            }
        }
    }
}

impl Simulation {
    /// Returns the irrevocable actions of a command that is about to be applied.
    pub(crate) fn irrevocable_actions(&self, resolved: &ResolvedCommand) -> Vec<IrrevocableAction> {
        let single = |words: String| vec![IrrevocableAction::Single(words)];
        match resolved {
            ResolvedCommand::None | ResolvedCommand::Set(_) | ResolvedCommand::ReadInsights(_) => Vec::new(),
            ResolvedCommand::Post(_) => single("post published".to_owned()),
            ResolvedCommand::StartResearch(project, _) => {
                single(format!("R&D project {} started, due on day {}", project.id(), project.due_day))
            }
            ResolvedCommand::ResearchMarket(attempt) => single(match attempt.found {
                Some(group) => format!("market research found group {group}"),
                None => "market research found nothing".to_owned(),
            }),
            ResolvedCommand::ResearchGroup(study, _) => {
                let (group, level, day) = (study.group, study.target, study.due_day);
                single(format!("study of {group} to level {level} ordered, due on day {day}"))
            }
            ResolvedCommand::SendDeals(messages) => self.offer_actions(messages),
            ResolvedCommand::RejectDeals(threads) => self.rejection_actions(threads),
        }
    }

    fn offer_actions(&self, messages: &[OfferMessage]) -> Vec<IrrevocableAction> {
        if messages.len() <= MAX_NAMED_ENTRIES {
            return messages.iter().map(|message| self.offer_action(message)).collect();
        }
        let mut alike: BTreeMap<(Option<Group>, Vec<Plan>), Vec<&OfferMessage>> = BTreeMap::new();
        for offer_message in messages {
            let plans = offer_message.offerings.iter().map(|offering| offering.plan).collect();
            alike
                .entry((self.customer_group(offer_message.customer), plans))
                .or_default()
                .push(offer_message);
        }
        let joined = |((group, plans), offer_messages): ((Option<Group>, Vec<Plan>), Vec<&OfferMessage>)| {
            match offer_messages[..] {
                [only] => self.offer_action(only),
                _ => IrrevocableAction::Offered {
                    group,
                    offerings: (0..plans.len())
                        .map(|at| price_range_of_offering(&offer_messages, at))
                        .collect(),
                    companies: offer_messages.len() as u32,
                },
            }
        };
        alike.into_iter().map(joined).collect()
    }

    fn rejection_actions(&self, threads: &[u32]) -> Vec<IrrevocableAction> {
        let all = &self.world.enterprise.threads;
        let ended = threads.iter().filter_map(|number| {
            all.binary_search_by_key(number, |thread| thread.number).ok().map(|at| &all[at])
        });
        if threads.len() <= MAX_NAMED_ENTRIES {
            let words = ended
                .map(|thread| format!("thread with {} ended", self.names.name_with_number(thread.customer)));
            return words.map(IrrevocableAction::Single).collect();
        }
        let mut by_group: BTreeMap<Group, u32> = BTreeMap::new();
        for thread in ended {
            *by_group.entry(thread.group).or_default() += 1;
        }
        by_group.into_iter().map(|(group, companies)| IrrevocableAction::Ended { group, companies }).collect()
    }

    fn offer_action(&self, message: &OfferMessage) -> IrrevocableAction {
        let offering =
            |offering: &Offering| format!("{} {}", offering.plan, dollars_and_cents(offering.price));
        let offerings: Vec<String> = message.offerings.iter().map(offering).collect();
        let company = self.names.name_with_number(message.customer);
        IrrevocableAction::Single(format!("offered to {company}: {}", offerings.join(", ")))
    }

    fn customer_group(&self, customer: u32) -> Option<Group> {
        self.world.enterprise.enterprise_customer(customer).map(|company| company.group)
    }
}

fn describe_companies(count: u32, group: Option<Group>) -> String {
    let of = group.map_or(String::new(), |group| format!(" of {group}"));
    let noun = if count == 1 { "company" } else { "companies" };
    format!("{} {noun}{of}", grouped_number(f64::from(count), 0))
}

/// Returns the plan that every message offers at position `at`, with its lowest and highest price.
fn price_range_of_offering(messages: &[&OfferMessage], at: usize) -> (Plan, f64, f64) {
    let prices = messages.iter().map(|message| message.offerings[at].price);
    let (least, most) =
        prices.fold((f64::INFINITY, f64::NEG_INFINITY), |all, price| (all.0.min(price), all.1.max(price)));
    (messages[0].offerings[at].plan, least, most)
}

fn describe_offering(&(plan, least, most): &(Plan, f64, f64)) -> String {
    match least == most {
        true => format!("{plan} at {}", dollars_and_cents(least)),
        false => format!("{plan} at {} to {}", dollars_and_cents(least), dollars_and_cents(most)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::create::NewRun;
    use crate::play::Session;
    use novamind_record::folder::configuration::Configuration;

    fn offer_message_to(customer: u32, offerings: &[(Plan, f64)]) -> OfferMessage {
        let offerings =
            offerings.iter().map(|(plan, price)| Offering { plan: *plan, price: *price }).collect();
        OfferMessage {
            customer,
            thread: customer,
            starts_thread: false,
            turn: 1,
            offerings,
            relationship: None,
            reply_day: 9,
        }
    }

    #[test]
    fn irrevocable_actions_list_few_offers_and_summarize_many() {
        let session = Session::create(NewRun::default(), &Configuration::bundled()).expect("a run");
        let descriptions = |messages: &[OfferMessage]| {
            let done =
                session.simulation().irrevocable_actions(&ResolvedCommand::SendDeals(messages.to_vec()));
            done.iter().map(IrrevocableAction::to_string).collect::<Vec<_>>()
        };
        let few: Vec<OfferMessage> =
            (1..=5).map(|customer| offer_message_to(customer, &[(Plan::B, 35.0)])).collect();
        assert_eq!(descriptions(&few).len(), 5);
        let named = |customer: u32| session.company().enterprise_names().name_with_number(customer);
        assert_eq!(descriptions(&few)[0], format!("offered to {}: B $35.00", named(1)));
        let mut many: Vec<OfferMessage> =
            (1..=3_569).map(|customer| offer_message_to(customer, &[(Plan::B, 35.0)])).collect();
        assert_eq!(descriptions(&many), ["offered B at $35.00 to 3,569 companies"]);
        many.push(offer_message_to(4_000, &[(Plan::B, 70.5)]));
        many.push(offer_message_to(4_001, &[(Plan::A, 8.0), (Plan::C, 54.0)]));
        assert_eq!(
            descriptions(&many),
            [
                format!("offered to {}: A $8.00, C $54.00", named(4_001)),
                "offered B at $35.00 to $70.50 to 3,570 companies".to_owned()
            ]
        );
    }

    #[test]
    fn similar_actions_of_several_calls_are_merged() {
        let e2 = Group::parse("E2").expect("a group");
        let offered = |plan: Plan, price: f64, companies: u32| IrrevocableAction::Offered {
            group: Some(e2),
            offerings: vec![(plan, price, price)],
            companies,
        };
        let mut done = vec![IrrevocableAction::Single("post published".to_owned())];
        for more in [
            vec![offered(Plan::B, 35.0, 900), IrrevocableAction::Ended { group: e2, companies: 40 }],
            vec![offered(Plan::C, 60.0, 10), offered(Plan::B, 30.0, 99)],
            vec![
                IrrevocableAction::Ended { group: e2, companies: 2 },
                IrrevocableAction::Single("post published".to_owned()),
            ],
        ] {
            IrrevocableAction::merge_all(&mut done, more);
        }
        assert_eq!(
            done.iter().map(IrrevocableAction::to_string).collect::<Vec<_>>(),
            [
                "post published",
                "offered B at $30.00 to $35.00 to 999 companies of E2",
                "threads with 42 companies of E2 ended",
                "offered C at $60.00 to 10 companies of E2",
                "post published",
            ]
        );
    }
}
