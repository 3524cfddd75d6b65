"""A picture of a world as data, and what is to be drawn."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

__all__ = ["Drawn", "Job"]


@dataclass(frozen=True)
class Job:
    """What is drawn: the world of a scenario at its start, and at the end of an episode.

    Attributes:
        name: Name of the scenario's file.
        text: Its text.
        start_seed: Seed of the world at its start.
        end_seed: Seed of the episode.
        seconds: When the episode ends [s].
        behavior: Behavior that drives the robots instead of theirs.
        pictures: Maps that lie beside the scenario: name → content of the file.
    """

    name: str
    text: str
    start_seed: int
    end_seed: int
    seconds: float
    behavior: str | None = None
    pictures: Mapping[str, bytes] = field(default_factory=dict)


@dataclass(frozen=True)
class Drawn:
    """A picture without axes: the whole of it shows ``extent``.

    Attributes:
        png: Content of the file.
        extent: x from, x to, y from, y to [m].
        size: Width and height [px].
        time: Time that it shows [s].
        seed: Seed of the world.
    """

    png: bytes
    extent: tuple[float, float, float, float]
    size: tuple[int, int]
    time: float
    seed: int
