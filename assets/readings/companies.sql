-- The companies of these negotiations: group, profile, and what their subscription says.
SELECT c.customer_id, c.group_id, c.persona_industry, c.company_size_descriptor, c.company_culture,
    c.company_decision_style, c.company_primary_concern, s.status, s.plan, s.effective_price, s.start_day,
    s.end_day, c.contract_start_day
FROM customers c
CROSS JOIN subscriptions s
WHERE c.customer_id IN (SELECT customer_id FROM enterprise_turns ORDER BY message_id DESC LIMIT 5000)
    AND s.customer_id = c.customer_id
