-- title: Public posts by week
-- what: Public posts by week, and how many of them reply to your posts.
-- chart: line week posts answers_to_us
SELECT (day + 6) / 7 AS week, count(*) AS posts, sum(reply_to_agent_post_id IS NOT NULL) AS answers_to_us
FROM social_media_posts
GROUP BY 1
ORDER BY 1
