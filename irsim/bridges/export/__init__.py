"""Recorded runs as files of other tools; each format is one module of :mod:`irsim.bridges.export.formats`."""
