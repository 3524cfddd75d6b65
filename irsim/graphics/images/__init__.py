"""Bundled pictures that the key `description` of a scenario can name; drawn by ``python -m irsim.graphics.images``."""
