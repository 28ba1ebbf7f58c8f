-- title: Usage by group
-- what: Usage by group on the last day, in all and per seat.
-- chart: bar group_id units
SELECT c.group_id, count(*) AS users, sum(s.seat_count) AS seats, sum(u.usage_units) AS units,
    round(1.0 * sum(u.usage_units) / sum(s.seat_count)) AS units_a_seat
FROM daily_usage u
CROSS JOIN subscriptions s
CROSS JOIN customers c
WHERE u.day = (SELECT max(day) FROM service_day) AND s.customer_id = u.customer_id AND s.status = 'subscribed'
    AND c.customer_id = u.customer_id
GROUP BY 1
ORDER BY 4 DESC
