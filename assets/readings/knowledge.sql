-- What is known of every group, and since when.
SELECT group_id, info_level, discovered_day, last_research_day
FROM group_info_levels
ORDER BY group_id
