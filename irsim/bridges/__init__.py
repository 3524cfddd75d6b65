"""Formats and programs of others: exports of recorded runs, maps from other worlds, robots and simulators."""
