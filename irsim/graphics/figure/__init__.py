"""Draws a scene with Matplotlib."""
