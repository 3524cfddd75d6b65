"""Motion and avoidance laws as functions of NumPy arrays; most of them call the core."""
