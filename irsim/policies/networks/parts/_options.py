"""Options that all observation parts have in common."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Annotated

import numpy as np
from pydantic import Field

from irsim.common.arrays import Floats
from irsim.options.base import Options, problem
from irsim.policies.networks.values import Channel
from irsim.policies.policy import Needs

__all__ = ["Label", "PartOptions", "clip_to", "select", "unique"]

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
        """What must be observed."""
        return Needs()

    def channels(self) -> tuple[Channel, ...]:
        """Its numbers in order, for each member if it is a set."""
        raise NotImplementedError


def unique(features: list[str]) -> list[str]:
    """Validator of lists of features: none twice."""
    if len(set(features)) < len(features):
        twice = next(name for name in features if features.count(name) > 1)
        raise problem("invalid-value", f"'{twice}' is listed twice", fix="list each feature once")
    return features


def clip_to(values: Floats, limit: float, clip: bool, *, low: float = -1.0) -> Floats:
    """Values divided by ``limit`` and, with ``clip``, clipped to [``low``, 1]."""
    scaled = values / limit
    return np.clip(scaled, low, 1.0) if clip else scaled


def select(columns: Mapping[str, Floats], names: Sequence[str]) -> Floats:
    """(..., F) columns of these names."""
    return np.stack([columns[name] for name in names], axis=-1)
