//! The public conversation as posts in threads: comments stand under the post of ours that they answer.

use std::cmp::Reverse;
use std::collections::BTreeMap;

use serde_json::Value;

use crate::console::company::Company;
use crate::console::readings::{number_at, text_at};
use crate::session::Rows;

/// Who writes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Kind {
    /// Customers of their own accord.
    Customers,
    /// Rivals and the economy, in the news.
    Press,
    /// Answers to our posts.
    Comments,
    /// The company.
    Own,
}

impl Kind {
    /// All kinds in the order they are chosen.
    pub const ALL: [Kind; 4] = [Kind::Customers, Kind::Press, Kind::Comments, Kind::Own];

    /// Name.
    pub fn name(self) -> &'static str {
        match self {
            Kind::Customers => "customers",
            Kind::Press => "press",
            Kind::Comments => "comments",
            Kind::Own => "our posts",
        }
    }
}

/// A post.
#[derive(Debug, Clone, PartialEq)]
pub struct Post {
    /// Who writes.
    pub kind: Kind,
    /// Number among the posts of others, or among ours.
    pub number: u32,
    /// Day.
    pub day: u32,
    /// Name and group of the author.
    pub author: String,
    /// Text.
    pub text: String,
    /// Our post that a comment answers, or the post that ours answers.
    pub answers: Option<u32>,
    /// Views of a post of ours; 0 until it was read.
    pub views: u32,
    /// Comments on a post of ours.
    pub comments: u32,
}

impl Post {
    /// Week that holds its day.
    pub fn week(&self) -> u32 {
        self.day.div_ceil(7).max(1)
    }

    /// Reactions to a post of ours, as far as they are published.
    pub fn reactions(&self) -> String {
        let noun = |count: u32, one: &str| format!("{count} {one}{}", if count == 1 { "" } else { "s" });
        format!("{}, {}", noun(self.views, "view"), noun(self.comments, "comment"))
    }

    /// The line above its text.
    pub fn head(&self) -> String {
        match (self.kind, self.answers) {
            (Kind::Own, Some(post)) => {
                format!("our post {}, answers #{post} · {}", self.number, self.reactions())
            }
            (Kind::Own, None) => format!("our post {} · {}", self.number, self.reactions()),
            (Kind::Comments, Some(own)) => {
                format!("{} · #{} on our post {own}, day {}", self.author, self.number, self.day)
            }
            _ => format!("{} · #{}", self.author, self.number),
        }
    }
}

/// Posts of others as get_social_posts tells them, in its order.
pub fn posts_of(company: &Company) -> Vec<Post> {
    let list = company.posts.get("posts").and_then(Value::as_array);
    list.into_iter().flatten().map(post_of).collect()
}

fn post_of(told: &Value) -> Post {
    let number = |name: &str| told.get(name).and_then(Value::as_u64).and_then(|own| u32::try_from(own).ok());
    let text = |name: &str| told.get(name).and_then(Value::as_str);
    let answers = number("reply_to_agent_post_id");
    let group = text("group_id").unwrap_or("–");
    // The press is the only one without a profile, comments aside.
    let (kind, author) = match (answers, text("persona_name")) {
        (Some(_), name) => (Kind::Comments, format!("{} · {group}", name.unwrap_or("somebody"))),
        (None, Some(name)) => (Kind::Customers, format!("{name} · {group}")),
        (None, None) => (Kind::Press, "press".to_owned()),
    };
    Post {
        kind,
        number: number("post_id").unwrap_or(0),
        day: number("day").unwrap_or(0),
        author,
        text: text("content").unwrap_or_default().to_owned(),
        answers,
        views: 0,
        comments: 0,
    }
}

/// Our posts as the database tells them.
pub fn own_posts(rows: &Rows) -> Vec<Post> {
    let own = |row: &Vec<crate::session::Cell>| {
        let answers = number_at(row, 3) as u32;
        let comments: Vec<u64> = serde_json::from_str(text_at(row, 5)).unwrap_or_default();
        Post {
            kind: Kind::Own,
            number: number_at(row, 0) as u32,
            day: number_at(row, 1) as u32,
            author: "NovaMind".to_owned(),
            text: text_at(row, 2).to_owned(),
            answers: (answers > 0).then_some(answers),
            views: number_at(row, 4) as u32,
            comments: comments.len() as u32,
        }
    };
    rows.rows.iter().map(own).collect()
}

/// Which posts are shown.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Filter {
    /// Of these writers only.
    pub kind: Option<Kind>,
    /// Of this week only.
    pub week: Option<u32>,
    /// That hold this text, in any case.
    pub text: String,
}

impl Filter {
    /// Whether a post is shown.
    pub fn takes(&self, post: &Post) -> bool {
        let wanted = self.text.to_lowercase();
        self.kind.is_none_or(|kind| kind == post.kind)
            && self.week.is_none_or(|week| week == post.week())
            && (wanted.is_empty()
                || post.text.to_lowercase().contains(&wanted)
                || post.head().to_lowercase().contains(&wanted))
    }

