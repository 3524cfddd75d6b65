"""Pictures that a scenario's `description` may name; drawn by ``python -m irsim.graphics.images``."""
