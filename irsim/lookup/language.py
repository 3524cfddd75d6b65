"""The JSON Schema of the language for lookups: made once, and again when a feature has been registered."""

from __future__ import annotations

from functools import lru_cache

from irsim.lookup.schema_walk import Node
from irsim.options.registry import CUSTOM_BEHAVIORS, CUSTOM_GROUP_BEHAVIORS, REGISTRIES
from irsim.scenario.model.json_schema import json_schema

__all__ = ["language_schema"]


def language_schema() -> Node:
    """The schema with all features that are registered now; it is shared and must not be changed."""
    features = ((kind, one.name, one.options, one.simulated) for kind, r in REGISTRIES.items() for one in r.features())
    return _schema_of((*features, *CUSTOM_BEHAVIORS.names(), "groups", *CUSTOM_GROUP_BEHAVIORS.names()))


@lru_cache(maxsize=1)
def _schema_of(features: tuple[object, ...]) -> Node:
    """The schema of a set of features, which is the key of the cache."""
    return json_schema()
