-- Dollars by week and category, without payments and lead costs: those are rows per customer, the weekly figures
-- know their sums. A decision day still belongs to the week before it.
SELECT (day + 6) / 7 AS week, category, sum(amount) AS amount
FROM ledger
WHERE category NOT IN ('subscription_payment', 'lead_acquisition_cost')
GROUP BY 1, 2
