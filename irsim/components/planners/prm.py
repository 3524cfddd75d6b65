"""``prm``: probabilistic road map."""

from __future__ import annotations

from typing import Annotated, Any, ClassVar, Literal

from pydantic import Field

import irsim._core as core
from irsim.components.planners._options import PlannerOptions
from irsim.options.registry import PLANNERS
from irsim.options.units import Integer, Meters


class Prm(PlannerOptions):
    """Connect random free points to a graph, then take its shortest path."""

    schema_extra: ClassVar[dict[str, Any]] = {"examples": [{"name": "prm", "n_sample": 500}]}

    name: Literal["prm"] = "prm"
    n_sample: Annotated[Integer, Field(ge=1)] = 500
    """Number of random free points."""
    n_knn: Annotated[Integer, Field(ge=1)] = 10
    """Largest number of edges per point."""
    max_edge_len: Annotated[Meters, Field(gt=0)] = 30.0
    """Longest edge."""


PLANNERS.register(Prm, kernel=core.PrmOptions)
