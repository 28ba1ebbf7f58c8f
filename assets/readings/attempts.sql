-- Attempts at market research, the newest first.
SELECT day, cost, success, discovered_group_id
FROM segment_discovery
ORDER BY id DESC
