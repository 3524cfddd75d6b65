"""Policies decide for robots from outside the scenario: behaviors, functions, plug-ins and networks from files.

A policy sees observations and returns controls. The same object drives one environment, a batch of worlds, a benchmark
and a loop of the user's own; replacing it never changes the scenario.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from irsim.common.lazy import lazy_names

if TYPE_CHECKING:
    from irsim.policies.catalog import open_policy
    from irsim.policies.observations import Map, Neighbors, Observations, Scan
    from irsim.policies.policy import Episode, FunctionPolicy, Needs, Policy
    from irsim.policies.registry import register_policy

__all__ = [
    "Episode",
    "FunctionPolicy",
    "Map",
    "Needs",
    "Neighbors",
    "Observations",
    "Policy",
    "Scan",
    "open_policy",
    "register_policy",
]

__getattr__, __dir__ = lazy_names(
    __name__,
    {
        "Episode": "irsim.policies.policy",
        "FunctionPolicy": "irsim.policies.policy",
        "Map": "irsim.policies.observations",
        "Needs": "irsim.policies.policy",
        "Neighbors": "irsim.policies.observations",
        "Observations": "irsim.policies.observations",
        "Policy": "irsim.policies.policy",
        "Scan": "irsim.policies.observations",
        "open_policy": "irsim.policies.catalog",
        "register_policy": "irsim.policies.registry",
    },
)
