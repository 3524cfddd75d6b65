"""Drawing of objects: the scene of an environment, and single objects that scripts plot by hand."""
