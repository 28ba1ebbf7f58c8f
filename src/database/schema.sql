-- The observable company. What is stored as codes comes back as words through ordinary views, so that the file
-- opens in any SQLite tool; the two block tables (daily_usage, ads_revenue) are served by the program.

CREATE TABLE projection (
    id INTEGER PRIMARY KEY CHECK (id = 1),
    seq INTEGER NOT NULL,
    line_hash TEXT NOT NULL,
    own_check TEXT NOT NULL
);

-- Words of customer profiles by group and axis.
CREATE TABLE words (
    axis TEXT NOT NULL,
    group_id TEXT NOT NULL,
    n INTEGER NOT NULL,
    word TEXT NOT NULL,
    PRIMARY KEY (axis, group_id, n)
) WITHOUT ROWID;

-- persona packs one byte per axis: industry, role, experience, work style, technical skill, size, decision, concern.
CREATE TABLE customer_rows (
    customer_id INTEGER PRIMARY KEY,
    group_id TEXT NOT NULL,
    created_day INTEGER NOT NULL,
    source INTEGER,
    persona INTEGER,
    usage_label INTEGER,
    budget_label INTEGER,
    seats INTEGER,
    email TEXT,
    contract_start_day INTEGER
);

CREATE VIEW customers AS
SELECT
    c.customer_id,
    CASE WHEN c.group_id LIKE 'E%' OR c.group_id LIKE 'D_E%' THEN 'large' ELSE 'small' END AS customer_type,
    c.group_id,
    c.created_day,
    (SELECT word FROM words WHERE axis = 'industry' AND group_id = c.group_id AND n = (c.persona & 255))
        AS persona_industry,
    (SELECT word FROM words WHERE axis = 'role' AND group_id = c.group_id AND n = (c.persona >> 8 & 255))
        AS persona_role,
    (SELECT word FROM words WHERE axis = 'experience' AND group_id = c.group_id AND n = (c.persona >> 16 & 255))
        AS persona_experience,
    (SELECT word FROM words WHERE axis = 'work_style' AND group_id = c.group_id AND n = (c.persona >> 24 & 255))
        AS persona_work_style,
    (SELECT word FROM words WHERE axis = 'tech_savvy' AND group_id = c.group_id AND n = (c.persona >> 32 & 255))
        AS persona_tech_savvy,
    (SELECT word FROM words WHERE axis = 'size' AND group_id = c.group_id AND n = (c.persona >> 40 & 255))
        AS company_size_descriptor,
    CASE WHEN c.email IS NOT NULL THEN
        (SELECT word FROM words WHERE axis = 'work_style' AND group_id = c.group_id AND n = (c.persona >> 24 & 255))
    END AS company_culture,
    (SELECT word FROM words WHERE axis = 'decision' AND group_id = c.group_id AND n = (c.persona >> 48 & 255))
        AS company_decision_style,
    (SELECT word FROM words WHERE axis = 'concern' AND group_id = c.group_id AND n = (c.persona >> 56 & 255))
        AS company_primary_concern,
    CASE WHEN c.persona IS NULL THEN NULL WHEN c.email IS NULL THEN
        (SELECT word FROM words WHERE axis = 'experience' AND group_id = c.group_id AND n = (c.persona >> 16 & 255))
        || ' ' ||
        (SELECT word FROM words WHERE axis = 'role' AND group_id = c.group_id AND n = (c.persona >> 8 & 255))
        || ' in ' ||
        (SELECT word FROM words WHERE axis = 'industry' AND group_id = c.group_id AND n = (c.persona & 255))
        || '; ' || (SELECT word FROM words WHERE axis = 'usage' AND group_id = c.group_id AND n = c.usage_label)
        || ', ' || (SELECT word FROM words WHERE axis = 'budget' AND group_id = c.group_id AND n = c.budget_label)
        || ', ' || (SELECT word FROM words WHERE axis = 'quality' AND group_id = c.group_id AND n = 0)
    ELSE
        (SELECT word FROM words WHERE axis = 'size' AND group_id = c.group_id AND n = (c.persona >> 40 & 255))
        || ' ' ||
        (SELECT word FROM words WHERE axis = 'industry' AND group_id = c.group_id AND n = (c.persona & 255))
        || ' company with ' || c.seats
        || (SELECT CASE WHEN c.seats >= n THEN '+' ELSE '' END FROM words WHERE axis = 'plus' AND group_id = c.group_id)
        || ' seats, '
        || (SELECT word FROM words WHERE axis = 'work_style' AND group_id = c.group_id AND n = (c.persona >> 24 & 255))
        || '; ' || (SELECT word FROM words WHERE axis = 'quality' AND group_id = c.group_id AND n = 0)
        || ', concerned with '
        || (SELECT word FROM words WHERE axis = 'concern' AND group_id = c.group_id AND n = (c.persona >> 56 & 255))
    END AS persona_description,
    c.email,
    c.contract_start_day,
    CASE c.source
        WHEN 0 THEN 'social_media' WHEN 1 THEN 'search_ads' WHEN 2 THEN 'linkedin' WHEN 3 THEN 'content_marketing'
        WHEN 4 THEN 'referral_program' WHEN 5 THEN 'network' WHEN 6 THEN 'organic'
    END AS acquisition_source
