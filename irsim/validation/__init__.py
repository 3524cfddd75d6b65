"""Validation of a scenario: findings, repairs, feasibility, a dry run, and the comparison with another scenario."""
