-- title: Retention by plan and tenure
-- what: Share of subscribers who stayed for a number of months, of those who could have, by plan.
-- chart: line months plan_A_percent plan_B_percent plan_C_percent
WITH today AS (SELECT max(day) AS day FROM service_day),
months(months) AS (VALUES (1), (2), (3), (4), (5), (6), (9), (12)),
stays AS (
    SELECT s.plan, (t.day - s.start_day) / 30 AS possible, (coalesce(s.end_day, t.day) - s.start_day) / 30 AS stayed,
        count(*) AS customers
    FROM subscriptions s
    CROSS JOIN today t
    WHERE s.status IN ('subscribed', 'cancelled')
    -- One number is sorted faster than three values.
    GROUP BY (t.day - s.start_day) / 30 * 1000 + (coalesce(s.end_day, t.day) - s.start_day) / 30 * 10
        + instr('ABC', s.plan)
)
SELECT m.months, sum(customers) AS could_have_stayed,
    round(100.0 * sum((stayed >= months AND plan = 'A') * customers) / sum((plan = 'A') * customers), 1)
        AS plan_A_percent,
    round(100.0 * sum((stayed >= months AND plan = 'B') * customers) / sum((plan = 'B') * customers), 1)
        AS plan_B_percent,
    round(100.0 * sum((stayed >= months AND plan = 'C') * customers) / sum((plan = 'C') * customers), 1)
        AS plan_C_percent
FROM months m
JOIN stays s ON s.possible >= m.months
GROUP BY 1
ORDER BY 1