FROM customer_rows c;

-- Nobody has two subscriptions, so the customer is the key; status: 0 lead, 1 subscribed, 2 cancelled, 3 lost.
CREATE TABLE subscription_rows (
    customer_id INTEGER PRIMARY KEY,
    subscription_id INTEGER NOT NULL,
    plan TEXT NOT NULL,
    listed_price REAL NOT NULL,
    promotion REAL NOT NULL,
    start_day INTEGER NOT NULL,
    end_day INTEGER,
    status INTEGER NOT NULL,
    billing_day INTEGER NOT NULL,
    seats INTEGER NOT NULL,
    contract_end_day INTEGER,
    billed_once INTEGER NOT NULL
);

CREATE VIEW subscriptions AS
SELECT
    subscription_id,
    customer_id,
    plan,
    listed_price,
    promotion,
    max(0.0, listed_price - promotion) AS effective_price,
    start_day,
    end_day,
    CASE status WHEN 0 THEN 'lead' WHEN 1 THEN 'subscribed' WHEN 2 THEN 'cancelled' ELSE 'lost' END AS status,
    billing_day AS billing_day_mod30,
    NULL AS pending_plan,
    NULL AS pending_price,
    seats AS seat_count,
    1 AS contract_months,
    contract_end_day,
    billed_once AS first_billing_done
FROM subscription_rows;

-- category: the twelve of the view; about: the customer of lead costs and payments.
CREATE TABLE ledger_rows (
    id INTEGER PRIMARY KEY,
    day INTEGER NOT NULL,
    category INTEGER NOT NULL,
    amount REAL NOT NULL,
    about INTEGER,
    note TEXT
);

-- Serves questions about days and about what money was for without the rows themselves. In the order in which rows
-- come: they go to its end, and a question without an order is answered as before.
CREATE INDEX ledger_by_day ON ledger_rows (day, id, category, amount);

CREATE VIEW ledger AS
SELECT
    id,
    day,
    CASE category
        WHEN 0 THEN 'initial_funding' WHEN 1 THEN 'lead_acquisition_cost' WHEN 2 THEN 'subscription_payment'
        WHEN 3 THEN 'capacity' WHEN 4 THEN 'compute' WHEN 5 THEN 'operations' WHEN 6 THEN 'development'
        WHEN 7 THEN 'advertising' WHEN 8 THEN 'ad_revenue' WHEN 9 THEN 'market_research'
        WHEN 10 THEN 'group_research' ELSE 'research_project'
    END AS category,
    amount,
    CASE category
        WHEN 1 THEN 'Lead acquisition cost for customer ' || about
        WHEN 2 THEN 'Subscription payment from customer ' || about
        ELSE note
    END AS note
FROM ledger_rows;

-- An issue ages with the clock; aged_from and aged_to are its readings when the issue was opened and solved.
CREATE TABLE issue_clock (
    id INTEGER PRIMARY KEY CHECK (id = 1),
    aged INTEGER NOT NULL
);
INSERT INTO issue_clock VALUES (1, 0);

CREATE TABLE issue_rows (
    issue_id INTEGER PRIMARY KEY,
    customer_id INTEGER NOT NULL,
    group_id TEXT NOT NULL,
    open_day INTEGER NOT NULL,
    aged_from INTEGER NOT NULL,
    aged_to INTEGER,
    resolved_day INTEGER
);

CREATE VIEW issues AS
SELECT
    issue_id,
    customer_id,
    group_id,
    open_day,
    coalesce(aged_to, (SELECT aged FROM issue_clock)) - aged_from AS days_open,
    CASE WHEN resolved_day IS NULL THEN 'open' ELSE 'resolved' END AS status,
    resolved_day,
    CASE WHEN resolved_day IS NULL THEN NULL ELSE 'ops_resolved' END AS resolution_type
FROM issue_rows;

CREATE TABLE service_day (
    day INTEGER PRIMARY KEY,
    total_usage_units INTEGER NOT NULL,
    p95_ms REAL NOT NULL,
    error_rate REAL NOT NULL,
    downtime_minutes INTEGER NOT NULL,
    capacity_tier INTEGER NOT NULL,
    capacity_units INTEGER NOT NULL
);

