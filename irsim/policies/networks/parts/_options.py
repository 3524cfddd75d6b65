"""Options that all observation parts have in common."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field

from irsim.options.base import Options, problem
from irsim.options.knowledge import Fact
from irsim.options.registry import Registry
from irsim.policies.networks.values import Channel
from irsim.policies.observations import Observations
from irsim.policies.policy import Needs

__all__ = ["PARTS", "Label", "PartOptions", "unique"]

PARTS = Registry(
    "part",
    "irsim.policies.networks.parts",
    "irsim.observation_parts",
    families=("neighbors", "robot", "rvo", "surroundings"),
)
"""Parts of observations: each is a function of :class:`irsim.policies.Observations`."""
Label = Annotated[str, Field(pattern=r"^[A-Za-z][A-Za-z0-9_]{0,63}$")]
"""Name of a value in a network."""


class PartOptions(Options):
    """Keys that every part takes."""

    name: str
    """Name of the part."""
    label: Label | None = None
    """Name of its numbers in the network; null is the name of the part."""

    @property
    def key(self) -> str:
        """The name of its numbers in the network."""
        return self.label or self.name

    @property
    def members(self) -> int | None:
        """Number of members if the part is a set; None if it is one vector."""
        return None

    def needs(self) -> Needs:
        """The observations that it needs."""
        return Needs()

    def known(self) -> frozenset[Fact]:
        """Its information besides the robot's own state and goal."""
        return frozenset()

    def channels(self) -> tuple[Channel, ...]:
        """Its numbers in order, for each member if it is a set."""
        raise NotImplementedError

    def check(self, observations: Observations) -> None:
        """Refuse observations that lack what the part needs.

        Raises:
            PolicyInputError: Something is missing.
        """


def unique(features: list[str]) -> list[str]:
    """Validator of lists of features: none twice."""
    if len(set(features)) < len(features):
        twice = next(name for name in features if features.count(name) > 1)
        raise problem("invalid-value", f"'{twice}' is listed twice", fix="list each feature once")
    return features
