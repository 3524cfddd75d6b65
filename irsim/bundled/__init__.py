"""Files that ship with the package: the scenario templates and the agent skills."""
