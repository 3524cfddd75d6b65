"""Replay of a recorded run as one self-contained HTML page: ``irsim.replay("last")``."""
