-- title: Revenue per customer by group and plan
-- what: Monthly revenue by group and plan, in all and per customer.
-- chart: bar group_and_plan dollars_a_month
SELECT c.group_id || ' ' || s.plan AS group_and_plan, count(*) AS subscribers, sum(s.seat_count) AS seats,
    round(sum(s.effective_price * s.seat_count)) AS dollars_a_month,
    round(sum(s.effective_price * s.seat_count) / count(*), 2) AS dollars_a_customer,
    round(sum(s.effective_price * s.seat_count) / sum(s.seat_count), 2) AS dollars_a_seat
FROM subscriptions s
CROSS JOIN customers c
WHERE s.status = 'subscribed' AND c.customer_id = s.customer_id
GROUP BY 1
ORDER BY 4 DESC
