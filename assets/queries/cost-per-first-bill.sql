-- title: Cost per first bill by channel and group
-- what: Cost of a lead and of a first bill for each channel and group in the last twelve weeks.
-- chart: bar channel_and_group dollars_per_first_bill
WITH bills AS (
    SELECT c.acquisition_source AS channel_id, c.group_id, count(*) AS first_bills
    FROM customers c
    CROSS JOIN subscriptions s
    WHERE c.created_day > (SELECT max(day) FROM service_day) - 84 AND s.customer_id = c.customer_id
        AND s.status IN ('subscribed', 'cancelled')
        -- An individual pays on the first day, an enterprise on its next billing day.
        AND (c.customer_type = 'small' OR 'Subscription payment from customer ' || c.customer_id IN
            (SELECT note FROM ledger WHERE category = 'subscription_payment'))
    GROUP BY 1, 2
)
SELECT a.channel_id || ' ' || a.group_id AS channel_and_group, sum(a.leads_generated) AS leads, b.first_bills,
    round(sum(a.spend)) AS spend, round(sum(a.spend) / nullif(sum(a.leads_generated), 0), 2) AS dollars_per_lead,
    round(sum(a.spend) / b.first_bills, 2) AS dollars_per_first_bill
FROM ad_channel_leads a
LEFT JOIN bills b ON b.channel_id = a.channel_id AND b.group_id = a.group_id
WHERE a.day > (SELECT max(day) FROM service_day) - 84
GROUP BY a.channel_id, a.group_id
ORDER BY dollars_per_first_bill IS NULL, dollars_per_first_bill
