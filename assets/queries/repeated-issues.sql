-- title: Customers with most issues
-- what: Customers with the most issues in the last four weeks, their payments, and whether they are still subscribed.
-- chart: bar customer issues
SELECT '#' || t.customer_id || ' ' || t.group_id AS customer, t.issues, t.open, s.plan, s.seat_count AS seats,
    round(s.effective_price * s.seat_count, 2) AS dollars_a_month, s.status
FROM (
    SELECT customer_id, group_id, count(*) AS issues, sum(resolved_day IS NULL) AS open
    FROM issues
    WHERE open_day > (SELECT max(day) FROM service_day) - 28
    GROUP BY customer_id
    ORDER BY 3 DESC, customer_id
    LIMIT 40
) t
JOIN subscriptions s ON s.customer_id = t.customer_id
ORDER BY 2 DESC, t.customer_id
