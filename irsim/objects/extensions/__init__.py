"""Behaviors, drives and hooks that are written in Python, and how they take part in a step."""
