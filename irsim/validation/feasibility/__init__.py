"""Feasibility of a scenario: whether its objects fit into the world, and whether its robots can reach their goals."""
