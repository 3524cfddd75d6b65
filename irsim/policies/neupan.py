"""``neupan``: NeuPAN, if the user has installed it; irsim has none of its code."""

from __future__ import annotations

import contextlib
import importlib.util
import io
import math
import os
import sys
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import numpy as np

from irsim.common.arguments import as_given, is_number
from irsim.common.arrays import Floats
from irsim.common.records import ContentError
from irsim.common.yaml.plain import read_plain_yaml
from irsim.diagnostics.errors import ArgumentError, PolicyError
from irsim.policies.observations import Neighbors, Observations
from irsim.policies.policy import Episode, Needs, Policy

__all__ = ["NeuPanPolicy"]

_INSTALL = (
    "git clone https://github.com/hanruihua/NeuPAN && pip install -e ./NeuPAN; it is on no registry, and its licence "
    "is GPL-3.0"
)
_DRIVES = ("diff", "acker", "omni")
"""Drives for which NeuPAN plans."""
_SECTIONS = ("robot", "ipath", "pan", "adjust", "train")
"""Sections of its file."""
_LARGEST_M = 1e6
"""Largest coordinate of a footprint [m]."""
_SEEN_M = 0.02
"""Beams that end closer than this to the largest range have hit nothing [m]."""
_SAME_M = 0.02
"""Greatest distance between corners of equal footprints [m]."""
_ON_NEIGHBOR_M = 0.1
"""Points up to this far outside the bounding circle of a neighbor move with it [m]."""


