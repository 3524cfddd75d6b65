"""Worlds of the core, stepped from Python."""
