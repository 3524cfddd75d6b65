"""Maps for planners, and the planners as classes; the searches themselves are functions of the core."""
