-- What companies wrote in the last eight days, the newest of each thread: a thread that waits ends a week after it.
-- Letters with a price, and wishes for another plan, which name none: with the plan that the company has.
SELECT thread_id, message_text,
    CASE WHEN offer_json = '{}' THEN
        (SELECT s.plan FROM subscriptions s WHERE s.customer_id = enterprise_turns.customer_id)
    END AS present_plan
FROM enterprise_turns
WHERE message_id IN (
    SELECT max(message_id) FROM enterprise_turns
    WHERE sender = 'customer' AND (offer_json <> '{}' OR thread_type = 'plan_change') AND closed = 0
        AND message_id > (SELECT coalesce(max(message_id), 0) - 40000 FROM enterprise_turns)
        AND day >= (SELECT max(day) FROM service_day) - 8
    GROUP BY thread_id)
ORDER BY thread_id DESC
LIMIT 5000
