-- title: Cost per lead by channel and group
-- what: Which pairs of channel and group brought leads cheaply in the last twelve weeks.
-- chart: bar channel_and_group dollars_per_lead
SELECT channel_id || ' ' || group_id AS channel_and_group, sum(leads_generated) AS leads, round(sum(spend)) AS spend,
    round(sum(spend) / nullif(sum(leads_generated), 0), 2) AS dollars_per_lead
FROM ad_channel_leads
WHERE day > (SELECT max(day) FROM service_day) - 84
GROUP BY channel_id, group_id
ORDER BY dollars_per_lead IS NULL, dollars_per_lead
