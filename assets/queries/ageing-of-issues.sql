-- title: Ageing of open issues
-- what: Age of the open issues of active customers, by group.
-- chart: bar group_id over_two_weeks
SELECT i.group_id, count(*) AS open, sum(i.days_open < 4) AS up_to_3_days,
    sum(i.days_open BETWEEN 4 AND 7) AS up_to_a_week, sum(i.days_open BETWEEN 8 AND 14) AS up_to_two_weeks,
    sum(i.days_open > 14) AS over_two_weeks, max(i.days_open) AS oldest_days
FROM issues i
CROSS JOIN subscriptions s
WHERE i.resolved_day IS NULL AND i.open_day > (SELECT max(day) FROM service_day) - 112
    AND s.customer_id = i.customer_id AND s.status = 'subscribed'
GROUP BY 1
ORDER BY 2 DESC
