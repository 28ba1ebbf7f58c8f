-- title: Your posts and their views
-- what: Your public posts, their views and the number of replies.
-- chart: bar post views
SELECT '#' || agent_post_id || ' day ' || day AS post, views, json_array_length(comment_post_ids) AS comments,
    reply_to_post_id IS NOT NULL AS is_answer, content
FROM agent_social_media_posts
ORDER BY agent_post_id DESC
LIMIT 500
