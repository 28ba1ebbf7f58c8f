-- title: Running costs by week
-- what: Each kind of cost by week; a purchase counts in the week after its decision day.
-- chart: line week capacity compute operations development advertising
SELECT CASE WHEN category IN ('research_project', 'market_research', 'group_research')
        THEN day / 7 + 1 ELSE (day + 6) / 7 END AS week, round(-sum((category = 'capacity') * amount)) AS capacity,
    round(-sum((category = 'compute') * amount)) AS compute,
    round(-sum((category = 'operations') * amount)) AS operations,
    round(-sum((category = 'development') * amount)) AS development,
    round(-sum((category = 'advertising') * amount)) AS advertising,
    round(-sum((category IN ('market_research', 'group_research', 'research_project')) * amount)) AS research
FROM ledger
WHERE amount < 0 AND category NOT IN ('subscription_payment', 'lead_acquisition_cost')
GROUP BY 1
ORDER BY 1
