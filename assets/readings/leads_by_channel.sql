-- Leads and spend of the last four weeks by channel and group.
SELECT channel_id, group_id, sum(leads_generated) AS leads, sum(spend) AS spend
FROM ad_channel_leads
WHERE day > (SELECT max(day) FROM service_day) - 28
GROUP BY 1, 2
