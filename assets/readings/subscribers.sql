-- Active subscriptions by group and plan, what they pay a month, and how many of them were there 30 days ago.
SELECT c.group_id, s.plan, count(*) AS customers, sum(s.seat_count) AS seats,
    sum(s.effective_price * s.seat_count) AS monthly,
    sum(s.start_day <= (SELECT max(day) FROM service_day) - 30) AS since_30_days
FROM subscriptions s
CROSS JOIN customers c
WHERE s.status = 'subscribed' AND c.customer_id = s.customer_id
GROUP BY 1, 2
