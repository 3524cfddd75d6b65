"""Five trainings of each policy that learns: how much of a result is the training, and how much the episodes."""
