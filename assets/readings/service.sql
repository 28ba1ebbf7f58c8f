-- How the service ran, day by day.
SELECT day, total_usage_units, capacity_units, capacity_tier, p95_ms, error_rate, downtime_minutes
FROM service_day
ORDER BY day
