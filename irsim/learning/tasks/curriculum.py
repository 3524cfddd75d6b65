"""``curriculum``: levels of a task, from easy to hard."""

from __future__ import annotations

from typing import Annotated, Any, ClassVar

from pydantic import Field, model_validator

from irsim.learning.tasks.randomize import Randomize, Value
from irsim.options.base import Options, problem
from irsim.options.units import Fraction, Integer, Seconds

__all__ = ["Curriculum", "CurriculumLevel"]


class CurriculumLevel(Options):
    """What a level changes in the task; an empty one is the task as it is."""

    randomize: Randomize = Randomize()
    """Ranges that replace those of the task with the same word or name; others stay."""
    parameters: dict[str, Value] = {}
    """Values of parameters of the template."""
    values: dict[str, Any] = {}
    """Values of the scenario by their paths, such as `robot[0].distribution.goal_distance: 2`: places, goals, shapes
    and ranges. The paths must exist."""
    horizon: Annotated[Seconds, Field(gt=0)] | None = None
    """Time after which an episode is cut off; null: that of the task."""


class Curriculum(Options):
    """Levels from easy to hard. A training rises when it succeeds, and its success is measured on the last level."""

    schema_extra: ClassVar[dict[str, Any]] = {
        "examples": [{"levels": [{"randomize": {"number": {"obstacles": [0, 2]}}}, {}], "up": 0.8, "episodes": 200}]
    }
    also_called: ClassVar[dict[str, str]] = {"stages": "levels", "threshold": "up", "window": "episodes"}

    levels: Annotated[list[CurriculumLevel], Field(min_length=1, max_length=64)]
    """The levels."""
    up: Fraction = 0.9
    """Share of successes at which the level rises by one."""
    down: Fraction | None = None
    """Share of successes at which it falls by one; null: it never falls."""
    episodes: Annotated[Integer, Field(ge=1, le=1_000_000)] = 200
    """Number of the last episodes of learners, all of the present level, of which the share is taken. It is taken only
    when there are as many."""
    start: Annotated[Integer, Field(ge=0)] = 0
    """Level at the start, from 0."""

    @model_validator(mode="after")
    def _is_in_order(self) -> Curriculum:
        if self.start >= len(self.levels):
            what = f"'start' is {self.start}, and the last of the {len(self.levels)} levels is {len(self.levels) - 1}"
            raise problem("invalid-value", what, fix="levels are counted from 0")
        if self.down is not None and self.down >= self.up:
            what = f"'down' is {self.down:g}, and must be less than 'up', which is {self.up:g}"
            raise problem("invalid-value", what, fix=f"give a share below {self.up:g}")
        return self
