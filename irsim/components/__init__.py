"""One module for each component of a scenario file: what its keys mean, and which kernel computes it."""
