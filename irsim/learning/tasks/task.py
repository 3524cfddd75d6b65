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

from typing import Annotated, Any, ClassVar, Literal

from pydantic import AfterValidator, Field, model_validator

from irsim.learning.rewards._options import REWARDS, RewardOptions
from irsim.options.base import Options, problem
from irsim.options.selection import Select
from irsim.options.units import Bool, Fraction, Integer, LongInteger, Number, Seconds, Value
from irsim.policies.networks.document import Meaning, OutputOptions
from irsim.policies.networks.layout import Layout
from irsim.policies.networks.parts._options import PARTS, PartOptions
from irsim.scenario.perturbation import Perturbation

__all__ = [
    "QUANTITIES",
    "Action",
    "Curriculum",
    "CurriculumLevel",
    "Ends",
    "Randomize",
    "Seeds",
    "Task",
    "merged",
]


QUANTITIES = (
    "number", "size", "speed", "acceleration", "sensor_noise", "latency", "delay", "lag", "sensor_rate",
    "sensor_latency", "slip", "grip",
)  # fmt: skip
"""Quantities drawn for objects of the scenario, in the order of the keys."""


def _ordered(values: list[Any]) -> list[Any]:
    if values[0] > values[1]:
        what = f"the range begins at {values[0]:g}, which is more than its end, {values[1]:g}"
        raise problem("invalid-value", what, fix=f"write [{values[1]:g}, {values[0]:g}]")
    return values


_Pair = Field(min_length=2, max_length=2)
Whole = Annotated[list[Annotated[Integer, Field(ge=0, le=100_000)]], _Pair, AfterValidator(_ordered)]
Steps = Annotated[list[Annotated[Integer, Field(ge=0, le=1000)]], _Pair, AfterValidator(_ordered)]
Factors = Annotated[list[Annotated[Number, Field(gt=0, le=1000)]], _Pair, AfterValidator(_ordered)]
FactorsFromZero = Annotated[list[Annotated[Number, Field(ge=0, le=1000)]], _Pair, AfterValidator(_ordered)]


class Randomize(Options):
    """Draws for each episode: ranges [low, high], uniformly.

    Objects are named by a word: the name, tag or group of objects, an entry of the scenario such as `obstacle[0]`, or
    one of `learners`, `robots`, `obstacles` and `people` (obstacles that move). Each object draws its own value. A draw
    depends only on the seed, on the number of the scene and on the object, and never on what happened before.
    """

    schema_extra: ClassVar[dict[str, Any]] = {
        "examples": [
            {"number": {"obstacles": [2, 8]}, "size": {"obstacles": [0.7, 1.3]}, "latency": {"learners": [0, 2]}}
        ]
    }
    also_called: ClassVar[dict[str, str]] = {
        "count": "number",
        "numbers": "number",
        "sizes": "size",
        "scale": "size",
        "speeds": "speed",
        "velocity": "speed",
        "accelerations": "acceleration",
        "acce": "acceleration",
        "noise": "sensor_noise",
        "dead_time": "delay",
        "tau": "lag",
        "rate": "sensor_rate",
        "slippage": "slip",
        "mu": "grip",
        "params": "parameters",
    }

    number: dict[str, Whole] = {}
    """How many of the objects take part; the others are absent, as before `appear_time`. Which ones is drawn, too.
    Robots that learn and are absent are slots that wait."""
    size: dict[str, Factors] = {}
    """Factor on the footprint, about the origin of its body frame. Places are drawn for the scaled footprint; where the
    scenario gives them, scaled footprints may overlap."""
    speed: dict[str, Factors] = {}
    """Factor on the limits of speeds (not of turn rates), and on the speeds that behaviors want."""
    acceleration: dict[str, Factors] = {}
    """Factor on the limits of accelerations."""
    sensor_noise: dict[str, FactorsFromZero] = {}
    """Factor on the standard deviations of the sensors' errors, also of errors that hold for an episode; at 0
    they are exact. Shares of readings that fail, systematic errors and rounding stay. A lidar's `std` needs
    `noise: true`."""
    latency: dict[str, Steps] = {}
    """Steps after which actions of learners are executed; 0 is at once. Until the first one a learner stands still."""
    delay: dict[str, FactorsFromZero] = {}
    """Factor on `delay` of the `actuation` of the objects; at most 2 s come of it."""
    lag: dict[str, FactorsFromZero] = {}
    """Factor on `lag` of the `actuation` of the objects."""
    sensor_rate: dict[str, Factors] = {}
    """Factor on `rate` of all sensors of the objects that have one."""
    sensor_latency: dict[str, FactorsFromZero] = {}
    """Factor on `latency` of all sensors of the objects that have one; at most 10 s come of it."""
    slip: dict[str, FactorsFromZero] = {}
    """Factor on `slip` and `slip_std` of all zones, as the objects feel them; at most a slip of 1 comes of it."""
    grip: dict[str, Factors] = {}
    """Factor on `grip` of all zones with a ground, as the objects feel them: 0.5 halves it where it is 1, too."""
    same: list[
        Literal[
            "size", "speed", "acceleration", "sensor_noise", "latency", "delay", "lag", "sensor_rate",
            "sensor_latency", "slip", "grip",
        ]
    ] = []  # fmt: skip
    """Quantities of which all objects of a word share one draw."""
    parameters: dict[str, Annotated[list[Value], Field(min_length=1, max_length=64)]] = {}
    """Parameters of the template: [low, high] for numbers, a list of values otherwise. They change the geometry, so
    they are drawn as `variants`."""
    variants: Annotated[Integer, Field(ge=1, le=256)] = 8
    """Number of variants of the scenario that are made with drawn parameters; each episode draws one of them. Values of
    a number are spread evenly from low to high, in an order of its own for each parameter."""
    observed: list[Annotated[str, Field(min_length=1, max_length=100)]] = []
    """Draws that the policy observes, at the end of its observation, from 0 (low) to 1 (high): `size`, `speed`,
    `acceleration`, `sensor_noise`, `latency`, `delay`, `lag`, `sensor_rate`, `sensor_latency`, `slip`, `grip` of the
    learner itself, `number.WORD`, `parameters.NAME`. A policy that observes them cannot be exported, because only a
    simulation knows them."""


