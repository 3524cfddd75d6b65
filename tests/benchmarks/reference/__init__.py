"""Results of bundled suites, kept to notice when a change of the code changes a published number."""
