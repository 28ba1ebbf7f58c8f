-- title: Revenue by plan
-- what: Monthly revenue and seats of each plan, and the average price per seat.
-- chart: bar plan dollars_a_month
SELECT plan, count(*) AS subscribers, sum(seat_count) AS seats,
    round(sum(effective_price * seat_count)) AS dollars_a_month,
    round(sum(effective_price * seat_count) / sum(seat_count), 2) AS dollars_a_seat,
    round(100.0 * sum(effective_price * seat_count) / sum(sum(effective_price * seat_count)) OVER (), 1)
        AS percent_of_revenue
FROM subscriptions
WHERE status = 'subscribed'
GROUP BY 1
ORDER BY 1
