-- title: Paid leads and word of mouth by week
-- what: Leads of each group in the last twelve weeks: all, paid and signed.
-- chart: line week paid word_of_mouth
SELECT (c.created_day + 6) / 7 AS week, c.group_id, count(*) AS leads,
    sum(c.acquisition_source <> 'network') AS paid, sum(c.acquisition_source = 'network') AS word_of_mouth,
    sum(s.status IN ('subscribed', 'cancelled')) AS signed
FROM customers c
LEFT JOIN subscriptions s ON s.customer_id = c.customer_id
WHERE c.created_day > (SELECT max(day) FROM service_day) - 84 AND c.acquisition_source IS NOT NULL
GROUP BY 1, 2
ORDER BY 1, 2
