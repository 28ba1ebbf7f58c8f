-- title: How much people write
-- what: Posts in public week by week, and how many of them answer us.
-- chart: line week posts answers_to_us
SELECT (day + 6) / 7 AS week, count(*) AS posts, sum(reply_to_agent_post_id IS NOT NULL) AS answers_to_us
FROM social_media_posts
GROUP BY 1
ORDER BY 1