    /// The next kind, after the last one all.
    pub fn next_kind(&mut self) {
        self.kind = match self.kind {
            None => Kind::ALL.first().copied(),
            Some(kind) => Kind::ALL.iter().copied().find(|own| *own > kind),
        };
    }

    /// The week before, from all weeks the last one.
    pub fn earlier_week(&mut self, last: u32) {
        self.week = Some(self.week.map_or(last.max(1), |week| week.saturating_sub(1).max(1)));
    }

    /// The week after, after the last one all.
    pub fn later_week(&mut self, last: u32) {
        self.week = self.week.map(|week| week + 1).filter(|week| *week <= last);
    }

    /// In words; empty if everything is shown.
    pub fn words(&self) -> String {
        let kind = self.kind.map(|kind| kind.name().to_owned());
        let week = self.week.map(|week| format!("week {week}"));
        let text = (!self.text.is_empty()).then(|| format!("\"{}\"", self.text));
        [kind, week, text].into_iter().flatten().collect::<Vec<_>>().join(" · ")
    }
}

/// All posts with the newest first; comments follow the post of ours that they answer, the oldest first.
pub fn threads(others: &[Post], own: &[Post]) -> Vec<Post> {
    let days: BTreeMap<u32, u32> = own.iter().map(|post| (post.number, post.day)).collect();
    let place = |post: &Post| {
        let thread = match post.kind {
            Kind::Own => Some(post.number),
            Kind::Comments => post.answers.filter(|own| days.contains_key(own)),
            _ => None,
        };
        let day = thread.and_then(|own| days.get(&own).copied()).unwrap_or(post.day);
        // Within a day our thread stands first: its head, then the comments in the order they came.
        let within = match (thread, post.kind) {
            (Some(own), Kind::Own) => (0, Reverse(own), 0),
            (Some(own), _) => (0, Reverse(own), post.number),
            (None, _) => (1, Reverse(post.number), 0),
        };
        (Reverse(day), within)
    };
    let mut all: Vec<Post> = others.iter().chain(own).cloned().collect();
    all.sort_by_key(place);
    all
}

/// Posts of others by week, from the first week to the last.
pub fn by_week(posts: &[Post], last: u32, takes: impl Fn(Kind) -> bool) -> Vec<(f64, f64)> {
    let count = |week: u32| posts.iter().filter(|post| takes(post.kind) && post.week() == week).count();
    (1..=last).map(|week| (f64::from(week), count(week) as f64)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn post(kind: Kind, number: u32, day: u32, answers: Option<u32>) -> Post {
        let (author, text) = ("Ann · S1".to_owned(), format!("Words {number}"));
        Post { kind, number, day, author, text, answers, views: 0, comments: 0 }
    }

    #[test]
    fn comments_stand_under_the_post_they_answer() {
        let others = [
            post(Kind::Comments, 9, 15, Some(1)),
            post(Kind::Comments, 8, 15, Some(1)),
            post(Kind::Press, 7, 14, None),
            post(Kind::Customers, 6, 21, None),
            post(Kind::Comments, 5, 8, Some(99)),
        ];
        let own = [post(Kind::Own, 2, 21, None), post(Kind::Own, 1, 14, Some(3))];
        let order: Vec<(Kind, u32)> =
            threads(&others, &own).iter().map(|post| (post.kind, post.number)).collect();
        let (own, comment) = (Kind::Own, Kind::Comments);
        assert_eq!(
            order,
            [
                (own, 2),
                (Kind::Customers, 6),
                (own, 1),
                (comment, 8),
                (comment, 9),
                (Kind::Press, 7),
                (comment, 5)
            ]
        );
    }

    #[test]
    fn filters_join_kind_week_and_text() {
        let own = post(Kind::Customers, 6, 21, None);
        let mut filter = Filter::default();
        assert!(filter.takes(&own) && filter.words().is_empty());
        filter.earlier_week(4);
        assert!(!filter.takes(&own));
        filter.earlier_week(4);
        filter.text = "wORDS".to_owned();
        filter.next_kind();
        assert!(filter.takes(&own));
        assert_eq!(filter.words(), "customers · week 3 · \"wORDS\"");
        for _ in 0..4 {
            filter.next_kind();
        }
        filter.later_week(3);
        assert_eq!((filter.kind, filter.week), (None, None));
    }

    #[test]
    fn weeks_without_posts_count_as_none() {
        let posts = [post(Kind::Press, 1, 1, None), post(Kind::Press, 2, 15, None)];
        assert_eq!(by_week(&posts, 3, |_| true), [(1.0, 1.0), (2.0, 0.0), (3.0, 1.0)]);
        assert_eq!(by_week(&posts, 1, |kind| kind == Kind::Own), [(1.0, 0.0)]);
    }
}
