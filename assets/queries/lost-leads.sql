-- title: Lost leads
-- what: Of the leads of the last four weeks, how many signed, left without signing, or are still deciding, by group.
-- chart: bar group_id lost
SELECT c.group_id, count(*) AS leads, sum(s.status IN ('subscribed', 'cancelled')) AS signed,
    sum(s.status = 'lost') AS lost, sum(s.status = 'lead') AS undecided,
    round(100.0 * sum(s.status IN ('subscribed', 'cancelled')) / count(*), 1) AS signed_percent
FROM customers c
CROSS JOIN subscriptions s
WHERE c.created_day > (SELECT max(day) FROM service_day) - 28 AND s.customer_id = c.customer_id
GROUP BY 1
ORDER BY 4 DESC
