-- title: Cash by week
-- what: Income, costs and their difference by week. The running sum is the current cash.
-- chart: line week cash
WITH days AS MATERIALIZED (
    SELECT day, total(amount) AS net, total(amount) FILTER (WHERE amount < 0) AS cost
    FROM ledger
    GROUP BY day
), bought AS (
    SELECT day, sum(amount) AS amount
    FROM ledger
    WHERE day IN (SELECT day FROM days WHERE day % 7 = 0) AND amount < 0
        AND category IN ('research_project', 'market_research', 'group_research')
    GROUP BY day
)
SELECT week, round(sum(net) - sum(cost), 2) AS income, round(sum(cost), 2) AS cost, round(sum(net), 2) AS net,
    round(sum(sum(net)) OVER (ORDER BY week), 2) AS cash
FROM (
    SELECT (day + 6) / 7 AS week, net - coalesce(bought.amount, 0) AS net, cost - coalesce(bought.amount, 0) AS cost
    FROM days LEFT JOIN bought USING (day)
    UNION ALL
    SELECT day / 7 + 1, amount, amount FROM bought
)
GROUP BY 1
ORDER BY 1
