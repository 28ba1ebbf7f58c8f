-- title: Bills of the next four weeks
-- what: Bills of the next 28 days if today's subscribers stay on their plans at today's prices and no one joins.
-- chart: bar day dollars_due
WITH RECURSIVE coming (day) AS (
    SELECT max(day) + 1 FROM service_day
    UNION ALL
    SELECT day + 1 FROM coming WHERE day < (SELECT max(day) FROM service_day) + 28
), due AS (
    SELECT billing_day_mod30 AS billing_day, count(*) AS customers, sum(seat_count) AS seats,
        sum(effective_price * seat_count) AS dollars
    FROM subscriptions
    WHERE status = 'subscribed'
    GROUP BY 1
)
SELECT (c.day + 6) / 7 AS week, c.day, coalesce(d.customers, 0) AS customers, coalesce(d.seats, 0) AS seats,
    round(coalesce(d.dollars, 0), 2) AS dollars_due,
    round(sum(coalesce(d.dollars, 0)) OVER (ORDER BY c.day), 2) AS dollars_due_so_far
FROM coming c
LEFT JOIN due d ON d.billing_day = c.day % 30
ORDER BY 2
