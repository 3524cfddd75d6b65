"""Objects as scripts of IR-SIM 2.12 know them: the views of the world with all old names."""