class NeuPanPolicy(Policy):
    """NeuPAN (Han et al., T-RO 2025) drives along the path of its file around the points that its lidar sees.

    The package `neupan` must be installed. Its file says what it knows of the robot; the network that it names was
    trained for one footprint, so robots must have that one. Without vertices, length and width there, NeuPAN gets the
    footprint of each robot. Each robot has a planner of its own, and its first lidar gives the points. The path is
    ``ipath: {waypoints: …, loop: …}``, which begins at the robot; without waypoints it is a straight line to the goal.

    Args:
        config: The YAML file of NeuPAN, with its sections ``robot``, ``pan`` and so on.
        velocities: Whether points on moving neighbors get their velocities; NeuPAN takes all others as standing.
        speed: Reference speed [m/s]; None: the ``ref_speed`` of the file.

    Raises:
        PolicyError: The package is not installed, the file cannot be used, or its network is not there.
        ArgumentError: An option is not of its kind.
    """

    name = "neupan"
    stochastic = False
    needs = Needs(scan=True, footprints=True)
    drives: frozenset[str] | None = frozenset(_DRIVES)
    package = ("neupan", _INSTALL)

    def __init__(self, config: str, velocities: bool = False, speed: float | None = None) -> None:
        if not isinstance(velocities, bool):
            raise ArgumentError(f"velocities must be true or false, got {as_given(velocities)}", "write true")
        if speed is not None and not (is_number(speed) and 0 < speed < math.inf):
            raise ArgumentError(f"speed must be above 0 m/s, got {as_given(speed)}", "write 1")
        self._config = _read(config)
        self._folder = Path(config).resolve().parent
        self._speed = speed
        robot = self._config["robot"]
        drive = robot.get("kinematics")
        if drive not in _DRIVES:
            what = f"{config!r}: the robot has the kinematics {as_given(drive)}"
            raise PolicyError("policy-failed", what, f"NeuPAN plans for {', '.join(_DRIVES)}")
        self.output = "velocity" if drive == "omni" else "control"
        self.drives = None if drive == "omni" else frozenset({drive})
        self.needs = Needs(scan=True, footprints=True, neighbors=20 if velocities else 0)
        self._shape = _corners(robot)
        self._network = _find_network(self._config, config)
        self._path = _waypoints(self._config, config)
        self._footprints: dict[tuple[int, int], Floats] = {}
        self._step: dict[int, float] = {}
        self._planners: dict[tuple[int, int], Any] = {}
        self._goals: dict[tuple[int, int], tuple[float, ...]] = {}
        self._remarks: dict[int, str] = {}

    def reset(self, episode: Episode, rng: np.random.Generator) -> None:
        """Keep the footprints; each robot gets its planner at its first decision.

        Raises:
            PolicyError: A robot has another footprint than the network was trained for (``policy-mismatch``).
        """
        self._step[episode.world] = episode.step_time * episode.decision_steps
        for robot in episode.robots:
            self._remarks.pop(robot, None)
        for robot, outline in zip(episode.robots, episode.footprints, strict=True):
            if self._shape is not None and not _is_same(self._shape, outline):
                given, own = (np.round(corners, 2).tolist() for corners in (outline, self._shape))
                what = f"policy 'neupan' was trained for a robot with the corners {own}, and robot {robot} has {given}"
                raise PolicyError("policy-mismatch", what, "give the robot that shape, or train NeuPAN for this one")
            self._footprints[episode.world, robot] = outline

    def act(self, observations: Observations) -> Floats:
        """One decision of the planner of each robot, (B, 2); one without a goal stands still."""
        o = observations
        assert o.scan is not None
        decided = np.zeros((len(o), 2))
        for b in range(len(o)):
            key = (int(o.world[b]), int(o.robot[b]))
            if not np.isfinite(o.goal[b, :2]).all():
                continue
            planner = self._planner(key, bool(o.first[b]), float(o.goal_threshold[b]))
            state = o.pose[b][:, None].copy()
            self._lead(key, planner, state, o.goal[b])
            hit = o.scan.ranges[b] < o.scan.range_max - _SEEN_M
            points = _points(o.pose[b], o.scan.position, o.scan.ranges[b][hit], o.scan.angles[hit])
            moving = None if o.neighbors is None or points is None else _velocities(points, o.neighbors, b)
            with _quiet():
                action, info = planner(state, points, moving)
            self._remark(key[1], info)
            decided[b] = np.asarray(action, dtype=np.float64).reshape(-1)[:2]
        return decided

    def remarks(self) -> Mapping[int, str]:
        """The last remark of the planner of each robot that it has stopped."""
        return self._remarks

    def _remark(self, robot: int, info: Mapping[str, Any]) -> None:
        """Keep why the planner stops a robot, as long as it does."""
        if info.get("arrive"):
            end = (
                "its goal" if self._path is None else f"{np.round(self._path[-1][:2], 2).tolist()}, where its path ends"
            )
            self._remarks[robot] = f"NeuPAN has arrived at {end}"
        elif info.get("stop"):
            near = self._config.get("collision_threshold", 0.1)
            self._remarks[robot] = f"NeuPAN stops because something is nearer than collision_threshold ({near} m)"
        else:
            self._remarks.pop(robot, None)

    def _planner(self, key: tuple[int, int], first: bool, threshold: float) -> Any:
        """The planner of a robot, made at its first decision; with waypoints it makes its path once, from the start."""
        if key not in self._planners or (first and self._path is not None):
            self._planners[key] = self._made(key, threshold)
        elif first:
            with _quiet():
                self._planners[key].reset()
        if first:
            self._goals.pop(key, None)
        return self._planners[key]

    def _made(self, key: tuple[int, int], threshold: float) -> Any:
        config = {name: dict(part) if isinstance(part, dict) else part for name, part in self._config.items()}
        for name in _SECTIONS:
            config[f"{name}_kwargs"] = config.pop(name)
        if self._shape is None:
            config["robot_kwargs"]["vertices"] = self._footprints[key].tolist()
        config["ipath_kwargs"].setdefault("arrive_threshold", threshold)
        config["pan_kwargs"]["dune_checkpoint"] = str(self._network)
        config["step_time"] = self._step[key[0]]
        if self._speed is not None:
            config["ref_speed"] = float(self._speed)
        try:
            with _quiet():
                from neupan import neupan  # type: ignore[import-not-found] # on no registry

                return neupan(**config)
        except EOFError as error:  # it found an answer to its question
            what = f"NeuPAN asks a question about the network {str(self._network)!r}, which it cannot read"
            raise PolicyError("policy-failed", what, "name a network that NeuPAN has trained") from error

    def _lead(self, key: tuple[int, int], planner: Any, state: Floats, goal: Floats) -> None:
        """Give a planner without waypoints a straight path to each new goal."""
        if self._path is not None:
            return
        if self._goals.get(key) == tuple(goal.tolist()[:2]):
            return
        self._goals[key] = tuple(goal.tolist()[:2])
        heading = goal[2] if np.isfinite(goal[2]) else math.atan2(goal[1] - state[1, 0], goal[0] - state[0, 0])
        with _quiet():
            planner.update_initial_path_from_goal(state, np.array([[goal[0]], [goal[1]], [heading]]))


@contextlib.contextmanager
def _quiet() -> Iterator[None]:
    """Keep what NeuPAN prints from standard output, which may be a protocol, and its questions from standard input."""
    stdin = sys.stdin
    sys.stdin = io.StringIO()
    try:
        with contextlib.redirect_stdout(io.StringIO()):
            yield
    finally:
        sys.stdin = stdin


