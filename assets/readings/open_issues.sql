-- Open issues of the last sixteen weeks whose customers are still there, by group and days of ageing.
SELECT i.group_id, sum(i.days_open < 4), sum(i.days_open BETWEEN 4 AND 7), sum(i.days_open BETWEEN 8 AND 14),
    sum(i.days_open > 14)
FROM issues i
JOIN subscriptions s ON s.customer_id = i.customer_id
WHERE i.open_day > (SELECT max(day) FROM service_day) - 112 AND i.status = 'open' AND s.status = 'subscribed'
GROUP BY 1
