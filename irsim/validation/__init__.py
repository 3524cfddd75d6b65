"""What is right and wrong with a scenario, and what differs between two."""
