-- Units of the last day by group and plan, of customers who are still there, what those pay a month, and the days
-- since they signed, times their seats.
SELECT c.group_id, s.plan, count(*) AS users, sum(s.seat_count) AS seats, sum(u.usage_units) AS units,
    sum(s.effective_price * s.seat_count) AS monthly, sum((u.day - s.start_day) * s.seat_count) AS seat_days
FROM daily_usage u
CROSS JOIN subscriptions s
CROSS JOIN customers c
WHERE u.day = (SELECT max(day) FROM service_day) AND s.customer_id = u.customer_id
    AND s.status = 'subscribed' AND c.customer_id = u.customer_id
GROUP BY 1, 2
