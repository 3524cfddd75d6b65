"""Pixels as PNG, GIF, video and sheets of pictures."""
