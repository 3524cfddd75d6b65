"""Footprints and maps as solids that simulators in three dimensions know: boxes, cylinders and convex prisms."""
