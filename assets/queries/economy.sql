-- title: The economy
-- what: Published readings of the purchasing managers' index: above 50 the economy grows. Each is 30 days old.
-- chart: line day pmi
SELECT day, pmi_value AS pmi, pmi_change AS change, pmi_trend AS trend, cycle_phase AS phase
FROM macroeconomic_conditions
ORDER BY 1
