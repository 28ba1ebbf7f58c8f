-- title: Where customers come from
-- what: Leads of the last twelve weeks by channel, and how many of them became customers.
-- chart: bar acquisition_source leads signed
SELECT c.acquisition_source, count(*) AS leads, sum(s.status IN ('subscribed', 'cancelled')) AS signed,
    round(100.0 * sum(s.status IN ('subscribed', 'cancelled')) / count(*), 1) AS signed_percent,
    sum(s.status = 'subscribed') AS still_here
FROM customers c
CROSS JOIN subscriptions s
WHERE c.created_day > (SELECT max(day) FROM service_day) - 84 AND c.acquisition_source IS NOT NULL
    AND s.customer_id = c.customer_id
GROUP BY 1
ORDER BY 2 DESC
