-- title: Discounts in force
-- what: Number of customers with a discount, and the revenue that it costs per month.
-- chart: bar plan given_away_a_month
SELECT plan, count(*) AS subscribers, sum(promotion > 0) AS with_discount,
    round(avg(CASE WHEN promotion > 0 THEN promotion END), 2) AS average_discount,
    round(sum((listed_price - effective_price) * seat_count)) AS given_away_a_month,
    round(100.0 * sum((listed_price - effective_price) * seat_count) / sum(listed_price * seat_count), 1)
        AS percent_of_list
FROM subscriptions
WHERE status = 'subscribed'
GROUP BY 1
ORDER BY 1
