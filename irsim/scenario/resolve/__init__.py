"""From what a user wrote to one record for each object."""