def merged(base: Randomize, change: Randomize) -> Randomize:
    """The draws of a level: words and parameters that it names replace the task's, others stay."""
    given = {}
    for key in change.model_fields_set:
        value = getattr(change, key)
        given[key] = {**getattr(base, key), **value} if isinstance(value, dict) else value
    return base.model_copy(update=given)


class CurriculumLevel(Options):
    """Changes of the task at a level; an empty one is the task as it is."""

    randomize: Randomize = Randomize()
    """Ranges that replace the task's with the same word or name; others stay."""
    parameters: dict[str, Value] = {}
    """Values of parameters of the template."""
    values: dict[str, Any] = {}
    """Values of the scenario by their paths, such as `robot[0].distribution.goal_distance: 2`: places, goals, shapes
    and ranges. The paths must exist."""
    horizon: Annotated[Seconds, Field(gt=0)] | None = None
    """Time after which an episode is cut off; null keeps the task's."""


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
    start: Annotated[LongInteger, Field(ge=0)] = 0
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


Name = Annotated[str, Field(pattern=r"^[A-Za-z][A-Za-z0-9_.-]{0,63}$")]


class Action(Meaning):
    """Meaning of the numbers of an action.

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
    """When the episode of a learner and of its world is over."""

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

    train: Annotated[LongInteger, Field(ge=0)] = 1_000_000
    """Seed of the first world in training; world i has this number plus i."""
    validation: Annotated[LongInteger, Field(ge=0)] = 900_000
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
    """Its subject, in one line."""
    about: str = ""
    """Its purpose and origin, and how to read its results."""
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
    """Robots that have arrived stand still (`freeze`), stay controlled so that they can make room (`yield`), or do
    what the scenario says (`as-written`)."""
    observation: Annotated[list[Annotated[PartOptions, Select(PARTS)]], Field(min_length=1, max_length=32)]
    """Parts of what a learner observes, in this order; `irsim describe task.observation` lists them."""
    action: Action = Action()
    """Meaning of the numbers of an action."""
    reward: Annotated[list[Annotated[RewardOptions, Select(REWARDS)]], Field(min_length=1, max_length=32)]
    """Terms of the reward; it is the sum of their values times their weights."""
    ends: Ends = Ends()
    """When episodes are over."""
    horizon: Annotated[Seconds, Field(gt=0)] = 50.0
    """Time after which an episode is cut off. Learners are then `truncated`, not `terminated`."""
    seeds: Seeds = Seeds()
    """Seeds of the worlds."""
    randomize: Randomize = Randomize()
    """Draws for each episode, besides the places that the scenario draws: ranges [low, high] under words that name
    objects, as in `size: {"obstacle[0]": [0.7, 1.3]}`. A word is the name, tag or group of objects, an entry of
    the scenario such as `robot[1]`, or one of `learners`, `robots`, `obstacles` and `people` (obstacles that move)."""
    perturb: Annotated[list[Perturbation], Field(max_length=64)] = []
    """How far starts, headings and speeds may differ from the values of the scenario, as `perturb` of `irsim run`:
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
