"""Planners that draw samples: road maps and random trees."""

from __future__ import annotations

from typing import Annotated, Any, ClassVar, Literal

from pydantic import Field

import irsim._core as core
from irsim.components.options import PlannerOptions, SamplingPlanner
from irsim.options.registry import PLANNERS
from irsim.options.units import Bool, Integer, Meters, Number


class Prm(PlannerOptions):
    """Connect random free points to a graph, then take its shortest path."""

    schema_extra: ClassVar[dict[str, Any]] = {"examples": [{"name": "prm", "n_sample": 500}]}

    name: Literal["prm"] = "prm"
    n_sample: Annotated[Integer, Field(ge=1, le=10_000)] = 500
    """Number of random free points."""
    n_knn: Annotated[Integer, Field(ge=1, le=100)] = 10
    """Largest number of edges per point."""
    max_edge_len: Annotated[Meters, Field(gt=0)] = 30.0
    """Longest edge."""


PLANNERS.register(Prm, kernel=core.PrmOptions)


class Rrt(SamplingPlanner):
    """Grow a tree of random extensions until it reaches the goal."""

    schema_extra: ClassVar[dict[str, Any]] = {"examples": [{"name": "rrt", "expand_dis": 1.0}]}

    name: Literal["rrt"] = "rrt"


PLANNERS.register(Rrt, kernel=core.RrtOptions)


class RrtStar(SamplingPlanner):
    """RRT that rewires the tree around each new point, so that paths get shorter."""

    schema_extra: ClassVar[dict[str, Any]] = {"examples": [{"name": "rrt_star", "max_iter": 1000}]}

    name: Literal["rrt_star"] = "rrt_star"
    expand_dis: Annotated[Meters, Field(gt=0)] = 1.5
    """Longest extension of the tree."""
    connect_circle_dist: Annotated[Meters, Field(gt=0)] = 0.5
    """Scale of the radius in which the tree is rewired."""
    search_until_max_iter: Bool = False
    """Improve until all samples are drawn, instead of stopping at the first path."""


PLANNERS.register(RrtStar, kernel=core.RrtStarOptions)


class InformedRrtStar(RrtStar):
    """RRT* that, once it has a path, samples only the ellipse that can hold a shorter one."""

    schema_extra: ClassVar[dict[str, Any]] = {"examples": [{"name": "informed_rrt_star"}]}

    name: Literal["informed_rrt_star"] = "informed_rrt_star"  # type: ignore[assignment]  # an rrt_star by another name
    goal_sample_rate: Annotated[Number, Field(ge=0, le=100)] = 10.0
    """Share of samples placed at the goal, in percent."""
    connect_circle_dist: Annotated[Meters, Field(gt=0)] = 50.0
    """Scale of the radius in which the tree is rewired."""
    search_until_max_iter: Bool = True
    """Improve until all samples are drawn, instead of stopping at the first path."""


PLANNERS.register(InformedRrtStar, kernel=core.InformedRrtStarOptions)
