-- title: Prices that are paid
-- what: How many customers pay which price on which plan: old prices stay with those who joined under them.
-- chart: bar plan_and_price subscribers
SELECT plan || ' at $' || round(effective_price, 2) AS plan_and_price, plan, round(effective_price, 2) AS price,
    count(*) AS subscribers, sum(seat_count) AS seats, min(start_day) AS first_joined_day,
    max(start_day) AS last_joined_day
FROM subscriptions
WHERE status = 'subscribed'
GROUP BY 2, 3
ORDER BY 4 DESC
LIMIT 200
