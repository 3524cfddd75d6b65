"""Worlds of the core, stepped from Python: building, time, fog, random streams, traces, events and outcomes."""
