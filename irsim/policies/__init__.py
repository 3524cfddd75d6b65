"""What decides for robots and is no part of their scenario: behaviors, functions, plug-ins and networks from files.

A policy sees observations and returns controls. The same object drives one environment, a batch of worlds, a benchmark
and a loop of the user's own; replacing it never changes the scenario.
"""

from irsim.policies.observations import Map, Neighbors, Observations, Scan
from irsim.policies.policy import Episode, Needs, Policy

__all__ = ["Episode", "Map", "Needs", "Neighbors", "Observations", "Policy", "Scan"]
