"""Turns a validated scenario into one record per object."""
