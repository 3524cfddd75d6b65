"""A recorded run as one HTML page that needs nothing else: ``irsim.replay("last")``."""
