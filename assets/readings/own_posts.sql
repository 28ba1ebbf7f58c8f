-- Our posts, the newest first.
SELECT agent_post_id, day, content, reply_to_post_id, views, comment_post_ids
FROM agent_social_media_posts
ORDER BY agent_post_id DESC
