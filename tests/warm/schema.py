"""The schema of the language is built once a process, however many ask for it: it is most of the work of a topic."""

from __future__ import annotations

import marshal
from collections.abc import Hashable
from typing import Any

from irsim.options.registry import CUSTOM_BEHAVIORS, CUSTOM_GROUP_BEHAVIORS, REGISTRIES
from irsim.scenario.model import json_schema

__all__ = ["definitions"]

build = json_schema._definitions
built: dict[Hashable, bytes] = {}


def definitions(user_code: bool) -> dict[str, Any]:
    """Stands in for ``json_schema._definitions``; each caller gets a copy of its own.

    It is built again for as long as user code, which tests are full of, has anything registered.
    """
    features = [feature for registry in REGISTRIES.values() for feature in registry._features.values()]
    custom = [known.names() for known in (CUSTOM_BEHAVIORS, CUSTOM_GROUP_BEHAVIORS)]
    if any(custom) or any(feature.origin != "built-in" for feature in features):
        return build(user_code)
    key = (user_code, *((kind, *registry.names()) for kind, registry in REGISTRIES.items()))
    if key not in built:
        built[key] = marshal.dumps(build(user_code))
    return dict(marshal.loads(built[key]))
