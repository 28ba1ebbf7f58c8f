-- title: What a unit of usage costs
-- what: Compute and capacity costs in dollars per million units, by day: shows whether growth makes service cheaper.
-- chart: line day dollars_a_million_units
SELECT d.day, d.total_usage_units AS units, round(l.dollars, 2) AS dollars,
    round(1e6 * l.dollars / nullif(d.total_usage_units, 0), 2) AS dollars_a_million_units
FROM service_day d
JOIN (
    SELECT day, -sum(amount) AS dollars
    FROM ledger
    WHERE amount < 0 AND category IN ('compute', 'capacity')
    GROUP BY 1
) l ON l.day = d.day
ORDER BY 1
