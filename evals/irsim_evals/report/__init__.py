"""Reports of graded answers, and comparisons of two of them."""
