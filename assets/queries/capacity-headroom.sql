-- title: Capacity headroom
-- what: Usage against capacity day by day: how near the service is to its limit, and when it was beyond it.
-- chart: line day usage capacity
SELECT day, total_usage_units AS usage, capacity_units AS capacity, capacity_tier AS tier,
    round(100.0 * (capacity_units - total_usage_units) / nullif(capacity_units, 0), 1) AS free_percent
FROM service_day
ORDER BY 1
