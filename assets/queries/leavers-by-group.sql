-- title: Who left, by group and plan
-- what: Which groups and plans lost most customers in the last four weeks, what they paid, and how long they stayed.
-- chart: bar group_and_plan left
SELECT c.group_id || ' ' || s.plan AS group_and_plan, count(*) AS left, sum(s.seat_count) AS seats,
    round(sum(s.effective_price * s.seat_count)) AS dollars_a_month_lost,
    round(avg(s.effective_price), 2) AS average_price,
    round(avg(min(s.end_day, (SELECT max(day) FROM service_day)) - s.start_day)) AS average_days_stayed
FROM subscriptions s
CROSS JOIN customers c
WHERE s.end_day > (SELECT max(day) FROM service_day) - 28 AND s.status = 'cancelled'
    AND c.customer_id = s.customer_id
GROUP BY 1
ORDER BY 2 DESC
