//! What the press writes: of which rival, or of the economy.

use std::sync::Arc;

use crate::console::company::Company;
use crate::console::posts::{Kind, Post};

/// A piece of news.
#[derive(Debug, Clone, PartialEq)]
pub struct Item {
    /// The post.
    pub post: Arc<Post>,
    /// The rival that it names.
    pub rival: Option<String>,
}

/// The news of the press, the newest first.
pub fn of(company: &Company) -> Vec<Item> {
    let press = company.posts.iter().filter(|post| post.kind == Kind::Press);
    let item = |post: &Arc<Post>| {
        let rival = company.terms.rivals.iter().find(|name| post.text.contains(name.as_str()));
        Item { post: post.clone(), rival: rival.cloned() }
    };
    press.map(item).collect()
}
