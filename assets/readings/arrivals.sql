-- Leads of the last twelve weeks by week, group and source, and how many signed. Individuals sign on the day they
-- come or never; companies are counted again in the week of their deal. Companies without a request for an offer have
-- no subscription.
SELECT (c.created_day + 6) / 7 AS week, c.group_id, c.acquisition_source, count(*) AS leads,
    sum(c.email IS NULL AND coalesce(s.status, '') IN ('subscribed', 'cancelled')) AS signed
FROM customers c
LEFT JOIN subscriptions s ON s.customer_id = c.customer_id
WHERE c.created_day > (SELECT max(day) FROM service_day) - 84
GROUP BY 1, 2, 3
UNION ALL
SELECT (s.start_day + 6) / 7, c.group_id, c.acquisition_source, 0, count(*)
FROM customers c
CROSS JOIN subscriptions s
WHERE c.email IS NOT NULL AND s.customer_id = c.customer_id
    AND s.start_day > (SELECT max(day) FROM service_day) - 84 AND s.status IN ('subscribed', 'cancelled')
GROUP BY 1, 2, 3
