"""A second, naive implementation of the ten commonest predicates, which shares no code with the first."""
