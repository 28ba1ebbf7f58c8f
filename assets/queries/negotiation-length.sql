-- title: Length of threads
-- what: Threads by number of turns: deals, threads without a deal, and days.
-- chart: bar turns deals without_a_deal
SELECT turns, count(*) AS threads, sum(reason = 'accepted') AS deals, sum(reason <> 'accepted') AS without_a_deal,
    round(avg(days), 1) AS average_days, max(days) AS longest_days
FROM (
    SELECT thread_id, max(close_reason) AS reason, count(*) AS turns, max(day) - min(day) AS days
    FROM enterprise_turns
    GROUP BY thread_id
)
GROUP BY 1
ORDER BY 1
