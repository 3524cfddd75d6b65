"""Maps for planners, and the outlines of what stands in them; the searches themselves are computed by the core."""
