-- title: Biggest accounts
-- what: The thirty customers with the highest payments, their first day, and their discount from the list price.
-- chart: bar customer dollars_a_month
SELECT '#' || c.customer_id || ' ' || c.group_id AS customer, c.persona_industry AS industry, s.plan,
    s.seat_count AS seats, round(s.effective_price, 2) AS dollars_a_seat,
    round(s.effective_price * s.seat_count) AS dollars_a_month, s.start_day AS since_day,
    round(s.listed_price - s.effective_price, 2) AS below_list
FROM (
    SELECT customer_id
    FROM subscriptions
    WHERE status = 'subscribed'
    ORDER BY effective_price * seat_count DESC
    LIMIT 30
) biggest
JOIN subscriptions s ON s.customer_id = biggest.customer_id
JOIN customers c ON c.customer_id = biggest.customer_id
ORDER BY 6 DESC, c.customer_id
