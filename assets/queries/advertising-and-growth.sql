-- title: Advertising against new subscribers
-- what: Dollars of advertising, new subscribers and cost per new subscriber, by week.
-- chart: line week dollars_per_new_subscriber
SELECT joined.week, coalesce(ads.leads, 0) AS paid_leads, round(coalesce(ads.spend, 0)) AS spend,
    joined.customers AS new_subscribers,
    round(coalesce(ads.spend, 0) / joined.customers, 2) AS dollars_per_new_subscriber
FROM (
    SELECT (start_day + 6) / 7 AS week, count(*) AS customers
    FROM subscriptions
    WHERE status IN ('subscribed', 'cancelled')
    GROUP BY 1
) joined
LEFT JOIN (
    SELECT (day + 6) / 7 AS week, sum(leads_generated) AS leads, sum(spend) AS spend
    FROM ad_channel_leads
    GROUP BY 1
) ads ON ads.week = joined.week
ORDER BY 1
