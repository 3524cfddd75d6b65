"""What objects draw: the scene of an environment, and what scripts plot by hand."""
