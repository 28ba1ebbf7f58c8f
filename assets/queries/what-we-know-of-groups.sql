-- title: Known groups and their studies
-- what: Study level of each group, the day of its discovery, and its number of leads.
-- chart: bar group_id people
SELECT g.group_id, g.info_level, g.is_discoverable AS had_to_be_found, g.discovered_day, g.last_research_day,
    coalesce(p.people, 0) AS people
FROM group_info_levels g
LEFT JOIN (SELECT group_id, count(*) AS people FROM customers WHERE created_day > 0 GROUP BY 1) p
    ON p.group_id = g.group_id
ORDER BY 6 DESC, 1
