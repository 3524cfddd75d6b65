"""The texts of findings about a scenario."""
