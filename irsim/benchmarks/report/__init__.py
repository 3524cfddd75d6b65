"""The report of a benchmark: tables, charts and one page that contains everything."""
