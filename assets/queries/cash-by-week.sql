-- title: Cash by week
-- what: What came in and went out each week, and what was left. The running sum is the cash you have.
-- chart: line week cash
WITH days AS MATERIALIZED (
    SELECT day, sum(max(amount, 0)) AS income,
        sum(CASE WHEN day % 7 = 0 AND category IN ('research_project', 'market_research', 'group_research')
            THEN 0 ELSE min(amount, 0) END) AS cost,
        sum(CASE WHEN day % 7 = 0 AND category IN ('research_project', 'market_research', 'group_research')
            THEN amount ELSE 0 END) AS bought
    FROM ledger
    GROUP BY day
)
SELECT week, round(sum(income), 2) AS income, round(sum(cost), 2) AS cost, round(sum(income) + sum(cost), 2) AS net,
    round(sum(sum(income) + sum(cost)) OVER (ORDER BY week), 2) AS cash
FROM (
    SELECT (day + 6) / 7 AS week, income, cost FROM days
    UNION ALL
    SELECT day / 7 + 1, 0, bought FROM days WHERE bought <> 0
)
GROUP BY 1
ORDER BY 1
