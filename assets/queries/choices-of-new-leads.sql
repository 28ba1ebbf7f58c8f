-- title: What the last week's leads chose
-- what: Leads of the last seven days by group: how many signed up to each plan, were lost, negotiate, or opened no thread.
-- chart: bar group_id plan_A plan_B plan_C lost
SELECT group_id, count(*) AS leads, sum(choice = 'A') AS plan_A, sum(choice = 'B') AS plan_B,
    sum(choice = 'C') AS plan_C, sum(choice = 'lost') AS lost, sum(choice = 'lead') AS negotiating,
    sum(choice = '') AS no_thread, round(100.0 * sum(choice = 'A') / count(*), 1) AS plan_A_percent,
    round(100.0 * sum(choice = 'B') / count(*), 1) AS plan_B_percent,
    round(100.0 * sum(choice = 'C') / count(*), 1) AS plan_C_percent,
    round(100.0 * sum(choice = 'lost') / count(*), 1) AS lost_percent
FROM (
    SELECT c.group_id,
        CASE WHEN s.status IN ('lost', 'lead') THEN s.status WHEN s.status IS NULL THEN '' ELSE s.plan END AS choice
    FROM customers c
    LEFT JOIN subscriptions s ON s.customer_id = c.customer_id
    WHERE c.created_day > (SELECT max(day) FROM service_day) - 7 AND c.acquisition_source IS NOT NULL
)
GROUP BY 1
ORDER BY 2 DESC
