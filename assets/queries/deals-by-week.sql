-- title: Deals by week
-- what: Threads opened and deals made by week, with the agreed price.
-- chart: line week began deals
SELECT (day + 6) / 7 AS week, sum(turn_number = 0) AS began,
    sum(close_reason = 'accepted' AND sender = 'customer') AS deals,
    round(avg(CASE WHEN close_reason = 'accepted' AND sender = 'customer'
        THEN json_extract(offer_json, '$.price') END), 2) AS average_price_a_seat,
    sum(CASE WHEN close_reason = 'accepted' AND sender = 'customer' THEN seat_count ELSE 0 END) AS seats
FROM enterprise_turns
GROUP BY 1
ORDER BY 1
