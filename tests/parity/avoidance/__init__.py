"""How well robots avoid each other and walls, beside ir-sim 2.12: layouts, judge, references."""
