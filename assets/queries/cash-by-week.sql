-- title: Cash by week
-- what: What came in and went out each week, and what was left. The running sum is the cash you have.
-- chart: line week cash
SELECT week, round(sum(income), 2) AS income, round(sum(cost), 2) AS cost, round(sum(income) + sum(cost), 2) AS net,
    round(sum(sum(income) + sum(cost)) OVER (ORDER BY week), 2) AS cash
FROM (
    SELECT CASE WHEN category IN ('research_project', 'market_research', 'group_research')
            THEN day / 7 + 1 ELSE (day + 6) / 7 END AS week,
        sum(max(amount, 0)) AS income, sum(min(amount, 0)) AS cost
    FROM ledger
    GROUP BY 1
)
GROUP BY 1
ORDER BY 1
