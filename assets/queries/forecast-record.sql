-- title: Record of forecasts
-- what: Coverage of your intervals (the aim is 95 %) and their mean width, for each horizon.
-- chart: bar horizon inside_percent
WITH cash AS (
    SELECT day, sum(sum(amount)) OVER (ORDER BY day) AS cash
    FROM ledger
    WHERE (SELECT count(*) FROM predictions) > 0
    GROUP BY day
)
SELECT (p.horizon_days / 7) || CASE p.horizon_days WHEN 7 THEN ' week' ELSE ' weeks' END AS horizon,
    count(*) AS forecasts, sum(c.cash BETWEEN p.predicted_lower AND p.predicted_upper) AS inside,
    round(100.0 * avg(c.cash BETWEEN p.predicted_lower AND p.predicted_upper), 1) AS inside_percent,
    round(100.0 * avg(abs(c.cash - p.predicted_value) / nullif(abs(c.cash), 0)), 1) AS average_error_percent,
    round(avg(p.predicted_upper - p.predicted_lower)) AS average_width
FROM predictions p
JOIN cash c ON c.day = p.submit_day + p.horizon_days
GROUP BY p.horizon_days
ORDER BY p.horizon_days
