-- Notices of the last week, the newest first, without the talks with companies: those stand in the inbox.
SELECT day, type, message
FROM notifications
WHERE day > (SELECT max(day) FROM service_day) - 7
    AND type NOT IN ('large_customer_message', 'lead_lost', 'deal_won')
ORDER BY notification_id DESC
LIMIT 50
