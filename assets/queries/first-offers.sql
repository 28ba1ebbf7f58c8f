-- title: Outcome by first offer and week
-- what: Outcome of new enterprises by their first offer: plans, price per seat of the first plan, week.
WITH offers AS MATERIALIZED (
    SELECT thread_id, customer_id, day / 7 + 1 AS week, json_extract(offer_json, '$[0].plan')
        || coalesce('+' || json_extract(offer_json, '$[1].plan'), '')
        || coalesce('+' || json_extract(offer_json, '$[2].plan'), '') AS plan,
        CAST(json_extract(offer_json, '$[0].price_per_seat') AS INTEGER) AS dollars
    FROM enterprise_turns
    WHERE thread_type = 'new_lead' AND turn_number = 1 AND sender = 'agent' AND offer_json <> '{}'
), bands AS (
    SELECT *, CASE WHEN dollars < 20 THEN 5 WHEN dollars < 100 THEN 10 WHEN dollars < 500 THEN 50 ELSE 100 END AS width
    FROM offers
), outcomes AS (
    SELECT c.group_id, b.plan, b.dollars - b.dollars % b.width AS price_from,
        b.dollars - b.dollars % b.width + b.width AS price_below, b.week, EXISTS (
            SELECT 1 FROM enterprise_turns t WHERE t.thread_id = b.thread_id AND t.close_reason = 'accepted'
        ) AS is_signed, s.status = 'lead' AS is_waiting
    FROM bands b
    CROSS JOIN subscriptions s
    CROSS JOIN customers c
    WHERE s.customer_id = b.customer_id AND c.customer_id = b.customer_id
)
SELECT group_id, plan, price_from, price_below, week, count(*) AS threads, sum(is_signed) AS signed,
    sum(NOT is_signed AND NOT is_waiting) AS lost, sum(NOT is_signed AND is_waiting) AS waiting,
    round(100.0 * sum(is_signed) / count(*), 1) AS signed_percent
FROM outcomes
GROUP BY 1, 2, 3, 4, 5
ORDER BY week DESC, group_id, plan, price_from
