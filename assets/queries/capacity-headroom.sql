-- title: Capacity headroom
-- what: The peak day of each week compared with capacity, its growth, and next week's peak at the same growth.
-- chart: line week peak capacity next_peak
WITH weeks AS (
    SELECT (day + 6) / 7 AS week, count(*) AS days, max(total_usage_units) AS peak, min(capacity_units) AS capacity,
        max(capacity_tier) AS tier
    FROM service_day
    GROUP BY 1
)
SELECT w.week, w.peak, w.capacity, w.tier,
    round(100.0 * (w.capacity - w.peak) / nullif(w.capacity, 0), 1) AS free_percent,
    round(100.0 * (w.peak * 1.0 / nullif(b.peak, 0) - 1), 1) AS growth_percent,
    CASE WHEN w.days = 7 AND b.days = 7 THEN round(w.peak * 1.0 * w.peak / nullif(b.peak, 0)) END AS next_peak
FROM weeks w
LEFT JOIN weeks b ON b.week = w.week - 1
ORDER BY 1
