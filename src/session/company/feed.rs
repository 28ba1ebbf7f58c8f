//! The social feed of a session: all posts as text, and the judgements of the player's posts.
//!
//! The texts of posts are not part of the simulator state. A replay of the run produces the same texts, because the
//! texts of a language model are in the record.

use std::borrow::Cow;
use std::collections::BTreeMap;
use std::sync::Arc;

use serde::{Deserialize, Serialize};

use novamind_database::ProjectionEntry;
use novamind_tools::PublicPost;
use novamind_voice::judge::{Judgement, OriginalPost};
use novamind_voice::posts::PostWriter;
use novamind_voice::posts::names::profile_name;
use novamind_world::events::{Facts, Post, PostSubject, Sender, Sentiment};
use novamind_world::identifiers::Group;
use novamind_world::params::Params;
use novamind_world::random::Streams;

/// All posts since day 0, and the judgements of the player's posts.
#[derive(Clone, Default, Serialize, Deserialize)]
pub struct Feed {
    writer: PostWriter,
    /// Posts of other authors as the player sees them, ordered by number.
    #[serde(with = "kept_posts")]
    pub posts: Vec<PublicPost>,
    /// Original texts of the posts that a language model has reworded, by post number.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    built_in: BTreeMap<u32, String>,
    complains: Vec<bool>,
    /// Judgements of the player's posts, in the order of the posts. A post that is not judged yet has an empty list.
    pub judgements: Vec<Vec<Judgement>>,
}

/// Serialization of posts with all fields, including fields that tools do not return.
mod kept_posts {
    use serde::{Deserialize, Deserializer, Serialize, Serializer};

    use novamind_tools::PublicPost;
    use novamind_world::identifiers::Group;
    use std::borrow::Cow;

    #[derive(Serialize, Deserialize)]
    #[serde(remote = "PublicPost")]
    struct Kept {
        post: u32,
        day: u32,
        content: String,
        own_post: Option<u32>,
        source_group: Option<Group>,
        written_by: Option<Group>,
        profile: Option<Cow<'static, str>>,
    }

    #[derive(Serialize)]
    struct SerializedPost<'a>(#[serde(with = "Kept")] &'a PublicPost);

    #[derive(Deserialize)]
    struct DeserializedPost(#[serde(with = "Kept")] PublicPost);

    pub fn serialize<S: Serializer>(posts: &[PublicPost], serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_seq(posts.iter().map(SerializedPost))
    }

    pub fn deserialize<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Vec<PublicPost>, D::Error> {
        Ok(Vec::<DeserializedPost>::deserialize(deserializer)?.into_iter().map(|owned| owned.0).collect())
    }
}

impl Feed {
    fn judgement(&self, own_post: u32, group: Group) -> Option<&Judgement> {
        let of_post = self.judgements.get(own_post as usize - 1)?;
        of_post.iter().find(|judgement| judgement.group == group)
    }

    pub(crate) fn add_posts(&mut self, facts: &Facts, params: &Params, streams: &Streams) {
        for post in &facts.posts {
            let judgement = match post.matter {
                PostSubject::Comment { own_post, group, .. } => self.judgement(own_post, group).cloned(),
                _ => None,
            };
            let content = self.writer.write(post, judgement.as_ref(), params, streams);
            self.complains.push(post.sentiment == Sentiment::Negative);
            self.posts.push(to_public_post(post, facts.day, content, streams));
        }
    }

    /// Returns the texts of the posts in `facts`, which must be the newest posts of the feed.
    pub(crate) fn newest_texts(&self, facts: &Facts) -> Vec<String> {
        let first = self.posts.len().saturating_sub(facts.posts.len());
        self.posts[first..].iter().map(|post| post.content.clone()).collect()
    }

    /// Replaces the text of a post. Does nothing if the post does not exist.
    pub(crate) fn replace_text(&mut self, post: u32, text: &str) {
        let public_post = (post as usize).checked_sub(1).and_then(|at| self.posts.get_mut(at));
        let Some(public_post) = public_post else { return };
        let before = std::mem::replace(&mut public_post.content, text.to_owned());
        self.built_in.entry(post).or_insert(before);
    }

    /// Returns the post to which the player replies. Always uses the text of the built-in voice, because the effect of
    /// a reply is part of the world's state.
    pub(crate) fn original_post(&self, post: u32) -> Option<OriginalPost<'_>> {
        let at = (post as usize).checked_sub(1)?;
        let public_post = self.posts.get(at)?;
        let content = self.built_in.get(&post).unwrap_or(&public_post.content);
        Some(OriginalPost { content, negative: self.complains[at], group: public_post.written_by })
    }
}

fn to_public_post(post: &Post, day: u32, content: String, streams: &Streams) -> PublicPost {
    let (own_post, source_group) = match post.matter {
        PostSubject::Comment { own_post, group, .. } => (Some(own_post), Some(group)),
        _ => (None, None),
    };
    PublicPost {
        post: post.post,
        day,
        content,
        own_post,
        source_group,
        written_by: post.author.map(|author| author.group),
        profile: post.author.and_then(|author| profile_name(&author, streams)).map(Cow::Borrowed),
    }
}

pub(crate) fn build_entry(
    facts: &Arc<Facts>,
    notices: Vec<String>,
    feed: &Feed,
    params: &Params,
) -> ProjectionEntry {
    let companies = facts.arrivals.iter().filter(|arrival| arrival.group.is_enterprise());
    let writers = facts.turns.iter().filter(|turn| turn.sender == Sender::Customer);
    let named = companies.map(|arrival| arrival.customer).chain(writers.map(|turn| turn.customer));
    let personas = &params.personas;
    ProjectionEntry {
        notices,
        readings: facts.readings.iter().map(novamind_voice::reading_text).collect(),
        turns: facts.turns.iter().map(|turn| novamind_voice::message(turn, personas)).collect(),
        posts: feed.newest_texts(facts),
        addresses: named
            .map(|customer| (customer, novamind_voice::enterprise_address(customer, &personas.email)))
            .collect(),
        facts: facts.clone(),
        ..ProjectionEntry::default()
    }
}