def _read(config: str) -> dict[str, Any]:
    """The sections of a file of NeuPAN.

    Raises:
        PolicyError: There is no such file, or it is not a mapping.
    """
    try:
        data = read_plain_yaml(Path(config))
    except (TypeError, ContentError) as error:
        what = f"the file of NeuPAN {as_given(config)} cannot be read: {error}"
        raise PolicyError("policy-failed", what, "write {name: neupan, config: planner.yaml}") from error
    if not isinstance(data, dict):
        raise PolicyError(
            "policy-failed", f"{config!r} is not a file of NeuPAN", "it has sections such as robot and pan"
        )
    for name in _SECTIONS:
        if not isinstance(data.get(name) or {}, dict):
            what = f"{config!r}: the section {name} is not a mapping, got {as_given(data[name])}"
            raise PolicyError("policy-failed", what, f"write {name}: and its keys below it")
    return {**data, **{name: data.get(name) or {} for name in _SECTIONS}}


def _find_network(config: dict[str, Any], file: str) -> Path:
    """The file of the network: from the folder of the file of NeuPAN or one above it, from here, or from the package.

    Raises:
        PolicyError: The file names none, or it is in none of these places.
    """
    name = config["pan"].get("dune_checkpoint")
    fix = "write pan: {dune_checkpoint: model.pth}, with a network that NeuPAN has trained for this robot"
    if not isinstance(name, str) or name in ("", "None"):
        raise PolicyError("policy-failed", f"{file!r} names no network (pan: dune_checkpoint)", fix)
    folder = Path(file).resolve().parent
    places = [folder, *list(folder.parents)[:4], Path.cwd()]
    package = importlib.util.find_spec("neupan")
    if package is not None and package.origin:
        places.append(Path(package.origin).parents[1])
    for place in places:
        if os.path.isfile(place / name):  # false for names that are too long, too
            return place / name
    looked = ", ".join(dict.fromkeys(map(str, places)))
    raise PolicyError("policy-failed", f"{file!r} names the network {name!r}, which is in none of {looked}", fix)


def _waypoints(config: dict[str, Any], file: str) -> list[Floats] | None:
    """The poses x, y, heading [m, rad] of the path of a file of NeuPAN; None without one.

    Raises:
        PolicyError: They are not poses.
    """
    given = config["ipath"].get("waypoints")
    if not given:
        return None
    try:
        poses = np.asarray(given, dtype=np.float64)
    except (TypeError, ValueError):
        poses = np.empty(0)
    if poses.ndim != 2 or poses.shape[1] != 3 or not np.isfinite(poses).all():
        what = f"{file!r}: ipath: waypoints is a list of poses [x, y, heading], got {as_given(given)}"
        raise PolicyError("policy-failed", what, "write waypoints: [[0, 20, 0], [60, 20, 0]]")
    return list(poses)


def _corners(robot: dict[str, Any]) -> Floats | None:
    """(K, 2) corners of the robot of a file of NeuPAN [m]; None if it names none.

    Raises:
        PolicyError: They are not numbers.
    """
    try:
        if robot.get("vertices") is not None:
            corners: Floats = np.asarray(robot["vertices"], dtype=np.float64).reshape(-1, 2)
        elif robot.get("length") is None or robot.get("width") is None:
            return None
        else:
            length, width, wheelbase = (float(robot.get(key) or 0.0) for key in ("length", "width", "wheelbase"))
            back = (length - wheelbase) / 2
            corners = np.array([[x, y] for x in (-back, length - back) for y in (-width / 2, width / 2)])
    except (TypeError, ValueError, OverflowError):
        corners = np.zeros((0, 2))
    if not len(corners) or not (np.abs(corners) <= _LARGEST_M).all():
        what = "the section robot has vertices, a length, a width or a wheelbase that are not lengths"
        raise PolicyError("policy-failed", what, "write meters, such as length: 1.6 and width: 2.0")
    return corners


def _is_same(a: Floats, b: Floats) -> bool:
    """Whether each corner of one footprint is a corner of the other."""
    apart = np.hypot(*(a[:, None] - b[None]).transpose(2, 0, 1))
    return bool(apart.min(axis=0).max() <= _SAME_M and apart.min(axis=1).max() <= _SAME_M)


def _points(pose: Floats, position: Floats, ranges: Floats, angles: Floats) -> Floats | None:
    """(2, N) where beams end, world frame [m]; None if nothing is hit."""
    if not len(ranges):
        return None
    own = position[:, None] + ranges * np.stack([np.cos(angles), np.sin(angles)])
    cos, sin = math.cos(pose[2]), math.sin(pose[2])
    result: Floats = np.array([[cos, -sin], [sin, cos]]) @ own + pose[:2, None]
    return result


def _velocities(points: Floats, neighbors: Neighbors, b: int) -> Floats:
    """(2, N) velocity of each point [m/s]: the velocity of the neighbor that it lies on, or 0."""
    result = np.zeros_like(points)
    for k in np.flatnonzero(neighbors.mask[b]).tolist():
        away = np.hypot(*(points - neighbors.position[b, k][:, None]))
        result[:, away <= neighbors.radius[b, k] + _ON_NEIGHBOR_M] = neighbors.velocity[b, k][:, None]
    return result
