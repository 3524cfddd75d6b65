"""The resolved scenario: one record per object with all defaults applied, ready to build or describe."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any, Literal

from irsim.common.text import quoted
from irsim.components.options import BehaviorOptions, CustomOptions

__all__ = [
    "PERSON_TAG",
    "DrawnQuantity",
    "ObjectRecord",
    "Placement",
    "ResolvedScenario",
    "Spreads",
    "Variation",
    "VariedLevel",
    "random_parts",
]

if TYPE_CHECKING:
    from pydantic import BaseModel

    from irsim.components.maps._grid import MapGrid
    from irsim.diagnostics.diagnostic import Path
    from irsim.scenario.model.actuation import Actuation
    from irsim.scenario.model.scenario import Gui, ObjectPlot, WorldModel


PERSON_TAG = "pedestrian"
"""Tag of the obstacles that are people, in pictures and in sentences."""
_TERRAIN = {"map": "the map", "walls": "the walls round the world"}
"""Shapes that keys of ``world`` make -> how a sentence calls them."""


@dataclass(frozen=True, slots=True)
class Spreads:
    """How far an object may differ from the scenario: each seed draws uniformly within these spreads.

    Attributes:
        position: Largest change of the start in x and in y, either way [m].
        heading: Largest change of the initial heading, either way [rad].
        speed: Largest change of its speeds, either way, as a share of them.
        delay: Longest time for which it stands still at its start [s].
    """

    position: float = 0.0
    heading: float = 0.0
    speed: float = 0.0
    delay: float = 0.0


@dataclass(slots=True)
class ObjectRecord:
    """One object with all defaults applied (frames and units as in YAML).

    ``state`` has ``state_dim`` numbers, limits have ``vel_dim`` numbers. ``kinematics``, ``shape``, ``behavior``,
    ``group_behavior`` and ``sensors`` are validated options models of the registries; ``kinematics`` is None for an
    object without a drive. ``behavior`` may be a :class:`irsim.components.options.CustomOptions`.
    """

    id: int
    role: Literal["robot", "obstacle"]
    name: str
    group: int
    group_name: str
    path: Path  # of the entry: ("robot", 0) or ("robot",); ("world", key) of the map and the walls round the world
    index: int  # among the objects of its entry
    kinematics: BaseModel | None
    shape: Any  # options model; MapCells or Walls for the map and the walls round the world
    state: list[float]
    goals: list[list[float]]
    velocity: list[float]
    vel_min: list[float]
    vel_max: list[float]
    acce: list[float]
    state_dim: int
    vel_dim: int
    angle_range: tuple[float, float]
    goal_threshold: float
    arrive_mode: Literal["position", "state"]
    static: bool  # effective: also true for an object with neither kinematics nor a finite mass
    unobstructed: bool
    behavior: BaseModel | None
    group_behavior: BaseModel | None
    wander: bool
    loop: bool
    range_low: list[float]
    range_high: list[float]
    target_roles: Literal["all", "robot", "obstacle"]
    sensors: list[BaseModel]
    plot: ObjectPlot
    color: str | tuple[float, ...]
    description: str | None
    fov: float | None  # effective: from the lidar when not given
    fov_radius: float | None
    fov_occlusion: bool
    wheelbase: float | None  # effective: kinematics first, then shape
    mass: float
    friction: float
    inertia: float | None
    restitution: float
    drive_tau: float  # effective: kinematics first, then world
    actuation: Actuation | None = None
    perceives: Literal["truth", "estimate", "tracks", "both"] = "truth"
    tags: tuple[str, ...] = ()
    watches: bool = False  # whether `fov` is written; else the field of view is its lidar's
    joined: bool = True  # whether it follows the behavior of its group
    start_time: float = 0.0  # until then it stands still [s]
    appear_time: float = 0.0  # until then it is not in the world [s]
    vanish_time: float | None = None  # last time at which it is in the world [s]; None: it stays
    reflectivity: float = 0.8  # share of the light of lidars that its surface throws back
    material: Literal["matt", "glass", "mirror"] = "matt"
    spreads: Spreads | None = None  # None: it starts as written

    @property
    def estimates(self) -> bool:
        """Whether it decides from an estimate of its pose."""
        return self.perceives in ("estimate", "both")

    @property
    def follows_tracks(self) -> bool:
        """Whether it decides from the tracks of its detector."""
        return self.perceives in ("tracks", "both")

    @property
    def is_map(self) -> bool:
        """Whether it is the map of the world."""
        return bool(self.shape.name == "map")

    @property
    def is_terrain(self) -> bool:
        """Whether a key of ``world`` made it: the map, or the walls round the world."""
        return self.shape.name in _TERRAIN

    @property
    def is_person(self) -> bool:
        """Whether the scenario says that it is a person."""
        return self.role != "robot" and PERSON_TAG in self.tags

    @property
    def is_named(self) -> bool:
        """Whether the scenario gives it a name; else it has one of its role and number."""
        return self.name != f"{self.role}_{self.id}"

    @property
    def called(self) -> str:
        """How a sentence calls it: its name in quotes, or ``the map``, ``the walls round the world``.

        People without a name of their own are ``the person 'obstacle_7'``, a name that commands know.
        """
        kind = "the person " if self.is_person and not self.is_named else ""
        return _TERRAIN.get(self.shape.name, kind + quoted(self.name))

    @property
    def active_behavior(self) -> Any:
        """The options of what moves the object: of the behavior of its group, else of its own; None without any."""
        return self.behavior if self.group_behavior is None else self.group_behavior

    @property
    def recorded(self) -> bool:
        """Whether it replays a recording, which says where it starts and ends."""
        return getattr(self.behavior, "name", None) == "replay" and bool(getattr(self.behavior, "times", None))

    @property
    def moves_from(self) -> float:
        """Time from which it may move [s]."""
        return max(self.start_time, self.appear_time)

    def with_sensors(self, sensors: list[BaseModel], **changes: Any) -> ObjectRecord:
        """A copy with other sensors that decides from the truth, as it may lack what its estimate or its tracks need.

        Args:
            sensors: The sensors of the copy.
            **changes: Other fields of the copy.
        """
        return replace(self, sensors=sensors, perceives="truth", **changes)

    def heading_counts(self, goal: Sequence[float]) -> bool:
        """Whether it arrives at a goal (2 or 3 numbers; NaN: any heading) only with the heading of the goal."""
        return self.arrive_mode == "state" and len(goal) > 2 and not math.isnan(goal[2])


@dataclass(slots=True)
class Placement:
    """The objects of one entry whose places are drawn for each scene, such as ``distribution: random``.

    ``range_low``, ``range_high``, ``min_distance`` and ``clear_of`` are fields of ``Drawn`` in
    :mod:`irsim.components.options`, and ``options`` is its ``kernel``.
    """

    objects: list[int]  # ids
    range_low: list[float]
    range_high: list[float]
    min_distance: float
    path: Path
    distribution: str
    options: Mapping[str, Any]
    clear_of: Sequence[tuple[str, float]] = ()
    kept: list[tuple[int, float]] = field(default_factory=list)  # ids of the objects of `clear_of`, and how far [m]

    @property
    def distance_key(self) -> str:
        """Key of the distance that its objects keep."""
        return "min_distance" if self.distribution == "random" else "clearance"

    @property
    def further_keys(self) -> list[str]:
        """Other keys in use that leave less room."""
        used = {
            "keep_clear": bool(self.kept or self.options.get("keep_points")),
            "goal_distance": bool(self.options.get("goal_distance")),
        }
        return [key for key, is_used in used.items() if is_used]

    @property
    def ranges(self) -> list[tuple[str, list[float], list[float]]]:
        """First word of the keys, lower and upper bounds: of starts, and of goals where they lie elsewhere."""
        starts = ("range", self.range_low, self.range_high)
        goals = ("goal", self.options.get("goal_low", self.range_low), self.options.get("goal_high", self.range_high))
        return [starts] if goals[1:] == starts[1:] else [starts, goals]

    @property
    def room(self) -> str:
        """The area in which places are drawn, in words."""
        width, height = (self.range_high[i] - self.range_low[i] for i in range(2))
        if self.distribution == "circle_crossing":
            return f"the circle of radius {self.options['radius']:g} m with its noise of {self.options['noise']:g} m"
        if self.distribution == "square_crossing":
            return f"the halves of a square of {self.options['width']:g} m"
        return f"{abs(width * height):.3g} m2"

    @property
    def widen(self) -> str:
        """How to make that area larger, in words."""
        keys = {"circle_crossing": "raise radius or noise", "square_crossing": "raise width"}
        return keys.get(self.distribution, "widen range_low/range_high")


@dataclass(frozen=True, slots=True)
class DrawnQuantity:
    """A quantity that is drawn for each scene, uniformly; see ``Variation`` in ``irsim/_core.pyi``.

    Attributes:
        quantity: number, size, speed, acceleration, sensor_noise, latency, delay, lag, sensor_rate, sensor_latency,
            slip or grip.
        word: Name of the objects in the task.
        objects: Their ids.
        low, high: Range.
        same: Whether all objects share one draw.
    """

    quantity: str
    word: str
    objects: Sequence[int]
    low: float
    high: float
    same: bool = False


@dataclass(frozen=True, slots=True)
class VariedLevel:
    """The draws of one level of a curriculum: quantities, and one of some variants of the scenario."""

    drawn: Sequence[DrawnQuantity] = ()
    first_variant: int = 0
    variants: int = 0


@dataclass(frozen=True, slots=True)
class Variation:
    """The draws of each level, and the variants of all levels: the same objects elsewhere, of other shapes."""

    levels: Sequence[VariedLevel]
    variants: Sequence[ResolvedScenario] = ()


@dataclass(slots=True)
class ResolvedScenario:
    """A whole scenario, resolved.

    ``objects`` are in the order of the rows of a simulation. An object keeps its ``id`` when others are removed, so ids
    equal rows only until the first removal.
    """

    name: str
    world: WorldModel
    objects: list[ObjectRecord]
    placements: list[Placement]
    gui: Gui
    custom: Any
    document: dict[str, Any] = field(default_factory=dict)  # as parsed, for env.config
    source: str | None = None  # path of the file
    text: str | None = None
    grid: MapGrid | None = None  # the map, whether or not any cell is occupied
    map_files: dict[str, str] = field(default_factory=dict)  # name in the scenario -> path of the map file
    bridges: list[BaseModel] = field(default_factory=list)
    variation: Variation | None = None  # what a task draws for each scene

    def robots(self) -> Sequence[ObjectRecord]:
        """The robots, in id order."""
        return [o for o in self.objects if o.role == "robot"]

    def is_parked(self, record: ObjectRecord) -> bool:
        """Whether an object cannot move and its goal is only the default, not written in the scenario."""
        return (record.kinematics is None or record.static) and not self.has_written_goal(record)

    def has_written_goal(self, record: ObjectRecord) -> bool:
        """Whether the entry of an object, or what it replays, gives it a goal; otherwise it has at most the default."""
        if record.recorded:
            return True
        entry: Any = self.document
        for key in record.path:
            if key not in _keys(entry):
                return True
            entry = entry[key]
        return not isinstance(entry, Mapping) or any(entry.get(key) is not None for key in _GIVE_GOALS)


_GIVE_GOALS = ("goal", "waypoints", "distribution")


def _keys(value: Any) -> Any:
    return value if isinstance(value, Mapping) else range(len(value) if isinstance(value, list) else 0)


_SAMPLING_PLANNERS = ("rrt", "rrt_star", "informed_rrt_star", "prm")


def random_parts(scenario: ResolvedScenario) -> list[str]:
    """The parts of a run that depend on the seed, in words; empty if every seed gives the same run."""
    names: dict[str, None] = {}
    if scenario.placements:
        names["placement"] = None
    generator: Any = scenario.world.obstacle_map
    if getattr(generator, "seed", 0) is None:
        names["map"] = None
    for record in scenario.objects:
        names.update(dict.fromkeys(_of_object(record)))
    return list(names)


def _of_object(record: ObjectRecord) -> list[str]:
    shape: Any = record.shape
    drive: Any = record.kinematics
    parts = shape.parts if shape.name == "compound" else [shape]
    behaviors: list[Any] = [record.behavior, record.group_behavior]
    planners = [getattr(behavior, "planner", None) for behavior in behaviors]
    chances = {
        "shapes": any(getattr(part, "random_shape", False) for part in parts),
        "wander goals": record.wander and not record.static,
        "motion noise": getattr(drive, "noise", False) and not record.static,
        "actuation noise": record.actuation is not None and record.actuation.is_noisy and not record.static,
        "sensor noise": any(
            getattr(sensor, key, None)
            for sensor in record.sensors
            for key in ("noise", "velocity_noise_std", "realism")
        ),
        "perception": record.perceives != "truth" and not record.static,
        "decisions": any(isinstance(behavior, BehaviorOptions) and behavior.draws() for behavior in behaviors)
        and not record.static,
        "planners": any(getattr(planner, "name", planner) in _SAMPLING_PLANNERS for planner in planners),
        "user code": any(isinstance(behavior, CustomOptions) for behavior in behaviors),
    }
    return [name for name, chance in chances.items() if chance] + _perturbed_parts(record)


def _perturbed_parts(record: ObjectRecord) -> list[str]:
    spreads = record.spreads
    if spreads is None:
        return []
    names = {"position": "start positions", "heading": "start headings", "speed": "speeds", "delay": "start delays"}
    return [text for key, text in names.items() if getattr(spreads, key)]
