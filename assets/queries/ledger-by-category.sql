-- title: Where money comes from and goes to
-- what: Dollars of the last four weeks by category, the largest cost first.
-- chart: bar category dollars
SELECT category, round(sum(amount), 2) AS dollars, count(*) AS entries, round(sum(amount) / 28, 2) AS dollars_a_day
FROM ledger
WHERE day > (SELECT max(day) FROM service_day) - 28
GROUP BY 1
ORDER BY 2
