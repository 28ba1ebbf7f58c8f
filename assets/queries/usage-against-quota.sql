-- title: Usage against quota
-- what: Usage of the customers of each plan on the last day compared with their quota, and how many reached it.
-- chart: bar plan percent_of_quota
SELECT plan, max(quota) AS quota, count(*) AS customers, round(avg(units)) AS units_a_customer,
    round(100.0 * sum(units) / nullif(sum(quota), 0), 1) AS percent_of_quota,
    sum(units >= quota) AS at_their_quota, round(100.0 * sum(units >= quota) / count(*), 1) AS at_quota_percent,
    sum(units < quota / 4) AS below_a_quarter
FROM (
    SELECT s.plan, u.usage_units AS units,
        CASE s.plan WHEN 'A' THEN q.quota_A WHEN 'B' THEN q.quota_B ELSE q.quota_C END AS quota
    FROM daily_usage u
    CROSS JOIN subscriptions s
    CROSS JOIN config_history q
    WHERE u.day = (SELECT max(day) FROM service_day) AND s.customer_id = u.customer_id AND s.status = 'subscribed'
        AND q.day = (SELECT max(day) FROM config_history)
)
GROUP BY 1
ORDER BY 1
