-- title: Enterprises by industry
-- what: Industries in which enterprises sign and stay, by profile.
-- chart: bar industry signed
SELECT c.persona_industry AS industry, count(*) AS companies,
    sum(s.status IN ('subscribed', 'cancelled')) AS signed, sum(s.status = 'subscribed') AS still_here,
    round(100.0 * sum(s.status IN ('subscribed', 'cancelled')) / count(*), 1) AS signed_percent
FROM customers c
CROSS JOIN subscriptions s
WHERE c.email IS NOT NULL AND s.customer_id = c.customer_id
GROUP BY 1
ORDER BY 3 DESC, 2 DESC
