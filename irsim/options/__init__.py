"""The types that options are made of: units, vectors, colours, selections, and the registries of features."""
