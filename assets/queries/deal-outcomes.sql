-- title: Outcomes of threads
-- what: Outcomes of threads with enterprises, by type, and the number of turns to a deal.
-- chart: bar why deals
SELECT why, count(*) AS threads, sum(reason = 'accepted') AS deals, sum(reason = 'agent_rejected') AS rejected_by_us,
    sum(reason = '') AS without_an_end, round(100.0 * sum(reason = 'accepted') / count(*), 1) AS deals_percent,
    round(avg(CASE WHEN reason = 'accepted' THEN turns END), 1) AS turns_to_a_deal
FROM (
    SELECT thread_id, min(thread_type) AS why, max(close_reason) AS reason, count(*) AS turns
    FROM enterprise_turns
    GROUP BY thread_id
)
GROUP BY 1
ORDER BY 2 DESC
