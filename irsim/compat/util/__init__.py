"""Helpers for scripts that IR-SIM 2.12 has in ``irsim.util``: lists, checks, polygons, random numbers."""
