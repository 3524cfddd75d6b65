"""The content of a task file: what learning adds to a scenario.

::

    task: to_the_goal
    title: One robot with a lidar drives to its goal
    template: training-arena            # or scenario: {world: …, robot: …}, or file: scene.yaml
    parameters: {robots: 1}
    horizon: 30
    observation:
      - {name: scan, sectors: 36}
      - {name: goal, features: [nearness, cos, sin]}
      - {name: own, features: [vx, yaw_rate]}
    reward:
      - {name: progress, weight: 1.0}
      - {name: arrival, weight: 1.0}
      - {name: collision, weight: -3.0}
"""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import Field, model_validator

from irsim.learning.features import REWARDS
from irsim.learning.rewards._options import RewardOptions
from irsim.learning.tasks.curriculum import Curriculum, CurriculumLevel
from irsim.learning.tasks.randomize import Randomize, Value
from irsim.options.base import Options, problem
from irsim.options.selection import Select
from irsim.options.units import Bool, Integer, Seconds
from irsim.policies.networks.document import Meaning, OutputOptions
from irsim.policies.networks.layout import Layout
from irsim.policies.networks.parts._options import PARTS, PartOptions
from irsim.scenario.perturbation import Perturbation

__all__ = ["Action", "Ends", "Seeds", "Task"]

Name = Annotated[str, Field(pattern=r"^[A-Za-z][A-Za-z0-9_.-]{0,63}$")]


class Action(Meaning):
    """What the numbers of an action mean.

    Without `choices`, an action is a vector of numbers from -1 to 1. They lie between the limits of each robot's
    controls, or between `low` and `high`. With `choices` it is the number of one of them.
    """

    def meaning(self) -> OutputOptions:
        """The same for a network, whose numbers are clipped to -1 and 1."""
        given = self.model_dump()
        if self.choices is not None:
            return OutputOptions(input="action", **given)
        scaled = self.low is not None or self.returns == "velocity"
        return OutputOptions(input="action", squash="clip", **{**given, "limits": not scaled})


class Ends(Options):
    """When the episode of a learner, and that of its world, is over."""

    arrival: Bool | None = None
    """Whether the episode of a learner ends when it has reached its last goal; null: unless arrived robots make room
    (`protocol: yield`)."""
    collision: Bool = True
    """Whether the episode of a learner ends when it begins to collide."""
    world: Literal["all", "any", "collision"] = "all"
    """When a world starts its next episode: when all learners are done, when any is, or already when one collides. It
    always does at the horizon, and when every robot has arrived or stopped."""


class Seeds(Options):
    """Seeds of the worlds. Tests on other seeds show what a policy has learnt beyond its training."""

    train: Annotated[Integer, Field(ge=0, lt=2**53)] = 1_000_000
    """Seed of the first world in training; world i has this number plus i."""
    validation: Annotated[Integer, Field(ge=0, lt=2**53)] = 900_000
    """First of the seeds on which a training measures its success."""
    validation_count: Annotated[Integer, Field(ge=1, le=100_000)] = 100
    """Number of these seeds."""


class Task(Options):
    """A scenario, and what learning adds to it."""

    task: Name
    """Name of the task."""
    version: Annotated[Integer, Field(ge=1)] = 1
    """Version of the task: results of different versions are not comparable."""
    title: Annotated[str, Field(max_length=100)] = ""
    """What it is about, in one line."""
    about: str = ""
    """What it is for, where it comes from, and how to read its results."""
    template: str | None = None
    """Name of a bundled template; `irsim templates` lists them."""
    parameters: dict[str, Value] = {}
    """Values of parameters of the template."""
    scenario: dict[str, Any] | None = None
    """The scenario itself, as in a scenario file."""
    file: str | None = None
    """A scenario file, relative to the task file."""
    learners: list[str] | None = None
    """Names of the robots that learn, or tags; null: all robots. Others follow their behaviors."""
    protocol: Literal["as-written", "freeze", "yield"] = "as-written"
    """What robots do that have arrived: stand still (`freeze`), stay controlled so that they can make room (`yield`),
    or what the scenario says (`as-written`)."""
    observation: Annotated[list[Annotated[PartOptions, Select(PARTS)]], Field(min_length=1, max_length=32)]
    """Parts of what a learner observes, in this order; `irsim describe task.observation` lists them."""
    action: Action = Action()
    """What the numbers of an action mean."""
    reward: Annotated[list[Annotated[RewardOptions, Select(REWARDS)]], Field(min_length=1, max_length=32)]
    """Terms of the reward; it is the sum of their values times their weights."""
    ends: Ends = Ends()
    """When episodes are over."""
    horizon: Annotated[Seconds, Field(gt=0)] = 50.0
    """Time after which an episode is cut off. Learners are then `truncated`, not `terminated`."""
    seeds: Seeds = Seeds()
    """Seeds of the worlds."""
    randomize: Randomize = Randomize()
    """What is drawn for each episode, besides the places that the scenario draws: ranges [low, high] under words that
    name objects, as in `size: {"obstacle[0]": [0.7, 1.3]}`. A word is the name, tag or group of objects, an entry of
    the scenario such as `robot[1]`, or one of `learners`, `robots`, `obstacles` and `people` (obstacles that move)."""
    perturb: Annotated[list[Perturbation], Field(max_length=64)] = []
    """How far starts, headings and speeds may differ from those that the scenario writes, as `perturb` of `irsim run`:
    for random starts with goals that stay. Of two spreads for an object the later one counts."""
    curriculum: Curriculum | None = None
    """Levels from easy to hard, through which a training rises; null: the task as it is."""

    @model_validator(mode="after")
    def _has_one_source(self) -> Task:
        given = [key for key in ("template", "scenario", "file") if getattr(self, key) is not None]
        if len(given) != 1:
            names = " and ".join(given) or "none of them"
            what = f"exactly one of template, scenario and file says what the robots do; given: {names}"
            raise problem("invalid-value", what, fix="give one of them")
        if self.parameters and self.template is None:
            what = "'parameters' belong to a template"
            raise problem("invalid-value", what, fix="write values of a scenario where they belong")
        drawn = [self.randomize, *(level.randomize for level in self.levels)]
        if self.template is None and (
            any(one.parameters for one in drawn) or any(one.parameters for one in self.levels)
        ):
            what = "only a template has parameters that can be drawn"
            raise problem("invalid-value", what, fix="use a template, or change the scenario with `values` of a level")
        return self

    @property
    def levels(self) -> list[CurriculumLevel]:
        """The levels of the curriculum; without one, the task as it is."""
        return [CurriculumLevel()] if self.curriculum is None else self.curriculum.levels

    def horizon_of(self, level: int) -> float:
        """Time after which an episode of a level is cut off [s]."""
        own = self.levels[level].horizon
        return self.horizon if own is None else own

    @property
    def layout(self) -> Layout:
        """The observation as the layout of a network."""
        return Layout(parts=self.observation)

    @property
    def ends_on_arrival(self) -> bool:
        """Whether the episode of a learner ends with its arrival."""
        return self.protocol != "yield" if self.ends.arrival is None else self.ends.arrival
