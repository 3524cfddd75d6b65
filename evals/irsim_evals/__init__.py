"""Evaluation of prompt → YAML: what an agent made of a prompt is graded with evidence, and the grader is proved."""
