-- title: Cash by week
-- what: What came in and went out each week, and what was left. The running sum is the cash you have.
-- chart: line week cash
SELECT week, round(sum(income), 2) AS income, round(sum(cost), 2) AS cost, round(sum(income) + sum(cost), 2) AS net,
    round(sum(sum(income) + sum(cost)) OVER (ORDER BY week), 2) AS cash
FROM (
    SELECT (day + 6) / 7 AS week, sum(max(amount, 0)) AS income, sum(min(amount, 0)) AS cost
    FROM ledger
    GROUP BY day
)
GROUP BY 1
ORDER BY 1
