"""The scenes that each policy is for: one card for each that ships with irsim, trained or a law, as data."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import BaseModel, ConfigDict, Field

__all__ = ["SCENE_CARDS", "OptionValues", "SceneCard", "Span"]

Span = tuple[float, float]
"""Least and greatest value."""
OptionValues = dict[str, float | str | bool]
"""Options of a policy, as a scenario writes them."""


class SceneCard(BaseModel):
    """The scenes that a policy was trained in, or that its law is made for."""

    model_config = ConfigDict(extra="forbid", frozen=True, use_attribute_docstrings=True)

    origin: Literal["trained", "law"]
    """Whether it is a network, which knows nothing but its training, or a published law."""
    order: Annotated[int, Field(ge=1)]
    """Place among policies that fit a scene equally well: by success in the published suites, then by what a decision
    costs."""
    robots: Span = (1, 1000)
    """Number of robots that it drives together."""
    people: Span = (0, 1000)
    """Number of obstacles that move."""
    crowding: Annotated[float, Field(gt=0)] = 1000.0
    """Most robots and moving obstacles on 100 m2 of the world."""
    drives: tuple[str, ...] | None = None
    """Drives that it can control; None: all."""
    radius: Span = (0.0, 1000.0)
    """Radius of its robots [m], from the middle to the farthest point."""
    speed: Span = (0.0, 1000.0)
    """Top speed of its robots [m/s]."""
    way: Annotated[float, Field(gt=0)] = 1e6
    """Longest straight way from a start to a goal [m]."""
    static: Literal["none", "nearby", "planned"] = "nearby"
    """Its way with static obstacles, walls and maps: it does not know them, it avoids the near ones, or it plans around
    all."""
    movers: bool = True
    """Whether it avoids what moves."""
    unyielding: bool = True
    """Whether it manages among people who do not give way."""
    arrival: Literal["freeze", "yield"] | None = None
    """``after_arrival`` in its scenes; None: any."""
    favored: Literal["walls", "robots"] | None = None
    """Scenes in which it comes first among policies that fit equally well, by the published suites: those with walls or
    a map, or those with several robots and no people."""
    options: OptionValues = {}
    """Options to start from, besides its defaults."""
    remedy: OptionValues = {}
    """Options with which it manages among people who do not give way."""
    lidar: dict[str, float | str] | None = None
    """The lidar that its robots need, with the options of the training; None: it works without."""
    cost: str = ""
    """A price that one should know before choosing it."""


_SFM_AMONG_PEOPLE: OptionValues = {"force_factor_social": 12, "safety_radius": 0.5}
"""Measured with 20 seeds in crossing-pedestrians, crowdnav-circle, recorded-crowd and station-platform (starts moved by
up to 0.3 m): 80 of 80 episodes succeed, 43 with the defaults."""
_LEARNED = "a decision takes 20 to 3,000 times as long as one of orca"
_FRONT_LIDAR: dict[str, float | str] = {"name": "lidar2d", "range_max": 4, "angle_range": 4.712389}
_SQUARE = SceneCard(
    origin="trained", order=12, robots=(2, 25), people=(0, 0), crowding=25, drives=("diff",), radius=(0.1, 0.8),
    speed=(0.5, 1.5), static="none", way=13, unyielding=False, arrival="freeze", cost=_LEARNED,
)  # fmt: skip
_CIRCLE = SceneCard(
    origin="trained", order=10, people=(1, 10), robots=(1, 1), crowding=20, radius=(0.2, 0.4), speed=(0.5, 1.5),
    static="none", way=12, cost=_LEARNED,
)  # fmt: skip

SCENE_CARDS: dict[str, SceneCard] = {
    "orca": SceneCard(origin="law", order=1),
    "footprint_orca": SceneCard(
        origin="law", order=2, favored="robots", cost="a decision takes 3 to 5 times as long as one of orca"
    ),
    "avocado": SceneCard(origin="law", order=3),
    "rvo": SceneCard(origin="law", order=4),
    "follow": SceneCard(origin="law", order=5, static="planned", favored="walls", options={"local": "orca"}),
    "sfm": SceneCard(origin="law", order=6, unyielding=False, remedy=_SFM_AMONG_PEOPLE),
    "dash": SceneCard(origin="law", order=9, static="none", movers=False, unyielding=False),
    "crowd": _CIRCLE,
    "sarl": _CIRCLE.model_copy(update={"order": 11}),
    "goal_lidar": SceneCard(
        origin="trained", order=10, robots=(1, 1), people=(0, 0), drives=("diff",), radius=(0.2, 0.3), speed=(0.5, 1.5),
        way=13, unyielding=False, cost=_LEARNED, lidar=_FRONT_LIDAR | {"number": 180},
    ),
    "goal_lidar_noisy": SceneCard(
        origin="trained", order=11, robots=(1, 1), people=(0, 0), drives=("diff",), radius=(0.2, 0.3), speed=(0.5, 1.5),
        way=13, unyielding=False, cost=_LEARNED, lidar=_FRONT_LIDAR | {"number": 180},
    ),
    "corridor_social": SceneCard(
        origin="trained", order=10, robots=(1, 1), people=(1, 8), crowding=16, drives=("diff",), radius=(0.25, 0.35),
        speed=(0.5, 1.5), way=20, unyielding=False, cost=_LEARNED, lidar=_FRONT_LIDAR | {"number": 90},
    ),
    "multi_robot": _SQUARE.model_copy(update={"arrival": "yield"}),
    "multi_robot_freeze": _SQUARE.model_copy(update={"order": 10}),
    "multi_robot_v2": _SQUARE.model_copy(update={"order": 11, "arrival": "yield"}),
    "rl_rvo": _SQUARE.model_copy(update={"order": 13, "robots": (2, 10), "crowding": 10, "drives": None}),
    "sarl_multi_robot": _SQUARE.model_copy(update={"order": 14, "robots": (2, 10), "crowding": 10}),
}  # fmt: skip
"""Name of a policy -> its card."""
