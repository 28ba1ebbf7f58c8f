-- Subscribers of the last sixteen weeks by group, week of their signing, and the week in which they left; 0 for
-- those who are still there. A deal that was left early ends in the future.
SELECT c.group_id, (s.start_day + 6) / 7 AS cohort,
    CASE s.status WHEN 'subscribed' THEN 0 ELSE (min(s.end_day, d.day) + 6) / 7 END AS left_week,
    count(*) AS customers
FROM subscriptions s
CROSS JOIN (SELECT max(day) AS day FROM service_day) d
JOIN customers c ON c.customer_id = s.customer_id
WHERE s.start_day > (SELECT max(day) FROM service_day) - 112 AND s.status IN ('subscribed', 'cancelled')
GROUP BY 1, 2, 3
