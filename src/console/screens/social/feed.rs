//! Posts in feed order. Comments follow the player's post that they answer.

use std::cmp::Reverse;
use std::collections::BTreeMap;
use std::sync::Arc;

use novamind_database::{Interface, QueryResult, number_at, text_at};
pub use novamind_worker::posts::{Post, PostKind};

/// Parses the player's posts from a query result.
pub fn parse_own_posts(rows: &QueryResult) -> Vec<Arc<Post>> {
    let to_own_post = |row: &Vec<novamind_database::Cell>| {
        let answers = number_at(row, 3) as u32;
        let comments: Vec<u64> = serde_json::from_str(text_at(row, 5)).unwrap_or_default();
        Arc::new(Post {
            kind: PostKind::Own,
            number: number_at(row, 0) as u32,
            day: number_at(row, 1) as u32,
            author: "NovaMind".to_owned(),
            text: text_at(row, 2).to_owned(),
            answered_post: (answers > 0).then_some(answers),
            views: number_at(row, 4) as u32,
            comments: comments.len() as u32,
        })
    };
    rows.rows.iter().map(to_own_post).collect()
}

/// Filter of the feed.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct PostFilter {
    /// Kind of author, or `None` for all kinds.
    pub kind: Option<PostKind>,
    /// Week in which posts were published, or `None` for all weeks.
    pub week: Option<u32>,
    /// Thread of posts: the number of the player's post, and the number of the post that the player's post answers.
    pub thread: Option<(u32, Option<u32>)>,
    /// Text that posts contain, compared without regard to case.
    pub text: String,
}

impl PostFilter {
    /// Returns whether a post passes the filter.
    pub fn matches(&self, post: &Post) -> bool {
        let wanted = self.text.to_lowercase();
        self.kind.is_none_or(|kind| kind == post.kind)
            && self.week.is_none_or(|week| week == post.week())
            && self.thread.is_none_or(|thread| is_in_thread(post, thread))
            && (wanted.is_empty()
                || post.text.to_lowercase().contains(&wanted)
                || post.heading().to_lowercase().contains(&wanted))
    }

    /// Selects the next kind of author that a release publishes. After the last kind, selects all kinds.
    pub fn next_kind(&mut self, interface: Interface) {
        let mut kinds = PostKind::all(interface).iter().copied();
        self.kind = match self.kind {
            None => kinds.next(),
            Some(kind) => kinds.find(|post_kind| *post_kind > kind),
        };
    }

    /// Selects the previous week. If all weeks are selected, selects the last week.
    pub fn earlier_week(&mut self, last: u32) {
        self.week = Some(self.week.map_or(last.max(1), |week| week.saturating_sub(1).max(1)));
    }

    /// Selects the next week. After the last week, selects all weeks.
    pub fn later_week(&mut self, last: u32) {
        self.week = self.week.map(|week| week + 1).filter(|week| *week <= last);
    }

    /// Describes the filter of the feed. Returns an empty text if the filter shows all posts.
    pub fn label(&self) -> String {
        let kind = self.kind.map(|kind| kind.name().to_owned());
        let week = self.week.map(|week| format!("week {week}"));
        let thread = self.thread.map(|(number, _)| format!("thread of your post {number}"));
        let text = (!self.text.is_empty()).then(|| format!("\"{}\"", self.text));
        [thread, kind, week, text].into_iter().flatten().collect::<Vec<_>>().join(" · ")
    }
}

/// Returns whether a post belongs to the thread of one of the player's posts.
fn is_in_thread(post: &Post, (number, answered): (u32, Option<u32>)) -> bool {
    match post.kind {
        PostKind::Own => post.number == number,
        PostKind::Comments => post.answered_post == Some(number),
        PostKind::Customers | PostKind::Press | PostKind::Public => Some(post.number) == answered,
    }
}

