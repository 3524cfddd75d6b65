"""``commonroad``: static obstacles and the trajectories of all that moves as a scenario of CommonRoad (XML).

Written for commonroad-io 2026.1. Robots are obstacles of the type ``unknown``, obstacles that move are pedestrians, and
what is static is a pillar. Each robot with a goal is a planning problem as well. A scenario of CommonRoad has no
parts that are not of one object: parts of compounds and legs of lines are obstacles of their own. Maps and visibility
have no counterpart: the map is left out, and an object that comes late or leaves is recorded for as long as they are
there.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import shapely

from irsim.bridges.export.episode import ExportedEpisode
from irsim.bridges.export.registry import Format
from irsim.bridges.recorded import recorded_scene, recorded_states
from irsim.bridges.solids import Box, solids_of
from irsim.common.arrays import Floats
from irsim.common.outline import Circle, Line
from irsim.simulation.scene import SceneObject

__all__ = ["FORMAT"]

_FIRST_OBSTACLE = 1
_DIGITS = 9
"""Digits after the point, of coordinates and times."""
_THICKNESS = 0.05
"""Of legs of lines, which are outside of the rooms that closed lines are the walls of [m]."""


def _write(episodes: Sequence[ExportedEpisode], target: Path, name: str) -> list[str]:
    """Write the scenario of a run."""
    from commonroad.common.common_scenario import Location
    from commonroad.common.file_writer import CommonRoadFileWriter
    from commonroad.common.util import FileFormat
    from commonroad.common.writer.file_writer_interface import OverwriteExistingFile
    from commonroad.planning.planning_problem import PlanningProblemSet
    from commonroad.scenario.scenario import Scenario, Tag

    [episode] = episodes
    scene = recorded_scene(episode.run, episode.limits)
    chosen = {actor.name for actor in episode.actors}
    moving = [agent for agent in scene.agents if agent.name in chosen and agent.moves]
    times, tracks = _tracks(episode, moving)
    scenario = Scenario(dt=scene.step_time, tags={Tag.SIMULATED})
    numbers = iter(range(_FIRST_OBSTACLE, 10**9))
    for agent in scene.agents:
        if not agent.moves:
            scenario.add_objects(list(_static(agent, numbers)))
    for agent, track in zip(moving, tracks, strict=True):
        scenario.add_objects(list(_dynamic(agent, track, times, scene.step_time, numbers)))
    problems = PlanningProblemSet()
    for agent in scene.robots:
        if agent.goals:
            problems.add_planning_problem(_problem(agent, episode.last_step, next(numbers)))
    writer = CommonRoadFileWriter(
        scenario,
        problems,
        author="irsim",
        affiliation="irsim",
        source=f"run {episode.run.id} of {scene.name}",
        tags={Tag.SIMULATED},
        location=Location(),
        decimal_precision=_DIGITS,
        file_format=FileFormat.XML,
    )
    writer.write_to_file(str(target), OverwriteExistingFile.ALWAYS)
    return [] if scene.grid is None else ["the map was left out: CommonRoad has no grids"]


def _tracks(episode: ExportedEpisode, moving: Sequence[SceneObject]) -> tuple[list[int], list[Floats]]:
    """Steps, and (T, 4) x, y [m], yaw [rad], speed [m/s] of each agent that moves."""
    steps: list[int] = []
    rows: list[Floats] = []
    index = [agent.index for agent in moving]
    for state in recorded_states(episode.run, limits=episode.limits):
        speed = np.hypot(*state.twist[index, :2].T)
        rows.append(np.concatenate([state.pose[index], speed[:, None]], axis=1))
        steps.append(state.step)
        episode.progress(1)
    table = np.array(rows).reshape(len(rows), len(moving), 4)
    return steps, [table[:, number] for number in range(len(moving))]


def _parts(agent: SceneObject) -> Iterator[tuple[Any, Floats]]:
    """Shapes of an agent, and the places of their middles, body frame; lines are a rectangle for each leg."""
    from commonroad.geometry.obstacle_shapes.circle_obstacle_shape import CircleObstacleShape
    from commonroad.geometry.obstacle_shapes.polygon_obstacle_shape import PolygonObstacleShape

    for part in agent.parts:
        if isinstance(part, Circle):
            yield CircleObstacleShape(radius=part.radius), np.array(part.center)
            continue
        if not isinstance(part, Line):
            yield PolygonObstacleShape(vertices=part.corners), np.zeros(2)
            continue
        for leg in solids_of(part, _THICKNESS):
            if isinstance(leg, Box):
                yield PolygonObstacleShape(vertices=_corners(leg)), np.zeros(2)


def _corners(box: Box) -> Floats:
    """(4, 2) counterclockwise corners of a box, body frame."""
    cosine, sine = math.cos(box.yaw), math.sin(box.yaw)
    ahead, aside = box.half[0] * np.array([cosine, sine]), box.half[1] * np.array([-sine, cosine])
    return np.add(box.center, [-ahead - aside, ahead - aside, ahead + aside, aside - ahead])


def _static(agent: SceneObject, numbers: Iterator[int]) -> Iterator[Any]:
    from commonroad.scenario.obstacle import ObstacleType, StaticObstacle

    for shape, middle in _parts(agent):
        state = _state(0, _placed(np.array([*agent.pose, 0.0]), middle), initial=True)
        yield StaticObstacle(next(numbers), ObstacleType.PILLAR, shape, state)


def _dynamic(
    agent: SceneObject, track: Floats, steps: Sequence[int], step_time: float, numbers: Iterator[int]
) -> Iterator[Any]:
    """An obstacle for each part of an agent, and for each time that it is in the world without interruption."""
    from commonroad.prediction.prediction import TrajectoryPrediction
    from commonroad.scenario.obstacle import DynamicObstacle, ObstacleType
    from commonroad.scenario.trajectory import Trajectory

    kind = ObstacleType.UNKNOWN if agent.role == "robot" else ObstacleType.PEDESTRIAN
    there = np.isfinite(track[:, 0])
    edges = np.flatnonzero(np.diff(np.concatenate([[False], there, [False]]).astype(np.int8)))
    for begin, end in edges.reshape(-1, 2).tolist():
        for shape, middle in _parts(agent):
            states = [
                _state(steps[row], _placed(track[row], middle), initial=row == begin) for row in range(begin, end)
            ]
            later = states[1:]
            way = TrajectoryPrediction(Trajectory(steps[begin + 1], later), shape) if later else None
            yield DynamicObstacle(next(numbers), kind, shape, states[0], way)


def _placed(row: Floats, middle: Floats) -> Floats:
    """A row x, y, yaw, speed of the middle of a part."""
    x, y, yaw, speed = row.tolist()
    cosine, sine = math.cos(yaw), math.sin(yaw)
    moved = x + cosine * middle[0] - sine * middle[1], y + sine * middle[0] + cosine * middle[1]
    return np.array([*moved, yaw, speed])


def _state(step: int, row: Floats, *, initial: bool) -> Any:
    from commonroad.scenario.state import ExtendedPMState, InitialState

    x, y, yaw, speed = row.tolist()
    place = np.array([x, y])
    if not initial:
        return ExtendedPMState(time_step=step, position=place, velocity=speed, orientation=yaw, acceleration=0.0)
    return InitialState(
        time_step=step, position=place, orientation=yaw, velocity=speed, acceleration=0.0, yaw_rate=0.0, slip_angle=0.0
    )


def _problem(agent: SceneObject, last_step: int, number: int) -> Any:
    """From the start of a robot to a circle around its last goal, within the time of the run."""
    from commonroad.common.util import Interval
    from commonroad.geometry.occupancy.circle_occupancy import CircleOccupancy
    from commonroad.planning.goal import GoalRegion
    from commonroad.planning.planning_problem import PlanningProblem
    from commonroad.scenario.state import CustomState

    x, y, _ = agent.goals[-1]
    region = CircleOccupancy(radius=max(agent.radius, 0.1), circle_center=shapely.Point(x, y))
    goal = CustomState(time_step=Interval(0, max(1, last_step)), position=region)
    start = _state(0, np.array([*agent.pose, 0.0]), initial=True)
    return PlanningProblem(number, start, GoalRegion([goal]))


FORMAT = Format("commonroad", ".xml", _write, libraries=("commonroad",), ranges=False, extra="scenarios", scene=True)
