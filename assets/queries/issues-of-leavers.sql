-- title: Cancelled subscribers and their issues
-- what: Subscribers who cancelled in the last four weeks: their days and price, and the issues that were open on the last day.
SELECT s.customer_id, c.group_id, s.plan, s.effective_price AS dollars_a_month, s.start_day, s.end_day,
    count(i.issue_id) AS open_issues, max(s.end_day - i.open_day) AS oldest_issue_days
FROM subscriptions s
JOIN customers c ON c.customer_id = s.customer_id
LEFT JOIN issues i ON i.customer_id = s.customer_id AND i.open_day <= s.end_day
    AND (i.resolved_day IS NULL OR i.resolved_day >= s.end_day)
WHERE s.end_day > (SELECT max(day) FROM service_day) - 28 AND s.end_day <= (SELECT max(day) FROM service_day)
    AND s.status = 'cancelled'
GROUP BY s.customer_id
ORDER BY s.end_day DESC, s.customer_id