/// Returns all posts in feed order: the newest first. Comments follow the player's post that they answer, the oldest
/// first.
pub fn posts_in_feed_order(others: &[Arc<Post>], posts: &[Arc<Post>]) -> Vec<Arc<Post>> {
    let days: BTreeMap<u32, u32> = posts.iter().map(|post| (post.number, post.day)).collect();
    let place = |post: &Arc<Post>| {
        let thread = match post.kind {
            PostKind::Own => Some(post.number),
            PostKind::Comments => post.answered_post.filter(|number| days.contains_key(number)),
            _ => None,
        };
        let day = thread.and_then(|number| days.get(&number).copied()).unwrap_or(post.day);
        // The player's threads are the first posts of a day: the post of the player, followed by the comments in order
        // of arrival.
        let within = match (thread, post.kind) {
            (Some(number), PostKind::Own) => (0, Reverse(number), 0),
            (Some(number), _) => (0, Reverse(number), post.number),
            (None, _) => (1, Reverse(post.number), 0),
        };
        (Reverse(day), within)
    };
    let mut all: Vec<Arc<Post>> = others.iter().chain(posts).cloned().collect();
    all.sort_by_key(place);
    all
}

/// Returns the number of posts of other authors in each week, starting with the first week.
pub fn posts_by_week(posts: &[Arc<Post>], last: u32, takes: impl Fn(PostKind) -> bool) -> Vec<(f64, f64)> {
    let count = |week: u32| posts.iter().filter(|post| takes(post.kind) && post.week() == week).count();
    (1..=last).map(|week| (f64::from(week), count(week) as f64)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn post(kind: PostKind, number: u32, day: u32, answers: Option<u32>) -> Arc<Post> {
        let (author, text) = ("Ann · S1".to_owned(), format!("Words {number}"));
        Arc::new(Post { kind, number, day, author, text, answered_post: answers, views: 0, comments: 0 })
    }

    #[test]
    fn comments_follow_the_post_they_reply_to() {
        let others = [
            post(PostKind::Comments, 9, 15, Some(1)),
            post(PostKind::Comments, 8, 15, Some(1)),
            post(PostKind::Press, 7, 14, None),
            post(PostKind::Customers, 6, 21, None),
            post(PostKind::Comments, 5, 8, Some(99)),
        ];
        let posts = [post(PostKind::Own, 2, 21, None), post(PostKind::Own, 1, 14, Some(3))];
        let order: Vec<(PostKind, u32)> =
            posts_in_feed_order(&others, &posts).iter().map(|post| (post.kind, post.number)).collect();
        let (post_kind, comment) = (PostKind::Own, PostKind::Comments);
        assert_eq!(
            order,
            [
                (post_kind, 2),
                (PostKind::Customers, 6),
                (post_kind, 1),
                (comment, 8),
                (comment, 9),
                (PostKind::Press, 7),
                (comment, 5)
            ]
        );
    }

    #[test]
    fn filter_combines_kind_week_and_text() {
        let customer_post = post(PostKind::Customers, 6, 21, None);
        let mut filter = PostFilter::default();
        assert!(filter.matches(&customer_post) && filter.label().is_empty());
        filter.earlier_week(4);
        assert!(!filter.matches(&customer_post));
        filter.earlier_week(4);
        filter.text = "wORDS".to_owned();
        filter.next_kind(Interface::Release1);
        assert!(filter.matches(&customer_post));
        assert_eq!(filter.label(), "customers · week 3 · \"wORDS\"");
        for _ in 0..4 {
            filter.next_kind(Interface::Release1);
        }
        filter.later_week(3);
        assert_eq!((filter.kind, filter.week), (None, None));
    }

    #[test]
    fn thread_filter_includes_comments_and_the_original_post() {
        let filter = PostFilter { thread: Some((2, Some(6))), ..PostFilter::default() };
        for (kind, number, answers, belongs) in [
            (PostKind::Own, 2, Some(6), true),
            (PostKind::Own, 6, None, false),
            (PostKind::Comments, 9, Some(2), true),
            (PostKind::Comments, 2, Some(1), false),
            (PostKind::Customers, 6, None, true),
            (PostKind::Press, 2, None, false),
        ] {
            assert_eq!(filter.matches(&post(kind, number, 7, answers)), belongs, "{kind:?} {number}");
        }
        assert_eq!(filter.label(), "thread of your post 2");
    }

    #[test]
    fn weeks_without_posts_count_as_zero() {
        let posts = [post(PostKind::Press, 1, 1, None), post(PostKind::Press, 2, 15, None)];
        assert_eq!(posts_by_week(&posts, 3, |_| true), [(1.0, 1.0), (2.0, 0.0), (3.0, 1.0)]);
        assert_eq!(posts_by_week(&posts, 1, |kind| kind == PostKind::Own), [(1.0, 0.0)]);
    }
}
