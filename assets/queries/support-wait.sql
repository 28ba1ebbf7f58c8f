-- title: How long support takes
-- what: Issues opened in each of the last twelve weeks, how many of them are resolved, and after how many days.
-- chart: line opened_in_week average_days
SELECT (open_day + 6) / 7 AS opened_in_week, count(*) AS opened, count(resolved_day) AS solved,
    round(100.0 * count(resolved_day) / count(*), 1) AS solved_percent,
    round(avg(resolved_day - open_day), 2) AS average_days, max(resolved_day - open_day) AS longest_days
FROM issues
WHERE open_day > (SELECT max(day) FROM service_day) - 84
GROUP BY 1
ORDER BY 1
