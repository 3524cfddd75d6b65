"""The grader: a plain library that knows irsim, pydantic and shapely, and no harness."""
