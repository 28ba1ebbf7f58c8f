-- title: When customers leave
-- what: Cancellations by month of the subscription, and their share of the subscriptions that reached that month.
-- chart: bar month_of_stay left_percent
WITH stays AS (
    SELECT (coalesce(end_day, (SELECT max(day) FROM service_day)) - start_day) / 30 + 1 AS month,
        end_day IS NOT NULL AS is_gone, count(*) AS customers
    FROM subscriptions
    WHERE status IN ('subscribed', 'cancelled')
    GROUP BY 1, 2
)
SELECT month AS month_of_stay, sum(is_gone * customers) AS left,
    (SELECT sum(later.customers) FROM stays later WHERE later.month >= stays.month) AS got_so_far,
    round(100.0 * sum(is_gone * customers)
        / (SELECT sum(later.customers) FROM stays later WHERE later.month >= stays.month), 1) AS left_percent
FROM stays
GROUP BY 1
ORDER BY 1
