//! What a tool can do to the world: an effect is decided, its draws are made, and then it cannot fail.
//!
//! The three steps are apart so that a tool call can be checked without consequence ([`Effect`]), recorded
//! with its result ([`World::resolve`] changes nothing), and only then applied ([`World::apply`]).

use super::events::{Category, Facts, LedgerEntry, LedgerNote, OwnPostMade, ResearchChange, SettingsChange};
use super::market::social::own::OwnPost;
use super::params::Params;
use super::product::research::{self, Project};
use super::random::Streams;
use super::state::World;

/// A decided change.
#[expect(clippy::large_enum_variant, reason = "there is one at a time")]
#[derive(Debug, Clone, PartialEq)]
pub enum Effect {
    /// Nothing changes: the tool only reads.
    None,
    /// A family of settings, complete after the change.
    Set(SettingsChange),
    /// An R&D project of this tier is paid and started.
    StartResearch(u8),
    /// The player posts in public.
    Post(Draft),
}

/// A post that the player is about to publish.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Draft {
    /// Its text.
    pub content: String,
    /// Number of the post it answers.
    pub reply_to: Option<u32>,
}

/// A decided change whose draws are known.
#[expect(clippy::large_enum_variant, reason = "there is one at a time")]
#[derive(Debug, Clone, PartialEq)]
pub enum Deed {
    /// Nothing changes.
    None,
    /// A family of settings.
    Set(SettingsChange),
    /// An R&D project and its price in dollars.
    StartResearch(Project, f64),
    /// A post of the player.
    Post(OwnPostMade),
}

impl World {
    /// Makes the draws of an effect; changes nothing.
    pub fn resolve(&self, effect: Effect, params: &Params, streams: &Streams) -> Deed {
        match effect {
            Effect::None => Deed::None,
            Effect::Set(change) => Deed::Set(change),
            Effect::StartResearch(tier) => {
                let project = research::draw(&self.product, self.day, tier, params, streams);
                Deed::StartResearch(project, f64::from(params.research(tier).cost))
            }
            Effect::Post(Draft { content, reply_to }) => {
                let post = self.market.social.own.len() as u32 + 1;
                Deed::Post(OwnPostMade { post, content, reply_to })
            }
        }
    }

    /// Applies a deed. What it does carries the day already simulated; `facts` receives it.
    pub fn apply(&mut self, deed: Deed, facts: &mut Facts) {
        facts.begin(self.day);
        match deed {
            Deed::None => {}
            Deed::Set(change) => {
                self.settings.set(change.clone());
                facts.settings.push(change);
            }
            Deed::StartResearch(project, cost) => {
                let note = LedgerNote::Project(project.tier, project.number);
                self.finance
                    .book(LedgerEntry { category: Category::ResearchProject, amount: -cost, note }, facts);
                self.product.research.push(project);
                facts.research.push(ResearchChange::Started(project));
            }
            Deed::Post(made) => {
                let own = OwnPost::new(self.day, made.content.clone(), made.reply_to);
                self.market.social.own.push(own);
                facts.own_posts.push(made);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn resolving_changes_nothing_and_foretells_the_deed() {
        let (params, streams) = (Params::shipped(), Streams::new(3));
        let mut facts = Facts::default();
        let mut world = World::open(500, 1_000_000.0, &params, &mut facts);
        let before = world.part_hashes();
        let deed = world.resolve(Effect::StartResearch(1), &params, &streams);
        assert_eq!(world.part_hashes(), before);
        assert_eq!(deed, world.resolve(Effect::StartResearch(1), &params, &streams));
        world.apply(deed, &mut facts);
        assert_eq!(world.finance.cash, 833_333.0);
        let Deed::StartResearch(second, _) = world.resolve(Effect::StartResearch(1), &params, &streams)
        else {
            panic!("a start");
        };
        assert_eq!(second.id(), "t1_2");
    }
}
