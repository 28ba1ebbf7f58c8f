//! What a call does that cannot be taken back, in words: purchases, posts, offers, threads that end. Many like ones are
//! one sentence.

use std::collections::BTreeMap;

use super::simulation::Simulation;
use crate::notation::{cents, grouped};
use crate::world::command::ResolvedCommand;
use crate::world::enterprise::letters::Letter;
use crate::world::events::Offering;
use crate::world::identifiers::{Group, Plan};

/// Offers or threads of one call that are named one by one.
const NAMED: usize = 5;

impl Simulation {
    /// What cannot be taken back of a command that is about to be applied.
    pub(in crate::session) fn irrevocable(&self, resolved: &ResolvedCommand) -> Vec<String> {
        match resolved {
            ResolvedCommand::None | ResolvedCommand::Set(_) | ResolvedCommand::ReadInsights(_) => Vec::new(),
            ResolvedCommand::Post(_) => vec!["post published".to_owned()],
            ResolvedCommand::StartResearch(project, _) => {
                vec![format!("R&D project {} started, done on day {}", project.id(), project.due_day)]
            }
            ResolvedCommand::ResearchMarket(attempt) => vec![match attempt.found {
                Some(group) => format!("market research found group {group}"),
                None => "market research found nothing".to_owned(),
            }],
            ResolvedCommand::ResearchGroup(study, _) => {
                let (group, level, day) = (study.group, study.target, study.due_day);
                vec![format!("study of {group} to level {level} ordered, done on day {day}")]
            }
            ResolvedCommand::SendDeals(letters) => self.offers(letters),
            ResolvedCommand::RejectDeals(threads) => self.rejections(threads),
        }
    }

    fn offers(&self, letters: &[Letter]) -> Vec<String> {
        if letters.len() <= NAMED {
            return letters.iter().map(offer).collect();
        }
        let mut alike: BTreeMap<(Option<Group>, Vec<Plan>), Vec<&Letter>> = BTreeMap::new();
        for letter in letters {
            let plans = letter.offerings.iter().map(|offering| offering.plan).collect();
            alike.entry((self.group_of(letter.customer), plans)).or_default().push(letter);
        }
        let sentence = |((group, _), letters): ((Option<Group>, Vec<Plan>), Vec<&Letter>)| match letters[..] {
            [only] => offer(only),
            [first, ..] => {
                let offerings: Vec<String> =
                    (0..first.offerings.len()).map(|at| offering_of_all(&letters, at)).collect();
                let to = companies(letters.len(), group);
                format!("offered {} to {to}", offerings.join(" or "))
            }
            [] => String::new(),
        };
        alike.into_iter().map(sentence).collect()
    }

    fn rejections(&self, threads: &[u32]) -> Vec<String> {
        let all = &self.world.enterprise.threads;
        let ended = threads.iter().filter_map(|number| {
            all.binary_search_by_key(number, |thread| thread.number).ok().map(|at| &all[at])
        });
        if threads.len() <= NAMED {
            return ended.map(|thread| format!("thread with customer {} ended", thread.customer)).collect();
        }
        let mut by_group: BTreeMap<Group, usize> = BTreeMap::new();
        for thread in ended {
            *by_group.entry(thread.group).or_default() += 1;
        }
        by_group
            .into_iter()
            .map(|(group, count)| format!("threads with {} ended", companies(count, Some(group))))
            .collect()
    }

    fn group_of(&self, customer: u32) -> Option<Group> {
        self.world.enterprise.company(customer).map(|company| company.group)
    }
}

fn companies(count: usize, group: Option<Group>) -> String {
    let of = group.map_or(String::new(), |group| format!(" of {group}"));
    let noun = if count == 1 { "company" } else { "companies" };
    format!("{} {noun}{of}", grouped(count as f64, 0))
}

fn offer(letter: &Letter) -> String {
    let offering = |offering: &Offering| format!("{} {}", offering.plan, cents(offering.price));
    let offerings: Vec<String> = letter.offerings.iter().map(offering).collect();
    format!("offered to customer {}: {}", letter.customer, offerings.join(", "))
}

/// Plan and prices of the offerings at a place of letters with the same plans.
fn offering_of_all(letters: &[&Letter], at: usize) -> String {
    let prices = letters.iter().map(|letter| letter.offerings[at].price);
    let (least, most) =
        prices.fold((f64::INFINITY, f64::NEG_INFINITY), |all, price| (all.0.min(price), all.1.max(price)));
    let plan = letters[0].offerings[at].plan;
    match least == most {
        true => format!("{plan} at {}", cents(least)),
        false => format!("{plan} at {} to {}", cents(least), cents(most)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::session::folder::configuration::Configuration;
    use crate::session::folder::create::NewRun;
    use crate::session::state::Session;

    fn letter(customer: u32, offerings: &[(Plan, f64)]) -> Letter {
        let offerings =
            offerings.iter().map(|(plan, price)| Offering { plan: *plan, price: *price }).collect();
        Letter {
            customer,
            thread: customer,
            begins: false,
            turn: 1,
            offerings,
            relationship: None,
            reply_day: 9,
        }
    }

    #[test]
    fn few_offers_are_named_and_many_are_counted_by_plan() {
        let session = Session::create(NewRun::default(), &Configuration::shipped()).expect("a run");
        let told = |letters: &[Letter]| {
            session.simulation.irrevocable(&ResolvedCommand::SendDeals(letters.to_vec()))
        };
        let few: Vec<Letter> = (1..=5).map(|customer| letter(customer, &[(Plan::B, 35.0)])).collect();
        assert_eq!(told(&few).len(), 5);
        assert_eq!(told(&few)[0], "offered to customer 1: B $35.00");
        let mut many: Vec<Letter> =
            (1..=3_569).map(|customer| letter(customer, &[(Plan::B, 35.0)])).collect();
        assert_eq!(told(&many), ["offered B at $35.00 to 3,569 companies"]);
        many.push(letter(4_000, &[(Plan::B, 70.5)]));
        many.push(letter(4_001, &[(Plan::A, 8.0), (Plan::C, 54.0)]));
        assert_eq!(
            told(&many),
            [
                "offered to customer 4001: A $8.00, C $54.00",
                "offered B at $35.00 to $70.50 to 3,570 companies"
            ]
        );
    }
}
