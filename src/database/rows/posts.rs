//! Writes the rows of public posts.

use rusqlite::{Transaction, params};

use novamind_world::events::{Facts, PostSubject};

/// Writes posts of authors other than the player, with their texts.
pub(super) fn insert_posts(
    transaction: &Transaction<'_>,
    facts: &Facts,
    words: &[String],
) -> rusqlite::Result<()> {
    let mut insert =
        transaction.prepare_cached("INSERT OR REPLACE INTO social_media_posts VALUES (?1, ?2, ?3, ?4)")?;
    for (post, words) in facts.posts.iter().zip(words) {
        let answered = match post.matter {
            PostSubject::Comment { own_post, .. } => Some(own_post),
            _ => None,
        };
        insert.execute(params![post.post, facts.day, words, answered])?;
    }
    Ok(())
}

/// Writes the new texts of reworded posts.
pub(super) fn update_post_texts(
    transaction: &Transaction<'_>,
    rewordings: &[(u32, String)],
) -> rusqlite::Result<()> {
    if rewordings.is_empty() {
        return Ok(());
    }
    let mut update =
        transaction.prepare_cached("UPDATE social_media_posts SET content = ?2 WHERE post_id = ?1")?;
    for (post, text) in rewordings {
        update.execute(params![post, text])?;
    }
    Ok(())
}

/// Writes the player's posts, and updates their views and comments.
pub(super) fn insert_player_posts(transaction: &Transaction<'_>, facts: &Facts) -> rusqlite::Result<()> {
    let mut insert = transaction.prepare_cached(
        "INSERT OR REPLACE INTO agent_social_media_posts (agent_post_id, day, content, reply_to_post_id) \
         VALUES (?1, ?2, ?3, ?4)",
    )?;
    for made in &facts.own_posts {
        insert.execute(params![made.post, facts.day, made.content, made.reply_to])?;
    }
    let mut update = transaction.prepare_cached(
        "UPDATE agent_social_media_posts SET views = ?2, comment_post_ids = ?3 WHERE agent_post_id = ?1",
    )?;
    for seen in &facts.own_posts_seen {
        let comments: Vec<String> = seen.comments.iter().map(u32::to_string).collect();
        let comments = format!("[{}]", comments.join(", "));
        update.execute(params![seen.post, seen.views as i64, comments])?;
    }
    Ok(())
}
