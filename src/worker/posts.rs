//! Posts of the social feed for the screens. After the first call, only new posts are read.

use std::sync::Arc;

use novamind_database::Interface;
use novamind_session::Session;
use novamind_session::identifiers::Group;
use novamind_tools::{GetSocialPosts, PostAuthor, PostLimit, SocialPost};

/// Who wrote a post.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum PostKind {
    /// Customers who post without being asked.
    Customers,
    /// Press that writes about competitors and the economy.
    Press,
    /// Customers and press under release 2, which does not publish authors.
    Public,
    /// Authors of comments on the player's posts.
    Comments,
    /// The player's company.
    Own,
}

impl PostKind {
    /// Returns all kinds of authors that a release publishes, in display order.
    pub fn all(interface: Interface) -> &'static [PostKind] {
        match interface {
            Interface::Release1 => &[PostKind::Customers, PostKind::Press, PostKind::Comments, PostKind::Own],
            Interface::Release2 => &[PostKind::Public, PostKind::Comments, PostKind::Own],
        }
    }

    /// Returns the name that screens show for the kind.
    pub fn name(self) -> &'static str {
        match self {
            PostKind::Customers => "customers",
            PostKind::Press => "press",
            PostKind::Public => "public",
            PostKind::Comments => "comments",
            PostKind::Own => "our posts",
        }
    }
}

/// A post of the social feed.
#[derive(Debug, Clone, PartialEq)]
pub struct Post {
    /// Who wrote the post.
    pub kind: PostKind,
    /// Number of the post. The player's posts and other posts are numbered separately.
    pub number: u32,
    /// Day on which the post was published.
    pub day: u32,
    /// Name and group of the author.
    pub author: String,
    /// Text of the post, excluding the author.
    pub text: String,
    /// Number of the post to which this post replies, if any.
    pub answered_post: Option<u32>,
    /// Number of views of the player's post; 0 for other posts.
    pub views: u32,
    /// Number of comments on the player's post; 0 for other posts.
    pub comments: u32,
}

impl Post {
    /// Returns the week in which the post was published.
    pub fn week(&self) -> u32 {
        self.day.div_ceil(7).max(1)
    }

    /// Describes the views and comments of the player's post.
    pub fn reactions(&self) -> String {
        let noun = |count: u32, one: &str| format!("{count} {one}{}", if count == 1 { "" } else { "s" });
        format!("{}, {}", noun(self.views, "view"), noun(self.comments, "comment"))
    }

    /// Returns the heading above the text of the post.
    pub fn heading(&self) -> String {
        match (self.kind, self.answered_post) {
            (PostKind::Own, Some(post)) => {
                format!("our post {}, reply to #{post} · {}", self.number, self.reactions())
            }
            (PostKind::Own, None) => format!("our post {} · {}", self.number, self.reactions()),
            (PostKind::Comments, Some(answered_post)) => {
                format!("{} · #{} on our post {answered_post}, day {}", self.author, self.number, self.day)
            }
            _ => format!("{} · #{}", self.author, self.number),
        }
    }
}

/// Posts of other authors, newest first. Successive calls share unchanged posts.
pub type Posts = Arc<Vec<Arc<Post>>>;

/// Initial limit on the number of new posts to read, usually more than are published in a week.
const INITIAL_POSTS: usize = 64;

/// Reads the posts of other authors. If some posts are known, requests only newer posts.
pub fn read_posts(session: &Session, known: Option<&Posts>) -> Posts {
    let last = known.and_then(|posts| posts.first()).map(|post| post.number);
    let mut limit = if last.is_some() { PostLimit::Newest(INITIAL_POSTS) } else { PostLimit::All };
    loop {
        let social_posts =
            session.company().read_tool(&GetSocialPosts, limit).map_or(Vec::new(), |answer| answer.posts);
        let is_new = |post: &Post| last.is_none_or(|last| post.number > last);
        let fresh: Vec<Arc<Post>> =
            social_posts.iter().map(to_post).take_while(is_new).map(Arc::new).collect();
        // If all returned posts are new, there may be more new posts before them.
        if let PostLimit::Newest(most) = limit
            && !social_posts.is_empty()
            && fresh.len() == social_posts.len()
        {
            limit = if most > 10_000 { PostLimit::All } else { PostLimit::Newest(most * 8) };
            continue;
        }
        return match known {
            Some(known) if fresh.is_empty() => known.clone(),
            Some(known) => Arc::new(fresh.into_iter().chain(known.iter().cloned()).collect()),
            None => Arc::new(fresh),
        };
    }
}

