-- title: Retention by cohort
-- what: Subscribers who signed up in the same four weeks: how many are still subscribed, and how long the others stayed.
-- chart: line joined_from_day still_here_percent
SELECT start_day / 28 * 28 AS joined_from_day, count(*) AS joined, sum(end_day IS NULL) AS still_here,
    round(100.0 * sum(end_day IS NULL) / count(*), 1) AS still_here_percent,
    round(avg(end_day - start_day), 1) AS days_until_leaving
FROM subscriptions
WHERE status IN ('subscribed', 'cancelled')
GROUP BY 1
ORDER BY 1
