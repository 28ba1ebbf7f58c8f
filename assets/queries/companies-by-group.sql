-- title: Enterprises by group
-- what: Outcome of the enterprises of each group: won, lost, churned or open, and the payments of the won ones.
-- chart: bar group_id customers lost
SELECT c.group_id, count(*) AS companies, sum(s.status = 'subscribed') AS customers, sum(s.status = 'lost') AS lost,
    sum(s.status = 'cancelled') AS left, sum(s.status = 'lead') AS talking,
    sum((s.status = 'subscribed') * s.seat_count) AS seats,
    round(sum((s.status = 'subscribed') * s.effective_price * s.seat_count)) AS dollars_a_month
FROM customers c
CROSS JOIN subscriptions s
WHERE c.email IS NOT NULL AND s.customer_id = c.customer_id
GROUP BY 1
ORDER BY 2 DESC