fn kind_and_name(author: &PostAuthor, is_comment: bool) -> (PostKind, String) {
    let group = author.group_id.map_or("–", Group::id);
    // Press posts have the first group as the author's group, and no persona. Posts of customers in discovered groups
    // also have no persona.
    let is_press = author.group_id.is_some() && author.group_id == Group::at(0);
    match (is_comment, author.persona_name.as_deref()) {
        (true, name) => (PostKind::Comments, format!("{} · {group}", name.unwrap_or("someone"))),
        (false, Some(name)) => (PostKind::Customers, format!("{name} · {group}")),
        (false, None) if is_press => (PostKind::Press, "press".to_owned()),
        (false, None) => (PostKind::Customers, group.to_owned()),
    }
}

fn to_post(social_post: &SocialPost) -> Post {
    let is_comment = social_post.reply_to_agent_post_id.is_some();
    let (kind, author) = match &social_post.author {
        Some(author) => kind_and_name(author, is_comment),
        None if is_comment => (PostKind::Comments, "comment".to_owned()),
        None => (PostKind::Public, "post".to_owned()),
    };
    Post {
        kind,
        number: social_post.post_id,
        day: social_post.day,
        author,
        text: social_post.content.clone(),
        answered_post: social_post.reply_to_agent_post_id,
        views: 0,
        comments: 0,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn posts_of_discovered_groups_are_not_press() {
        let make_post = |group: &str, name: Option<&'static str>| {
            to_post(&SocialPost {
                post_id: 4,
                day: 9,
                content: "x".to_owned(),
                reply_to_agent_post_id: None,
                author: Some(PostAuthor {
                    source_group_id: None,
                    group_id: Group::parse(group),
                    customer_type: "small",
                    custom_name: None,
                    persona_name: name.map(Into::into),
                }),
                replying_to_your_post: None,
            })
        };
        let who = |post: Post| (post.kind, post.author);
        assert_eq!(who(make_post("D_S06", None)), (PostKind::Customers, "D_S06".to_owned()));
        assert_eq!(who(make_post("S1", None)), (PostKind::Press, "press".to_owned()));
        assert_eq!(who(make_post("S1", Some("Ada"))), (PostKind::Customers, "Ada · S1".to_owned()));
    }
    use crate::test_kit::{played_session, played_session_of};
    use novamind_record::trajectory::record::Via;

    #[test]
    fn incremental_read_equals_full_read() {
        let mut session = played_session(2);
        let first = read_posts(&session, None);
        assert!(!first.is_empty());
        assert!(Arc::ptr_eq(&first, &read_posts(&session, Some(&first))), "nothing has changed");
        let nothing = Posts::default();
        for known in [&first, &nothing] {
            for _ in 0..3 {
                let forecasts = session.company().naive_forecasts();
                session.advance("as planned", &forecasts, Via::Form, &mut |_| {}).expect("a week");
            }
            let (grown, posts) = (read_posts(&session, Some(known)), read_posts(&session, None));
            assert_eq!(grown, posts);
            assert!(grown.len() > known.len());
        }
        let again = read_posts(&session, Some(&first));
        let shared = again.iter().rev().zip(first.iter().rev());
        assert!(
            shared.clone().count() == first.len() && shared.clone().all(|(now, then)| Arc::ptr_eq(now, then))
        );
    }

    #[test]
    fn posts_of_release_2_have_no_authors() {
        let session = played_session_of("release-2", 3);
        let posts = read_posts(&session, None);
        assert!(!posts.is_empty());
        for post in posts.iter() {
            assert_eq!((post.kind, post.heading()), (PostKind::Public, format!("post · #{}", post.number)));
        }
        assert!(read_posts(&played_session(3), None).iter().all(|post| post.kind != PostKind::Public));
    }
}
