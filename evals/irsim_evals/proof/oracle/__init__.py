"""A second, naive implementation of the ten commonest predicates, which shares nothing of ours with the first."""
