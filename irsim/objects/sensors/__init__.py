"""Sensors of an object: their values, and how each is drawn."""
