"""Training of value networks that look ahead, as SARL does: imitation of a behavior, then reinforcement."""
