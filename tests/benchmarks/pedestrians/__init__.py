"""Writes the page of results on recorded pedestrians."""
