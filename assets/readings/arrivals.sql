-- Leads of the last twelve weeks by week, group and source, and how many of them have signed since.
SELECT (c.created_day + 6) / 7 AS week, c.group_id, c.acquisition_source,
    count(*) AS leads, sum(s.status IN ('subscribed', 'cancelled')) AS signed
FROM customers c
JOIN subscriptions s ON s.customer_id = c.customer_id
WHERE c.created_day > (SELECT max(day) FROM service_day) - 84
GROUP BY 1, 2, 3
