"""Gaussian splats: reading them, the ground plan of what they show, pictures and a page with a run in them."""
