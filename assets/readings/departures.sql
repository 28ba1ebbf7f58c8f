-- Customers who left in the last twelve weeks, by week and group. Whether they left is looked at last: the day
-- sorts out nearly all rows. A deal that was left early ends in the future.
SELECT (min(s.end_day, d.day) + 6) / 7 AS week, c.group_id, count(*) AS cancelled,
    sum(s.end_day > d.day - 30 AND s.start_day <= d.day - 30) AS of_30_days_ago
FROM subscriptions s
CROSS JOIN (SELECT max(day) AS day FROM service_day) d
JOIN customers c ON c.customer_id = s.customer_id
WHERE s.end_day > (SELECT max(day) FROM service_day) - 84 AND s.status = 'cancelled'
GROUP BY 1, 2
