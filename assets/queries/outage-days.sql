-- title: Days with an outage
-- what: Days with an outage, its length, and the utilization on that day.
-- chart: bar day outage_minutes
SELECT day, downtime_minutes AS outage_minutes, round(p95_ms) AS latency_ms,
    round(100.0 * error_rate, 2) AS failed_percent,
    round(100.0 * total_usage_units / nullif(capacity_units, 0), 1) AS full_percent, capacity_tier
FROM service_day
WHERE downtime_minutes > 0
ORDER BY 1 DESC
