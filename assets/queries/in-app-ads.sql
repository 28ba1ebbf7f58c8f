-- title: What in-app ads earn
-- what: Revenue of in-app ads on the last day by group, for one subscriber who sees them, and their strength.
-- chart: bar group_id dollars_a_day
SELECT group_id, count(*) AS subscribers, round(sum(revenue), 2) AS dollars_a_day,
    round(sum(revenue) / count(*), 4) AS dollars_each, round(avg(ads_strength), 2) AS strength
FROM ads_revenue
WHERE day = (SELECT max(day) FROM service_day)
GROUP BY 1
ORDER BY 3 DESC
