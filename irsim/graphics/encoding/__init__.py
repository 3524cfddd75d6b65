"""Writes pixels as PNG, GIF, video and contact sheets."""
