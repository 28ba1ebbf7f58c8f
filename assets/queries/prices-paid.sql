-- title: Prices paid
-- what: Number of customers by price paid and plan: subscribers keep earlier, lower prices.
-- chart: bar plan_and_price subscribers
WITH paid AS (
    -- Only the few different prices are rounded.
    SELECT plan, effective_price AS price, count(*) AS subscribers, sum(seat_count) AS seats,
        min(start_day) AS first_joined_day, max(start_day) AS last_joined_day
    FROM subscriptions
    WHERE status = 'subscribed'
    GROUP BY 1, 2
)
SELECT plan || ' at $' || round(price, 2) AS plan_and_price, plan, round(price, 2) AS price,
    sum(subscribers) AS subscribers, sum(seats) AS seats, min(first_joined_day) AS first_joined_day,
    max(last_joined_day) AS last_joined_day
FROM paid
GROUP BY 2, 3
ORDER BY 4 DESC
LIMIT 200
