-- title: Notices by kind
-- what: What the notices said, how often, and when last.
-- chart: bar type notices
SELECT type, count(*) AS notices, min(day) AS first_day, max(day) AS last_day,
    sum(day > (SELECT max(day) FROM service_day) - 28) AS last_4_weeks
FROM notifications
GROUP BY 1
ORDER BY 2 DESC
