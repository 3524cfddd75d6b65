"""Tasks: what learning adds to a scenario, as data."""
