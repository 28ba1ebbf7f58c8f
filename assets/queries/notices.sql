-- title: Notices by kind
-- what: Number of notices by type, with the first and last day.
-- chart: bar type notices
WITH days AS MATERIALIZED (
    SELECT type, day, count(*) AS notices
    FROM notifications
    GROUP BY type, day
)
SELECT type, sum(notices) AS notices, min(day) AS first_day, max(day) AS last_day,
    sum(CASE WHEN day > (SELECT max(day) FROM service_day) - 28 THEN notices ELSE 0 END) AS last_4_weeks
FROM days
GROUP BY 1
ORDER BY 2 DESC
