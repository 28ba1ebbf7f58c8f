-- What companies wrote in the last eight days, the newest of each thread: a thread that waits ends a week after it.
SELECT thread_id, message_text
FROM enterprise_turns
WHERE message_id IN (
    SELECT max(message_id) FROM enterprise_turns
    WHERE sender = 'customer' AND offer_json <> '{}' AND closed = 0
        AND message_id > (SELECT coalesce(max(message_id), 0) - 40000 FROM enterprise_turns)
        AND day >= (SELECT max(day) FROM service_day) - 8
    GROUP BY thread_id)
ORDER BY thread_id DESC
LIMIT 5000
