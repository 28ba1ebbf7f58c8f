-- title: Forecasts against outcome
-- what: Error of your cash forecasts in percent of cash, by due day and horizon.
-- chart: line due_on_day one_week four_weeks twelve_weeks half_a_year
WITH cash AS (
    SELECT day, sum(sum(amount)) OVER (ORDER BY day) AS cash
    FROM ledger
    WHERE (SELECT count(*) FROM predictions) > 0
    GROUP BY day
),
due AS (
    SELECT p.submit_day + p.horizon_days AS due_on_day, p.submit_day AS filed_on_day, p.horizon_days,
        p.predicted_value AS forecast, c.cash AS outcome,
        round(100.0 * (c.cash - p.predicted_value) / nullif(abs(c.cash), 0), 1) AS error_percent,
        c.cash BETWEEN p.predicted_lower AND p.predicted_upper AS inside
    FROM predictions p
    JOIN cash c ON c.day = p.submit_day + p.horizon_days
)
SELECT due_on_day, filed_on_day, horizon_days, round(forecast) AS forecast, round(outcome) AS outcome, inside,
    CASE horizon_days WHEN 7 THEN error_percent END AS one_week,
    CASE horizon_days WHEN 28 THEN error_percent END AS four_weeks,
    CASE horizon_days WHEN 84 THEN error_percent END AS twelve_weeks,
    CASE horizon_days WHEN 182 THEN error_percent END AS half_a_year
FROM due
ORDER BY due_on_day DESC, horizon_days
