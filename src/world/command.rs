//! Commands that change the world. A tool call is converted to a command. The random draws of the command are resolved
//! before the command is applied. Applying a command cannot fail.
//!
//! The steps are separate so that a call can be validated without side effects ([`Command`]) and recorded with its
//! result ([`World::resolve`]) before it is applied ([`World::apply`]).

use super::enterprise::messages::{OfferDraft, OfferMessage};
use super::events::{Attempt, Project, Study};
use super::events::{Category, Facts, LedgerEntry, LedgerNote, Notice, OwnPostPublished, ResearchChange};
use super::identifiers::Group;
use super::market::insights::{Insights, insights};
use super::market::social::own_posts::OwnPost;
use super::params::Params;
use super::product::research;
use super::random::Streams;
use super::settings::SettingsChange;
use super::state::World;

/// A validated change to the world that a tool call requests.
#[expect(clippy::large_enum_variant, reason = "only one exists at a time")]
#[derive(Debug, Clone, PartialEq)]
pub enum Command {
    /// No change, because the tool is read-only.
    None,
    /// Replaces a family of settings.
    Set(SettingsChange),
    /// Pays for and starts an R&D project of this tier.
    StartResearch(u8),
    /// Pays for an attempt to discover a group.
    ResearchMarket,
    /// Pays for and starts a study that raises a group to this study level.
    ResearchGroup(Group, u8),
    /// Draws the errors of a group's estimates. Does not change the world.
    ReadInsights(Group),
    /// Sends offers to enterprises.
    SendDeals(Vec<OfferDraft>),
    /// Ends the threads with these numbers.
    RejectDeals(Vec<u32>),
    /// Publishes a post of the player.
    Post(PostDraft),
}

/// A post of the player that is to be published.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct PostDraft {
    /// Text that the player wrote.
    pub content: String,
    /// Number of the post to which the player replies; `None` if the post is not a reply.
    pub reply_to: Option<u32>,
}

/// A validated change whose random draws are resolved.
#[expect(clippy::large_enum_variant, reason = "only one exists at a time")]
#[derive(Debug, Clone, PartialEq)]
pub enum ResolvedCommand {
    /// No change to the world.
    None,
    /// New values for a family of settings.
    Set(SettingsChange),
    /// An R&D project that is started, and its price in dollars.
    StartResearch(Project, f64),
    /// An attempt to discover a group, with its outcome.
    ResearchMarket(Attempt),
    /// A market study that is started, and its price in dollars.
    ResearchGroup(Study, f64),
    /// The estimates of a group, or `None` if the group is unknown. Changes nothing.
    ReadInsights(Option<Box<Insights>>),
    /// Messages with offers to enterprises.
    SendDeals(Vec<OfferMessage>),
    /// Numbers of the threads that end.
    RejectDeals(Vec<u32>),
    /// A post of the player with its effects.
    Post(OwnPostPublished),
}

impl ResolvedCommand {
    /// Returns whether the command leaves the world unchanged.
    pub fn is_read_only(&self) -> bool {
        matches!(self, ResolvedCommand::None | ResolvedCommand::ReadInsights(_))
    }
}

impl World {
    /// Resolves the random draws of `requested_command` without changing the world.
    pub fn resolve(&self, requested_command: Command, params: &Params, streams: &Streams) -> ResolvedCommand {
        match requested_command {
            Command::None => ResolvedCommand::None,
            Command::Set(change) => ResolvedCommand::Set(change),
            Command::StartResearch(tier) => {
                let project = research::draw_project(&self.product, self.day, tier, params, streams);
                ResolvedCommand::StartResearch(project, f64::from(params.research_tier(tier).cost))
            }
            Command::ResearchMarket => {
                ResolvedCommand::ResearchMarket(self.market.next_attempt(params, streams))
            }
            Command::ResearchGroup(group, target) => {
                let study = self.market.plan_study(group, target, self.day, params);
                ResolvedCommand::ResearchGroup(study, params.study_level(target).cost)
            }
            Command::ReadInsights(group) => {
                ResolvedCommand::ReadInsights(insights(group, &self.market, params, streams).map(Box::new))
            }
            Command::SendDeals(proposals) => ResolvedCommand::SendDeals(self.enterprise.resolve_offers(
                &proposals,
                self.day,
                &self.customers,
                params,
                streams,
            )),
            Command::RejectDeals(threads) => ResolvedCommand::RejectDeals(threads),
            Command::Post(PostDraft { content, reply_to }) => {
                let post = self.market.social.own.len() as u32 + 1;
                ResolvedCommand::Post(OwnPostPublished { post, content, reply_to })
            }
        }
    }

    /// Applies a resolved command on the current day and records its effects in `facts`.
    pub fn apply(&mut self, resolved: ResolvedCommand, params: &Params, facts: &mut Facts) {
        facts.start_day(self.day);
        match resolved {
            ResolvedCommand::None | ResolvedCommand::ReadInsights(_) => {}
            ResolvedCommand::Set(change) => {
                self.settings.apply(change.clone());
                facts.settings.push(change);
            }
            ResolvedCommand::StartResearch(project, cost) => {
                let note = LedgerNote::Project(project.tier, project.number);
                self.finance
                    .book(LedgerEntry { category: Category::ResearchProject, amount: -cost, note }, facts);
                self.product.research.push(project);
                facts.research.push(ResearchChange::Started(project));
            }
            ResolvedCommand::ResearchMarket(attempt) => self.apply_market_research(&attempt, params, facts),
            ResolvedCommand::ResearchGroup(study, cost) => {
                let note = LedgerNote::Study(study);
                self.finance
                    .book(LedgerEntry { category: Category::GroupResearch, amount: -cost, note }, facts);
                self.market.studies.push(study);
            }
            ResolvedCommand::SendDeals(messages) => {
                self.enterprise.send_offers(&messages, self.day, &mut self.customers, facts);
            }
            ResolvedCommand::RejectDeals(threads) => {
                self.enterprise.reject_threads(&threads, self.day, facts)
            }
            ResolvedCommand::Post(made) => {
                let own_post = OwnPost::new(self.day, made.content.clone(), made.reply_to);
                self.market.social.own.push(own_post);
                facts.own_posts.push(made);
            }
        }
    }
}

impl World {
    fn apply_market_research(&mut self, attempt: &Attempt, params: &Params, facts: &mut Facts) {
        let note = LedgerNote::General;
        let category = Category::MarketResearch;
        self.finance.book(LedgerEntry { category, amount: -attempt.cost, note }, facts);
        self.market.record_attempt(attempt, self.day, params);
        facts.attempts.push(*attempt);
        if let Some(group) = attempt.found {
            facts.knowledge.push((group, self.market.knowledge[group]));
            facts.notices.push(Notice::GroupFound { group, attempt: attempt.earlier + 1 });
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn resolve_is_pure_and_predicts_apply() {
        let (params, streams) = (Params::bundled(), Streams::new(3));
        let mut facts = Facts::default();
        let mut world = World::new(500, 1_000_000.0, &params, &mut facts);
        let before = world.part_hashes();
        let resolved = world.resolve(Command::StartResearch(1), &params, &streams);
        assert_eq!(world.part_hashes(), before);
        assert_eq!(resolved, world.resolve(Command::StartResearch(1), &params, &streams));
        world.apply(resolved, &params, &mut facts);
        assert_eq!(world.finance.cash, 833_333.0);
        let ResolvedCommand::StartResearch(second, _) =
            world.resolve(Command::StartResearch(1), &params, &streams)
        else {
            panic!("a start");
        };
        assert_eq!(second.id(), "t1_2");
    }
}
