"""Matplotlib figures of a scene."""