CREATE TABLE config_history (
    day INTEGER PRIMARY KEY,
    price_A REAL NOT NULL,
    price_B REAL NOT NULL,
    price_C REAL NOT NULL,
    tier_A INTEGER NOT NULL,
    tier_B INTEGER NOT NULL,
    tier_C INTEGER NOT NULL,
    spend_advertising REAL NOT NULL DEFAULT 0,
    spend_operations REAL NOT NULL,
    spend_development REAL NOT NULL,
    capacity_tier INTEGER NOT NULL,
    ad_spend_social_media REAL NOT NULL DEFAULT 0,
    ad_spend_search_ads REAL NOT NULL DEFAULT 0,
    ad_spend_linkedin REAL NOT NULL DEFAULT 0,
    ad_spend_content_marketing REAL NOT NULL DEFAULT 0,
    ad_spend_referral_program REAL NOT NULL DEFAULT 0,
    quota_A INTEGER NOT NULL,
    quota_B INTEGER NOT NULL,
    quota_C INTEGER NOT NULL
);

CREATE TABLE config_overrides (
    id INTEGER PRIMARY KEY,
    day INTEGER NOT NULL,
    tool_name TEXT NOT NULL,
    setting_type TEXT NOT NULL,
    settings_json TEXT NOT NULL
);

CREATE TABLE social_media_posts (
    post_id INTEGER PRIMARY KEY,
    day INTEGER NOT NULL,
    content TEXT NOT NULL,
    reply_to_agent_post_id INTEGER
);

CREATE TABLE agent_social_media_posts (
    agent_post_id INTEGER PRIMARY KEY,
    day INTEGER NOT NULL,
    content TEXT NOT NULL,
    reply_to_post_id INTEGER,
    views INTEGER NOT NULL DEFAULT 0,
    comment_post_ids TEXT NOT NULL DEFAULT '[]'
);

CREATE TABLE predictions (
    submit_day INTEGER NOT NULL,
    horizon_days INTEGER NOT NULL,
    metric TEXT NOT NULL,
    predicted_value REAL NOT NULL,
    predicted_lower REAL,
    predicted_upper REAL,
    submitted_at REAL NOT NULL,
    PRIMARY KEY (submit_day, horizon_days, metric)
) WITHOUT ROWID;

CREATE TABLE enterprise_turns (
    message_id INTEGER PRIMARY KEY,
    thread_id INTEGER NOT NULL,
    customer_id INTEGER NOT NULL,
    thread_type TEXT NOT NULL,
    turn_number INTEGER NOT NULL DEFAULT 0,
    sender TEXT NOT NULL,
    message_text TEXT NOT NULL DEFAULT '',
    offer_json TEXT NOT NULL DEFAULT '{}',
    day INTEGER NOT NULL,
    email TEXT NOT NULL DEFAULT '',
    seat_count INTEGER NOT NULL DEFAULT 1,
    closed INTEGER NOT NULL DEFAULT 0,
    close_reason TEXT NOT NULL DEFAULT ''
);
CREATE INDEX enterprise_turns_by_thread ON enterprise_turns (thread_id);

CREATE TABLE notifications (
    notification_id INTEGER PRIMARY KEY,
    day INTEGER NOT NULL,
    type TEXT NOT NULL,
    message TEXT NOT NULL
);

CREATE TABLE research_projects (
    project_id TEXT PRIMARY KEY,
    tier INTEGER NOT NULL,
    status TEXT DEFAULT 'in_progress',
    started_day INTEGER,
    expected_completion_day INTEGER,
    expected_quality_boost REAL DEFAULT 0,
    quality_boost_applied REAL DEFAULT 0
) WITHOUT ROWID;

CREATE TABLE macroeconomic_conditions (
    day INTEGER PRIMARY KEY,
    pmi_value REAL NOT NULL,
    pmi_trend TEXT NOT NULL,
    pmi_change REAL NOT NULL DEFAULT 0,
    cycle_phase TEXT NOT NULL,
    description TEXT NOT NULL
);

CREATE TABLE ad_channel_leads (
    id INTEGER PRIMARY KEY,
    day INTEGER NOT NULL,
    channel_id TEXT NOT NULL,
    group_id TEXT NOT NULL,
    leads_generated INTEGER NOT NULL,
    spend REAL NOT NULL
);

CREATE TABLE group_info_levels (
    group_id TEXT PRIMARY KEY,
    info_level INTEGER NOT NULL DEFAULT 0,
    is_discoverable INTEGER NOT NULL DEFAULT 0,
    discovered_day INTEGER,
    last_research_day INTEGER
) WITHOUT ROWID;

CREATE TABLE segment_discovery (
    id INTEGER PRIMARY KEY,
    day INTEGER NOT NULL,
    cost REAL NOT NULL,
    success INTEGER NOT NULL DEFAULT 0,
    discovered_group_id TEXT
);

-- Days of daily_usage and ads_revenue, packed.
CREATE TABLE usage_blocks (day INTEGER PRIMARY KEY, packed BLOB NOT NULL);
CREATE TABLE ads_blocks (day INTEGER PRIMARY KEY, packed BLOB NOT NULL);
