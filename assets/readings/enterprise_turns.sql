-- Turns of negotiations, the newest first; 5000 are what an answer holds. Without the table of customers, which
-- would take the seats away.
SELECT thread_id, customer_id, thread_type, turn_number, sender, message_text, offer_json, day, seat_count, close_reason
FROM enterprise_turns
ORDER BY message_id DESC
LIMIT 5000
