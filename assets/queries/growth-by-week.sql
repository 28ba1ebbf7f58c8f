-- title: Joined and left by week
-- what: Whether the number of subscribers grows, and which side of it moves.
-- chart: line week joined left
SELECT week, sum(joined) AS joined, sum(gone) AS left, sum(joined) - sum(gone) AS net,
    sum(sum(joined) - sum(gone)) OVER (ORDER BY week) AS subscribers
FROM (
    SELECT (start_day + 6) / 7 AS week, count(*) AS joined, 0 AS gone
    FROM subscriptions
    WHERE status IN ('subscribed', 'cancelled')
    GROUP BY 1
    UNION ALL
    SELECT (min(end_day, (SELECT max(day) FROM service_day)) + 6) / 7, 0, count(*)
    FROM subscriptions
    WHERE end_day IS NOT NULL AND status = 'cancelled'
    GROUP BY 1
)
GROUP BY 1
ORDER BY 1
