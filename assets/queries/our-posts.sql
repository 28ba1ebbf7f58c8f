-- title: Our posts and their readers
-- what: What we wrote in public, how often each post was seen, and how many answered.
-- chart: bar post views
SELECT '#' || agent_post_id || ' day ' || day AS post, views, json_array_length(comment_post_ids) AS comments,
    reply_to_post_id IS NOT NULL AS is_answer, content
FROM agent_social_media_posts
ORDER BY agent_post_id DESC
LIMIT 500
