-- title: Quality of service by week
-- what: Latency, failed requests and outage minutes, week by week, with the worst day of each.
-- chart: line week latency_ms
SELECT (day + 6) / 7 AS week, round(avg(p95_ms), 1) AS latency_ms, round(max(p95_ms), 1) AS worst_latency_ms,
    round(100.0 * avg(error_rate), 3) AS failed_percent, round(100.0 * max(error_rate), 3) AS worst_failed_percent,
    sum(downtime_minutes) AS outage_minutes
FROM service_day
WHERE day > 0
GROUP BY 1
ORDER BY 1
