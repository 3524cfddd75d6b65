"""Which bodies an assertion is about."""

from __future__ import annotations

import re
from typing import Annotated, Any, Literal

from pydantic import BaseModel, ConfigDict

from irsim.options.registry import KINEMATICS
from irsim_evals.grader.body import GradedBody
from irsim_evals.grader.matching import Match, Quantity, matches
from irsim_evals.grader.properties import PROPERTIES, SHAPES, Having, value_of
from irsim_evals.grader.scene import GradedScene
from irsim_evals.grader.words import Listed, OneOf, Regex

__all__ = ["BUILT_IN", "Selection", "Selections", "Selector", "select"]


_BUILT_IN: dict[str, dict[str, Any]] = {
    "all": {}, "robots": {"role": "robot"}, "obstacles": {"role": "obstacle"}, "movers": {"static": False},
    "statics": {"static": True}, "solids": {"static": True, "passable": False},
}  # fmt: skip
Selection = Annotated[str, OneOf("selection", tuple(_BUILT_IN), own="selections")]
"""Name of a selection: a built-in one, or one that the case has under ``select``."""
Drives = Annotated[list[Annotated[str, OneOf("drive", tuple(KINEMATICS.installed()))]], Listed()]
Shapes = Annotated[list[Annotated[str, OneOf("shape", SHAPES)]], Listed()]
Selections = Annotated[list[Selection], Listed()]


class Selector(BaseModel):
    """Bodies that meet every key that is given."""

    model_config = ConfigDict(extra="forbid", frozen=True, populate_by_name=True)

    role: Literal["robot", "obstacle"] | None = None
    """Section of the file."""
    static: bool | None = None
    """Whether it never moves."""
    passable: bool | None = None
    """Whether others pass through it."""
    kinematics: Drives | None = None
    """Name of its drive, or several."""
    shape: Shapes | None = None
    """``circle``, ``square``, ``rectangle``, ``line``, ``polygon``, ``compound``; a square is a rectangle, too."""
    named: Regex | None = None
    """Regular expression that its name, the name of its group or one of its tags contains, ignoring case."""
    inside: tuple[Quantity, Quantity, Quantity, Quantity] | None = None
    """x0, y0, x1, y1 of a region that holds its position [m]."""
    among: Selections | None = None
    """Other selections that it belongs to."""
    beyond: Selections | None = None
    """Other selections that it does not belong to."""
    having: Having = {}
    """Properties that it has."""
    any_of: list[Selector] = []
    """It meets at least one of these."""


BUILT_IN = {name: Selector(**keys) for name, keys in _BUILT_IN.items()}
"""Selections that every case has."""


def select(scene: GradedScene, name: str, selectors: dict[str, Selector]) -> list[GradedBody]:
    """The bodies of a selection in the order of the file.

    Raises:
        KeyError: No selection has that name.
    """
    selector = selectors.get(name) or BUILT_IN[name]
    return [body for body in scene.bodies if _meets(scene, body, selector, selectors)]


def _meets(scene: GradedScene, body: GradedBody, selector: Selector, selectors: dict[str, Selector]) -> bool:
    def belongs(name: str) -> bool:
        return _meets(scene, body, selectors.get(name) or BUILT_IN[name], selectors)

    def has(key: str, match: Match) -> bool:
        return matches(match, value_of(scene, body, key), PROPERTIES[key].kind)

    shapes = (body.shape, "rectangle") if body.shape == "square" else (body.shape,)
    return (
        selector.role in (None, body.role)
        and selector.static in (None, body.static)
        and selector.passable in (None, body.passable)
        and (selector.kinematics is None or body.kinematics in selector.kinematics)
        and (selector.shape is None or any(shape in selector.shape for shape in shapes))
        and (selector.named is None or _is_named(body, selector.named))
        and (selector.inside is None or _is_inside(body, selector.inside))
        and all(map(belongs, selector.among or ()))
        and not any(map(belongs, selector.beyond or ()))
        and all(has(key, match) for key, match in selector.having.items())
        and (not selector.any_of or any(_meets(scene, body, item, selectors) for item in selector.any_of))
    )


def _is_named(body: GradedBody, pattern: str) -> bool:
    texts = (body.name, body.record.group_name, *body.record.tags)
    return any(re.search(pattern, text, re.IGNORECASE) for text in texts)


def _is_inside(body: GradedBody, region: tuple[float, float, float, float]) -> bool:
    x, y = body.position
    return region[0] <= x <= region[2] and region[1] <= y <= region[3]
